/* report.c - everything that people and scripts read, except the picture.
 *
 * Standard output carries data only; the rest is one line at a time on
 * standard error. */
#include "report.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* Room for a message of the library (10 KiB) and what is said around it. */
#define LINE_BYTES 12288

/* One line; digits that bring every double back. */
#define JSON_FORM JSON_REAL_PRECISION(17)

/* Whether the terminal's last line names a stage, to be wiped before talk. */
static bool stage_shown;

static void wipe_stage(void) {
    if (stage_shown)
        fputs("\r\033[K", stderr);
    stage_shown = false;
}

/* File names come from outside: their control characters could forge lines or
 * drive the terminal. */
static void say_list(const char *format, va_list arguments) {
    char line[LINE_BYTES];
    vsnprintf(line, sizeof line, format, arguments);
    for (char *at = line; *at; at++) {
        if ((unsigned char)*at < ' ' || *at == 127)
            *at = '?';
    }
    wipe_stage();
    fprintf(stderr, "snowglass: %s\n", line);
}

void say(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    say_list(format, arguments);
    va_end(arguments);
}

int fail_usage(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    say_list(format, arguments);
    va_end(arguments);
    return SNOW_BAD_USAGE;
}

int fail_output(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    say_list(format, arguments);
    va_end(arguments);
    return SNOW_BAD_OUTPUT;
}

/* The message is complete already: file, fault, remedy. */
int fail_status(const snow_context *context, snow_status status) {
    const char *message = context ? snow_context_message(context) : "";
    say("%s", *message ? message : snow_status_text(status));
    return (int)status;
}

int fail_volume(const snow_context *context, snow_status status,
                const char *input) {
    if (status != SNOW_BAD_INPUT)
        return fail_status(context, status);
    say("%s: %s", input, snow_context_message(context));
    return (int)status;
}

static void hear_notice(void *user, const char *text) {
    (void)user;
    say("note: %s", text);
}

int open_context(const options *asked, snow_context **out) {
    snow_status status = snow_context_new(NULL, out);
    if (status != SNOW_OK)
        return fail_status(NULL, status);
    if (asked->verbosity >= 0)
        snow_context_set_notice(*out, hear_notice, NULL);
    return GO_ON;
}

double seconds_now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* "dumb" terminals (editors, logs) cannot wipe a line. */
static bool is_terminal(void) {
    const char *term = getenv("TERM");
    return isatty(STDERR_FILENO) && term && strcmp(term, "dumb") != 0;
}

void progress(const options *asked, const char *stage) {
    if (asked->verbosity < 0 || strcmp(asked->progress, "never") == 0)
        return;
    bool always = strcmp(asked->progress, "always") == 0;
    wipe_stage();
    if (is_terminal()) {
        fputs(stage ? stage : "", stderr);
        stage_shown = stage != NULL;
    } else if (always && stage) {
        say("%s", stage);
    }
    fflush(stderr);
}

/* printf only fills a buffer: a full disk or a reader that went away shows
 * when it is flushed, and must not end in exit code 0. */
int finish_stdout(void) {
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout))
        return SNOW_OK;
    return fail_output("standard output: %s; write to a file with room",
                       errno ? strerror(errno) : "cannot be written");
}

