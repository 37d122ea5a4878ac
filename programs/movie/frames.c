/* frames.c - the queue between rendering and writing: a bounded ring of slots
 * under one lock (the monitor of C. A. R. Hoare, 1974).
 *
 * Frames get tickets 0, 1, 2, ... when they are put; ticket t uses slot
 * t mod slots.  Three counters give the state of all slots:
 *
 *   committed <= taken <= put <= committed + slots
 *
 * Tickets below `committed` are done, those up to `taken` are with workers, the
 * rest wait.  The position of a ticket decides who owns its slot, so the
 * contents of a slot need no lock. */
#include "movie/frames.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define SLOTS_MOST (FRAME_WORKERS_MOST + 2)
#define MESSAGE_BYTES 12288 /* the library's longest message, and some more */

struct frame_queue {
    frame_sink sink;
    pthread_mutex_t lock;
    pthread_cond_t changed; /* signalled when any of the following changes */
    uint64_t put, taken, committed;
    bool closing;
    snow_status status; /* the first error, in the order of tickets */
    double seconds;
    char message[MESSAGE_BYTES];
    frame_slot ring[SLOTS_MOST];
    int slots, workers;
    pthread_t threads[FRAME_WORKERS_MOST];
};

static double clock_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static frame_slot *slot_of(frame_queue *queue, uint64_t ticket) {
    return &queue->ring[ticket % (uint64_t)queue->slots];
}

/* Waits for the next ticket; returns false at the end. */
static bool take_ticket(frame_queue *queue, uint64_t *ticket) {
    while (queue->taken == queue->put && !queue->closing)
        pthread_cond_wait(&queue->changed, &queue->lock);
    if (queue->taken == queue->put)
        return false;
    *ticket = queue->taken++;
    return true;
}

/* Only the first error is kept: the others follow from it. */
static void note_fault(frame_queue *queue, const frame_slot *slot,
                       snow_status status) {
    if (status == SNOW_STATUS_OK || queue->status != SNOW_STATUS_OK)
        return;
    queue->status = status;
    snprintf(queue->message, sizeof queue->message, "%s",
             slot->fault[0] ? slot->fault
                            : snow_context_message(slot->context));
}

/* Serves one frame from its ticket to its end.  The lock is held on entry and
 * on return, and released while the sink works.  Earlier tickets were taken
 * earlier, so the ticket whose turn it is never waits. */
static void serve_frame(frame_queue *queue, uint64_t ticket) {
    frame_slot *slot = slot_of(queue, ticket);
    snow_status status = queue->status;
    pthread_mutex_unlock(&queue->lock);
    double begin = clock_seconds();
    if (status == SNOW_STATUS_OK)
        status = queue->sink.prepare(queue->sink.user, slot);
    double seconds = clock_seconds() - begin;
    pthread_mutex_lock(&queue->lock);
    while (queue->committed != ticket)
        pthread_cond_wait(&queue->changed, &queue->lock);
    if (status == SNOW_STATUS_OK && queue->status == SNOW_STATUS_OK) {
        pthread_mutex_unlock(&queue->lock);
        begin = clock_seconds();
        status = queue->sink.commit(queue->sink.user, slot);
        seconds += clock_seconds() - begin;
        pthread_mutex_lock(&queue->lock);
    }
    note_fault(queue, slot, status);
    queue->seconds += seconds;
    queue->committed++;
    pthread_cond_broadcast(&queue->changed);
}

static void *work(void *argument) {
    frame_queue *queue = argument;
    uint64_t ticket;
    pthread_mutex_lock(&queue->lock);
    while (take_ticket(queue, &ticket))
        serve_frame(queue, ticket);
    pthread_mutex_unlock(&queue->lock);
    return NULL;
}

static snow_status make_slots(frame_queue *queue) {
    for (int i = 0; i < queue->slots; i++) {
        snow_status status = snow_context_new(NULL, &queue->ring[i].context);
        if (status != SNOW_STATUS_OK)
            return status;
    }
    return SNOW_STATUS_OK;
}

/* One worker is enough to continue. */
static snow_status start_workers(frame_queue *queue, int wanted) {
    while (queue->workers < wanted &&
           pthread_create(&queue->threads[queue->workers], NULL, work, queue) ==
               0)
        queue->workers++;
    return queue->workers > 0 ? SNOW_STATUS_OK : SNOW_STATUS_FAILED;
}

