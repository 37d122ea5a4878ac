/* base/parallel.c - a pool of threads for each context.
 *
 * A call is a batch of items: the caller writes down the work, wakes as many
 * sleepers as it wants, and takes items like everybody else; who finds none
 * left signs off, and the caller waits for the last.  Nobody spins: on a
 * machine with other work a spinning thread takes the time of the one that it
 * waits for.
 *
 * A batch may lie open behind the calls (snow_parallel_begin).  Threads take
 * its items one by one, and none while a call has some. */
#include "base/parallel.h"

#include "base/apart.h"

#include <string.h>
#include <unistd.h>

typedef struct snow_pool snow_pool;

/* A thread of the pool; its number is that of the worker. */
typedef struct pool_thread {
    snow_pool *pool;
    pthread_t id;
    int worker;
    bool asleep;
    bool apart; /* kept off a processor, until it has work */
} pool_thread;

/* Batches change under the lock but for `next`, and stay as they are while
 * anybody takes items. */
struct snow_pool {
    pid_t owner; /* the process that the threads are of */
    pthread_mutex_t lock;
    pthread_cond_t wake, rest;
    pool_thread *threads; /* worker n is threads[n - 1] */
    int count, room;
    bool quit;
    snow_apart apart;
    snow_batch call;  /* of snow_parallel */
    snow_batch *open; /* of snow_parallel_begin, or NULL */
};

/* Memory of the context itself, which is not counted among its objects'. */
static void *take(snow_context *context, size_t bytes) {
    void *block = context->allocator.allocate(context->allocator.user, bytes);
    if (block)
        memset(block, 0, bytes);
    return block;
}

static void give_back(snow_context *context, void *block) {
    if (block)
        context->allocator.release(context->allocator.user, block);
}

/* Does one item; false where none is left. */
static bool take_item(snow_batch *batch, int worker) {
    int64_t item = atomic_fetch_add(&batch->next, 1);
    if (item >= batch->items)
        return false;
    batch->work(batch->job, item, worker);
    return true;
}

/* The batch that a worker has something to do in (under the lock), or NULL. */
static snow_batch *batch_for(snow_pool *pool, int worker) {
    snow_batch *const batches[] = {&pool->call, pool->open};
    for (int n = 0; n < 2; n++)
        if (batches[n] && worker < batches[n]->wanted &&
            atomic_load(&batches[n]->next) < batches[n]->items)
            return batches[n];
    return NULL;
}

/* A thread's share of a batch (under the lock, which it leaves meanwhile). */
static void work_along(pool_thread *self, snow_batch *batch) {
    snow_pool *pool = self->pool;
    const snow_apart apart = pool->apart;
    bool still_apart = self->apart;
    batch->busy++;
    pthread_mutex_unlock(&pool->lock);
    if (still_apart)
        still_apart = !snow_apart_release(&apart);
    while (take_item(batch, self->worker) && batch == &pool->call)
        continue;
    pthread_mutex_lock(&pool->lock);
    self->apart = still_apart;
    if (--batch->busy == 0)
        pthread_cond_signal(&pool->rest);
}

