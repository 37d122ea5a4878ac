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
    /* Sent by this rank, for the figures of a benchmark; lent: of the bytes,
     * those that a rank of the same node read in place. */
    uint64_t messages_sent, bytes_sent, bytes_shared;
    void *shared;        /* memory that ranks of the node read, or NULL */
    size_t shared_bytes; /* its size, alike on all ranks; 0: never made */
    size_t shared_taken; /* of the bytes, by the combiner that uses it */
    snow_status broken;  /* the transport's failure, which later calls return */
    bool agreed;         /* the context's message is the same on all ranks */
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
    SNOW_TAG_LAYERS,
    SNOW_TAG_RETURN
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

/* --- shared.c: memory that the ranks of a node read in place ---------------

 * The number of ranks of every node, if all have as many and their numbers
 * follow one another; otherwise 1. */
int snow_comm_ranks_per_node(const snow_comm *comm);

/* Collective. Takes `bytes` of this rank's shared memory, alike on all ranks,
 * until snow_comm_drop_shared; the context counts them. *out is NULL if the
 * ranks of this node share none, or while a combiner of any rank has it.
 * Errors, alike on all ranks: SNOW_STATUS_NO_MEMORY, those of the transport. */
snow_status snow_comm_take_shared(snow_comm *comm, size_t bytes, void **out);
void snow_comm_drop_shared(snow_comm *comm); /* what was shared has come back */

/* For snow_comm_free: it is not counted any more. */
void snow_comm_forget_shared(snow_comm *comm);

/* Returns whether messages between this rank and another may be loans: the
 * same on both. */
bool snow_comm_lends(const snow_comm *comm, int rank);

/* A loan: the place of bytes in the shared memory of the rank that sends it. */
typedef struct snow_loan {
    uint64_t offset, bytes;
} snow_loan;

/* Does what snow_comm_send does, for bytes in the memory of
 * snow_comm_take_shared. They stay as they are until `returned` is done; *loan
 * stays until `sent` is. */
snow_status snow_comm_lend(snow_comm *comm, const void *bytes, size_t count,
                           int to, int tag, snow_loan *loan, snow_message *sent,
                           snow_message *returned);

/* The receiver calls snow_comm_receive for *loan, reads the bytes here, and
 * returns them. NULL: the loan lies outside of the lender's memory. */
const void *snow_comm_borrowed(const snow_comm *comm, int from,
                               const snow_loan *loan);
snow_status snow_comm_return(snow_comm *comm, int to);

#endif
