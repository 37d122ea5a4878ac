/* base/apart.h - a thread that is woken begins on another processor than the
 * one that wakes it.
 *
 * Linux puts a waking thread on a processor that it believes to be idle.  In a
 * virtual machine it does not believe it of one that rests and whose time the
 * host has given to others; it leaves the thread behind its waker, and notices
 * some milliseconds later: a picture that is made after a pause takes as long
 * with two threads as with one.  So sleepers are kept off the processor of whom
 * they are to help. */
#ifndef SNOW_APART_H
#define SNOW_APART_H

#include <pthread.h>

/* No processor. */
#define SNOW_APART_NONE (-1)

/* Keeps `sleeper`, the caller's nth helper (from 1 on), off the caller's
 * processor, and lets it on `*avoided` again, which it was kept off since the
 * last call (NONE before the first).  Where it may use no more than n
 * processors it is kept off none.  Costs nothing while the caller stays where
 * it is, else two calls of the system; does nothing where it has no such. */
void snow_apart(pthread_t sleeper, int nth, int *avoided);

#endif
