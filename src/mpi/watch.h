/* mpi/watch.h - what a rank does while it waits: it looks whether those that it
 * waits for still answer, and answers those that wait for it.
 *
 * A rank that is stopped, or that hangs, sends no error: its peers would wait
 * for ever, and theirs for them.  So a rank that has waited for half of its
 * timeout asks those that it waits for.  One that waits itself answers, and is
 * left alone: it has its own peer to look after.  One that has not answered
 * when the timeout is over has neither sent nor waited for so long, and is the
 * reason.  Only one rank tells of it, the lowest of the others, if it can.
 *
 * No thread is needed: notes are written and read between tests of messages. A
 * rank at work answers nothing, so that the timeout must be longer than any
 * work between two messages. */
#ifndef SNOW_MPI_WATCH_H
#define SNOW_MPI_WATCH_H

#include <snowglass/mpi.h>

typedef struct mpi_watch mpi_watch;

/* Collective over `group`, of which it has a duplicate for its notes.  Errors:
 * SNOW_NO_MEMORY, SNOW_FAILED (of MPI); the other ranks must learn of them.
 * `*out` is set and to be freed even then, unless it is NULL. */
snow_status snow_watch_new(snow_context *context, MPI_Comm group,
                           mpi_watch **out);

/* Collective while MPI is well (`orderly`): else the group is left alone. */
void snow_watch_free(mpi_watch *watch, bool orderly);

/* Seconds; 0: nobody is asked, and waits may last for ever. */
void snow_watch_limit(mpi_watch *watch, double seconds);

/* Before the first test of a message that is waited for. */
snow_status snow_watch_begin(mpi_watch *watch);

/* After a test that has found nothing: messages to or from `peers`, count of
 * them at least 1, are waited for.  Gives the processor to others.  Errors:
 * SNOW_FAILED, with the ranks that are waited for in vain. */
snow_status snow_watch_turn(mpi_watch *watch, const int *peers, int count);

#endif
