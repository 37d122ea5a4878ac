/* movie_encoder.c - runs ffmpeg at the end of a pipe.
 *
 * It is a program of its own and not a linked library: its licence and its many
 * codecs stay apart, and any version works.  Frames go through the pipe as raw
 * bytes.  Its messages go to a file, which cannot fill up and block as a second
 * pipe could. */
#define _XOPEN_SOURCE 700
#include "movie/movie_encoder.h"
#include "run/paths.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

#define PROGRAM "ffmpeg"
#define ARGUMENTS_MOST 64
#define LINE_BYTES 512

/* H.264 and VP9 as 4:2:0, which all players support.  Its sides are even, so an
 * odd side gets one more black line.  Levels are converted to BT.709 and
 * tagged: without tags players guess from the size of the picture. */
#define TO_VIDEO                                                  \
    "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:" \
    "out_range=tv:flags=accurate_rnd+full_chroma_int,format=yuv420p"
#define TAGS                                                           \
    "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", \
        "bt709", "-color_range", "tv"

/* At crf 18 the loss of H.264 becomes invisible.  For renderings "veryfast"
 * makes files a twelfth larger than "medium" in half the time.  faststart lets
 * a browser play before it has the whole file. */
static const char *const mp4[] = {
    "-vf", TO_VIDEO, "-c:v",      "libx264",    "-preset", "veryfast", "-crf",
    "18",  TAGS,     "-movflags", "+faststart", "-f",      "mp4",      NULL};

/* For renderings "realtime" has the size and quality of "good" at 4, in a third
 * of the time. */
static const char *const webm[] = {
    "-vf",     TO_VIDEO, "-c:v",      "libvpx-vp9", "-crf",      "24",
    "-b:v",    "0",      "-deadline", "realtime",   "-cpu-used", "6",
    "-row-mt", "1",      TAGS,        "-f",         "webm",      NULL};

/* Each frame has its own palette: one for all would need all frames in memory,
 * or a second pass.  Bayer's dither is still where the picture is. */
static const char *const gif[] = {
    "-vf",
    "split[a][b];[a]palettegen=stats_mode=single:reserve_transparent=0[p];"
    "[b][p]paletteuse=new=1:dither=bayer:bayer_scale=4",
    "-loop",
    "0",
    "-f",
    "gif",
    NULL};

static const movie_format formats[] = {
    {".mp4", mp4}, {".webm", webm}, {".gif", gif}, {".webp", NULL}};

const movie_format *movie_format_of(const char *path) {
    size_t length = strlen(path);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        size_t suffix = strlen(formats[i].suffix);
        if (length > suffix &&
            strcmp(path + length - suffix, formats[i].suffix) == 0 &&
            (formats[i].arguments || !strchr(path, '%')))
            return &formats[i];
    }
    return NULL;
}

/* Searches the PATH as the shell does; an empty part is the working folder. */
bool encoder_is_there(void) {
    const char *folders = getenv("PATH");
    while (folders && *folders) {
        int length = (int)strcspn(folders, ":");
        char path[PATH_MAX];
        snprintf(path, sizeof path, "%.*s/%s", length ? length : 1,
                 length ? folders : ".", PROGRAM);
        if (access(path, X_OK) == 0 ||
            (!means_absence(errno) &&
             errno != EACCES)) /* to start it says so */
            return true;
        folders += length + (folders[length] == ':');
    }
    return false;
}

/* The command line; `texts` holds the text of numbers. */
typedef struct command {
    char size[32], rate[32], threads[16];
    char target[PATH_MAX + 8]; /* a name may begin with a dash, or contain a
                                * colon as addresses do */
    const char *words[ARGUMENTS_MOST];
    int count;
} command;

static void add_words(command *c, const char *const *words) {
    for (; *words && c->count < ARGUMENTS_MOST - 1; words++)
        c->words[c->count++] = *words;
    c->words[c->count] = NULL;
}

