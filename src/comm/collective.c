/* comm/collective.c - collective operations, built from messages alone.
 *
 * The patterns are the usual ones (Thakur, Rabenseifner, Gropp, Optimization of
 * Collective Communication Operations in MPICH, 2005): recursive doubling for a
 * reduction, a binomial tree for a broadcast, doubling windows around the ring
 * for an all-gather (share). Nothing is allocated, see comm.h. */
#include "comm/comm.h"

#include <stdio.h>
#include <string.h>

static snow_status send_one(snow_comm *comm, const void *bytes, size_t count,
                            int to) {
    snow_message message = {0};
    SNOW_TRY(
        snow_comm_send(comm, bytes, count, to, SNOW_TAG_COLLECTIVE, &message));
    return snow_comm_wait_all(comm, &message, 1);
}

static snow_status receive_one(snow_comm *comm, void *bytes, size_t count,
                               int from) {
    snow_message message = {0};
    SNOW_TRY(snow_comm_receive(comm, bytes, count, from, SNOW_TAG_COLLECTIVE,
                               &message));
    return snow_comm_wait_all(comm, &message, 1);
}

/* --- reduction ------------------------------------------------------------ */

/* values[i] = reduction of values[i] and others[i]. */
typedef void reduce_fn(void *values, const void *others, size_t count,
                       const void *how);

/* Sums of integers wrap around, so that overflow is defined. */
static void reduce_ints(void *values, const void *others, size_t count,
                        const void *how) {
    int64_t *a = values;
    const int64_t *b = others;
    const snow_reduce by = *(const snow_reduce *)how;
    for (size_t i = 0; i < count; i++) {
        if (by == SNOW_REDUCE_SUM)
            a[i] = (int64_t)((uint64_t)a[i] + (uint64_t)b[i]);
        else if (by == SNOW_REDUCE_MIN ? b[i] < a[i] : b[i] > a[i])
            a[i] = b[i];
    }
}

/* The number of maxima, which come before the sums. */
static void reduce_both(void *values, const void *others, size_t count,
                        const void *how) {
    const size_t maxima = *(const size_t *)how;
    reduce_ints(values, others, maxima, &(snow_reduce){SNOW_REDUCE_MAX});
    reduce_ints((int64_t *)values + maxima, (const int64_t *)others + maxima,
                count - maxima, &(snow_reduce){SNOW_REDUCE_SUM});
}

static void reduce_doubles(void *values, const void *others, size_t count,
                           const void *how) {
    double *a = values;
    const double *b = others;
    const snow_reduce by = *(const snow_reduce *)how;
    for (size_t i = 0; i < count; i++) {
        if (by == SNOW_REDUCE_SUM)
            a[i] += b[i];
        else if (by == SNOW_REDUCE_MIN ? b[i] < a[i] : b[i] > a[i])
            a[i] = b[i];
    }
}

/* Ranks of a power of two exchange with those whose number differs in one bit,
 * bit after bit. Both of a pair compute a + b, which is b + a to the bit, so
 * that in the end all have the same bits. The ranks beyond the power send their
 * numbers before, and receive the result after:
 *
 *   rank   0   1   2   3   4      0 <- 4
 *          0 - 1   2 - 3          bit 0
 *          0 ----- 2, 1 ----- 3   bit 1
 *          0 ------------> 4 */
static snow_status reduce_some(snow_comm *comm, void *values, size_t count,
                               reduce_fn *reduce, const void *how) {
    const size_t bytes = count * sizeof comm->scratch[0];
    int power = 1;
    while (power <= comm->ranks / 2)
        power *= 2;
    if (comm->rank >= power) {
        SNOW_TRY(send_one(comm, values, bytes, comm->rank - power));
        return receive_one(comm, values, bytes, comm->rank - power);
    }
    const bool helps = comm->rank + power < comm->ranks;
    if (helps) {
        SNOW_TRY(receive_one(comm, comm->scratch, bytes, comm->rank + power));
        reduce(values, comm->scratch, count, how);
    }
    for (int bit = 1; bit < power; bit *= 2) {
        int other = comm->rank ^ bit;
        /* Sends to one rank while receiving from the same or another. */
        snow_message messages[2] = {{0}};
        SNOW_TRY(snow_comm_receive(comm, comm->scratch, bytes, other,
                                   SNOW_TAG_COLLECTIVE, &messages[0]));
        SNOW_TRY(snow_comm_send(comm, values, bytes, other, SNOW_TAG_COLLECTIVE,
                                &messages[1]));
        SNOW_TRY(snow_comm_wait_all(comm, messages, 2));
        reduce(values, comm->scratch, count, how);
    }
    return helps ? send_one(comm, values, bytes, comm->rank + power)
                 : SNOW_STATUS_OK;
}

/* In chunks of the scratch memory's size. */
static snow_status reduce_all(snow_comm *comm, void *values, size_t count,
                              snow_reduce by, reduce_fn *reduce) {
    unsigned char *bytes = values;
    while (count && comm->ranks > 1) {
        size_t some = count < SNOW_COMM_SCRATCH ? count : SNOW_COMM_SCRATCH;
        SNOW_TRY(reduce_some(comm, bytes, some, reduce, &by));
        bytes += some * sizeof comm->scratch[0];
        count -= some;
    }
    return comm->broken;
}

