/* decompose/redistribute.c - redistributes voxels between ranks.
 *
 * Every rank holds boxes of one grid, which do not overlap, and wants one box:
 * its own with ghost voxels around it, or another partition of the grid.
 *
 *   held                       wanted by rank 0
 *   +-------+-------+          +---------+
 *   |   0   |   1   |          |   0   |1|    its own voxels are copied, one
 *   +-------+---+---+          |-------+-|    message comes from each other
 *   |     2     | 1 |          |    2    |    rank that holds a part
 *   +-----------+---+          +---------+
 *
 * Boxes seldom change from picture to picture: they are planned once, and
 * voxels moved any number of times without allocating memory.
 *
 * All ranks know the boxes of all. Rank a compares its own boxes with every
 * wanted box to find what it sends; rank b compares all boxes with its wanted
 * one to find what it receives. Both list the parts of a message in the same
 * order, that of the sender's boxes, and pack them one after another, x
 * fastest. The work of a rank grows with its own boxes times ranks, plus the
 * boxes of all.
 *
 * Many voxels move in rounds, some slices of each box in each, so that buffers
 * are small. */
#include "decompose/redistribute.h"

#include <string.h>

/* A buffer has about so many bytes. */
#define ROUND_BYTES ((int64_t)4 << 20)

/* A part of a message, or of the copy within a rank: voxels of one box. */
typedef struct portion {
    int brick;        /* of the sender's boxes */
    snow_box box, of; /* the sender's box */
} portion;

/* Portions of one message.  Its offset in a round is in voxels of the buffer
 * that holds all messages of its direction. */
typedef struct block_message {
    int rank; /* of the other side */
    size_t first, portions;
    int64_t offset;
} block_message;

/* All that is sent, received, or kept. */
typedef struct traffic {
    portion *portions;
    size_t portion_count;
    block_message *block_messages;
    size_t block_message_count;
    int64_t voxels;
    char *buffer;
} traffic;

struct snow_voxels {
    snow_comm *comm;
    snow_context *context;
    snow_box wanted;
    traffic sent, received, kept;
    snow_message *messages; /* those received, then those sent */
    int rounds;             /* of a move, the same on all ranks */
    bool gives_up;          /* bricks that are moved */
    bool has_gaps;          /* not all that is wanted is there */
    size_t ready; /* bytes of a value that buffers and messages fit; the same on
                     all ranks */
};

/* Every rank's boxes, while planning. */
typedef struct box_table {
    int ranks, most;  /* boxes of a rank */
    snow_box *held;   /* [rank * most + n]; missing ones are empty */
    snow_box *wanted; /* [rank] */
} box_table;

/* --- planning ------------------------------------------------------------- */

snow_status snow_voxels_new(snow_comm *comm, snow_voxels **out) {
    snow_context *context = snow_comm_context(comm);
    snow_voxels *voxels = snow_allocate_clear(context, sizeof *voxels);
    if (!voxels)
        return SNOW_STATUS_NO_MEMORY;
    voxels->comm = comm;
    voxels->context = context;
    *out = voxels;
    return SNOW_STATUS_OK;
}

void snow_voxels_clear(snow_voxels *voxels) {
    const traffic *const all[] = {&voxels->sent, &voxels->received,
                                  &voxels->kept};
    for (int n = 0; n < 3; n++) {
        snow_release(voxels->context, all[n]->portions);
        snow_release(voxels->context, all[n]->block_messages);
        snow_release(voxels->context, all[n]->buffer);
    }
    snow_release(voxels->context, voxels->messages);
    *voxels = (snow_voxels){.comm = voxels->comm, .context = voxels->context};
}

void snow_voxels_free(snow_voxels *voxels) {
    if (!voxels)
        return;
    snow_voxels_clear(voxels);
    snow_release(voxels->context, voxels);
}

/* Drops the plan; buffers are kept. */
static void clear_plan(snow_voxels *voxels) {
    traffic *const all[] = {&voxels->sent, &voxels->received, &voxels->kept};
    for (int n = 0; n < 3; n++) {
        all[n]->portion_count = all[n]->block_message_count = 0;
        all[n]->voxels = 0;
    }
    voxels->ready = 0;
}

/* Collective. Shares all boxes. Ranks with fewer than the maximum send empty
 * ones. */
