/* base/affinity.h - helper threads that are woken after a pause start on other
 * processors than the one that wakes them.
 *
 * Linux puts a waking thread on a processor that it believes to be idle. In a
 * virtual machine it does not believe that of a processor that has paused,
 * since the host may have given its time to others: the thread is queued behind
 * its waker, for some milliseconds. A picture that is made after a pause then
 * takes as long with two threads as with one. So after a pause of the whole
 * process a sleeping helper is kept off its waker's processor until it is
 * awake. While the process works without a pause nothing is done: then the
 * state of processors is known. */
#ifndef SNOW_BASE_AFFINITY_H
#define SNOW_BASE_AFFINITY_H

#include <pthread.h>
#include <stdbool.h>

/* Shared by a caller and its helpers, who access it under a lock. */
typedef struct snow_affinity {
    double ended, ended_cpu; /* when helpers were last needed; zeros: never */
    double until;            /* helpers are kept off until then */
    unsigned char everywhere[128]; /* a cpu_set_t: where the caller may run */
} snow_affinity;

/* Helpers are no longer needed. */
void snow_affinity_end(snow_affinity *affinity);

/* Helpers are needed again; returns whether to keep them off the caller's
 * processor. That is the case for a short time after a pause, since the next
 * pauses of processors, between the parts of a picture, have the same effect.
 * Helpers may run where the caller may; a change of that applies to them from
 * the next pause on. */
bool snow_affinity_begin(snow_affinity *affinity);

/* Keeps the sleeping `helper`, the caller's nth (from 1 on), off the caller's
 * processor; returns whether it did. It does not if there are at most n
 * processors, or if the system refuses. */
bool snow_affinity_keep(const snow_affinity *affinity, pthread_t helper,
                        int nth);

/* Lets the calling helper run everywhere; returns whether that succeeded.
 * `affinity` may be a copy. */
bool snow_affinity_release(const snow_affinity *affinity);

#endif