/* JSON knows no NaN and no infinity; jansson would drop the key silently. */
json_t *json_number(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *json_vector(const double *values, size_t count) {
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(array, json_number(values[i]));
    return array;
}

json_t *json_sizes(const int64_t *values, size_t count) {
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(array, json_integer(values[i]));
    return array;
}

int print_json(json_t *object) {
    if (json_dumpf(object, stdout, JSON_FORM) == 0)
        putchar('\n');
    json_decref(object);
    return finish_stdout();
}

bool is_special(const char *path) {
    struct stat what;
    if (strcmp(path, "-") == 0)
        return true;
    return stat(path, &what) == 0 && !S_ISREG(what.st_mode) &&
           !S_ISDIR(what.st_mode);
}

/* The folder of a path, "." when it has none. */
static void folder_of(const char *path, char *out, size_t size) {
    const char *slash = strrchr(path, '/');
    if (!slash)
        snprintf(out, size, ".");
    else
        snprintf(out, size, "%.*s", (int)(slash == path ? 1 : slash - path),
                 path);
}

bool same_place(const char *a, const char *b) {
    struct stat of_a, of_b;
    if (stat(a, &of_a) == 0 && stat(b, &of_b) == 0)
        return S_ISREG(of_a.st_mode) && of_a.st_dev == of_b.st_dev &&
               of_a.st_ino == of_b.st_ino;
    const char *slash_a = strrchr(a, '/'), *slash_b = strrchr(b, '/');
    if (strcmp(slash_a ? slash_a + 1 : a, slash_b ? slash_b + 1 : b) != 0)
        return false;
    char folder_a[LINE_BYTES], folder_b[LINE_BYTES];
    folder_of(a, folder_a, sizeof folder_a);
    folder_of(b, folder_b, sizeof folder_b);
    return stat(folder_a, &of_a) == 0 && stat(folder_b, &of_b) == 0 &&
           of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
}

/* The same rules as for pictures: figures of an earlier run are results too. */
int check_stats_path(const char *path, bool overwrite) {
    struct stat what;
    if (is_special(path))
        return GO_ON;
    if (stat(path, &what) == 0 && S_ISDIR(what.st_mode))
        return fail_output("%s: is a folder; name a file", path);
    if (stat(path, &what) == 0 && !overwrite)
        return fail_output("%s: exists; give --overwrite or another name",
                           path);
    char folder[LINE_BYTES];
    folder_of(path, folder, sizeof folder);
    if (access(folder, W_OK | X_OK) != 0)
        return fail_output("%s: %s; choose a folder that can be written", path,
                           strerror(errno));
    return GO_ON;
}

/* Flushes too, so that an error shows here and not in fclose. */
static int dump_json(json_t *object, FILE *file) {
    bool good = json_dumpf(object, file, JSON_FORM) == 0;
    good = good && fputc('\n', file) != EOF && fflush(file) == 0;
    return good ? 0 : -1;
}

/* Opens a new file beside `path` and leaves its name in `aside`. */
static FILE *open_aside(const char *path, char *aside, size_t size) {
    int length = snprintf(aside, size, "%s.XXXXXX", path);
    if (length < 0 || (size_t)length >= size) {
        errno = ENAMETOOLONG;
        return NULL;
    }
    int handle = mkstemp(aside);
    if (handle < 0)
        return NULL;
    mode_t mask = umask(0);
    umask(mask);
    fchmod(handle, 0666 & ~mask); /* mkstemp's 0600 is for secrets */
    return fdopen(handle, "w");
}

/* As the library does for pictures: whole under its name, or absent. */
static int write_aside(json_t *object, const char *path) {
    char aside[LINE_BYTES];
    FILE *file = open_aside(path, aside, sizeof aside);
    if (!file)
        return -1;
    int done = dump_json(object, file);
    if (done == 0 && fsync(fileno(file)) != 0)
        done = -1;
    if (fclose(file) != 0 || done != 0 || rename(aside, path) != 0) {
        int reason = errno;
        unlink(aside);
        errno = reason;
        return -1;
    }
    return 0;
}

/* For pipes and devices, which a rename would replace by a plain file. */
static int write_through(json_t *object, const char *path) {
    FILE *file = fopen(path, "w");
    if (!file)
        return -1;
    int done = dump_json(object, file);
    int reason = errno;
    if (fclose(file) != 0)
        return -1;
    errno = reason;
    return done;
}

int write_json(json_t *object, const char *path) {
    if (strcmp(path, "-") == 0)
        return print_json(object);
    errno = 0;
    int done = is_special(path) ? write_through(object, path)
                                : write_aside(object, path);
    json_decref(object);
    if (done == 0)
        return SNOW_OK;
    return fail_output("%s: %s; choose a place that can be written", path,
                       errno ? strerror(errno) : "cannot be written");
}