snow_status frames_new(const frame_sink *sink, int workers, frame_queue **out) {
    frame_queue *queue = calloc(1, sizeof *queue);
    if (!queue)
        return SNOW_STATUS_NO_MEMORY;
    queue->sink = *sink;
    queue->slots = workers + 2;
    pthread_mutex_init(&queue->lock, NULL);
    pthread_cond_init(&queue->changed, NULL);
    snow_status status = make_slots(queue);
    if (status == SNOW_STATUS_OK)
        status = start_workers(queue, workers);
    if (status != SNOW_STATUS_OK) {
        frames_free(queue);
        return status;
    }
    *out = queue;
    return SNOW_STATUS_OK;
}

static void drop_image(snow_image **image) {
    snow_image_free(*image);
    *image = NULL;
}

/* Reallocates the slot's picture only if the size or kind has changed; a frame
 * without a picture needs none. */
static snow_status copy_image(frame_slot *slot, const snow_image *from,
                              snow_image **to) {
    if (!from) {
        drop_image(to);
        return SNOW_STATUS_OK;
    }
    int width = snow_image_width(from), height = snow_image_height(from);
    int channels = snow_image_channels(from);
    if (*to &&
        (snow_image_width(*to) != width || snow_image_height(*to) != height ||
         snow_image_channels(*to) != channels))
        drop_image(to);
    if (!*to) {
        snow_status status =
            snow_image_new(slot->context, width, height, channels, to);
        if (status != SNOW_STATUS_OK)
            return status;
    }
    memcpy(snow_image_pixels(*to), snow_image_data(from),
           (size_t)width * (size_t)height * (size_t)channels * sizeof(float));
    return SNOW_STATUS_OK;
}

snow_status frames_put(frame_queue *queue, int64_t index, snow_image *image,
                       const snow_image *depth) {
    /* Waits for a free slot. */
    pthread_mutex_lock(&queue->lock);
    while (queue->put - queue->committed == (uint64_t)queue->slots)
        pthread_cond_wait(&queue->changed, &queue->lock);
    snow_status status = queue->status;
    frame_slot *slot = slot_of(queue, queue->put);
    pthread_mutex_unlock(&queue->lock);
    if (status != SNOW_STATUS_OK)
        return status;
    slot->index = index;
    slot->fault[0] = '\0';
    status = copy_image(slot, image, &slot->image);
    if (status == SNOW_STATUS_OK)
        status = copy_image(slot, depth, &slot->depth);
    pthread_mutex_lock(&queue->lock);
    note_fault(queue, slot, status);
    status = queue->status;
    queue->put += status == SNOW_STATUS_OK;
    pthread_cond_broadcast(&queue->changed);
    pthread_mutex_unlock(&queue->lock);
    return status;
}

snow_status frames_status(frame_queue *queue) {
    pthread_mutex_lock(&queue->lock);
    snow_status status = queue->status;
    pthread_mutex_unlock(&queue->lock);
    return status;
}

void frames_stop(frame_queue *queue) {
    pthread_mutex_lock(&queue->lock);
    if (queue->status == SNOW_STATUS_OK && queue->committed != queue->put)
        queue->status = SNOW_STATUS_STOPPED;
    pthread_mutex_unlock(&queue->lock);
}

snow_status frames_drain(frame_queue *queue) {
    pthread_mutex_lock(&queue->lock);
    while (queue->committed != queue->put)
        pthread_cond_wait(&queue->changed, &queue->lock);
    snow_status status = queue->status;
    pthread_mutex_unlock(&queue->lock);
    return status;
}

const char *frames_message(const frame_queue *queue) {
    return queue->message;
}

double frames_seconds(const frame_queue *queue) {
    return queue->seconds;
}

void frames_free(frame_queue *queue) {
    if (!queue)
        return;
    pthread_mutex_lock(&queue->lock);
    queue->closing = true;
    pthread_cond_broadcast(&queue->changed);
    pthread_mutex_unlock(&queue->lock);
    for (int i = 0; i < queue->workers; i++)
        pthread_join(queue->threads[i], NULL);
    for (int i = 0; i < queue->slots; i++) {
        frame_slot *slot = &queue->ring[i];
        if (slot->work && queue->sink.release)
            queue->sink.release(queue->sink.user, slot);
        drop_image(&slot->image);
        drop_image(&slot->depth);
        snow_context_free(slot->context);
    }
    pthread_cond_destroy(&queue->changed);
    pthread_mutex_destroy(&queue->lock);
    free(queue);
}
