/* snowglass/comm.h - processors that work on one picture together.
 *
 * A communicator is a fixed group of processors, numbered from 0 (its ranks):
 * one process, threads, MPI (mpi.h), or a transport of your own (extend.h).
 * Collective calls are made by all ranks in the same order; what fails on one
 * fails on all, with the same status and a message that names the rank. */
#ifndef SNOWGLASS_COMM_H
#define SNOWGLASS_COMM_H

#include <snowglass/context.h>

/* Makes a communicator of one rank. */
SNOW_API snow_status snow_comm_new_self(snow_context *context, snow_comm **out);

/* What a rank of snow_comm_run_threads does. */
typedef snow_status snow_comm_body_fn(snow_comm *comm, void *user);

/* Runs `body` on `ranks` threads. Each has a communicator and a context of its
 * own, over the memory of `context`, which end with the call. Returns the
 * status of the lowest rank that failed of itself. Ranks that wait for a body
 * that has returned, or all for one another, are released: their calls fail. */
SNOW_API snow_status snow_comm_run_threads(
    snow_context *context, int ranks, snow_comm_body_fn *body, void *user);

/* Frees a communicator, after the objects that were made with it. Collective
 * where the transport needs it. */
SNOW_API void snow_comm_free(snow_comm *comm);

/* Return the number of this rank, from 0, how many there are, and the context
 * that the communicator was made with. */
SNOW_API int snow_comm_rank(const snow_comm *comm);
SNOW_API int snow_comm_size(const snow_comm *comm);
SNOW_API snow_context *snow_comm_context(const snow_comm *comm);

/* Collective. Returns OK if all ranks give OK; else the status of the lowest
 * rank that failed, with its message in every context, after "rank N: ". */
SNOW_API snow_status snow_comm_agree_status(
    snow_comm *comm, snow_status status);

/* Collective. Copies `count` bytes of rank `root` to all. */
SNOW_API snow_status snow_comm_broadcast(
    snow_comm *comm, void *bytes, size_t count, int root);

/* Collective. Copies `count` bytes of each rank to all, in the order of ranks;
 * `all` has room for count * size bytes. */
SNOW_API snow_status snow_comm_allgather(
    snow_comm *comm, const void *mine, size_t count, void *all);

/* Returns whether the transport has failed on this rank. All further calls
 * fail. Other ranks may not know: end all processes, and free no frame and no
 * pictures in situ before. */
SNOW_API bool snow_comm_broken(const snow_comm *comm);

/* Sets the seconds to wait for a rank that neither sends nor waits
 * (docs/scaling.md), alike on all ranks; then the communicator is broken. 0:
 * for ever. */
SNOW_API void snow_comm_set_timeout(snow_comm *comm, double seconds);

/* Returns wall time, or that of a simulated transport. */
SNOW_API double snow_comm_seconds(snow_comm *comm);

/* Gives the messages and bytes that this rank has sent so far. */
SNOW_API void snow_comm_sent(
    const snow_comm *comm, uint64_t *messages, uint64_t *bytes);

#endif
