/* movie_frame.h - a movie that is made, and what becomes of each frame.
 *
 * The thread that renders puts pictures into a queue; its workers make a file
 * of each, and the bytes for ffmpeg.  A frame's way:
 *
 *   render -> copy -> compress aside, sync | record, rename, bytes to ffmpeg
 *                     several at once      | one after another
 *
 * Frames that an earlier run has left whole go the second half only, and only
 * where there is an ffmpeg to feed. */
#ifndef MOVIE_FRAME_H
#define MOVIE_FRAME_H

#include "movie/frames.h"
#include "movie/movie_encoder.h"
#include "movie/movie_record.h"

/* A physical time; each file may count from a date of its own. */
typedef struct frame_time {
    double value;
    char unit[64], calendar[24]; /* as of snow_volume_info */
} frame_time;

struct movie {
    const options *opts;
    const shot_list *list;
    movie_place place;
    frame_record record;
    snow_context *context;
    frame_queue *queue;
    movie_encoder encoder;
    bool encoding; /* ffmpeg, or standard output, takes the frames */
    bool claimed;  /* the record belongs to this run */
    bool begun;    /* and has been written */
    bool made_folder;
    snow_image_options form;         /* the form of the frames' files */
    picture_annotations annotations; /* known from the first picture on */
    bool has_annotations;
    frame_time *times; /* of the frames, as their pictures come */
    measures **measured; /* of each step, until it is drawn */
};

/* Keeps the time of a frame's volume for what is drawn over it. */
void movie_take_time(movie *s, int64_t index, const snow_volume_info *info);

/* The two halves, and what ends a slot (frames.h); `user` is a movie. */
snow_status movie_frame_prepare(void *user, frame_slot *slot);
snow_status movie_frame_commit(void *user, frame_slot *slot);
void movie_frame_release(void *user, frame_slot *slot);

#endif
