/* base/apart.c - helpers begin on other processors than whom they help.  Calls
 * that the system refuses change nothing. */
#define _GNU_SOURCE /* pthread_setaffinity_np, sched_getcpu */
#include "base/apart.h"

#include "base/base.h"

#include <sched.h>

/* Seconds: of a rest that counts, and how long it counts for.  A process that
 * works for a quarter of the time does not rest. */
#define REST 1e-3
#define AFTER 20e-3
#define WORK 0.25

void snow_apart_end(snow_apart *apart) {
    apart->ended = snow_seconds();
    apart->ended_cpu = snow_cpu_seconds();
}

bool snow_apart_begin(snow_apart *apart) {
    double now = snow_seconds(), rest = now - apart->ended;
    if (rest > REST && snow_cpu_seconds() - apart->ended_cpu < WORK * rest)
        apart->until = now + AFTER;
    return now < apart->until;
}

int snow_apart_keep(pthread_t helper, int nth, int avoided) {
    int here = sched_getcpu();
    cpu_set_t allowed;
    if (avoided != SNOW_APART_NONE || here < 0 || here >= CPU_SETSIZE ||
        pthread_getaffinity_np(helper, sizeof allowed, &allowed) ||
        !CPU_ISSET((size_t)here, &allowed) || CPU_COUNT(&allowed) <= nth)
        return avoided;
    CPU_CLR((size_t)here, &allowed);
    return pthread_setaffinity_np(helper, sizeof allowed, &allowed)
               ? SNOW_APART_NONE
               : here;
}

void snow_apart_release(int avoided) {
    cpu_set_t allowed;
    if (avoided == SNOW_APART_NONE ||
        pthread_getaffinity_np(pthread_self(), sizeof allowed, &allowed))
        return;
    CPU_SET((size_t)avoided, &allowed);
    pthread_setaffinity_np(pthread_self(), sizeof allowed, &allowed);
}
