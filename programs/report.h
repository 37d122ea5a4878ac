/* report.h - talk on standard error, data on standard output, figures in
 * JSON. */
#ifndef REPORT_H
#define REPORT_H

#include "options.h"

#include <jansson.h>

/* One line on standard error, "snowglass: " before it; what could move the
 * cursor is replaced, so that a file's name cannot write more lines.  A rank
 * that does not talk (launch.h) only keeps the line. */
void say(const char *format, ...) SNOW_PRINTF(1, 2);

/* The last line of a rank that does not talk, "" before any. */
const char *last_said(void);

/* Tells a fault and answers the exit code of it. */
int fail_usage(const char *format, ...) SNOW_PRINTF(1, 2);
int fail_output(const char *format, ...) SNOW_PRINTF(1, 2);
int fail_status(const snow_context *context, snow_status status);

/* The same for a stage that was given a volume in memory: it can find fault
 * with the input, or have no room for it, but not say which file that came
 * from, unless it was read meanwhile. */
int fail_volume(const snow_context *context, snow_status status,
                const char *input);

/* Makes a context whose remarks go to standard error, unless quiet.
 * Answers GO_ON or an exit code. */
int open_context(const options *asked, snow_context **out);

/* Whether a context's remarks are heard; never when quiet, and on rank 0 only.
 */
void hear_notices(const options *asked, snow_context *context, bool hear);

/* The context of what is rendered: that of the communicator, where there is
 * one, and else as above.  Answers GO_ON or an exit code. */
int open_render_context(const options *asked, snow_context **out);
void close_render_context(snow_context *context);

/* Seconds of a steady clock. */
double seconds_now(void);

/* Names a stage on standard error as --progress says; NULL ends the last. */
void progress(const options *asked, const char *stage);

/* The same of a stage that may last: its seconds are told every 10 s, on a
 * terminal every second, until progress_end.  Between the two only the library
 * may speak, and nobody else begins a stage. */
void progress_begin(const options *asked, const char *stage);
void progress_end(const options *asked);

/* Whether --progress may say anything, and whether it goes to a terminal, where
 * a line is written over. */
bool progress_is_wanted(const options *asked);
bool progress_is_live(void);

/* Ends standard output: what could not be written is an error.
 * Answers an exit code. */
int finish_stdout(void);

/* A JSON number; null for what JSON cannot write. */
json_t *json_number(double value);
json_t *json_vector(const double *values, size_t count);
json_t *json_sizes(const int64_t *values, size_t count);

/* One line; digits that bring every double back. */
#define JSON_FORM JSON_REAL_PRECISION(17)

/* Writes an object to standard output and frees it.  Answers an exit code. */
int print_json(json_t *object);

#endif
