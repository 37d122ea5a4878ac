/* interrupt.h - what SIGINT and SIGTERM do.
 *
 * While a picture is computed nothing has been written, and the tool leaves at
 * once with exit code 130.  While a file is written aside and renamed, the
 * signal waits for its end: then the file is whole and the run is done.  So 130
 * means that no output was left.  A second signal does not wait. */
#ifndef INTERRUPT_H
#define INTERRUPT_H

void interrupt_install(void);

/* Around the writing of a file. */
void interrupt_hold(void);
void interrupt_release(void);

#endif
