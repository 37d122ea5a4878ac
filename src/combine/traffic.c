/* combine/traffic.c - the messages of a round. To a rank of the same node only
 * a loan is sent: it reads the pixels in the sender's memory (comm/shared.c),
 * and returns them when it has composited them. */
#include "combine/combiner.h"

snow_status snow_traffic_receive(snow_combiner *combiner, snow_traffic *in,
                                 int i, int from, unsigned char *bytes,
                                 size_t capacity) {
    snow_comm *comm = combiner->comm;
    const bool shared = combiner->lends && snow_comm_lends(comm, from);
    void *place = shared ? (void *)&in->loans[i] : bytes;
    return snow_comm_receive(comm, place, shared ? sizeof *in->loans : capacity,
                             from, SNOW_TAG_COMBINE, &in->messages[i]);
}

const unsigned char *snow_traffic_message(const snow_combiner *combiner,
                                          const snow_traffic *in, int i,
                                          int from, const unsigned char *bytes,
                                          size_t *count) {
    if (!combiner->lends || !snow_comm_lends(combiner->comm, from)) {
        *count = in->messages[i].bytes;
        return bytes;
    }
    *count = 0;
    if (in->messages[i].bytes != sizeof *in->loans)
        return NULL;
    *count = (size_t)in->loans[i].bytes;
    return snow_comm_borrowed(combiner->comm, from, &in->loans[i]);
}

snow_status snow_traffic_send(snow_combiner *combiner, snow_traffic *out,
                              const unsigned char *bytes, size_t count,
                              int to) {
    snow_comm *comm = combiner->comm;
    const int i = out->count++;
    if (!combiner->lends || !snow_comm_lends(comm, to))
        return snow_comm_send(comm, bytes, count, to, SNOW_TAG_COMBINE,
                              &out->messages[i]);
    return snow_comm_lend(comm, bytes, count, to, SNOW_TAG_COMBINE,
                          &out->loans[i], &out->messages[i],
                          &out->returns[out->shared++]);
}

snow_status snow_traffic_return(snow_combiner *combiner, int level) {
    snow_comm *comm = combiner->comm;
    const snow_round *round = &combiner->rounds.rounds[level];
    const snow_traffic *in = &combiner->in[level & 1];
    if (!combiner->lends)
        return SNOW_STATUS_OK;
    for (int i = 0; i < round->receives; i++) {
        const snow_share *share =
            &combiner->rounds.shares[round->first_receive + i];
        const int from = combiner->exchange.order.ranks[share->rank_position];
        /* A loan has bytes; a message of no pixels was not received. */
        if (in->messages[i].bytes && snow_comm_lends(comm, from))
            SNOW_TRY(snow_comm_return(comm, from));
    }
    return SNOW_STATUS_OK;
}

snow_status snow_traffic_await_sent(snow_combiner *combiner,
                                    snow_traffic *out) {
    SNOW_TRY(snow_comm_wait_all(combiner->comm, out->messages, out->count));
    out->count = 0;
    return SNOW_STATUS_OK;
}

snow_status snow_traffic_await_return(snow_combiner *combiner,
                                      snow_traffic *out) {
    SNOW_TRY(snow_comm_wait_all(combiner->comm, out->returns, out->shared));
    out->shared = 0;
    return SNOW_STATUS_OK;
}

snow_status snow_traffic_await_returns(snow_combiner *combiner) {
    SNOW_TRY(snow_traffic_await_return(combiner, &combiner->out[0]));
    return snow_traffic_await_return(combiner, &combiner->out[1]);
}
