/* comm/shared.c - memory that the ranks of a node read in place: a message
 * holds the place of its bytes, and an empty one returns them.
 *
 *   lender                        borrower
 *   lend    -- offset, bytes -->  receives the loan, reads the bytes in the
 *                                 lender's memory
 *   may write there again  <----  return
 *
 * The receive of the return is started before the loan is sent, so that a
 * borrower never waits. */
#include "comm/comm.h"

/* --- nodes ---------------------------------------------------------------- */

static int node_of(const snow_comm *comm, int rank) {
    return comm->ops.node_of(comm->self, rank);
}

int snow_comm_ranks_per_node(const snow_comm *comm) {
    int each = 1;
    if (!comm->ops.node_of)
        return 1;
    while (each < comm->ranks && node_of(comm, each) == node_of(comm, 0))
        each++;
    bool alike = comm->ranks % each == 0;
    for (int rank = each; rank < comm->ranks && alike; rank++) {
        const bool first = rank % each == 0;
        alike = (node_of(comm, rank) == node_of(comm, rank - 1)) != first;
    }
    return alike ? each : 1;
}

/* --- the memory ----------------------------------------------------------- */

/* Replaces this rank's memory by more. */
static snow_status renew(snow_comm *comm, size_t bytes) {
    comm->shared = NULL;
    comm->shared_bytes = 0;
    SNOW_TRY(snow_comm_agree_status(
        comm, comm->ops.share(comm->self, bytes, &comm->shared)));
    comm->shared_bytes = bytes;
    return SNOW_STATUS_OK;
}

/* A rank that has failed says so before the transport's call, in which nobody
 * watches. */
snow_status snow_comm_take_shared(snow_comm *comm, size_t bytes, void **out) {
    int64_t taken = comm->shared_taken != 0;
    *out = NULL;
    if (comm->ranks == 1 || !comm->ops.node_of)
        return SNOW_STATUS_OK;
    const snow_status counted = snow_memory_count(comm->context, bytes);
    snow_status status = snow_comm_agree_status(comm, counted);
    /* Does a combiner of any rank have the memory?  Ranks may free an old one
     * before or after they plan a new one. */
    if (status == SNOW_STATUS_OK)
        status = snow_comm_reduce_ints(comm, &taken, 1, SNOW_REDUCE_MAX);
    if (status == SNOW_STATUS_OK && !taken && bytes > comm->shared_bytes)
        status = renew(comm, bytes);
    if (status == SNOW_STATUS_OK && !taken && comm->shared) {
        *out = comm->shared;
        comm->shared_taken = bytes;
    } else if (counted == SNOW_STATUS_OK) {
        snow_memory_forget(comm->context, bytes);
    }
    return status;
}

void snow_comm_drop_shared(snow_comm *comm) {
    snow_comm_forget_shared(comm);
    if (comm->context->limit)
        comm->ops.unshare(comm->self);
}

void snow_comm_forget_shared(snow_comm *comm) {
    snow_memory_forget(comm->context, comm->shared_taken);
    comm->shared_taken = 0;
}

bool snow_comm_lends(const snow_comm *comm, int rank) {
    return comm->shared && rank != comm->rank &&
           node_of(comm, rank) == node_of(comm, comm->rank);
}

/* --- loans ---------------------------------------------------------------- */

snow_status snow_comm_lend(snow_comm *comm, const void *bytes, size_t count,
                           int to, int tag, snow_loan *loan, snow_message *sent,
                           snow_message *returned) {
    const ptrdiff_t offset =
        (const unsigned char *)bytes - (unsigned char *)comm->shared;
    *loan = (snow_loan){(uint64_t)offset, count};
    SNOW_TRY(snow_comm_receive(comm, NULL, 0, to, SNOW_TAG_RETURN, returned));
    SNOW_TRY(snow_comm_send(comm, loan, sizeof *loan, to, tag, sent));
    comm->bytes_sent += count - sizeof *loan; /* as by a message */
    comm->bytes_shared += count;
    return SNOW_STATUS_OK;
}

const void *snow_comm_borrowed(const snow_comm *comm, int from,
                               const snow_loan *loan) {
    const unsigned char *there = comm->ops.shared(comm->self, from);
    if (!there || loan->bytes > comm->shared_bytes ||
        loan->offset > comm->shared_bytes - loan->bytes)
        return NULL;
    return there + loan->offset;
}

snow_status snow_comm_return(snow_comm *comm, int to) {
    snow_message message = {0};
    SNOW_TRY(snow_comm_send(comm, NULL, 0, to, SNOW_TAG_RETURN, &message));
    comm->messages_sent--; /* it belongs to the loan */
    return snow_comm_wait_all(comm, &message, 1);
}
