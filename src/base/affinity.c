/* base/affinity.c - sets the affinity of helper threads so that they start on
 * other processors than the thread that wakes them. */
#define _GNU_SOURCE /* pthread_setaffinity_np, sched_getcpu */
#include "base/affinity.h"

#include "base/base.h"

#include <assert.h>
#include <sched.h>
#include <string.h>

/* Seconds: the shortest pause that counts, and how long it counts for. A
 * process that works for this fraction of the time does not pause. */
#define REST 1e-3
#define AFTER 20e-3
#define WORK 0.25

void snow_affinity_end(snow_affinity *affinity) {
    affinity->ended = snow_seconds();
    affinity->ended_cpu = snow_cpu_seconds();
}

static_assert(sizeof(cpu_set_t) <= sizeof((snow_affinity){0}.everywhere),
              "the record must hold a cpu_set_t");

bool snow_affinity_begin(snow_affinity *affinity) {
    double now = snow_seconds(), rest = now - affinity->ended;
    cpu_set_t all;
    if (rest > REST && snow_cpu_seconds() - affinity->ended_cpu < WORK * rest)
        affinity->until = now + AFTER;
    if (now >= affinity->until ||
        pthread_getaffinity_np(pthread_self(), sizeof all, &all))
        return false;
    memcpy(affinity->everywhere, &all, sizeof all);
    return true;
}

bool snow_affinity_keep(const snow_affinity *affinity, pthread_t helper,
                        int nth) {
    int here = sched_getcpu();
    cpu_set_t all;
    memcpy(&all, affinity->everywhere, sizeof all);
    if (here < 0 || here >= CPU_SETSIZE || CPU_COUNT(&all) <= nth)
        return false;
    CPU_CLR((size_t)here, &all);
    return pthread_setaffinity_np(helper, sizeof all, &all) == 0;
}

bool snow_affinity_release(const snow_affinity *affinity) {
    cpu_set_t all;
    memcpy(&all, affinity->everywhere, sizeof all);
    return pthread_setaffinity_np(pthread_self(), sizeof all, &all) == 0;
}
