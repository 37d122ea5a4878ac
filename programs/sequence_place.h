/* sequence_place.h - where the frames of a sequence go, and what lies there. */
#ifndef SEQUENCE_PLACE_H
#define SEQUENCE_PLACE_H

#include "options.h"
#include "sequence_encoder.h"
#include "sequence_names.h"

typedef struct sequence_place {
    const char *output;         /* as told */
    const movie_format *format; /* NULL: the frames are the result */
    frame_names names;          /* of the frames */
    /* Of a movie: the folder of its frames, and in it the movie until it is
     * whole, and what ffmpeg has to say. */
    char folder[PATH_MAX], movie[PATH_MAX], log[PATH_MAX];
    char record[PATH_MAX];
} sequence_place;

/* Reads the output's name.  Answers GO_ON or an exit code. */
int place_read(const char *output, sequence_place *out);

/* Whether frames and movie can be written there.  Answers GO_ON or an exit
 * code. */
int place_check(snow_context *context, const sequence_place *place,
                const options *asked);

/* A frame's name, and the one that it has until it is whole; `size` bytes
 * suffice for both when place_check was content. */
bool place_frame(const sequence_place *place, int64_t index, char *out,
                 size_t size);
bool place_aside(const sequence_place *place, int64_t index, char *out,
                 size_t size);

/* The lowest number of a frame that lies there, at least `from`; -1: none. */
int64_t place_first(const sequence_place *place, int64_t from);

/* Removes frames numbered below `count`. */
void place_remove_frames(const sequence_place *place, int64_t count);

/* Removes what a run that was killed has left unfinished. */
void place_sweep(const sequence_place *place);

/* Of a movie: makes the folder; removes it with all that a sequence leaves in
 * it.  The first answers GO_ON or an exit code. */
int place_make_folder(const sequence_place *place);
void place_remove_folder(const sequence_place *place);

#endif
