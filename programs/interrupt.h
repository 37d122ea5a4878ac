/* interrupt.h - what SIGINT and SIGTERM do.
 *
 * While a picture is computed nothing has been written, and the tool leaves at
 * once with exit code 130.  While a file is written aside and renamed, the
 * signal is let go: the file becomes whole and the run ends as usual.  So 130
 * means that no output was left.  A second signal ends the run at once. */
#ifndef INTERRUPT_H
#define INTERRUPT_H

void interrupt_install(void);

/* From here to the end of the program a file comes into being. */
void interrupt_hold(void);

#endif
