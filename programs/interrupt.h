/* interrupt.h - what SIGINT, SIGTERM and SIGHUP do.
 *
 * While a picture is computed nothing has been written, and the tool leaves at
 * once with exit code 130.  While a file is written aside and renamed, the
 * first signal is let go: the file becomes whole and the run ends as usual,
 * with exit code 0 when all went well.  So after one signal 130 means that no
 * output was left, and 0 that all of it was.
 *
 * A movie is many files, each whole: the first signal ends it after the frame
 * in hand, with 130, and --resume goes on from there.
 *
 * A second signal ends even the writing at once, with 130; then, where files
 * cannot be without a name (src/base/writer.c), the hidden file
 * .NAME.snow-XXXXXX beside the output may be left.  Its name is the library's
 * secret, so the handler cannot remove it. */
#ifndef INTERRUPT_H
#define INTERRUPT_H

#include <stdbool.h>

void interrupt_install(void);

/* From here to the end of the program files come into being. */
void interrupt_hold(void);

/* The same for a movie, which asks itself; the first signal is told. */
void interrupt_hold_movie(void);

/* Whether a signal has come since. */
bool interrupt_seen(void);

/* From here on nothing is said: of ranks only the first one says that it was
 * interrupted, and none when it has done its work. */
void interrupt_mute(void);

#endif
