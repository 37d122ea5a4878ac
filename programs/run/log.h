/* log.h - messages on standard error, data on standard output, figures in
 * JSON. */
#ifndef REPORT_H
#define REPORT_H

#include "options/options.h"

#include <jansson.h>

/* Prints one line, "snowglass: MESSAGE", on standard error.  Control characters
 * are replaced, so a file name cannot add lines.  A rank that does not print
 * (start.h) only keeps the line. */
void say(const char *format, ...) SNOW_PRINTF(1, 2);

/* From here on messages go to a function instead, which any thread calls. */
void say_to(void (*show)(void *user, const char *line), void *user);

/* What this thread says waits from here on: until it is said, or dropped since
 * what it was about is tried again. */
void say_later(void);
void say_now(bool drop);

/* The last line of a rank that does not print, or "". */
const char *last_said(void);

/* Print an error and return its exit code. */
int fail_with(snow_status status, const char *format, ...) SNOW_PRINTF(2, 3);
#define fail_usage(...) fail_with(SNOW_STATUS_BAD_USAGE, __VA_ARGS__)
#define fail_output(...) fail_with(SNOW_STATUS_BAD_OUTPUT, __VA_ARGS__)
#define fail_memory(...) fail_with(SNOW_STATUS_NO_MEMORY, __VA_ARGS__)
int fail_status(const snow_context *context, snow_status status);

/* The same for a stage that gets a volume in memory.  Its errors about the
 * input, or its size, do not name the file unless it was read meanwhile; this
 * adds the name. */
int fail_volume(const snow_context *context, snow_status status,
                const char *input);

/* The same where the status may be SNOW_STATUS_OK, for which they return
 * CONTINUE. */
int check_status(const snow_context *context, snow_status status);
int check_volume(const snow_context *context, snow_status status,
                 const char *input);

/* From here on only this program's own messages are seen: what the libraries
 * underneath write to standard error is dropped. */
void silence_others(void);

/* Creates a context whose warnings go to standard error, unless quiet.  Returns
 * CONTINUE or an exit code. */
int open_context(const options *opts, snow_context **out);

/* Sends a context's warnings to standard error or drops them; they are printed
 * on rank 0 only, and never when quiet. */
void show_warnings(const options *opts, snow_context *context, bool show);

/* The context for rendering: the communicator's if there is one, otherwise a
 * new one as above.  Returns CONTINUE or an exit code. */
int open_render_context(const options *opts, snow_context **out);
void close_render_context(snow_context *context);

/* Seconds of a monotonic clock. */
double seconds_now(void);

/* Prints the name of a stage on standard error, as --progress requests; NULL
 * ends the last stage. */
void progress(const options *opts, const char *stage);

/* The same for a stage that may take long: its seconds are printed every 10 s,
 * on a terminal every second, until progress_end.  In between only the library
 * may print, and no other stage may begin. */
void progress_begin(const options *opts, const char *stage);
void progress_end(const options *opts);

/* Hears of the library's progress (a snow_progress_fn): it is a part of such a
 * stage, shown as a bar on a terminal.  Asks for a stop after a signal. */
bool progress_show(void *unused, snow_stage stage, double fraction);

/* "[######--------------] " */
void progress_bar(double fraction, char *out, size_t size);

/* Whether --progress may say anything, and whether it goes to a terminal, where
 * a line is written over. */
bool progress_is_wanted(const options *opts);
bool progress_is_live(void);

/* Flushes standard output and reports a failed write.  Returns an exit code. */
int finish_stdout(void);

/* A JSON number; null for NaN and infinity. */
json_t *json_number(double value);
json_t *json_vector(const double *values, size_t count);
json_t *json_sizes(const int64_t *values, size_t count);
json_t *json_names(const char *(*at)(size_t)); /* until it returns NULL */

/* One line; digits that bring every double back. */
#define JSON_FORM JSON_REAL_PRECISION(17)

/* Writes an object to standard output and frees it.  Returns an exit code. */
int print_json(json_t *object);

#endif
