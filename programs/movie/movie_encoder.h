/* movie_encoder.h - ffmpeg as an encoder of movies: takes the bytes of frames
 * from a pipe and writes a file. */
#ifndef MOVIE_ENCODER_H
#define MOVIE_ENCODER_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* A movie format. */
typedef struct movie_format {
    const char *suffix;           /* ".mp4" */
    const char *const *arguments; /* arguments of ffmpeg before the file's name;
                                   * NULL: written by movie_webp.h */
} movie_format;

/* The format of a path's suffix; NULL if it is not a movie's, or if the path is
 * a pattern of numbered pictures. */
const movie_format *movie_format_of(const char *path);

/* Whether ffmpeg is on the PATH. */
bool encoder_is_there(void);

typedef struct encoder_job {
    const movie_format *format;
    int width, height;
    double rate;      /* frames a second */
    int threads;      /* 0: ffmpeg decides */
    const char *path; /* the file it writes; replaced if it exists */
    const char *log;  /* the file of its messages */
} encoder_job;

typedef struct movie_encoder {
    pid_t process; /* 0: none */
    int pipe;      /* -1: closed */
    char log[PATH_MAX];
} movie_encoder;

/* Starts ffmpeg in a process group of its own: Ctrl-C reaches only this
 * program, which stops ffmpeg.  Returns 0 or an error number. */
int encoder_start(const encoder_job *job, movie_encoder *out);

/* Sends bytes of frames.  Returns 0 or an error number: EPIPE if ffmpeg has
 * ended. */
int encoder_write(movie_encoder *encoder, const void *bytes, size_t size);

/* Closes the pipe and waits.  Returns false if ffmpeg failed: `fault` is then
 * its last message, or how it ended. */
bool encoder_finish(movie_encoder *encoder, char *fault, size_t size);

/* Stops ffmpeg at once; the file it wrote is incomplete. */
void encoder_stop(movie_encoder *encoder);

#endif
