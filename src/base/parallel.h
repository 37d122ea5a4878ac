/* base/parallel.h - the one place where threads are made.
 *
 * Work is cut into items that do not touch each other's results, so that the
 * number of threads, and which of them does what, cannot change a bit. */
#ifndef SNOW_PARALLEL_H
#define SNOW_PARALLEL_H

#include "base/base.h"

#include <stdatomic.h>

#define SNOW_THREADS_MOST 4096

/* One item of work; `worker` is 0 .. threads - 1, and no two items of one
 * worker run at the same time: it may index scratch memory. */
typedef void snow_work_fn(void *job, int64_t item, int worker);

/* Does items 0 .. items - 1 on up to `threads` threads, the calling one
 * included, and returns when all are done.  Items are handed out in order.  The
 * threads belong to the context and sleep between calls; where the system gives
 * fewer, fewer do the work.  One call at a time for each context. */
void snow_parallel(snow_context *context, int threads, int64_t items,
                   snow_work_fn *work, void *job);

/* Items to be done; zeros: there are none. */
typedef struct snow_batch {
    snow_work_fn *work;
    void *job;
    int64_t items;
    int wanted; /* workers, the caller included */
    int busy;   /* of the pool's threads */
    atomic_int_fast64_t next;
} snow_batch;

/* The same in three steps, between which the caller may do other things, calls
 * of snow_parallel among them, whose items then come first: begins a batch, and
 * returns while other threads are at work; does one item of it, or tells that
 * all are taken; does all that are left, and returns when all are done.  A
 * batch is not moved until its end; to end it twice does nothing.  Of several
 * batches of a context other threads do the first one's items only. */
void snow_parallel_begin(snow_context *context, int threads, int64_t items,
                         snow_work_fn *work, void *job, snow_batch *batch);
bool snow_parallel_step(snow_batch *batch);
void snow_parallel_end(snow_context *context, snow_batch *batch);

/* Ends a context's threads; for snow_context_free. */
void snow_pool_free(snow_context *context);

#endif
