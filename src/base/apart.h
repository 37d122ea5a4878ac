/* base/apart.h - helpers that are woken after a rest begin on other processors
 * than the one that wakes them.
 *
 * Linux puts a waking thread on a processor that it believes to be idle.  In a
 * virtual machine it does not believe it of one that has rested, since the host
 * may have given its time to others: the thread is left behind its waker, for
 * some milliseconds.  A picture that is made after a pause then takes as long
 * with two threads as with one.  So after a pause of the whole process a
 * sleeping helper is kept off its waker's processor until it is awake.  While
 * the process works without a pause nothing is done: then processors are known
 * to be idle, or are not. */
#ifndef SNOW_APART_H
#define SNOW_APART_H

#include <pthread.h>
#include <stdbool.h>

/* What a caller and its helpers share; they change and read it under a lock. */
typedef struct snow_apart {
    double ended, ended_cpu; /* when helpers were needed last; zeros: never */
    double until;            /* helpers are kept apart */
    unsigned char everywhere[128]; /* a cpu_set_t: where the caller may run */
} snow_apart;

/* Helpers are needed no more. */
void snow_apart_end(snow_apart *apart);

/* Helpers are needed again; returns whether they are to be kept apart: for a
 * short time after a rest, since the processors' next rests, between the parts
 * of a picture, are taken for the same.  They may run where the caller may, so
 * that a change to that counts for them from the next rest on. */
bool snow_apart_begin(snow_apart *apart);

/* Keeps the sleeping `helper`, the caller's nth (from 1 on), off the caller's
 * processor; returns whether.  Not where there are no more than n processors,
 * and not where the system refuses. */
bool snow_apart_keep(const snow_apart *apart, pthread_t helper, int nth);

/* Lets the calling helper run everywhere; returns whether.  A copy will do. */
bool snow_apart_release(const snow_apart *apart);

#endif
