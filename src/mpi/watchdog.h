/* mpi/watchdog.h - detects ranks that stopped: a waiting rank checks whether
 * those that it waits for still answer, and answers those that wait for it.
 *
 * A rank that is stopped, or that hangs, sends no error: its peers would wait
 * for ever, and theirs for them. So a rank that has waited for half of its
 * timeout asks those that it waits for. One that waits itself answers, and is
 * not blamed: it checks its own peers. One that has not answered when the
 * timeout is over has neither sent nor waited for that time, and is the reason.
 * Only one rank reports it, the lowest of the others, if it can.
 *
 * No thread is needed: notes are written and read between tests of messages. A
 * working rank does not answer, so the timeout must be longer than any work
 * between two messages. */
#ifndef SNOW_MPI_WATCHDOG_H
#define SNOW_MPI_WATCHDOG_H

#include <snowglass/mpi.h>

typedef struct mpi_watchdog mpi_watchdog;

/* Collective over `group`, which is duplicated for the notes. Errors:
 * SNOW_STATUS_NO_MEMORY, SNOW_STATUS_FAILED (of MPI); the caller must inform
 * the other ranks. Even then `*out` must be freed, unless it is NULL. */
snow_status snow_watchdog_new(snow_context *context, MPI_Comm group,
                              mpi_watchdog **out);

/* Collective if MPI is well (`orderly`); otherwise the group is left alone. */
void snow_watchdog_free(mpi_watchdog *watchdog, bool orderly);

/* Sets the timeout in seconds; 0: no rank is asked, and waits may last for
 * ever. */
void snow_watchdog_limit(mpi_watchdog *watchdog, double seconds);

/* Call before the first test of a message that is waited for. */
snow_status snow_watchdog_begin(mpi_watchdog *watchdog);

/* Call after a test that has found nothing: waits for messages to or from
 * `peers`, of which there is at least one. Yields the processor, and sleeps in
 * long waits. Errors:
 * SNOW_STATUS_FAILED, naming the ranks that do not answer. */
snow_status snow_watchdog_turn(mpi_watchdog *watchdog, const int *peers,
                               int count);

#endif
