/* report.h - talk on standard error, data on standard output, figures in
 * JSON. */
#ifndef REPORT_H
#define REPORT_H

#include "options.h"

#include <jansson.h>

/* One line on standard error, "snowglass: " before it; what could move the
 * cursor is replaced, so that a file's name cannot write more lines. */
void say(const char *format, ...) SNOW_PRINTF(1, 2);

/* Tells a fault and answers the exit code of it. */
int fail_usage(const char *format, ...) SNOW_PRINTF(1, 2);
int fail_output(const char *format, ...) SNOW_PRINTF(1, 2);
int fail_status(const snow_context *context, snow_status status);

/* The same for a stage that was given a volume in memory: it can find fault
 * with the input, but not say which file that came from. */
int fail_volume(const snow_context *context, snow_status status,
                const char *input);

/* Makes a context whose remarks go to standard error, unless quiet.
 * Answers GO_ON or an exit code. */
int open_context(const options *asked, snow_context **out);

/* Seconds of a steady clock. */
double seconds_now(void);

/* Names a stage on standard error as --progress says; NULL ends the last. */
void progress(const options *asked, const char *stage);

/* Ends standard output: what could not be written is an error.
 * Answers an exit code. */
int finish_stdout(void);

/* A JSON number; null for what JSON cannot write. */
json_t *json_number(double value);
json_t *json_vector(const double *values, size_t count);
json_t *json_sizes(const int64_t *values, size_t count);

/* Writes an object to standard output and frees it.  Answers an exit code. */
int print_json(json_t *object);

/* Whether a path is standard output, a pipe or a device: what a rename may not
 * replace, and what may wait for its reader for ever. */
bool is_special(const char *path);

/* Whether two paths name one file, also one that is not there yet. */
bool same_place(const char *a, const char *b);

/* Whether --stats can go where it shall: asked before rendering. */
int check_stats_path(const char *path, bool overwrite);

/* Writes an object to a file, aside and renamed, or through to what is no
 * plain file; "-" is standard output.  Frees it.  Answers an exit code. */
int write_json(json_t *object, const char *path);

#endif
