/* base/thread_pool.c - a pool of threads for each context.
 *
 * A call is a batch of items. The caller stores the work, wakes as many
 * sleepers as it wants, and processes items like the others; a thread that
 * finds no more items leaves the batch, and the caller waits for the last one.
 *
 * The stages of a picture follow one another within microseconds, and to wake a
 * sleeper takes longer.  So whoever waits looks for a change for a moment
 * before it sleeps, and yields its processor to other threads meanwhile.
 *
 * A batch may stay open behind the calls (snow_parallel_begin). Threads process
 * its items one by one, while no call has items. */
#include "base/thread_pool.h"

#include "base/affinity.h"

#include <sched.h>
#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef struct snow_pool snow_pool;

/* A thread of the pool; its index is that of the worker. */
typedef struct pool_thread {
    snow_pool *pool;
    pthread_t id;
    int worker;
    bool asleep;
    bool affinity; /* kept off a processor until it has work */
} pool_thread;

/* Batches change under the lock, except for `next`, and are constant while any
 * thread processes items. */
struct snow_pool {
    pid_t owner; /* the process that owns the threads */
    pthread_mutex_t lock;
    pthread_cond_t wake, rest;
    atomic_int begun;     /* batches, to see that there is another */
    pool_thread *threads; /* worker n is threads[n - 1] */
    int count, capacity;
    bool quit;
    snow_affinity affinity;
    snow_batch call;  /* of snow_parallel */
    snow_batch *open; /* of snow_parallel_begin, or NULL */
};

/* Memory of the context itself, not counted among its objects' memory. */
static void *allocate_uncounted(snow_context *context, size_t bytes) {
    void *block = context->allocator.allocate(context->allocator.user, bytes);
    if (block)
        memset(block, 0, bytes);
    return block;
}

static void give_back(snow_context *context, void *block) {
    if (block)
        context->allocator.release(context->allocator.user, block);
}

/* Processes or skips one item; false if none is left. */
static bool take_item(snow_batch *batch, int worker) {
    int64_t item = atomic_fetch_add(&batch->next, 1);
    if (item >= batch->items)
        return false;
    if (batch->skips &&
        snow_monitor_item(batch->monitor, worker, item, batch->items))
        return true;
    batch->work(batch->job, item, worker);
    return true;
}

/* The batch with items for a worker (under the lock), or NULL. */
static snow_batch *batch_for(snow_pool *pool, int worker) {
    snow_batch *const batches[] = {&pool->call, pool->open};
    for (int n = 0; n < 2; n++)
        if (batches[n] && worker < batches[n]->wanted &&
            atomic_load(&batches[n]->next) < batches[n]->items)
            return batches[n];
    return NULL;
}

/* A thread's share of a batch (under the lock, which it releases meanwhile). */
static void work_along(pool_thread *self, snow_batch *batch) {
    snow_pool *pool = self->pool;
    const snow_affinity affinity = pool->affinity;
    bool still_apart = self->affinity;
    batch->busy++;
    pthread_mutex_unlock(&pool->lock);
    if (still_apart)
        still_apart = !snow_affinity_release(&affinity);
    while (take_item(batch, self->worker) && batch == &pool->call)
        continue;
    pthread_mutex_lock(&pool->lock);
    self->affinity = still_apart;
    if (--batch->busy == 0)
        pthread_cond_signal(&pool->rest);
}

#define LINGER_SECONDS 50e-6

/* Waits for a change of a value, but not long enough to be worth sleeping
 * (under the lock, which is left meanwhile); false: there was none. */
static bool linger(snow_pool *pool, const atomic_int *value) {
    const int before = atomic_load(value);
    const double until = snow_seconds() + LINGER_SECONDS;
    pthread_mutex_unlock(&pool->lock);
    while (atomic_load(value) == before && snow_seconds() < until)
        sched_yield();
    pthread_mutex_lock(&pool->lock);
    return atomic_load(value) != before;
}

