/* base/apart.h - helpers that are woken after a rest begin on other processors
 * than the one that wakes them.
 *
 * Linux puts a waking thread on a processor that it believes to be idle.  In a
 * virtual machine it does not believe it of one that has rested, since the host
 * may have given its time to others: the thread is left behind its waker, for
 * some milliseconds.  A picture that is made after a pause then takes as long
 * with two threads as with one.  So after a pause of the whole process a helper
 * is kept off its waker's processor until it is awake.  While the process works
 * without a pause nothing is done: then processors are known to be idle, or are
 * not. */
#ifndef SNOW_APART_H
#define SNOW_APART_H

#include <pthread.h>
#include <stdbool.h>

/* When helpers were needed last; zeros: never. */
typedef struct snow_apart {
    double ended, ended_cpu; /* snow_seconds() and snow_cpu_seconds() */
    double until;            /* helpers are kept apart; snow_seconds() */
} snow_apart;

/* Helpers are needed no more; whether they are to be kept apart, now that they
 * are needed again: for a short time after a rest, since the processors' next
 * rests, between the parts of a picture, are taken for the same. */
void snow_apart_end(snow_apart *apart);
bool snow_apart_begin(snow_apart *apart);

/* No processor. */
#define SNOW_APART_NONE (-1)

/* Keeps the caller's nth helper (from 1 on) off the caller's processor; not
 * where the helper may use no more than n processors.  Returns the processor,
 * or what it was kept off already, `avoided`. */
int snow_apart_keep(pthread_t helper, int nth, int avoided);

/* The calling helper may use `avoided`, if any, again. */
void snow_apart_release(int avoided);

#endif
