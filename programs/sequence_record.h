/* sequence_record.h - the text beside frames that says what they were made
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
 * All options that were given and can change a picture are in it, and of every
 * input the path, the bytes and the time of its last change.  A frame is kept
 * where all of that is the same; a "done" line is added after a frame has got
 * its name, with its bytes.  So frames of different settings never stand side
 * by side, and a list of frames may grow at its end (a simulation that goes
 * on). */
#ifndef SEQUENCE_RECORD_H
#define SEQUENCE_RECORD_H

#include "sequence.h"
#include "sequence_place.h"

typedef struct frame_record {
    int file;      /* with a lock on it; -1: none yet */
    char *text;    /* what shall stand in it, without "done" lines */
    bool *kept;    /* per frame: it lies there, whole */
    int64_t keeps; /* how many */
    int64_t done;  /* frames that an earlier record tells of, beyond ours too */
    bool anew;     /* the record is to be written from its beginning */
    bool replaces; /* and frames that lie there may go */
} frame_record;

/* Reads what lies there, and compares.  Nothing is written.  Answers GO_ON or
 * an exit code: another run is at work there, frames exist that may not be
 * replaced, or --resume was given for other settings. */
int record_open(const options *asked, const shot_list *list,
                const sequence_place *place, frame_record *out);

/* Makes the record, empty, where there is none yet, before anything else is
 * written: of two runs that begin together one goes on.  Answers 0 or an error
 * number: EEXIST or EAGAIN where another run was first. */
int record_claim(frame_record *record, const sequence_place *place);

/* Begins the record, before the first new frame; frames that do not count any
 * more are removed.  Answers 0 or an error number. */
int record_begin(frame_record *record, const sequence_place *place,
                 int64_t count);

/* Says that a frame bears its name.  Answers 0 or an error number. */
int record_add(frame_record *record, int64_t index, int64_t bytes);

void record_close(frame_record *record);

#endif
