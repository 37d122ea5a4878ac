/* comm/comm.c - a communicator: a transport's functions, with a count of what
 * is sent and the status of a failure.
 *
 * A transport that has failed is not used again. Its state is unknown, and the
 * ranks that still work would wait for messages of a round that this rank has
 * left. */
#include "comm/comm.h"

SNOW_RECORD_OF_ZEROS(snow_comm_ops);

snow_status snow_comm_new(snow_context *context, const snow_comm_ops *given,
                          void *self, int rank, int ranks, snow_comm **out) {
    snow_comm_ops ops;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_comm_ops, given, &ops));
    if (ranks < 1 || rank < 0 || rank >= ranks)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "invalid rank %d of %d: ranks count from 0", rank,
                         ranks);
    if (!ops.send || !ops.receive || !ops.wait_any || !ops.wait_all ||
        !ops.seconds || !ops.end)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "the transport lacks a function: send, receive, "
                         "wait_any, wait_all, seconds and end are needed");
    if (!ops.node_of != !ops.share || !ops.node_of != !ops.shared ||
        !ops.node_of != !ops.unshare)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "the transport lacks a function: node_of, share, "
                         "shared and unshare come together");
    snow_comm *comm = snow_allocate(context, sizeof *comm);
    if (!comm)
        return SNOW_STATUS_NO_MEMORY;
    *comm = (snow_comm){.context = context,
                        .ops = ops,
                        .self = self,
                        .rank = rank,
                        .ranks = ranks};
    *out = comm;
    return SNOW_STATUS_OK;
}

void snow_comm_free(snow_comm *comm) {
    if (comm) {
        snow_comm_forget_shared(comm);
        comm->ops.end(comm->self);
        snow_release(comm->context, comm);
    }
}

int snow_comm_rank(const snow_comm *comm) {
    return comm->rank;
}

int snow_comm_size(const snow_comm *comm) {
    return comm->ranks;
}

snow_context *snow_comm_context(const snow_comm *comm) {
    return comm->context;
}

bool snow_comm_broken(const snow_comm *comm) {
    return comm->broken != SNOW_STATUS_OK;
}

void snow_comm_sent(const snow_comm *comm, uint64_t *messages,
                    uint64_t *bytes) {
    *messages = comm->messages_sent;
    *bytes = comm->bytes_sent;
}

/* Returns a transport's status, and stores it if it is a failure. */
static snow_status heed(snow_comm *comm, snow_status status) {
    if (status != SNOW_STATUS_OK)
        comm->broken = status;
    return status;
}

/* Checks that the communicator is not broken, and rank and tag are valid. */
static snow_status check_peer(snow_comm *comm, int rank, int tag) {
    SNOW_TRY(comm->broken);
    if (rank < 0 || rank >= comm->ranks || tag < 0 || tag > 32767)
        return heed(
            comm, snow_fail(comm->context, SNOW_STATUS_BAD_USAGE,
                            "invalid message with tag %d to or from rank %d of "
                            "%d: ranks count from 0, tags must not be negative",
                            tag, rank, comm->ranks));
    return SNOW_STATUS_OK;
}

snow_status snow_comm_send(snow_comm *comm, const void *bytes, size_t count,
                           int to, int tag, snow_message *message) {
    SNOW_TRY(check_peer(comm, to, tag));
    SNOW_TRY(
        heed(comm, comm->ops.send(comm->self, bytes, count, to, tag, message)));
    comm->messages_sent++;
    comm->bytes_sent += count;
    return SNOW_STATUS_OK;
}

snow_status snow_comm_receive(snow_comm *comm, void *bytes, size_t capacity,
                              int from, int tag, snow_message *message) {
    SNOW_TRY(check_peer(comm, from, tag));
    return heed(comm, comm->ops.receive(comm->self, bytes, capacity, from, tag,
                                        message));
}

snow_status snow_comm_wait_any(snow_comm *comm, snow_message *messages,
                               int count, int *which) {
    SNOW_TRY(comm->broken);
    return heed(comm, comm->ops.wait_any(comm->self, messages, count, which));
}

snow_status snow_comm_wait_all(snow_comm *comm, snow_message *messages,
                               int count) {
    SNOW_TRY(comm->broken);
    return heed(comm, comm->ops.wait_all(comm->self, messages, count));
}

double snow_comm_seconds(snow_comm *comm) {
    return comm->ops.seconds(comm->self);
}

void snow_comm_set_timeout(snow_comm *comm, double seconds) {
    if (comm->ops.timeout)
        comm->ops.timeout(comm->self, seconds);
}

void snow_comm_work(snow_comm *comm, double seconds) {
    if (comm->ops.work)
        comm->ops.work(comm->self, seconds);
}

void snow_comm_occupy(snow_comm *comm, snow_idle_fn *work, void *user) {
    if (comm->ops.occupy)
        comm->ops.occupy(comm->self, work, user);
}

void snow_comm_progress(snow_comm *comm) {
    if (comm->ops.progress && !comm->broken)
        comm->ops.progress(comm->self);
}
