/* job.c - implements job.h.  A thread of its own waits for orders and for the
 * tool: no page and no picture waits for either. */
#include "movies/job.h"
#include "movie/movie_encoder.h"
#include "movies/child.h"
#include "movies/folder.h"
#include "options/options.h"
#include "run/log.h"

#include <snowglass/snowglass.h>

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

/* Between two looks at the orders; what the tool has for an orderly end. */
#define POLL_SECONDS 0.1
#define STOP_SECONDS 3

enum job_state { JOB_NONE, JOB_WRITING, JOB_DONE, JOB_FAILED, JOB_CANCELLED };

struct movie_job {
    outbox *box;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool ends, cancels, threaded;
    enum job_state state;
    char *command; /* of the next movie */
    movie_order order;
    char name[100];
    char text[CHILD_LINE_BYTES]; /* the stage, or why it failed */
    char last[CHILD_LINE_BYTES]; /* what the tool said last, but for its frames
                                  */
    int64_t frame, bytes;
    int pages;
    double alone_since;
    private_folder folder;
    char path[PATH_MAX];
};

/* --- what is offered ------------------------------------------------------ */

json_t *job_offer(void) {
    const bool encoder = encoder_is_there();
    const bool webp = snow_image_format_bits("m.webp") > 0;
    json_t *formats = json_array();
    for (size_t i = 0; order_format(i); i++)
        if (strcmp(order_format(i), "webp") == 0 ? webp : encoder)
            json_array_append_new(formats, json_string(order_format(i)));
    return json_pack("{s:o, s:s}", "formats", formats, "note",
                     encoder ? ""
                     : webp
                         ? "ffmpeg is not installed where the viewer runs: "
                           "MP4, WebM and GIF need it; animated WebP does not."
                         : "ffmpeg is not installed where the viewer runs, "
                           "which movies need.");
}

/* --- what pages hear ------------------------------------------------------ */

/* Under the lock. */
static void tell(movie_job *j) {
    static const char *const names[] = {"none", "writing", "done", "failed",
                                        "cancelled"};
    json_t *tree = json_pack("{s:s, s:s, s:s, s:s, s:I, s:I, s:I, s:s}", "t",
                             "movie", "state", names[j->state], "name", j->name,
                             "tag", j->order.tag, "frame", (json_int_t)j->frame,
                             "frames", (json_int_t)j->order.frames, "bytes",
                             (json_int_t)j->bytes, "text", j->text);
    char *text = json_dumps(tree, JSON_COMPACT);
    outbox_put_text(j->box, 0, MESSAGE_MOVIE, text);
    free(text);
    json_decref(tree);
}

/* What the tool says, without the folder, which is nobody's business, and what
 * no page can do. */
static void clean_line(const movie_job *j, const char *line,
                       char out[CHILD_LINE_BYTES]) {
    static const char mark[] = "snowglass: ";
    const size_t length = strlen(j->folder.path);
    size_t used = 0;
    if (strncmp(line, mark, strlen(mark)) == 0)
        line += strlen(mark);
    while (*line && *line != ';' && used < CHILD_LINE_BYTES - 1) {
        if (length && strncmp(line, j->folder.path, length) == 0)
            line += length + (line[length] == '/');
        else
            out[used++] = *line++;
    }
    out[used] = 0;
    json_t *is_text = json_string(out);
    if (!is_text)
        snprintf(out, CHILD_LINE_BYTES, "it says what is no text");
    json_decref(is_text);
}

/* "frame 12 of 120, 3 a second, 36 s left", or a stage. */
static void take_line(movie_job *j, const char *line) {
    char clean[CHILD_LINE_BYTES];
    long long frame;
    int used = 0;
    clean_line(j, line, clean);
    pthread_mutex_lock(&j->lock);
    if (sscanf(clean, "frame %lld of %*d%n", &frame, &used) == 1 && used) {
        const char *left = strrchr(clean, ',');
        j->frame = frame;
        snprintf(j->text, sizeof j->text, "%s", left ? left + 2 : "");
    } else {
        snprintf(j->text, sizeof j->text, "%s", clean);
        snprintf(j->last, sizeof j->last, "%s", clean);
    }
    tell(j);
    pthread_mutex_unlock(&j->lock);
}

