/* base/parallel.h - the one place where threads are made.
 *
 * Work is cut into items that do not touch each other's results, so that the
 * number of threads, and which of them does what, cannot change a bit. */
#ifndef SNOW_PARALLEL_H
#define SNOW_PARALLEL_H

#include "base/base.h"

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

/* Ends a context's threads; for snow_context_free. */
void snow_pool_free(snow_context *context);

#endif
