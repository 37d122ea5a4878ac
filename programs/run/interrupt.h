/* interrupt.h - handles SIGINT, SIGTERM and SIGHUP.
 *
 * While a picture is computed nothing has been written.  The library is asked
 * to stop (snow_settings.stop, snow_context_set_progress), and the tool ends in
 * order with exit code 130; where that takes longer than INTERRUPT_SECONDS, or
 * where the library is not at work, the handler ends it.  While a file is
 * written aside and renamed, the first signal is let go: the file becomes whole
 * and the run ends as usual, with exit code 0 when all went well.  So after one
 * signal 130 means that no output was left, and 0 that all of it was.
 *
 * A movie is many files, each whole: the first signal stops the picture that is
 * drawn and ends the movie when the frames that are being written are whole,
 * with 130; --resume goes on from there.
 *
 * A second signal stops even the writing at once, with code 130.  On file
 * systems without unnamed files (src/io/output_file.c) the hidden file
 * .NAME.snow-XXXXXX may then be left beside the output.  Only the library knows
 * its name, so the handler cannot remove it. */
#ifndef INTERRUPT_H
#define INTERRUPT_H

#include <stdbool.h>

void interrupt_install(void);

#define INTERRUPT_SECONDS 0.06

/* From here to the other call a signal is left to interrupt_asked.  The other
 * one says whether there was one, and the run is to end with 130. */
void interrupt_guard(void);
bool interrupt_unguard(void);

/* Whether a signal has come: a snow_stop_fn. */
bool interrupt_asked(void *unused);

/* From here to the end of the program files come into being. */
void interrupt_hold(void);

/* All files are there: signals change the exit status no more. */
void interrupt_finish(void);

/* The same for a movie, which polls interrupt_asked; the first signal is
 * reported. */
void interrupt_hold_movie(void);

/* From here on nothing is printed.  Of all ranks only the first reports an
 * interruption, and none does when the work is done. */
void interrupt_mute(void);

/* Messages go to a descriptor other than that of standard error. */
void interrupt_write_to(int descriptor);

#endif
