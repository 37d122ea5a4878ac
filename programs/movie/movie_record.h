/* movie_record.h - the text file beside frames that records what they were made
 * with:
 *
 *   snowglass frames 1
 *   version 0.1.0
 *   kernels vector
 *   --size 1024x1024
 *   frame 0 azimuth 0 time 0 of 2883584 1731000000.5 /data/engine.nrrd
 *   frame 1 azimuth 3 ...
 *   done 0 130903
 *
 * It holds all given options that can change a picture, and for each input the
 * size, the time of the last change and the path.  A frame is kept if all of
 * these are the same.  A "done" line with the frame's size is added after the
 * frame has got its name.  So frames of different settings never mix, and a
 * list of frames may grow at its end (a simulation that continues). */
#ifndef MOVIE_RECORD_H
#define MOVIE_RECORD_H

#include "movie/movie.h"
#include "movie/movie_place.h"

typedef struct frame_record {
    int file;      /* locked; -1: none yet */
    char *text;    /* the new content, without "done" lines */
    bool *kept;    /* per frame: its complete file exists */
    int64_t keeps; /* how many */
    int64_t done; /* frames that an earlier record lists, including those beyond
                     ours */
    bool anew;    /* the record is to be rewritten */
    bool replaces; /* existing frames may be replaced */
} frame_record;

/* Reads an existing record and compares it.  Of a list that has grown the look
 * stays that of the shots before (list->looked).  Writes nothing.  Returns
 * CONTINUE or an exit code: another run is active, frames exist that must not
 * be replaced, or --resume was given with other settings. */
int record_open(const options *opts, shot_list *list, const movie_place *place,
                frame_record *out);

/* Creates an empty record if there is none, before anything else is written: if
 * two runs start together, one continues.  Returns 0 or an error number: EEXIST
 * or EAGAIN if another run was first. */
int record_claim(frame_record *record, const movie_place *place);

/* Begins the record, before the first new frame; removes frames that are no
 * longer valid.  Returns 0 or an error number. */
int record_begin(frame_record *record, const movie_place *place, int64_t count);

/* Records that a frame has its final name.  Returns 0 or an error number. */
int record_add(frame_record *record, int64_t index, int64_t bytes);

void record_close(frame_record *record);

#endif
