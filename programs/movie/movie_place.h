/* movie_place.h - where the frames of a sequence go, and which files exist
 * there. */
#ifndef MOVIE_PLACE_H
#define MOVIE_PLACE_H

#include "movie/movie_encoder.h"
#include "movie/movie_names.h"
#include "options/options.h"

typedef struct movie_place {
    const char *output;         /* as given */
    const movie_format *format; /* NULL: the frames are the result */
    bool streams;               /* they go to standard output, as raw bytes */
    frame_names names;          /* names of the frames */
    /* For a movie: the folder of its frames, and in it the unfinished movie and
     * the messages of ffmpeg. */
    char folder[PATH_MAX], movie[PATH_MAX], log[PATH_MAX];
    char record[PATH_MAX];
} movie_place;

/* Parses the output's name.  Returns CONTINUE or an exit code. */
int place_read(const char *output, movie_place *out);

/* Whether frames and movie can be written there.  Returns CONTINUE or an exit
 * code. */
int place_check(snow_context *context, const movie_place *place,
                const options *opts);

/* Returns whether frames go as bytes to ffmpeg, or to what reads the pipe. */
static inline bool place_needs_encoder(const movie_place *place) {
    return place->streams || (place->format && place->format->arguments);
}

/* A frame's final name, and its name until it is complete; `size` bytes suffice
 * for both after place_check succeeded. */
bool place_frame(const movie_place *place, int64_t index, char *out,
                 size_t size);
bool place_aside(const movie_place *place, int64_t index, char *out,
                 size_t size);

/* The lowest number, at least `from`, of a frame that exists; -1: none.  Where
 * the folder cannot be listed, `from`: there may be frames. */
int64_t place_first(const movie_place *place, int64_t from);

/* Removes frames numbered below `count`. */
void place_remove_frames(const movie_place *place, int64_t count);

/* Removes the unfinished files of a run that was killed. */
void place_sweep(const movie_place *place);

/* For a movie: make the folder; remove it with all files that a sequence leaves
 * in it.  The first returns CONTINUE or an exit code. */
int place_make_folder(const movie_place *place);
void place_remove_folder(const movie_place *place);

#endif
