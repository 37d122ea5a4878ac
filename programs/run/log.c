/* log.c - everything that people and scripts read, except the picture.
 *
 * Standard output carries only data; messages go to standard error, one line
 * each. */
#include "run/log.h"
#include "run/interrupt.h"
#include "run/start.h"

#include <snowglass/extend.h>

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
#define SANITIZED
#include <sanitizer/common_interface_defs.h>
#include <stdint.h>
#endif

/* Room for a message of the library (10 KiB) and the words around it. */
#define LINE_BYTES 12288

/* Whether the last line on the terminal is a stage, to be erased before a
 * message. */
static bool stage_shown;

/* The last message of a rank that does not print. */
static char kept[LINE_BYTES];

/* Held while the last line of the terminal changes: a thread of its own reports
 * a long stage. */
static pthread_mutex_t talking = PTHREAD_MUTEX_INITIALIZER;

/* Where messages go, if not to standard error. */
static FILE *own;

/* Libraries underneath write to descriptor 2 itself. */
void silence_others(void) {
    int kept_open = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
    int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    own = kept_open >= 0 && nowhere >= 0 ? fdopen(kept_open, "w") : NULL;
    if (own) {
        setvbuf(own, NULL, _IONBF, 0);
        interrupt_write_to(kept_open);
        (void)dup2(nowhere, STDERR_FILENO);
#ifdef SANITIZED
        __sanitizer_set_report_fd((void *)(intptr_t)kept_open);
#endif
    } else if (kept_open >= 0) {
        close(kept_open);
    }
    if (nowhere >= 0)
        close(nowhere);
}

/* Who hears messages instead. */
static void (*show_line)(void *user, const char *line);
static void *show_user;

void say_to(void (*show)(void *user, const char *line), void *user) {
    show_line = show;
    show_user = user;
}

/* The lines that wait, each with its end. */
static _Thread_local FILE *later;
static _Thread_local char *lines;
static _Thread_local size_t lines_bytes;

static void wipe_stage(void) {
    if (stage_shown)
        fputs("\r\033[K", stderr);
    stage_shown = false;
}

/* File names come from outside: their control characters could forge lines or
 * control the terminal. */
static void say_list(const char *format, va_list arguments) {
    char line[LINE_BYTES];
    vsnprintf(line, sizeof line, format, arguments);
    snow_text_to_line(line, sizeof line);
    if (later) {
        fprintf(later, "%s\n", line);
        return;
    }
    if (show_line) {
        show_line(show_user, line);
        return;
    }
    if (!process_talks()) {
        memcpy(kept, line, sizeof kept);
        return;
    }
    pthread_mutex_lock(&talking);
    wipe_stage();
    fprintf(own ? own : stderr, "snowglass: %s\n", line);
    pthread_mutex_unlock(&talking);
}

const char *last_said(void) {
    return kept;
}

void say(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    say_list(format, arguments);
    va_end(arguments);
}

void say_later(void) {
    if (!later)
        later = open_memstream(&lines, &lines_bytes);
}

void say_now(bool drop) {
    if (!later)
        return;
    fclose(later);
    later = NULL;
    for (char *at = lines, *end; !drop && at && (end = strchr(at, '\n'));
         at = end + 1)
        say("%.*s", (int)(end - at), at);
    free(lines);
    lines = NULL;
}

int fail_with(snow_status status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    say_list(format, arguments);
    va_end(arguments);
    return (int)status;
}

/* The library's message is complete: file, error, advice.  A lost rank makes
 * all frames in flight fail; it is reported once. */
int fail_status(const snow_context *context, snow_status status) {
    static bool reported_broken;
    if (status == SNOW_STATUS_STOPPED) /* interrupt.c has said so */
        return EXIT_INTERRUPTED;
    if (process_broken() && reported_broken)
        return (int)status;
    reported_broken = process_broken();
    const char *message = context ? snow_context_message(context) : "";
    say("%s", *message ? message : snow_status_description(status));
    return (int)status;
}

int check_status(const snow_context *context, snow_status status) {
    return status == SNOW_STATUS_OK ? CONTINUE : fail_status(context, status);
}

int fail_volume(const snow_context *context, snow_status status,
                const char *input) {
    const char *message = snow_context_message(context);
    bool of_input =
        status == SNOW_STATUS_BAD_INPUT || status == SNOW_STATUS_NO_MEMORY;
    if (!of_input || strncmp(message, input, strlen(input)) == 0)
        return fail_status(context, status);
    say("%s: %s", input, message);
    return (int)status;
}

int check_volume(const snow_context *context, snow_status status,
                 const char *input) {
    return status == SNOW_STATUS_OK ? CONTINUE
                                    : fail_volume(context, status, input);
}

/* So many notes are remembered, as many bytes of each. */
#define NOTES 16
#define NOTE_BYTES 256

/* All steps of a file cause the same notes, one after another; each is printed
 * once.  Threads read steps at the same time. */
static bool is_new_note(const char *text) {
    static pthread_mutex_t reading = PTHREAD_MUTEX_INITIALIZER;
    static char notes[NOTES][NOTE_BYTES];
    static size_t count;
    bool found = false;
    pthread_mutex_lock(&reading);
    for (size_t n = 0; n < NOTES && n < count; n++)
        found |= strncmp(notes[n], text, NOTE_BYTES - 1) == 0;
    if (!found)
        snprintf(notes[count++ % NOTES], NOTE_BYTES, "%s", text);
    pthread_mutex_unlock(&reading);
    return !found;
}

static void show_warning(void *user, const char *text) {
    (void)user;
    if (is_new_note(text))
        say("note: %s", text);
}

int open_context(const options *opts, snow_context **out) {
    snow_status status = snow_context_new(NULL, out);
    if (status != SNOW_STATUS_OK)
        return fail_status(NULL, status);
    show_warnings(opts, *out, true);
    return CONTINUE;
}

void show_warnings(const options *opts, snow_context *context, bool show) {
    show = show && opts->verbosity >= 0 && process_talks();
    snow_context_set_warning(context, show ? show_warning : NULL, NULL);
}

int open_render_context(const options *opts, snow_context **out) {
    if (process_ranks() == 1)
        return open_context(opts, out);
    *out = snow_comm_context(process_comm());
    show_warnings(opts, *out, true);
    return CONTINUE;
}

void close_render_context(snow_context *context) {
    if (process_ranks() == 1)
        snow_context_free(context);
}

double seconds_now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* "dumb" terminals (editors, logs) cannot erase a line. */
bool progress_is_live(void) {
    const char *term = getenv("TERM");
    return isatty(STDERR_FILENO) && term && strcmp(term, "dumb") != 0;
}

bool progress_is_wanted(const options *opts) {
    return process_talks() && opts->verbosity >= 0 &&
           strcmp(opts->progress, "never") != 0;
}

void progress(const options *opts, const char *stage) {
    if (!progress_is_wanted(opts))
        return;
    bool always = strcmp(opts->progress, "always") == 0;
    bool live = progress_is_live();
    pthread_mutex_lock(&talking);
    wipe_stage();
    if (live)
        fputs(stage ? stage : "", stderr);
    stage_shown = live && stage;
    fflush(stderr);
    pthread_mutex_unlock(&talking);
    if (!live && always && stage)
        say("%s", stage);
}

/* printf only fills a buffer: a full disk or a reader that went away shows
 * when it is flushed, and must not end in exit code 0. */
int finish_stdout(void) {
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout))
        return SNOW_STATUS_OK;
    return fail_output(
        "standard output: %s; write to a file system with free space",
        errno ? strerror(errno) : "cannot be written");
}
