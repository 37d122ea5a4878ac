/* support_comm.c - see there. */
#include "support/comm.h"

#include <time.h>

void rest(long microseconds) {
    nanosleep(&(struct timespec){.tv_nsec = microseconds * 1000}, NULL);
}

snow_status send_number(snow_comm *comm, int64_t number, int to, int tag) {
    snow_message message = {0};
    SNOW_TRY(snow_comm_send(comm, &number, sizeof number, to, tag, &message));
    return snow_comm_wait_all(comm, &message, 1);
}

snow_status receive_number(snow_comm *comm, int64_t *number, int from,
                           int tag) {
    snow_message message = {0};
    SNOW_TRY(
        snow_comm_receive(comm, number, sizeof *number, from, tag, &message));
    return snow_comm_wait_all(comm, &message, 1);
}

snow_status send_all_to_all(snow_comm *comm, void *user) {
    (void)user;
    const int ranks = snow_comm_size(comm), rank = snow_comm_rank(comm);
    snow_message messages[66] = {{0}};
    int64_t in[33], out[33];
    for (int other = 0; other < ranks; other++) {
        out[other] = rank * 1000 + other;
        SNOW_TRY(snow_comm_send(comm, &out[other], sizeof out[0], other, 7,
                                &messages[other]));
    }
    for (int other = 0; other < ranks; other++)
        SNOW_TRY(snow_comm_receive(comm, &in[other], sizeof in[0], other, 7,
                                   &messages[ranks + other]));
    SNOW_TRY(snow_comm_wait_all(comm, messages, 2 * ranks));
    for (int other = 0; other < ranks; other++) {
        CHECK(in[other] == other * 1000 + rank);
        CHECK(messages[ranks + other].handle == NULL);
        CHECK(messages[ranks + other].bytes == sizeof in[0]);
    }
    uint64_t count, bytes;
    snow_comm_sent(comm, &count, &bytes);
    CHECK(count == (uint64_t)ranks && bytes == count * 8);
    return SNOW_STATUS_OK;
}

snow_status mix_tags(snow_comm *comm, void *user) {
    (void)user;
    enum { TAGS = 200 };
    const int ranks = snow_comm_size(comm), rank = snow_comm_rank(comm);
    const int to = (rank + 1) % ranks, from = (rank + ranks - 1) % ranks;
    snow_message sent[2 * TAGS] = {{0}};
    int64_t out[2 * TAGS];
    for (int i = 0; i < 2 * TAGS; i++) {
        out[i] = i % 2 ? -i / 2 : i / 2;
        SNOW_TRY(
            snow_comm_send(comm, &out[i], sizeof out[0], to, i / 2, &sent[i]));
    }
    for (int tag = TAGS - 1; tag >= 0; tag--) {
        int64_t first = -1, second = 1;
        snow_message messages[2] = {{0}};
        SNOW_TRY(snow_comm_receive(comm, &first, sizeof first, from, tag,
                                   &messages[0]));
        SNOW_TRY(snow_comm_receive(comm, &second, sizeof second, from, tag,
                                   &messages[1]));
        SNOW_TRY(snow_comm_wait_all(comm, &messages[1], 1));
        SNOW_TRY(snow_comm_wait_all(comm, &messages[0], 1));
        CHECK(first == tag && second == -tag);
    }
    return snow_comm_wait_all(comm, sent, 2 * TAGS);
}

/* Receives are posted before their messages are sent. */
static snow_status receive_first(snow_comm *comm, void *user) {
    (void)user;
    const int ranks = snow_comm_size(comm), rank = snow_comm_rank(comm);
    snow_message messages[99] = {{0}};
    int64_t in[99];
    int got[33] = {0};
    for (int i = 0; i < 3 * ranks; i++)
        SNOW_TRY(snow_comm_receive(comm, &in[i], sizeof in[i], i % ranks, 1,
                                   &messages[i]));
    for (int i = 0; i < 3 * ranks; i++)
        SNOW_TRY(
            send_number(comm, rank * 3 + i / ranks, (rank + i) % ranks, 1));
    for (int which;;) {
        SNOW_TRY(snow_comm_wait_any(comm, messages, 3 * ranks, &which));
        if (which < 0)
            break;
        CHECK(in[which] == which % ranks * 3 + which / ranks);
        got[which % ranks]++;
    }
    for (int other = 0; other < ranks; other++)
        CHECK(got[other] == 3);
    return SNOW_STATUS_OK;
}

