/* frames.h - pictures on their way from the thread that renders them to those
 * that compress and write them.
 *
 * A queue is a ring of a few slots.  The renderer copies its picture into a
 * free one and goes on; workers prepare slots (compress, in any order), and
 * commit them one at a time in the order in which they were put:
 *
 *   put ->  |7 free|4 commit|5 prepared|6 prepare|  -> files, pipe
 *
 * so that the files and the bytes of a pipe are the same as without a queue,
 * and memory is that of the slots however long the movie is. */
#ifndef FRAMES_H
#define FRAMES_H

#include <snowglass/snowglass.h>

#define FRAME_FAULT_BYTES 5000 /* a path or two, and a line */

typedef struct frame_slot {
    int64_t index;         /* of the frame, from 0 */
    snow_context *context; /* the slot's own: a context serves one thread at a
                              time, and slots are handed on */
    snow_image *image;     /* NULL: a frame that lies in its file already */
    snow_image *depth;     /* of its pixels; NULL: none */
    void *work;            /* the sink's; begins as NULL */
    char fault[FRAME_FAULT_BYTES]; /* the sink's own message; "": the context's
                                      counts */
} frame_slot;

/* What is done with frames.  A fault leaves its message in slot->fault or
 * slot->context; then no later frame is committed. */
typedef struct frame_sink {
    void *user;
    /* Called by several threads at once, each with a slot of its own. */
    snow_status (*prepare)(void *user, frame_slot *slot);
    /* Called by one thread at a time, in the order of frames_put. */
    snow_status (*commit)(void *user, frame_slot *slot);
    /* Frees slot->work; by the thread that frees the queue. */
    void (*release)(void *user, frame_slot *slot);
} frame_sink;

typedef struct frame_queue frame_queue;

#define FRAME_WORKERS_MOST 8

/* Starts 1 to FRAME_WORKERS_MOST workers; there are two slots more than
 * workers.  The sink is copied.  Errors: SNOW_NO_MEMORY (or no thread). */
snow_status frames_new(const frame_sink *sink, int workers, frame_queue **out);

/* Takes a copy of a picture and of its depths (NULL: none), or NULL for a frame
 * that lies in its file; waits for a free slot.  Answers the status of the
 * queue: a fault may be that of an earlier frame. */
snow_status frames_put(frame_queue *queue, int64_t index, snow_image *image,
                       const snow_image *depth);

/* The status so far, without waiting. */
snow_status frames_status(frame_queue *queue);

/* Waits until all that was put is done; answers the first fault. */
snow_status frames_drain(frame_queue *queue);

/* Of the first fault; "" where there is none.  After frames_drain only. */
const char *frames_message(const frame_queue *queue);

/* Seconds that the workers prepared and committed, summed over them.  After
 * frames_drain only. */
double frames_seconds(const frame_queue *queue);

/* Ends the workers, when all that was put is done; NULL is accepted. */
void frames_free(frame_queue *queue);

#endif
