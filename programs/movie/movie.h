/* movie.h - many pictures as one movie: what turntable and movie share.
 *
 * A movie is a list of shots.  They are rendered one after another; with
 * several ranks the next is rendered while one is combined.  Meanwhile other
 * threads compress and write the frames before (frames.h).  Every frame becomes
 * a file, complete or absent:
 *
 *   -o f_%04d.png    f_0000.png, f_0001.png, ...      the result itself
 *   -o spin.mp4      spin.mp4.frames/000000.png, ...  until the movie is
 * complete; ffmpeg gets the same bytes meanwhile
 *
 * A record beside the frames holds what they were made with and which are done
 * (movie_record.h), so that --resume can continue after any interruption. */
#ifndef MOVIE_H
#define MOVIE_H

#include "options/options.h"
#include "picture/annotations.h"

/* A frame to be made. */
typedef struct movie_shot {
    const char *path; /* of the volume */
    int64_t time;     /* the step in that file */
    double azimuth;   /* of the camera, in degrees */
    int64_t step;     /* the step number to show, -1: none */
    int64_t slice;    /* of a list of slices: its number, */
    int axis;         /* of the grid, across which, */
    int64_t place;    /*   and its place among them */
} movie_shot;

typedef struct shot_list {
    movie_shot *shots;
    int64_t count; /* at least 1 */
    bool steps;    /* they are time steps, or slices */
    bool slices;
    int64_t looked; /* the look of all frames is chosen from so many shots, the
                       first: if one of them changes it is another movie; 0: of
                       none */
} shot_list;

typedef struct shot_renderer shot_renderer;
typedef struct movie movie;

/* Refuses options that contradict each other.  Returns CONTINUE or an exit
 * code.
 */
int movie_check(const options *opts);

/* Opens the output: checks whether it can be written and what an earlier run
 * left there.  Writes nothing yet, but locks what will be resumed, whose look
 * stays that of list->looked shots.  `list` and `opts` must outlive the movie.
 * Only for the rank that writes.  Returns CONTINUE or an exit code. */
int movie_open(const options *opts, shot_list *list, movie **out);

/* Makes all frames that are missing, the movie from them, and the figures of
 * --stats.  Ranks that do not write pass NULL for `s`.  Returns an exit
 * code. */
int movie_run(movie *s, const options *opts, const shot_list *list,
              shot_renderer *shots, double begin);

/* Accepts NULL. */
void movie_close(movie *s);

#endif