snow_status snow_comm_reduce_ints(snow_comm *comm, int64_t *values,
                                  size_t count, snow_reduce by) {
    return reduce_all(comm, values, count, by, reduce_ints);
}

snow_status snow_comm_reduce_both(snow_comm *comm, int64_t *values,
                                  size_t maxima, size_t sums) {
    if (comm->ranks > 1)
        SNOW_TRY(
            reduce_some(comm, values, maxima + sums, reduce_both, &maxima));
    return comm->broken;
}

snow_status snow_comm_reduce_doubles(snow_comm *comm, double *values,
                                     size_t count, snow_reduce by) {
    return reduce_all(comm, values, count, by, reduce_doubles);
}

/* --- broadcast and share -------------------------------------------------- */

/* Numbered from the root, rank r receives the bytes from r without its highest
 * bit, and passes them on to r + 2^k for the higher bits in turn. */
snow_status snow_comm_broadcast(snow_comm *comm, void *bytes, size_t count,
                                int root) {
    const int ranks = comm->ranks;
    const int mine = (comm->rank - root + ranks) % ranks;
    int bit = 1; /* lowest above all bits of this rank's number */
    while (bit <= mine)
        bit *= 2;
    SNOW_TRY(comm->broken);
    if (mine)
        SNOW_TRY(
            receive_one(comm, bytes, count, (mine - bit / 2 + root) % ranks));
    for (; mine + bit < ranks; bit *= 2)
        SNOW_TRY(send_one(comm, bytes, count, (mine + bit + root) % ranks));
    return SNOW_STATUS_OK;
}

/* Ranks from .. from + count - 1 around the ring, as one or two runs of `all`:
 * the second begins at rank 0 and may be empty. */
static void cut_ring(const snow_comm *comm, int from, int count, int first[2],
                     int length[2]) {
    first[0] = from % comm->ranks;
    first[1] = 0;
    length[0] =
        first[0] + count <= comm->ranks ? count : comm->ranks - first[0];
    length[1] = count - length[0];
}

/* After a round rank r has ranks r .. r + known - 1; the next round doubles
 * that by what the rank after these has. */
static snow_status share_round(snow_comm *comm, size_t bytes,
                               unsigned char *all, int known) {
    const int ranks = comm->ranks;
    const int count = known <= ranks - known ? known : ranks - known;
    const int from = (comm->rank + known) % ranks;
    const int to = (comm->rank + ranks - known) % ranks;
    int in[2], in_length[2], out[2], out_length[2], in_flight = 0;
    cut_ring(comm, from, count, in, in_length);
    cut_ring(comm, comm->rank, count, out, out_length);
    snow_message messages[4] = {{0}};
    for (int run = 0; run < 2; run++) {
        if (in_length[run])
            SNOW_TRY(snow_comm_receive(comm, all + (size_t)in[run] * bytes,
                                       (size_t)in_length[run] * bytes, from,
                                       SNOW_TAG_COLLECTIVE,
                                       &messages[in_flight++]));
        if (out_length[run])
            SNOW_TRY(snow_comm_send(comm, all + (size_t)out[run] * bytes,
                                    (size_t)out_length[run] * bytes, to,
                                    SNOW_TAG_COLLECTIVE,
                                    &messages[in_flight++]));
    }
    return snow_comm_wait_all(comm, messages, in_flight);
}

snow_status snow_comm_allgather(snow_comm *comm, const void *mine, size_t count,
                                void *all) {
    unsigned char *bytes = all;
    SNOW_TRY(comm->broken);
    if (!count)
        return SNOW_STATUS_OK;
    memmove(bytes + (size_t)comm->rank * count, mine, count);
    for (int known = 1; known < comm->ranks; known *= 2)
        SNOW_TRY(share_round(comm, count, bytes, known));
    return SNOW_STATUS_OK;
}

/* --- agreement ------------------------------------------------------------ */

/* Sends the first failure and its message to all ranks. */
static snow_status spread_failure(snow_comm *comm, snow_status status,
                                  int first) {
    struct {
        int32_t status;
        char message[SNOW_MESSAGE_BYTES];
    } failure = {.status = (int32_t)status};
    if (comm->rank == first)
        memcpy(failure.message, comm->context->message, sizeof failure.message);
    SNOW_TRY(snow_comm_broadcast(comm, &failure, sizeof failure, first));
    failure.message[sizeof failure.message - 1] = 0;
    comm->agreed = true;
    int rank, length = 0;
    if (sscanf(failure.message, "rank %d: %n", &rank, &length) == 1 &&
        length > 0)
        return snow_fail(comm->context, (snow_status)failure.status, "%s",
                         failure.message);
    return snow_fail(comm->context, (snow_status)failure.status, "rank %d: %s",
                     first, failure.message);
}

snow_status snow_comm_agree_status(snow_comm *comm, snow_status status) {
    SNOW_TRY(comm->broken);
    if (comm->ranks == 1)
        return status;
    int64_t first = status == SNOW_STATUS_OK ? comm->ranks : comm->rank;
    SNOW_TRY(snow_comm_reduce_ints(comm, &first, 1, SNOW_REDUCE_MIN));
    comm->agreed = false;
    if (first == comm->ranks)
        return SNOW_STATUS_OK;
    return spread_failure(comm, status, (int)first);
}
