/* snowglass/comm.h - processors that work on one picture together.
 *
 * A communicator is a fixed group of processors, numbered from 0 (its ranks):
 * one process, threads, MPI (mpi.h), or a transport of your own (extend.h).
 * Collective calls are made by all ranks in the same order; what fails on one
 * fails on all, with the same status and a message that names the rank. */
#ifndef SNOWGLASS_COMM_H
#define SNOWGLASS_COMM_H

#include <snowglass/context.h>

typedef struct snow_comm snow_comm;

/* A group of one. */
SNOW_API snow_status snow_comm_new_self(snow_context *context, snow_comm **out);
/* Runs `body` on `ranks` threads, each with a communicator and context of its
 * own, which end with the call, over the memory of `context`. The status is
 * that of the lowest rank that failed of itself. A body that returns, or all
 * ranks waiting for one another, releases those who wait: their calls fail. */
typedef snow_status snow_comm_body_fn(snow_comm *comm, void *user);
SNOW_API snow_status snow_comm_run_threads(
    snow_context *context, int ranks, snow_comm_body_fn *body, void *user);
/* After the objects made with it; collective where the transport needs it. */
SNOW_API void snow_comm_free(snow_comm *comm);
SNOW_API int snow_comm_rank(const snow_comm *comm); /* from 0 */
SNOW_API int snow_comm_size(const snow_comm *comm); /* how many */
SNOW_API snow_context *snow_comm_context(const snow_comm *comm);
/* Collective. OK if all ranks give it; else the status of the lowest rank that
 * failed, with its message in every context, after "rank N: ". */
SNOW_API snow_status snow_comm_agree_status(snow_comm *, snow_status status);
/* Collective. `count` bytes of rank `root` to all; of each rank, in order. */
SNOW_API snow_status snow_comm_broadcast(
    snow_comm *comm, void *bytes, size_t count, int root);
SNOW_API snow_status snow_comm_allgather(
    snow_comm *comm, const void *mine, size_t count, void *all);
/* Whether the transport has failed on this rank. All further calls fail. Other
 * ranks may not know: end all processes, and free no frame or movie before. */
SNOW_API bool snow_comm_broken(const snow_comm *comm);
/* Alike on all ranks: seconds to wait for a rank that neither sends nor waits
 * (docs/scaling.md); then the communicator is broken. 0: for ever. */
SNOW_API void snow_comm_set_timeout(snow_comm *comm, double seconds);
/* Wall time, unless simulated; messages and bytes of this rank so far. */
SNOW_API double snow_comm_seconds(snow_comm *comm);
SNOW_API void snow_comm_sent(
    const snow_comm *comm, uint64_t *messages, uint64_t *bytes);

#endif
