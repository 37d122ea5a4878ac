/* frames.h - the queue of pictures from the thread that renders them to those
 * that compress and write them.
 *
 * The queue is a ring of a few slots.  The renderer copies its picture into a
 * free slot and goes on.  Workers prepare slots (compress them, in any order),
 * and commit them one at a time, in the order in which they were put:
 *
 *   put ->  |7 free|4 commit|5 prepared|6 prepare|  -> files, pipe
 *
 * So the files and the bytes of a pipe are the same as without a queue, and
 * memory is bounded by the slots, however long the movie is. */
#ifndef FRAMES_H
#define FRAMES_H

#include <snowglass/snowglass.h>

#define FRAME_FAULT_BYTES 5000 /* room for two paths and a line */

typedef struct frame_slot {
    int64_t index;         /* of the frame, from 0 */
    snow_context *context; /* the slot's own: a context serves one thread at a
                            * time, and slots change threads */
    snow_image *image;     /* NULL: the frame's file exists already */
    snow_image *depth;     /* of the pixels; NULL: none */
    void *work;            /* private data of the sink; NULL at first */
    char fault[FRAME_FAULT_BYTES]; /* the sink's own message; if "", the
                                    * context's message is used */
} frame_slot;

/* The functions that process frames.  An error leaves its message in
 * slot->fault or slot->context; no later frame is then committed. */
typedef struct frame_sink {
    void *user;
    /* Called by several threads at once, each with its own slot. */
    snow_status (*prepare)(void *user, frame_slot *slot);
    /* Called by one thread at a time, in the order of frames_put. */
    snow_status (*commit)(void *user, frame_slot *slot);
    /* Frees slot->work; called by the thread that frees the queue. */
    void (*release)(void *user, frame_slot *slot);
} frame_sink;

typedef struct frame_queue frame_queue;

#define FRAME_WORKERS_MOST 8

/* Starts 1 to FRAME_WORKERS_MOST workers, with two slots more than workers. The
 * sink is copied.  Errors: SNOW_STATUS_NO_MEMORY, SNOW_STATUS_FAILED (the
 * system gives no thread). */
snow_status frames_new(const frame_sink *sink, int workers, frame_queue **out);

/* Copies a picture and its depths (NULL: none), or takes NULL for a frame whose
 * file exists already.  Waits for a free slot.  Returns the status of the
 * queue: an error may come from an earlier frame. */
snow_status frames_put(frame_queue *queue, int64_t index, snow_image *image,
                       const snow_image *depth);

/* The status so far, without waiting. */
snow_status frames_status(frame_queue *queue);

/* Drops the frames that were put and are not being committed: they end with
 * SNOW_STATUS_STOPPED, which has no message. */
void frames_stop(frame_queue *queue);

/* Waits until all that was put is done; answers the first fault. */
snow_status frames_drain(frame_queue *queue);

/* The message of the first error, or "".  After frames_drain only. */
const char *frames_message(const frame_queue *queue);

/* The seconds that workers spent in prepare and commit, summed over them. After
 * frames_drain only. */
double frames_seconds(const frame_queue *queue);

/* Stops the workers when all frames are done; NULL is accepted. */
void frames_free(frame_queue *queue);

#endif
