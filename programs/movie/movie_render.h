/* movie_render.h - the frames of a sequence, rendered by this process or by
 * all ranks (render_state.h). */
#ifndef MOVIE_RENDER_H
#define MOVIE_RENDER_H

#include "movie/movie.h"
#include "picture/paint.h"
#include "picture/render_state.h"

struct shot_renderer {
    render_state state;
    int64_t count;         /* number of frames, for messages */
    int64_t time;          /* time step of the present volume */
    snow_volume_info grid; /* grid of the first volume */
    bool whole_files; /* a file with several time steps is an error: it is one
                       * of many, and no step was selected */
    bool drawn;       /* a picture has been made, and choices printed */
    paint_given painted; /* how a picture of values was painted */
    /* Draws shots in place of the state, which then is lent; NULL: none. */
    int (*draw)(void *user, const movie_shot *shot, snow_image **image);
    void *user;
    snow_image *made; /* by it, until it is finished */
    /* Of steps, whose values differ: what is measured in those that are begun,
     * and in the last one that was finished. */
    measures *begun[2], *measured;
    int in_flight;
};

/* Returns CONTINUE or an exit code. */
int shots_open(const options *opts, shot_renderer *out);
void shots_close(shot_renderer *shots);

/* Checks that a volume is one time step, on the same grid as the first one.
 * Returns CONTINUE or an exit code. */
int shots_check(shot_renderer *shots, const char *path,
                const snow_volume_info *info);

/* Opens a shot's volume as the present one.  Returns CONTINUE or an exit
 * code. */
int shots_volume(shot_renderer *shots, const movie_shot *shot);

/* Begin to render a shot, and finish the one begun first: of many ranks two
 * are in flight.  All ranks call them in the same order with the same shots,
 * and all get the same result: CONTINUE, or an exit code after the error was
 * printed.  *image belongs to the caller, and is NULL on ranks that do not
 * write. */
int shots_begin(shot_renderer *shots, const movie_shot *shot);
int shots_finish(shot_renderer *shots, snow_image **image);

/* The annotations of the pictures, known after the first one. */
picture_annotations shots_annotations(const shot_renderer *shots);

#endif