static snow_status take_box_table(snow_comm *comm, const snow_box *held,
                                  int count, const snow_box *wanted,
                                  box_table *c) {
    snow_context *context = snow_comm_context(comm);
    int64_t most = count;
    SNOW_TRY(snow_comm_reduce_ints(comm, &most, 1, SNOW_REDUCE_MAX));
    c->ranks = snow_comm_size(comm);
    c->most = most > 0 ? (int)most : 1;
    size_t bytes = (size_t)c->most * sizeof *held;
    snow_status status = SNOW_RESERVE(context, c->wanted, 0, c->ranks);
    if (status == SNOW_STATUS_OK)
        status = snow_reserve(context, &c->held, 0, (uint64_t)c->ranks, bytes);
    snow_box *mine = snow_allocate_clear(context, bytes);
    if (!mine)
        status = SNOW_STATUS_NO_MEMORY;
    else if (count > 0)
        memcpy(mine, held, (size_t)count * sizeof *held);
    status = snow_comm_agree_status(comm, status);
    if (status == SNOW_STATUS_OK)
        status = snow_comm_allgather(comm, mine, bytes, c->held);
    if (status == SNOW_STATUS_OK)
        status = snow_comm_allgather(comm, wanted, sizeof *wanted, c->wanted);
    snow_release(context, mine);
    return status;
}

/* Adds a message: the voxels of a wanted box that a rank holds, in the order of
 * its boxes. */
static snow_status add_block_message(snow_context *context, traffic *t,
                                     int rank, const snow_box *held, int count,
                                     const snow_box *wanted) {
    block_message p = {.rank = rank, .first = t->portion_count};
    portion part;
    for (int n = 0; n < count; n++) {
        part = (portion){.brick = n, .of = held[n]};
        if (!snow_box_intersect(&held[n], wanted, &part.box))
            continue;
        SNOW_TRY(SNOW_RESERVE(context, t->portions, t->portion_count,
                              t->portion_count + 1));
        t->portions[t->portion_count++] = part;
        t->voxels += snow_box_voxels(&part.box);
        p.portions++;
    }
    if (!p.portions)
        return SNOW_STATUS_OK;
    SNOW_TRY(SNOW_RESERVE(context, t->block_messages, t->block_message_count,
                          t->block_message_count + 1));
    t->block_messages[t->block_message_count++] = p;
    return SNOW_STATUS_OK;
}

/* From the next rank on, so that not all send to the same one at a time. */
static snow_status make_block_messages(snow_voxels *voxels,
                                       const box_table *c) {
    int me = snow_comm_rank(voxels->comm);
    const snow_box *mine = c->held + (size_t)me * (size_t)c->most;
    for (int step = 0; step < c->ranks; step++) {
        int to = (me + step) % c->ranks;
        int from = (me - step + c->ranks) % c->ranks;
        traffic *out = step ? &voxels->sent : &voxels->kept;
        SNOW_TRY(add_block_message(voxels->context, out, to, mine, c->most,
                                   &c->wanted[to]));
        if (step)
            SNOW_TRY(add_block_message(voxels->context, &voxels->received, from,
                                       c->held + (size_t)from * (size_t)c->most,
                                       c->most, &voxels->wanted));
    }
    return SNOW_STATUS_OK;
}

/* Rejects boxes of this rank that overlap any other: it would not be known
 * which voxel is right. */
static snow_status check_overlap(snow_voxels *voxels, const box_table *c) {
    size_t most = (size_t)c->most, all = (size_t)c->ranks * most;
    size_t first = (size_t)snow_comm_rank(voxels->comm) * most;
    snow_box box;
    for (size_t i = first; i < first + most; i++)
        for (size_t j = 0; j < all; j++)
            if (i != j && snow_box_intersect(&c->held[i], &c->held[j], &box))
                return snow_fail(
                    voxels->context, SNOW_STATUS_BAD_USAGE,
                    "voxel (%lld, %lld, %lld) belongs to two ranks, also to "
                    "rank %lld: boxes must not overlap; leave ghost voxels out "
                    "of them",
                    (long long)box.first[0], (long long)box.first[1],
                    (long long)box.first[2], (long long)(j / most));
    return SNOW_STATUS_OK;
}

