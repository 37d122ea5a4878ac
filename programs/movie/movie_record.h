/* movie_record.h - the text file beside frames that records what they were made
 * with:
 *
 *   snowglass frames 2
 *   version 0.1.0
 *   kernels vector
 *   --size 1024x1024
 *   look of 2 steps
 *   frame 0 of 2 bytes 0 azimuth 0 time 0 of 2883584 1731000000.5 /run_0.nrrd
 *   frame 1 of 2 bytes 0 azimuth 0 time 0 of 2883584 1731000001.5 /run_1.nrrd
 *   frame 0 of 2 bytes 130903 azimuth 0 time 0 of 2883584 1731000000.5 /run...
 *
 * First stands what holds for all frames: the given options that can change a
 * picture.  Then each frame has a line with the bytes of its file, and its
 * input: size, time of the last change and path.  The steps that the look was
 * chosen from have one from the beginning.  The line is written before the
 * frame gets its name, so that no frame is without one, whatever ends the run;
 * the last one of a frame counts.  A frame is kept if its file is there with
 * these bytes, and refused if its line would be another now.  So frames of
 * different settings never mix, and a list of frames may grow at its end (a
 * simulation that continues). */
#ifndef MOVIE_RECORD_H
#define MOVIE_RECORD_H

#include "movie/movie.h"
#include "movie/movie_place.h"

typedef struct frame_record {
    int file;       /* locked; -1: none yet */
    char *head;     /* the new text before the frames' lines */
    char **inputs;  /* per frame: its line from the azimuth on */
    int64_t count;  /* of inputs */
    int64_t whole;  /* bytes of whole lines, where a torn one may follow */
    bool *kept;     /* per frame: its complete file exists */
    int64_t keeps;  /* how many */
    int64_t listed; /* frames that an earlier record lists, also beyond ours */
    bool anew;      /* the record begins anew */
    bool renewed;   /* files of frames that are kept have grown */
    bool replaces;  /* existing frames may be replaced */
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

/* Records a frame that is about to get its name; before the first one, removes
 * those that are no longer valid.  Returns 0 or an error number. */
int record_add(frame_record *record, const movie_place *place,
               const shot_list *list, int64_t index, int64_t bytes);

void record_close(frame_record *record);

#endif
