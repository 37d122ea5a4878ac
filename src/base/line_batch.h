/* base/line_batch.h - the tiles of an image, or its bands, drawn by threads of
 * the context while the caller does other work, and which lines of them are
 * there.
 *
 * Items share nothing, so their order is free.  Where several processors draw,
 * each begins with another line, so that what one draws last is not what all
 * draw last: whoever a part of all images is for gets one of them at a time. */
#ifndef SNOW_BASE_LINE_BATCH_H
#define SNOW_BASE_LINE_BATCH_H

#include "base/thread_pool.h"

/* What is drawn: item n is in line n / width.  `begin_at`, 0 to below 1, is the
 * share of the lines before the one that is drawn first. */
typedef struct snow_line_batch_params {
    int64_t lines, width;
    double begin_at;
    bool whole; /* the image has other lines: they are there all at once */
    int threads;
    snow_work_fn *draw;
    void (*made)(void *job); /* after the last; NULL: nothing is to be done */
    void *job;
} snow_line_batch_params;

/* All zeros: empty. */
typedef struct snow_line_batch {
    snow_context *context;
    snow_batch batch;
    snow_monitor *monitor; /* of the picture, or NULL */
    snow_line_batch_params order;
    int64_t first;        /* line */
    atomic_int *finished; /* items of each line */
} snow_line_batch;

/* Begins a batch as snow_parallel_begin does; the one before has ended.  Its
 * progress is snow_monitor_next's.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_line_batch_begin(snow_context *context, snow_line_batch *batch,
                                  const snow_line_batch_params *params);

/* Draws an item; false: none is left to begin. */
bool snow_line_batch_step(snow_line_batch *batch);

/* Draws all that are left; of a batch that has ended, or never began, nothing.
 * After a stop (base/monitor.h) items are finished without being drawn, so that
 * nobody waits for them. */
void snow_line_batch_end(snow_line_batch *batch);

/* Before the end: whether lines first .. end - 1 are there. */
bool snow_line_batch_drawn(const snow_line_batch *batch, int first, int end);

void snow_line_batch_fini(snow_line_batch *batch);

#endif