/* --- the work ------------------------------------------------------------- */

/* Whether nobody waits for it any more; under the lock. */
static bool is_unwanted(const movie_job *j) {
    return j->ends || j->cancels ||
           (!j->pages && seconds_now() - j->alone_since > JOB_ALONE_SECONDS);
}

static bool is_to_stop(movie_job *j) {
    pthread_mutex_lock(&j->lock);
    const bool stops = is_unwanted(j);
    pthread_mutex_unlock(&j->lock);
    return stops;
}

/* Until it has ended; its exit code.  Where nobody waits any more it is asked
 * to end, and after some time made to. */
static int follow(movie_job *j, child *c) {
    const struct timespec pause = {.tv_nsec = (long)(1e9 * POLL_SECONDS)};
    char line[CHILD_LINE_BYTES];
    double asked = 0;
    int code = 0;
    while (!child_ended(c, &code)) {
        if (child_read(c, POLL_SECONDS, line))
            take_line(j, line);
        else if (c->messages < 0)
            nanosleep(&pause, NULL);
        if (asked <= 0 && is_to_stop(j)) {
            asked = seconds_now();
            child_stop(c, false);
        }
        if (asked > 0 && seconds_now() - asked > STOP_SECONDS)
            child_stop(c, true);
    }
    while (child_read(c, 0, line))
        take_line(j, line);
    child_close(c);
    return code;
}

/* What to do about a fault, by the exit code of the tool. */
static void write_fault(movie_job *j, int code) {
    const char *what = code == SNOW_STATUS_BAD_OUTPUT
                           ? "make space where the viewer runs, or start it "
                             "with another TMPDIR"
                       : code == SNOW_STATUS_NO_MEMORY
                           ? "choose a smaller size, or crop the volume"
                           : "try its command in a terminal";
    if (code > 128)
        snprintf(j->text, sizeof j->text,
                 "it was ended by signal %d, perhaps for lack of memory; %s",
                 code - 128, what);
    else
        snprintf(j->text, sizeof j->text, "%.400s; %s", j->last, what);
}

/* Under the lock.  An empty picture is one, too. */
static void note_end(movie_job *j, int code) {
    struct stat what = {.st_size = 0};
    const bool whole = (code == SNOW_STATUS_OK || code == EXIT_EMPTY) &&
                       stat(j->path, &what) == 0;
    j->bytes = (int64_t)what.st_size;
    if (is_unwanted(j)) {
        j->state = JOB_CANCELLED;
        j->text[0] = 0;
    } else if (whole) {
        j->state = JOB_DONE;
        snprintf(j->text, sizeof j->text, "%s",
                 code == EXIT_EMPTY ? "nothing is visible in it" : "");
    } else {
        j->state = JOB_FAILED;
        write_fault(j, code);
    }
    if (j->state != JOB_DONE)
        folder_remove(&j->folder);
    tell(j);
}

/* Runs the tool, without the lock. */
static int write_movie(movie_job *j, const char *command) {
    child c;
    char **words = child_words(command, j->path);
    int number = words ? child_start(words, &c) : ENOMEM;
    free(words);
    if (number == 0)
        return follow(j, &c);
    pthread_mutex_lock(&j->lock);
    snprintf(j->last, sizeof j->last, "snowglass cannot be started: %s",
             strerror(number));
    pthread_mutex_unlock(&j->lock);
    return SNOW_STATUS_FAILED;
}

/* A movie that nobody wants any more is taken away. */
static void discard(movie_job *j) {
    folder_remove(&j->folder);
    j->cancels = false;
    j->state = JOB_NONE;
    tell(j);
}

static void wait_for_change(movie_job *j) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += 1;
    pthread_cond_timedwait(&j->changed, &j->lock, &until);
}

