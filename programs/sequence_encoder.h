/* sequence_encoder.h - the program ffmpeg as an encoder of movies: it takes
 * bytes of frames from a pipe and writes a file. */
#ifndef SEQUENCE_ENCODER_H
#define SEQUENCE_ENCODER_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* A movie format. */
typedef struct movie_format {
    const char *suffix;           /* ".mp4" */
    const char *const *arguments; /* of ffmpeg, before the file's name; NULL:
                                     we write it ourselves (sequence_webp.h) */
} movie_format;

/* The format of a path's suffix; NULL when it is none of a movie, or that of
 * pictures which a pattern numbers. */
const movie_format *movie_format_of(const char *path);

/* Whether the program is on the PATH. */
bool encoder_is_there(void);

typedef struct encoder_job {
    const movie_format *format;
    int width, height;
    double rate;      /* frames a second */
    int threads;      /* 0: as many as it likes */
    const char *path; /* what it writes; replaced when it is there */
    const char *log;  /* where its complaints go */
} encoder_job;

typedef struct movie_encoder {
    pid_t process; /* 0: none */
    int pipe;      /* -1: closed */
    char log[PATH_MAX];
} movie_encoder;

/* Starts it, in a process group of its own: Ctrl-C is for this program, which
 * ends it.  Answers 0 or an error number. */
int encoder_start(const encoder_job *job, movie_encoder *out);

/* Hands over bytes of frames.  Answers 0 or an error number: EPIPE when it has
 * ended. */
int encoder_write(movie_encoder *encoder, const void *bytes, size_t size);

/* Ends the pipe and waits.  False when it failed: `fault` is then the last line
 * that it wrote, or how it ended. */
bool encoder_finish(movie_encoder *encoder, char *fault, size_t size);

/* Ends it at once; what it has written is not whole. */
void encoder_stop(movie_encoder *encoder);

#endif
