/* comm/comm.h - the inside of a communicator: messages, and what ranks do
 * together, made of messages alone so that every transport has it.
 *
 * Collectives take about log2(ranks) rounds and are deterministic: numbers are
 * reduced in the same order whatever arrives first.  They fail only with the
 * transport, so that what one rank finds out alone is never a reason for the
 * others to wait.  Local work may fail on one rank: then snow_comm_agree. */
#ifndef SNOW_COMM_H
#define SNOW_COMM_H

#include "base/base.h"

#include <snowglass/comm.h>

#define SNOW_COMM_SCRATCH 2048

struct snow_comm {
    snow_context *context;
    snow_comm_ops ops;
    void *self;
    int rank, ranks;
    /* What this rank has sent, for the figures of a benchmark. */
    uint64_t messages_sent, bytes_sent;
    snow_status broken; /* how the transport failed: the answer of all calls
                           from then on */
    bool agreed;        /* the context's message is one of all ranks */
    uint64_t scratch[SNOW_COMM_SCRATCH]; /* another rank's numbers: a
                           collective call takes no memory, which could fail
                           on one rank alone */
};

/* Tags of the library's own messages; others may use tags below. */
enum {
    SNOW_TAG_COLLECTIVE = 32000,
    SNOW_TAG_COMBINE,
    SNOW_TAG_GATHER,
    SNOW_TAG_VOXELS,
    SNOW_TAG_LINES,
    SNOW_TAG_LAYERS
};

/* The transport's functions, with counting.  A message to oneself is allowed.
 * A send may be done only when its receiver has asked for it, as with MPI, and
 * always is so between threads, where it is tested: start a send and what the
 * other side waits for, then wait for both.  Errors: those of the transport;
 * SNOW_BAD_USAGE (a rank or tag that there is not).  Any of them breaks the
 * communicator. */
snow_status snow_comm_send(snow_comm *comm, const void *bytes, size_t count,
                           int to, int tag, snow_message *message);
snow_status snow_comm_receive(snow_comm *comm, void *bytes, size_t room,
                              int from, int tag, snow_message *message);
snow_status snow_comm_wait_any(snow_comm *comm, snow_message *messages,
                               int count, int *which);
snow_status snow_comm_wait_all(snow_comm *comm, snow_message *messages,
                               int count);
void snow_comm_work(snow_comm *comm, double seconds);

/* What this rank does, piece by piece, wherever it would wait for messages;
 * NULL: nothing, as in the beginning. */
void snow_comm_occupy(snow_comm *comm, snow_meanwhile_fn *work, void *user);

/* Between pieces of work while messages are under way: lets them move on. */
void snow_comm_progress(snow_comm *comm);

/* Collective, as are broadcast and share (snowglass/comm.h): element by element
 * over all ranks; the result replaces `values` on every rank, and has the same
 * bits there. */
typedef enum snow_reduction { SNOW_SUM, SNOW_MIN, SNOW_MAX } snow_reduction;
snow_status snow_comm_reduce_ints(snow_comm *comm, int64_t *values,
                                  size_t count, snow_reduction by);

/* The same of some by SNOW_MAX and of those behind them by SNOW_SUM, at the
 * price of one; together at most SNOW_COMM_SCRATCH. */
snow_status snow_comm_reduce_both(snow_comm *comm, int64_t *values,
                                  size_t maxima, size_t sums);
snow_status snow_comm_reduce_doubles(snow_comm *comm, double *values,
                                     size_t count, snow_reduction by);

#endif