/* Nothing, one byte, and 3 MB, where there is room for more. */
static snow_status send_sizes(snow_comm *comm, void *user) {
    (void)user;
    enum { LARGE = 3000000 };
    const size_t counts[] = {0, 1, LARGE};
    const int ranks = snow_comm_size(comm), rank = snow_comm_rank(comm);
    snow_context *context = snow_comm_context(comm);
    unsigned char *out = snow_allocate(context, LARGE);
    unsigned char *in = snow_allocate_clear(context, LARGE + 1);
    memset(out, rank + 1, LARGE);
    snow_message messages[6] = {{0}};
    for (int i = 0; i < 3; i++) {
        SNOW_TRY(snow_comm_send(comm, counts[i] ? out : NULL, counts[i],
                                (rank + 1) % ranks, 3, &messages[i]));
        SNOW_TRY(snow_comm_receive(comm, in, LARGE + 1,
                                   (rank + ranks - 1) % ranks, 3,
                                   &messages[3 + i]));
    }
    SNOW_TRY(snow_comm_wait_all(comm, messages, 6));
    int wrong = 0;
    for (int i = 0; i < 3; i++)
        wrong += messages[3 + i].bytes != counts[i];
    for (size_t i = 0; i < LARGE; i++)
        wrong += in[i] != (rank + ranks - 1) % ranks + 1;
    wrong += in[LARGE] != 0;
    snow_release(context, in);
    snow_release(context, out);
    CHECK(wrong == 0);
    return SNOW_STATUS_OK;
}

/* Pieces of work: so many, or for ever. */
typedef struct pieces {
    int left, done;
} pieces;

static bool do_piece(void *user) {
    pieces *p = user;
    if (!p->left)
        return false;
    p->left--;
    p->done++;
    rest(100);
    return true;
}

/* Rank 1 works while it waits for rank 0; on whether it got to work at all, and
 * to the end of what there is, all agree. */
static snow_status work_once(snow_comm *comm, int left, int64_t *worked) {
    const int rank = snow_comm_rank(comm);
    pieces some = {left, 0};
    int64_t number = -1;
    if (rank == 1) {
        SNOW_TRY(send_number(comm, 1, 0, 5)); /* it is about to wait */
        snow_comm_occupy(comm, do_piece, &some);
        SNOW_TRY(receive_number(comm, &number, 0, 6));
        CHECK(number == 42);
        *worked =
            left < 0 ? some.done > 0 && some.done < 1000 : some.done == left;
        snow_comm_occupy(comm, NULL, NULL);
    } else if (rank == 0) {
        SNOW_TRY(receive_number(comm, &number, 1, 5));
        rest(50000);
        SNOW_TRY(send_number(comm, 42, 1, 6));
    }
    SNOW_TRY(snow_comm_broadcast(comm, worked, sizeof *worked, 1));
    return SNOW_STATUS_OK;
}

/* On a busy machine the message comes before rank 1 waits: then once more. */
static snow_status work_while_waiting(snow_comm *comm, void *user) {
    (void)user;
    if (snow_comm_size(comm) == 1)
        return SNOW_STATUS_OK;
    for (int left = -1; left < 8; left += 3) {
        int64_t worked = 0;
        for (int tries = 0; !worked && tries < 20; tries++)
            SNOW_TRY(work_once(comm, left, &worked));
        CHECK(worked);
    }
    return SNOW_STATUS_OK;
}

snow_status wait_for_none(snow_comm *comm, void *user) {
    (void)user;
    int which = 5;
    SNOW_TRY(snow_comm_wait_any(comm, NULL, 0, &which));
    CHECK(which == -1);
    return snow_comm_wait_all(comm, NULL, 0);
}

snow_status leave_much_undone(snow_comm *comm, void *user) {
    (void)user;
    static int64_t nowhere[33];
    const int rank = snow_comm_rank(comm);
    snow_message messages[4] = {{0}};
    for (int i = 0; i < 2; i++) {
        SNOW_TRY(snow_comm_send(comm, &nowhere[rank], 8, i ? rank : 0, i,
                                &messages[2 * i]));
        SNOW_TRY(snow_comm_receive(comm, &nowhere[rank], 8, rank, 1 + i,
                                   &messages[2 * i + 1]));
    }
    return SNOW_STATUS_OK;
}

/* More numbers than go in one piece. */
enum { MANY = SNOW_COMM_SCRATCH * 2 + 3 };

static snow_status reduce_ints(snow_comm *comm, void *user) {
    (void)user;
    static const snow_reduce kinds[] = {SNOW_REDUCE_SUM, SNOW_REDUCE_MIN,
                                        SNOW_REDUCE_MAX};
    const int64_t ranks = snow_comm_size(comm), rank = snow_comm_rank(comm);
    int64_t values[MANY];
    for (int kind = 0; kind < 3; kind++) {
        for (int64_t i = 0; i < MANY; i++)
            values[i] = (rank - i % ranks) * (rank - i % ranks) - i;
        SNOW_TRY(snow_comm_reduce_ints(comm, values, MANY, kinds[kind]));
        for (int64_t i = 0; i < MANY; i++) {
            int64_t sum = 0, most = 0;
            for (int64_t r = 0; r < ranks; r++) {
                int64_t square = (r - i % ranks) * (r - i % ranks);
                sum += square;
                most = square > most ? square : most;
            }
            const int64_t right[] = {sum - ranks * i, -i, most - i};
            CHECK(values[i] == right[kind]);
        }
    }
    int64_t both[5] = {rank, -rank, rank, rank, 1}; /* two maxima, three sums */
    SNOW_TRY(snow_comm_reduce_both(comm, both, 2, 3));
    CHECK(both[0] == ranks - 1 && both[1] == 0 && both[4] == ranks);
    CHECK(both[2] == ranks * (ranks - 1) / 2 && both[3] == both[2]);
    snow_comm_progress(comm);
    return SNOW_STATUS_OK;
}