/* The life of a thread: asleep until a batch needs it. */
static void *run_thread(void *argument) {
    pool_thread *self = argument;
    snow_pool *pool = self->pool;
    pthread_mutex_lock(&pool->lock);
    while (!pool->quit) {
        snow_batch *batch = batch_for(pool, self->worker);
        if (batch) {
            work_along(self, batch);
            continue;
        }
        if (linger(pool, &pool->begun))
            continue;
        self->asleep = true;
        pthread_cond_wait(&pool->wake, &pool->lock);
        self->asleep = false;
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

/* A child of fork() has the pool's memory but not its threads, and perhaps a
 * lock that nobody will release: it does not use them. */
static bool is_mine(const snow_pool *pool) {
    return pool->owner == getpid();
}

static snow_pool *pool_of(snow_context *context) {
    if (context->pool && is_mine(context->pool))
        return context->pool;
    snow_pool *pool = allocate_uncounted(context, sizeof *pool);
    if (!pool)
        return NULL;
    *pool = (snow_pool){.owner = getpid(),
                        .lock = PTHREAD_MUTEX_INITIALIZER,
                        .wake = PTHREAD_COND_INITIALIZER,
                        .rest = PTHREAD_COND_INITIALIZER};
    context->pool = pool;
    return pool;
}

/* Signals that are sent to the process are for the program's own threads: a
 * handler here could still run when the program has freed what it uses.  What a
 * thread's own fault raises is handled as everywhere. */
static bool start_thread(pool_thread *thread) {
    static const int faults[] = {SIGSEGV, SIGBUS,  SIGFPE, SIGILL,
                                 SIGABRT, SIGTRAP, SIGPROF};
    sigset_t others, before;
    sigfillset(&others);
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
        sigdelset(&others, faults[i]);
    pthread_sigmask(SIG_BLOCK, &others, &before);
    bool made = pthread_create(&thread->id, NULL, run_thread, thread) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return made;
}

/* Makes threads until there are `count`, as far as the system permits. */
static void add_threads(snow_context *context, snow_pool *pool, int count) {
    if (count > pool->capacity) {
        /* Threads keep their records' addresses: the records must not move. */
        if (pool->count)
            snow_pool_free(context);
        pool = pool_of(context);
        pool_thread *threads =
            pool ? allocate_uncounted(context, (size_t)count * sizeof *threads)
                 : NULL;
        if (!threads)
            return;
        give_back(context, pool->threads);
        pool->threads = threads;
        pool->capacity = count;
    }
    for (; pool->count < count; pool->count++) {
        pool_thread *thread = &pool->threads[pool->count];
        *thread = (pool_thread){.pool = pool, .worker = pool->count + 1};
        if (!start_thread(thread))
            return;
    }
}

/* The pool with threads for the given number of workers, or as many as there
 * are; NULL: none at all. While a batch is open its threads do not change. */
static snow_pool *pool_for(snow_context *context, int threads) {
    snow_pool *pool = pool_of(context);
    if (!pool || threads < 2 || pool->open)
        return pool;
    add_threads(context, pool, threads - 1);
    return context->pool;
}

static void fill_batch(snow_batch *batch, snow_monitor *monitor, int threads,
                       int64_t items, snow_work_fn *work, void *job) {
    batch->monitor = monitor;
    batch->skips = false;
    batch->work = work;
    batch->job = job;
    batch->items = items;
    batch->wanted = threads;
    atomic_store(&batch->next, 0);
}

/* Wakes the threads that the batch needs (under the lock). */
static void wake_threads(snow_pool *pool, const snow_batch *batch) {
    bool affinity = snow_affinity_begin(&pool->affinity);
    atomic_fetch_add(&pool->begun, 1);
    for (int n = 0; affinity && n < pool->count && n < batch->wanted - 1; n++) {
        pool_thread *thread = &pool->threads[n];
        if (thread->asleep &&
            snow_affinity_keep(&pool->affinity, thread->id, thread->worker))
            thread->affinity = true;
    }
    pthread_cond_broadcast(&pool->wake);
}

/* The caller is worker 0. */
static void take_all(snow_batch *batch) {
    while (take_item(batch, 0))
        continue;
}

#define ASK_NANOSECONDS 2000000

/* Waits for the pool's threads for a while, and asks whether to stop (under the
 * lock, which is left meanwhile). */
static void rest_and_ask(snow_pool *pool, snow_monitor *monitor) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += ASK_NANOSECONDS;
    if (until.tv_nsec >= 1000000000) {
        until.tv_nsec -= 1000000000;
        until.tv_sec++;
    }
    pthread_cond_timedwait(&pool->rest, &pool->lock, &until);
    pthread_mutex_unlock(&pool->lock);
    (void)snow_monitor_look(monitor, 0);
    pthread_mutex_lock(&pool->lock);
}

/* Waits until the pool's threads have finished their items (under the lock). */
static void close_batch(snow_pool *pool, snow_batch *batch) {
    while (batch->busy) {
        if (linger(pool, &batch->busy))
            continue;
        if (batch->monitor && batch->monitor->stop)
            rest_and_ask(pool, batch->monitor);
        else
            pthread_cond_wait(&pool->rest, &pool->lock);
    }
    batch->items = 0;
    snow_affinity_end(&pool->affinity);
}

/* Without threads. */
static void do_alone(snow_context *context, int64_t items, snow_work_fn *work,
                     void *job) {
    double mark = snow_seconds(), longest = 0;
    for (int64_t item = 0; item < items; item++) {
        double took = 0;
        if (snow_monitor_item(context->monitor, 0, item, items))
            break;
        work(job, item, 0);
        snow_lap(&mark, &took);
        longest = took > longest ? took : longest;
        context->shared += took;
    }
    context->longest += longest;
}

snow_status snow_parallel(snow_context *context, int threads, int64_t items,
                          snow_work_fn *work, void *job) {
    snow_monitor *monitor = context->monitor;
    if (threads > items)
        threads = (int)items;
    snow_pool *pool = threads > 1 ? pool_for(context, threads) : NULL;
    snow_monitor_batch(monitor);
    if (pool && pool->count) {
        pthread_mutex_lock(&pool->lock);
        fill_batch(&pool->call, monitor, threads, items, work, job);
        pool->call.skips = monitor != NULL;
        wake_threads(pool, &pool->call);
        pthread_mutex_unlock(&pool->lock);
        take_all(&pool->call);
        pthread_mutex_lock(&pool->lock);
        close_batch(pool, &pool->call);
        pthread_mutex_unlock(&pool->lock);
    } else
        do_alone(context, items, work, job);
    snow_monitor_batch(monitor);
    return snow_monitor_status(monitor);
}

void snow_parallel_begin(snow_context *context, int threads, int64_t items,
                         snow_work_fn *work, void *job, snow_batch *batch) {
    if (threads > items)
        threads = (int)items;
    snow_pool *pool = threads > 1 ? pool_for(context, threads) : NULL;
    batch->busy = 0;
    fill_batch(batch, context->monitor, threads, items, work, job);
    if (!pool || !pool->count || pool->open)
        return;
    pthread_mutex_lock(&pool->lock);
    pool->open = batch;
    wake_threads(pool, batch);
    pthread_mutex_unlock(&pool->lock);
}

bool snow_parallel_step(snow_batch *batch) {
    return take_item(batch, 0);
}

void snow_parallel_end(snow_context *context, snow_batch *batch) {
    snow_pool *pool = context->pool;
    take_all(batch);
    if (!pool || !is_mine(pool) || pool->open != batch)
        return;
    pthread_mutex_lock(&pool->lock);
    close_batch(pool, batch);
    pool->open = NULL;
    pthread_mutex_unlock(&pool->lock);
}

void snow_pool_free(snow_context *context) {
    snow_pool *pool = context->pool;
    if (!pool || !is_mine(pool))
        return;
    pthread_mutex_lock(&pool->lock);
    pool->quit = true;
    atomic_fetch_add(&pool->begun, 1);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
    for (int n = 0; n < pool->count; n++)
        pthread_join(pool->threads[n].id, NULL);
    pthread_cond_destroy(&pool->rest);
    pthread_cond_destroy(&pool->wake);
    pthread_mutex_destroy(&pool->lock);
    give_back(context, pool->threads);
    give_back(context, pool);
    context->pool = NULL;
}
