/* base/apart.c - a woken thread begins on another processor than its waker's.
 */
#define _GNU_SOURCE /* pthread_setaffinity_np, sched_getcpu */
#include "base/apart.h"

#include <sched.h>

void snow_apart(pthread_t sleeper, int nth, int *avoided) {
    int here = sched_getcpu();
    cpu_set_t allowed;
    if (here == *avoided || here < 0 || here >= CPU_SETSIZE ||
        pthread_getaffinity_np(sleeper, sizeof allowed, &allowed))
        return;
    if (*avoided != SNOW_APART_NONE)
        CPU_SET((size_t)*avoided, &allowed);
    if (CPU_COUNT(&allowed) <= nth)
        here = SNOW_APART_NONE;
    else
        CPU_CLR((size_t)here, &allowed);
    if (here != *avoided &&
        pthread_setaffinity_np(sleeper, sizeof allowed, &allowed) == 0)
        *avoided = here;
}