snow_status reduce_doubles(snow_comm *comm, void *user) {
    rank_sums *rounding = user;
    const int rank = snow_comm_rank(comm);
    double values[3] = {1.0 / (rank + 1), 1.0 / (rank + 1), 1.0 / (rank + 1)};
    SNOW_TRY(snow_comm_reduce_doubles(comm, values, 1, SNOW_REDUCE_SUM));
    SNOW_TRY(snow_comm_reduce_doubles(comm, values + 1, 1, SNOW_REDUCE_MIN));
    SNOW_TRY(snow_comm_reduce_doubles(comm, values + 2, 1, SNOW_REDUCE_MAX));
    CHECK(values[1] == 1.0 / snow_comm_size(comm) && values[2] == 1);
    rounding->sums[rank] = values[0];
    return SNOW_STATUS_OK;
}

static snow_status broadcast(snow_comm *comm, void *user) {
    (void)user;
    for (int root = 0; root < snow_comm_size(comm); root++) {
        int64_t value = snow_comm_rank(comm) == root ? root + 5 : -1;
        SNOW_TRY(snow_comm_broadcast(comm, &value, sizeof value, root));
        CHECK(value == root + 5);
        SNOW_TRY(snow_comm_broadcast(comm, NULL, 0, root));
    }
    return SNOW_STATUS_OK;
}

static snow_status share(snow_comm *comm, void *user) {
    (void)user;
    struct {
        char bytes[3];
    } mine, all[34];
    memset(all, 99, sizeof all);
    memset(&mine, snow_comm_rank(comm), sizeof mine);
    SNOW_TRY(snow_comm_allgather(comm, &mine, sizeof mine, all));
    for (int rank = 0; rank < snow_comm_size(comm); rank++)
        for (int i = 0; i < 3; i++)
            CHECK(all[rank].bytes[i] == rank);
    CHECK(all[snow_comm_size(comm)].bytes[0] == 99);
    /* One's own may stand in its place already. */
    SNOW_TRY(snow_comm_allgather(comm, &all[snow_comm_rank(comm)], 3, all));
    SNOW_TRY(snow_comm_allgather(comm, NULL, 0, NULL));
    CHECK(all[0].bytes[0] == 0);
    return SNOW_STATUS_OK;
}

/* Calls of several kinds after one another do not take each other's messages,
 * though some ranks are late. */
static snow_status one_after_another(snow_comm *comm, void *user) {
    (void)user;
    const int ranks = snow_comm_size(comm), rank = snow_comm_rank(comm);
    uint64_t seed = (uint64_t)rank + 1;
    for (int round = 0; round < 30; round++) {
        if (support_uniform(&seed) < 0.1)
            rest(200);
        int64_t value = rank + round, all[33];
        SNOW_TRY(snow_comm_allgather(comm, &value, sizeof value, all));
        CHECK(all[ranks - 1] == ranks - 1 + round);
        SNOW_TRY(
            snow_comm_broadcast(comm, &value, sizeof value, round % ranks));
        CHECK(value == round % ranks + round);
        SNOW_TRY(snow_comm_reduce_ints(comm, &value, 1, SNOW_REDUCE_SUM));
        CHECK(value == (round % ranks + round) * ranks);
        SNOW_TRY(snow_comm_agree_status(comm, SNOW_STATUS_OK));
    }
    return SNOW_STATUS_OK;
}

snow_status agree_on_failure(snow_comm *comm, void *user) {
    (void)user;
    const int rank = snow_comm_rank(comm);
    snow_context *context = snow_comm_context(comm);
    snow_status status = SNOW_STATUS_OK;
    if (rank == 2 || rank == 3)
        status = snow_fail(
            context, rank == 2 ? SNOW_STATUS_BAD_INPUT : SNOW_STATUS_NO_MEMORY,
            "file %d is broken", rank);
    status = snow_comm_agree_status(comm, status);
    CHECK(status == SNOW_STATUS_BAD_INPUT);
    CHECK(!strcmp(snow_context_message(context), "rank 2: file 2 is broken"));
    CHECK(!snow_comm_broken(comm));
    SNOW_TRY(snow_comm_agree_status(comm, SNOW_STATUS_OK));
    return snow_comm_agree_status(comm, rank == 3 ? SNOW_STATUS_FAILED
                                                  : SNOW_STATUS_OK);
}

#define BODY(name) \
    { #name, name }

const comm_body comm_bodies[] = {
    BODY(send_all_to_all),   BODY(mix_tags),      BODY(receive_first),
    BODY(send_sizes),        BODY(wait_for_none), BODY(work_while_waiting),
    BODY(reduce_ints),       BODY(broadcast),     BODY(share),
    BODY(one_after_another), {NULL, NULL},
};
