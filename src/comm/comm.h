/* comm/comm.h - the internals of a communicator: messages, and collective
 * operations that are built from messages alone, so that every transport has
 * them.
 *
 * Collectives take about log2(ranks) rounds and are deterministic: numbers are
 * reduced in the same order regardless of arrival. They fail only with the
 * transport, so a failure of one rank alone never makes the others wait. Local
 * work may fail on one rank: then call snow_comm_agree_status. */
#ifndef SNOW_COMM_H
#define SNOW_COMM_H

#include "base/base.h"

#define SNOW_COMM_SCRATCH 2048

struct snow_comm {
    snow_context *context;
    snow_comm_ops ops;
    void *self;
    int rank, ranks;
    /* Sent by this rank, for the figures of a benchmark. */
    uint64_t messages_sent, bytes_sent;
    snow_status broken; /* the transport's failure, which later calls return */
    bool agreed;        /* the context's message is the same on all ranks */
    uint64_t scratch[SNOW_COMM_SCRATCH]; /* another rank's numbers: a collective
                                            call allocates nothing, which could
                                            fail on one rank alone */
};

/* Tags of the library's own messages; others may use smaller tags. */
enum {
    SNOW_TAG_COLLECTIVE = 32000,
    SNOW_TAG_COMBINE,
    SNOW_TAG_GATHER,
    SNOW_TAG_VOXELS,
    SNOW_TAG_LINES,
    SNOW_TAG_LAYERS
};

/* The transport's functions, with counting. A rank may send to itself. A send
 * may complete only when its receiver has asked for it, as with MPI; with
 * threads, where this is tested, it always does so. Start a send and the
 * receives that the other side waits for, then wait for both. Errors: those of
 * the transport; SNOW_STATUS_BAD_USAGE (an invalid rank or tag). Any of them
 * breaks the communicator. */
snow_status snow_comm_send(snow_comm *comm, const void *bytes, size_t count,
                           int to, int tag, snow_message *message);
snow_status snow_comm_receive(snow_comm *comm, void *bytes, size_t capacity,
                              int from, int tag, snow_message *message);
snow_status snow_comm_wait_any(snow_comm *comm, snow_message *messages,
                               int count, int *which);
snow_status snow_comm_wait_all(snow_comm *comm, snow_message *messages,
                               int count);
void snow_comm_work(snow_comm *comm, double seconds);

/* Sets the work that this rank does in pieces while it would wait for messages;
 * NULL: none, the initial state. */
void snow_comm_occupy(snow_comm *comm, snow_idle_fn *work, void *user);

/* Lets messages progress, between pieces of work while they are in flight. */
void snow_comm_progress(snow_comm *comm);

/* Reduces the first values with SNOW_REDUCE_MAX and those after them with
 * SNOW_REDUCE_SUM, at the cost of one reduction; together at most
 * SNOW_COMM_SCRATCH. */
snow_status snow_comm_reduce_both(snow_comm *comm, int64_t *values,
                                  size_t maxima, size_t sums);

#endif