static void *work(void *user) {
    movie_job *j = user;
    pthread_mutex_lock(&j->lock);
    while (!j->ends) {
        char *command = j->command;
        j->command = NULL;
        if (command) {
            tell(j);
            pthread_mutex_unlock(&j->lock);
            const int code = write_movie(j, command);
            pthread_mutex_lock(&j->lock);
            free(command);
            note_end(j, code);
            j->cancels = false;
        } else if (j->state != JOB_NONE && is_unwanted(j))
            discard(j);
        else
            wait_for_change(j);
    }
    pthread_mutex_unlock(&j->lock);
    return NULL;
}

/* --- for others ----------------------------------------------------------- */

movie_job *job_new(outbox *box) {
    movie_job *j = calloc(1, sizeof *j);
    if (!j)
        return NULL;
    pthread_mutex_init(&j->lock, NULL);
    pthread_cond_init(&j->changed, NULL);
    j->box = box;
    return j;
}

void job_end(movie_job *j) {
    if (!j)
        return;
    pthread_mutex_lock(&j->lock);
    j->ends = true;
    pthread_cond_signal(&j->changed);
    pthread_mutex_unlock(&j->lock);
    if (j->threaded)
        pthread_join(j->thread, NULL);
    j->threaded = false;
    folder_remove(&j->folder);
}

void job_free(movie_job *j) {
    if (!j)
        return;
    job_end(j);
    free(j->command);
    pthread_cond_destroy(&j->changed);
    pthread_mutex_destroy(&j->lock);
    free(j);
}

/* Under the lock.  The movie before goes when there is room for another. */
static const char *prepare(movie_job *j, const char *name) {
    static char fault[PATH_MAX];
    private_folder made;
    int number = folder_make(&made);
    if (number == 0 && !j->threaded) {
        number = pthread_create(&j->thread, NULL, work, j);
        j->threaded = number == 0;
    }
    if (number != 0) {
        folder_remove(&made);
        snprintf(fault, sizeof fault,
                 "movie: cannot be begun in %s: %s; make space there, or start "
                 "the viewer with another TMPDIR",
                 folder_parent(), strerror(number));
        return fault;
    }
    folder_remove(&j->folder);
    j->folder = made;
    snprintf(j->path, sizeof j->path, "%s/%s", j->folder.path, name);
    return NULL;
}

const char *job_begin(movie_job *j, char *command, const char *name,
                      const movie_order *order) {
    pthread_mutex_lock(&j->lock);
    const char *fault =
        j->state == JOB_WRITING
            ? "movie: one is being written; wait for it, or cancel it"
        : j->state == JOB_DONE && !order->overwrite
            ? "movie: one is written already; fetch it, then discard it or "
              "order with overwrite"
            : prepare(j, name);
    if (fault) {
        free(command);
    } else {
        j->state = JOB_WRITING;
        j->cancels = false;
        j->order = *order;
        j->frame = j->bytes = 0;
        j->command = command;
        j->text[0] = j->last[0] = 0;
        snprintf(j->name, sizeof j->name, "%s", name);
        pthread_cond_signal(&j->changed);
    }
    pthread_mutex_unlock(&j->lock);
    return fault;
}

void job_cancel(movie_job *j) {
    pthread_mutex_lock(&j->lock);
    j->cancels = j->state != JOB_NONE;
    pthread_cond_signal(&j->changed);
    pthread_mutex_unlock(&j->lock);
}

void job_note_pages(movie_job *j, int count) {
    pthread_mutex_lock(&j->lock);
    if (j->pages && !count)
        j->alone_since = seconds_now();
    j->pages = count;
    pthread_mutex_unlock(&j->lock);
}

int job_open(movie_job *j, char name[100]) {
    pthread_mutex_lock(&j->lock);
    int file = j->state == JOB_DONE ? open(j->path, O_RDONLY | O_CLOEXEC) : -1;
    snprintf(name, 100, "%s", j->name);
    pthread_mutex_unlock(&j->lock);
    return file;
}