/* Boxes do not overlap, so a count shows whether all is there. */
static snow_status check_whole(const snow_voxels *voxels) {
    int64_t found = voxels->kept.voxels + voxels->received.voxels;
    int64_t wanted = snow_box_voxels(&voxels->wanted);
    if (found == wanted || voxels->has_gaps)
        return SNOW_STATUS_OK;
    const int64_t *first = voxels->wanted.first, *count = voxels->wanted.count;
    return snow_fail(
        voxels->context, SNOW_STATUS_BAD_USAGE,
        "no rank holds %lld of the %lld voxels from (%lld, %lld, %lld) to "
        "(%lld, %lld, %lld): every voxel of the grid must belong to a rank",
        (long long)(wanted - found), (long long)wanted, (long long)first[0],
        (long long)first[1], (long long)first[2],
        (long long)(first[0] + count[0] - 1),
        (long long)(first[1] + count[1] - 1),
        (long long)(first[2] + count[2] - 1));
}

/* Plans what this rank can plan without the others. */
static snow_status plan_alone(snow_voxels *voxels, const box_table *c) {
    SNOW_TRY(make_block_messages(voxels, c));
    SNOW_TRY(check_whole(voxels));
    size_t messages =
        voxels->sent.block_message_count + voxels->received.block_message_count;
    return SNOW_RESERVE(voxels->context, voxels->messages, 0, messages);
}

snow_status snow_voxels_plan(snow_voxels *voxels, const snow_box *held,
                             int count, const snow_box *wanted) {
    clear_plan(voxels);
    voxels->wanted = *wanted;
    box_table c = {0};
    snow_status status = take_box_table(voxels->comm, held, count, wanted, &c);
    /* Before counting, since overlaps would spoil it on other ranks. */
    if (status == SNOW_STATUS_OK)
        status =
            snow_comm_agree_status(voxels->comm, check_overlap(voxels, &c));
    if (status == SNOW_STATUS_OK)
        status = snow_comm_agree_status(voxels->comm, plan_alone(voxels, &c));
    snow_release(voxels->context, c.held);
    snow_release(voxels->context, c.wanted);
    if (status != SNOW_STATUS_OK)
        clear_plan(voxels);
    return status;
}

/* --- rounds --------------------------------------------------------------- */

/* What of a portion moves in a round; false: nothing. */
static bool part_of(const portion *p, int round, int rounds, snow_box *out) {
    const snow_box slices = snow_box_slices(&p->of, round, rounds);
    return snow_box_intersect(&p->box, &slices, out);
}

/* The voxels of some portions in a round. */
static int64_t voxels_of(const traffic *t, size_t first, size_t portions,
                         int round, int rounds) {
    int64_t voxels = 0;
    snow_box box;
    for (size_t i = first; i < first + portions; i++)
        if (part_of(&t->portions[i], round, rounds, &box))
            voxels += snow_box_voxels(&box);
    return voxels;
}

/* Room for any round. */
static snow_status make_buffer(const snow_voxels *voxels, traffic *t,
                               size_t value) {
    int64_t most = 0;
    for (int round = 0; round < voxels->rounds; round++) {
        const int64_t here =
            voxels_of(t, 0, t->portion_count, round, voxels->rounds);
        most = here > most ? here : most;
    }
    return snow_reserve(voxels->context, &t->buffer, 0, (uint64_t)most, value);
}

/* Collective if values are larger than any before: the size so far is the same
 * on all ranks. */
static snow_status make_ready(snow_voxels *voxels, size_t value) {
    if (value <= voxels->ready)
        return SNOW_STATUS_OK;
    traffic *out = &voxels->sent, *in = &voxels->received;
    int64_t most = out->voxels > in->voxels ? out->voxels : in->voxels;
    if (voxels->gives_up && voxels->kept.voxels > most)
        most = voxels->kept.voxels; /* not all of them twice at once */
    const int64_t once = ROUND_BYTES / (int64_t)value;
    int64_t rounds = most / (once > 0 ? once : 1) + 1;
    SNOW_TRY(snow_comm_reduce_ints(voxels->comm, &rounds, 1, SNOW_REDUCE_MAX));
    voxels->rounds = (int)rounds;
    snow_status status = make_buffer(voxels, out, value);
    if (status == SNOW_STATUS_OK)
        status = make_buffer(voxels, in, value);
    SNOW_TRY(snow_comm_agree_status(voxels->comm, status));
    voxels->ready = value;
    return SNOW_STATUS_OK;
}

/* --- moving --------------------------------------------------------------- */