/* The life of a thread: asleep until there is a batch that wants it. */
static void *live(void *argument) {
    pool_thread *self = argument;
    snow_pool *pool = self->pool;
    pthread_mutex_lock(&pool->lock);
    while (!pool->quit) {
        snow_batch *batch = batch_for(pool, self->worker);
        if (batch) {
            work_along(self, batch);
            continue;
        }
        self->asleep = true;
        pthread_cond_wait(&pool->wake, &pool->lock);
        self->asleep = false;
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

/* A child of fork() has the pool's memory but not its threads, and perhaps a
 * lock that nobody will ever open: it leaves them alone. */
static bool is_mine(const snow_pool *pool) {
    return pool->owner == getpid();
}

static snow_pool *pool_of(snow_context *context) {
    if (context->pool && is_mine(context->pool))
        return context->pool;
    snow_pool *pool = take(context, sizeof *pool);
    if (!pool)
        return NULL;
    if (pthread_mutex_init(&pool->lock, NULL) ||
        pthread_cond_init(&pool->wake, NULL) ||
        pthread_cond_init(&pool->rest, NULL)) {
        give_back(context, pool);
        return NULL;
    }
    pool->owner = getpid();
    context->pool = pool;
    return pool;
}

/* Makes threads until there are `count`, as far as the system gives them. */
static void grow(snow_context *context, snow_pool *pool, int count) {
    if (count > pool->room) {
        /* A thread knows its record's address: the records may not move. */
        if (pool->count)
            snow_pool_free(context);
        pool = pool_of(context);
        pool_thread *threads =
            pool ? take(context, (size_t)count * sizeof *threads) : NULL;
        if (!threads)
            return;
        give_back(context, pool->threads);
        pool->threads = threads;
        pool->room = count;
    }
    for (; pool->count < count; pool->count++) {
        pool_thread *thread = &pool->threads[pool->count];
        *thread = (pool_thread){.pool = pool, .worker = pool->count + 1};
        if (pthread_create(&thread->id, NULL, live, thread))
            return;
    }
}

/* The pool with threads for so many workers, or what there is of it; NULL: none
 * at all.  While a batch lies open its threads stay as they are. */
static snow_pool *pool_for(snow_context *context, int threads) {
    snow_pool *pool = pool_of(context);
    if (!pool || threads < 2 || pool->open)
        return pool;
    grow(context, pool, threads - 1);
    return context->pool;
}

static void fill_batch(snow_batch *batch, int threads, int64_t items,
                       snow_work_fn *work, void *job) {
    batch->work = work;
    batch->job = job;
    batch->items = items;
    batch->wanted = threads;
    atomic_store(&batch->next, 0);
}

/* Wakes the threads that the batch wants (under the lock). */
static void wake(snow_pool *pool, const snow_batch *batch) {
    bool apart = snow_apart_begin(&pool->apart);
    for (int n = 0; apart && n < pool->count && n < batch->wanted - 1; n++) {
        pool_thread *thread = &pool->threads[n];
        if (thread->asleep &&
            snow_apart_keep(&pool->apart, thread->id, thread->worker))
            thread->apart = true;
    }
    pthread_cond_broadcast(&pool->wake);
}

/* The caller is worker 0. */
static void take_all(snow_batch *batch) {
    while (take_item(batch, 0))
        continue;
}

/* Until the pool's threads have done what they took (under the lock). */
static void close_batch(snow_pool *pool, snow_batch *batch) {
    while (batch->busy)
        pthread_cond_wait(&pool->rest, &pool->lock);
    batch->items = 0;
    snow_apart_end(&pool->apart);
}

void snow_parallel(snow_context *context, int threads, int64_t items,
                   snow_work_fn *work, void *job) {
    if (threads > items)
        threads = (int)items;
    snow_pool *pool = threads > 1 ? pool_for(context, threads) : NULL;
    if (!pool || !pool->count) {
        for (int64_t item = 0; item < items; item++)
            work(job, item, 0);
        return;
    }
    pthread_mutex_lock(&pool->lock);
    fill_batch(&pool->call, threads, items, work, job);
    wake(pool, &pool->call);
    pthread_mutex_unlock(&pool->lock);
    take_all(&pool->call);
    pthread_mutex_lock(&pool->lock);
    close_batch(pool, &pool->call);
    pthread_mutex_unlock(&pool->lock);
}

void snow_parallel_begin(snow_context *context, int threads, int64_t items,
                         snow_work_fn *work, void *job, snow_batch *batch) {
    if (threads > items)
        threads = (int)items;
    snow_pool *pool = threads > 1 ? pool_for(context, threads) : NULL;
    batch->busy = 0;
    fill_batch(batch, threads, items, work, job);
    if (!pool || !pool->count || pool->open)
        return;
    pthread_mutex_lock(&pool->lock);
    pool->open = batch;
    wake(pool, batch);
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
