/* base/parallel.c - a pool of threads for each context.
 *
 * A call is a round: the caller writes down the work, wakes as many sleepers as
 * it wants, and takes items like everybody else; who finds none left signs off,
 * and the caller waits for the last.  Nobody spins: on a machine with other
 * work a spinning thread takes the time of the one that it waits for. */
#include "base/parallel.h"

#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

typedef struct snow_pool snow_pool;

/* A thread of the pool; its number is that of the worker. */
typedef struct pool_thread {
    snow_pool *pool;
    pthread_t id;
    int worker;
    uint64_t seen; /* the last round that it need not care for */
} pool_thread;

struct snow_pool {
    pid_t owner; /* the process that the threads are of */
    pthread_mutex_t lock;
    pthread_cond_t wake, rest;
    pool_thread *threads; /* worker n is threads[n - 1] */
    int count, room;
    /* The round, guarded by the lock but for `next`. */
    uint64_t round;
    bool quit;
    int wanted; /* workers of this round, the caller included */
    int busy;   /* of the pool's threads */
    snow_work_fn *work;
    void *job;
    int64_t items;
    atomic_int_fast64_t next;
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

static void work_off(snow_pool *pool, int worker) {
    for (;;) {
        int64_t item = atomic_fetch_add(&pool->next, 1);
        if (item >= pool->items)
            return;
        pool->work(pool->job, item, worker);
    }
}

/* The life of a thread: asleep until there is a round that wants it. */
static void *live(void *argument) {
    pool_thread *self = argument;
    snow_pool *pool = self->pool;
    uint64_t seen = self->seen;
    pthread_mutex_lock(&pool->lock);
    while (!pool->quit) {
        if (pool->round == seen || self->worker >= pool->wanted) {
            seen = pool->round;
            pthread_cond_wait(&pool->wake, &pool->lock);
            continue;
        }
        seen = pool->round;
        pthread_mutex_unlock(&pool->lock);
        work_off(pool, self->worker);
        pthread_mutex_lock(&pool->lock);
        if (--pool->busy == 0)
            pthread_cond_signal(&pool->rest);
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
        *thread = (pool_thread){
            .pool = pool, .worker = pool->count + 1, .seen = pool->round};
        if (pthread_create(&thread->id, NULL, live, thread))
            return;
    }
}

void snow_parallel(snow_context *context, int threads, int64_t items,
                   snow_work_fn *work, void *job) {
    if (threads > items)
        threads = (int)items;
    snow_pool *pool = threads > 1 ? pool_of(context) : NULL;
    if (pool) {
        grow(context, pool, threads - 1);
        pool = context->pool;
    }
    if (!pool || !pool->count) {
        for (int64_t item = 0; item < items; item++)
            work(job, item, 0);
        return;
    }
    pthread_mutex_lock(&pool->lock);
    pool->work = work;
    pool->job = job;
    pool->items = items;
    pool->wanted = threads;
    pool->busy = threads - 1 < pool->count ? threads - 1 : pool->count;
    pool->round++;
    atomic_store(&pool->next, 0);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
    work_off(pool, 0);
    pthread_mutex_lock(&pool->lock);
    while (pool->busy)
        pthread_cond_wait(&pool->rest, &pool->lock);
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