static snow_status start_receiving(snow_voxels *voxels, int round,
                                   size_t value) {
    traffic *t = &voxels->received;
    int64_t at = 0;
    for (size_t n = 0; n < t->block_message_count; n++) {
        block_message *p = &t->block_messages[n];
        const int64_t count =
            voxels_of(t, p->first, p->portions, round, voxels->rounds);
        p->offset = at;
        at += count;
        voxels->messages[n] = (snow_message){0};
        if (count)
            SNOW_TRY(snow_comm_receive(voxels->comm,
                                       t->buffer + (size_t)p->offset * value,
                                       (size_t)count * value, p->rank,
                                       SNOW_TAG_VOXELS, &voxels->messages[n]));
    }
    return SNOW_STATUS_OK;
}

static snow_status start_sending(snow_voxels *voxels, const snow_brick *bricks,
                                 int round, size_t value) {
    traffic *t = &voxels->sent;
    char *at = t->buffer;
    snow_message *message =
        voxels->messages + voxels->received.block_message_count;
    for (size_t n = 0; n < t->block_message_count; n++, message++) {
        const block_message *p = &t->block_messages[n];
        const char *first = at;
        snow_box box;
        for (size_t i = p->first; i < p->first + p->portions; i++) {
            if (!part_of(&t->portions[i], round, voxels->rounds, &box))
                continue;
            snow_brick_copy(&bricks[t->portions[i].brick], value, &box, &box,
                            at);
            at += (size_t)snow_box_voxels(&box) * value;
        }
        *message = (snow_message){0};
        if (at > first)
            SNOW_TRY(snow_comm_send(voxels->comm, first, (size_t)(at - first),
                                    p->rank, SNOW_TAG_VOXELS, message));
    }
    return SNOW_STATUS_OK;
}

/* Copies the voxels of a message to their places. */
static void unpack(const snow_voxels *voxels, const block_message *p, int round,
                   size_t value, void *dense) {
    const traffic *t = &voxels->received;
    const char *at = t->buffer + (size_t)p->offset * value;
    snow_box box;
    for (size_t i = p->first; i < p->first + p->portions; i++) {
        if (!part_of(&t->portions[i], round, voxels->rounds, &box))
            continue;
        snow_brick packed = {
            box, at, {1, box.count[0], box.count[0] * box.count[1]}};
        snow_brick_copy(&packed, value, &box, &voxels->wanted, dense);
        at += (size_t)snow_box_voxels(&box) * value;
    }
}

/* Unpacks messages as they arrive, while others are in flight. */
static snow_status finish_receiving(snow_voxels *voxels, int round,
                                    size_t value, void *dense) {
    int count = (int)voxels->received.block_message_count;
    for (int left = count, which; left > 0; left--) {
        SNOW_TRY(
            snow_comm_wait_any(voxels->comm, voxels->messages, count, &which));
        if (which < 0)
            break;
        unpack(voxels, &voxels->received.block_messages[which], round, value,
               dense);
    }
    return SNOW_STATUS_OK;
}

void snow_voxels_expect(snow_voxels *voxels, bool spent, bool gaps) {
    voxels->gives_up = spent;
    voxels->has_gaps = gaps;
}

static snow_status move_round(snow_voxels *voxels, const snow_brick *bricks,
                              int round, size_t value, void *dense) {
    SNOW_TRY(start_receiving(voxels, round, value));
    SNOW_TRY(start_sending(voxels, bricks, round, value));
    const traffic *t = &voxels->kept;
    snow_box box;
    for (size_t i = 0; i < t->portion_count; i++)
        if (part_of(&t->portions[i], round, voxels->rounds, &box))
            snow_brick_copy(&bricks[t->portions[i].brick], value, &box,
                            &voxels->wanted, dense);
    SNOW_TRY(finish_receiving(voxels, round, value, dense));
    SNOW_TRY(snow_comm_wait_all(
        voxels->comm, voxels->messages + voxels->received.block_message_count,
        (int)voxels->sent.block_message_count));
    if (voxels->gives_up)
        snow_brick_forget(bricks, round, voxels->rounds, value);
    return SNOW_STATUS_OK;
}

snow_status snow_voxels_move(snow_voxels *voxels, const snow_brick *bricks,
                             size_t value, void *dense) {
    SNOW_TRY(make_ready(voxels, value));
    for (int round = 0; round < voxels->rounds; round++)
        SNOW_TRY(move_round(voxels, bricks, round, value, dense));
    return SNOW_STATUS_OK;
}
