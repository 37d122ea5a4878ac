/* base/thread_pool.h - the only place where threads are created.
 *
 * Work is divided into items that do not touch each other's results, so the
 * number of threads, and which thread does what, cannot change a bit. */
#ifndef SNOW_BASE_THREAD_POOL_H
#define SNOW_BASE_THREAD_POOL_H

#include "base/monitor.h"

#include <stdatomic.h>

#define SNOW_THREADS_MOST 4096

/* One work item; `worker` is 0 .. threads - 1, and no two items of one worker
 * run at the same time: it may index scratch memory. */
typedef void snow_work_fn(void *job, int64_t item, int worker);

/* Processes items 0 .. items - 1 with up to `threads` threads, including the
 * calling one, and returns when all are done. Items are started in order. The
 * threads belong to the context and sleep between calls; if the system provides
 * fewer, fewer do the work. One call at a time for each context.
 * After a stop (base/monitor.h) the remaining items are skipped. Errors:
 * SNOW_STATUS_STOPPED. */
#if defined(__GNUC__)
__attribute__((warn_unused_result))
#endif
snow_status
snow_parallel(snow_context *context, int threads, int64_t items,
              snow_work_fn *work, void *job);

/* A batch of items; all zeros: empty. */
typedef struct snow_batch {
    snow_work_fn *work;
    void *job;
    int64_t items;
    int wanted;            /* workers, the caller included */
    atomic_int busy;       /* of the pool's threads */
    bool skips;            /* the items that are left after a stop */
    snow_monitor *monitor; /* that it is for, or NULL */
    atomic_int_fast64_t next;
} snow_batch;

/* The same in three steps, between which the caller may do other work,
 * including calls of snow_parallel, whose items then have precedence.
 * snow_parallel_begin starts a batch, and returns while other threads are
 * working; snow_parallel_step processes one item, or returns false if none is
 * left; snow_parallel_end processes all that are left, and returns when all are
 * done. A batch must not move until its end; ending it twice has no effect. If
 * a context has several batches, other threads process the first one's items
 * only. No item is skipped. */
void snow_parallel_begin(snow_context *context, int threads, int64_t items,
                         snow_work_fn *work, void *job, snow_batch *batch);
bool snow_parallel_step(snow_batch *batch);
void snow_parallel_end(snow_context *context, snow_batch *batch);

/* Ends a context's threads; called by snow_context_free. */
void snow_pool_free(snow_context *context);

#endif