static void fill_command(const encoder_job *job, command *c) {
    c->count = 0;
    snprintf(c->size, sizeof c->size, "%dx%d", job->width, job->height);
    snprintf(c->rate, sizeof c->rate, "%.10g", job->rate);
    snprintf(c->threads, sizeof c->threads, "%d", job->threads);
    snprintf(c->target, sizeof c->target, "file:%s", job->path);
    const char *const input[] = {
        PROGRAM,  "-hide_banner", "-nostdin",   "-nostats", "-loglevel",
        "error",  "-f",           "rawvideo",   "-pix_fmt", "rgb24",
        "-s",     c->size,        "-framerate", c->rate,    "-i",
        "pipe:0", "-an",          "-threads",   c->threads, NULL};
    const char *const output[] = {"-y", c->target, NULL};
    add_words(c, input);
    add_words(c, job->format->arguments);
    add_words(c, output);
}

/* Standard input comes from the pipe, messages go to the log; signals are reset
 * to their defaults. */
static int spawn(const command *c, const char *log, int input, pid_t *process) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t signals;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return ENOMEM;
    if (posix_spawnattr_init(&attributes) != 0) {
        posix_spawn_file_actions_destroy(&actions);
        return ENOMEM;
    }
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes, &signals);
    sigaddset(&signals, SIGPIPE);
    sigaddset(&signals, SIGXFSZ);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP |
                                              POSIX_SPAWN_SETSIGDEF |
                                              POSIX_SPAWN_SETSIGMASK);
    posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null",
                                     O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log,
                                     O_WRONLY | O_CREAT | O_TRUNC | O_APPEND,
                                     S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH);
    int number = posix_spawnp(process, PROGRAM, &actions, &attributes,
                              (char *const *)c->words, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return number;
}

/* Both ends are close-on-exec: if the child kept our end open, the pipe would
 * never end. */
int encoder_start(const encoder_job *job, movie_encoder *out) {
    command c;
    int ends[2];
    if (pipe(ends) != 0)
        return errno;
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    *out = (movie_encoder){.pipe = ends[1]};
    snprintf(out->log, sizeof out->log, "%s", job->log);
    fill_command(job, &c);
    const int number = spawn(&c, job->log, ends[0], &out->process);
    close(ends[0]);
    if (number != 0) {
        out->process = 0;
        close(out->pipe);
        out->pipe = -1;
    }
    return number;
}

int encoder_write(movie_encoder *encoder, const void *bytes, size_t size) {
    const char *at = bytes;
    while (size) {
        ssize_t taken = write(encoder->pipe, at, size);
        if (taken < 0 && errno == EINTR)
            continue;
        if (taken <= 0)
            return errno ? errno : EIO;
        at += taken;
        size -= (size_t)taken;
    }
    return 0;
}

/* The last line that is not empty. */
static void read_last_line(const char *log, char *out, size_t size) {
    FILE *file = fopen(log, "r");
    char line[LINE_BYTES];
    while (file && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\r\n")] = '\0';
        if (line[0])
            snprintf(out, size, "%s", line);
    }
    if (file)
        fclose(file);
}

static void close_pipe(movie_encoder *encoder) {
    if (encoder->pipe >= 0)
        close(encoder->pipe);
    encoder->pipe = -1;
}

static int wait_for(movie_encoder *encoder) {
    int how = 0;
    while (waitpid(encoder->process, &how, 0) < 0 && errno == EINTR)
        continue;
    encoder->process = 0;
    return how;
}

bool encoder_finish(movie_encoder *encoder, char *fault, size_t size) {
    close_pipe(encoder);
    if (!encoder->process)
        return true;
    int how = wait_for(encoder);
    if (WIFEXITED(how) && WEXITSTATUS(how) == 0)
        return true;
    if (WIFSIGNALED(how))
        snprintf(fault, size, "ended by signal %d", WTERMSIG(how));
    else
        snprintf(fault, size, "exit code %d", WEXITSTATUS(how));
    read_last_line(encoder->log, fault, size);
    return false;
}

void encoder_stop(movie_encoder *encoder) {
    if (encoder->process) {
        kill(encoder->process, SIGKILL);
        (void)wait_for(encoder);
    }
    close_pipe(encoder);
}
