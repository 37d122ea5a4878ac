/* base/apart.c - helpers begin on other processors than whom they help. */
#define _GNU_SOURCE /* pthread_setaffinity_np, sched_getcpu */
#include "base/apart.h"

#include "base/base.h"

#include <assert.h>
#include <sched.h>
#include <string.h>

/* Seconds: of a rest that counts, and how long it counts for.  A process that
 * works for a quarter of the time does not rest. */
#define REST 1e-3
#define AFTER 20e-3
#define WORK 0.25

void snow_apart_end(snow_apart *apart) {
    apart->ended = snow_seconds();
    apart->ended_cpu = snow_cpu_seconds();
}

static_assert(sizeof(cpu_set_t) <= sizeof((snow_apart){0}.everywhere),
              "the record has room for a set of processors");

bool snow_apart_begin(snow_apart *apart) {
    double now = snow_seconds(), rest = now - apart->ended;
    cpu_set_t all;
    if (rest > REST && snow_cpu_seconds() - apart->ended_cpu < WORK * rest)
        apart->until = now + AFTER;
    if (now >= apart->until ||
        pthread_getaffinity_np(pthread_self(), sizeof all, &all))
        return false;
    memcpy(apart->everywhere, &all, sizeof all);
    return true;
}

bool snow_apart_keep(const snow_apart *apart, pthread_t helper, int nth) {
    int here = sched_getcpu();
    cpu_set_t all;
    memcpy(&all, apart->everywhere, sizeof all);
    if (here < 0 || here >= CPU_SETSIZE || CPU_COUNT(&all) <= nth)
        return false;
    CPU_CLR((size_t)here, &all);
    return pthread_setaffinity_np(helper, sizeof all, &all) == 0;
}

bool snow_apart_release(const snow_apart *apart) {
    cpu_set_t all;
    memcpy(&all, apart->everywhere, sizeof all);
    return pthread_setaffinity_np(pthread_self(), sizeof all, &all) == 0;
}
