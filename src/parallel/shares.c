/* parallel/shares.c - see shares.h. */
#include "parallel/shares.h"

#include "base/monitor.h"
#include "decompose/slab.h"
#include <stddef.h>

/* --- shares --------------------------------------------------------------- */

/* Slabs of whole blocks along z, and parts of each of them along y. */
typedef struct layout {
    const int64_t *dims;
    snow_file_blocks blocks;
    int slabs, parts;
} layout;

static int64_t count_blocks(const layout *l, int axis) {
    const int64_t size = l->blocks.size[axis];
    return (l->dims[axis] + l->blocks.cut[axis] + size - 1) / size;
}

/* Returns where a block begins; the end, for the one behind the last. */
static int64_t begin_of(const layout *l, int axis, int64_t block) {
    const int64_t at = block * l->blocks.size[axis] - l->blocks.cut[axis];
    return at < 0 ? 0 : at < l->dims[axis] ? at : l->dims[axis];
}

static layout divide(layout l, int ranks, int slabs) {
    const int64_t most = count_blocks(&l, 1);
    l.slabs = slabs;
    l.parts = ranks / slabs < most ? ranks / slabs : (int)most;
    return l;
}

/* Rows of the largest share along an axis that is cut into so many. */
static int64_t longest_of(const layout *l, int axis, int parts) {
    const int64_t rows =
        ((count_blocks(l, axis) - 1) / parts + 1) * l->blocks.size[axis];
    return rows < l->dims[axis] ? rows : l->dims[axis];
}

static int64_t largest_of(const layout *l) {
    return longest_of(l, 2, l->slabs) * longest_of(l, 1, l->parts);
}

/* There are as many slabs as there can be, or fewer, if the largest share of
 * blocks is smaller then. */
static layout lay_out(const int64_t dims[3], const snow_file_blocks *blocks,
                      int ranks) {
    const bool packed = blocks && blocks->size[2] > 0;
    const double equal = (double)dims[1] * (double)dims[2] / ranks;
    layout l = {dims, {{1, 1, 1}, {0, 0, 0}}, 1, 1};
    if (packed)
        l.blocks = *blocks;
    const int64_t most = count_blocks(&l, 2);
    l = divide(l, ranks, ranks < most ? ranks : (int)most);
    for (int slabs = l.slabs - 1; slabs > 0 && packed; slabs--) {
        const layout other = divide(l, ranks, slabs);
        if (largest_of(&other) < largest_of(&l))
            l = other;
    }
    return packed && (double)largest_of(&l) > SNOW_SHARE_MOST * equal
               ? lay_out(dims, NULL, ranks)
               : l;
}

int snow_share_readers(const int64_t dims[3], const snow_file_blocks *blocks,
                       int ranks) {
    const layout l = lay_out(dims, blocks, ranks);
    return l.slabs * l.parts;
}

static void take_run(const layout *l, int axis, int parts, int part,
                     snow_box *box) {
    const snow_slab run = snow_slab_equal(count_blocks(l, axis), parts, part);
    box->first[axis] = begin_of(l, axis, run.first);
    box->count[axis] =
        begin_of(l, axis, run.first + run.count) - box->first[axis];
}

snow_box snow_share_of(const int64_t dims[3], const snow_file_blocks *blocks,
                       int rank, int ranks) {
    snow_box box = {{0, 0, 0}, {dims[0], 0, 0}};
    const layout l = lay_out(dims, blocks, ranks);
    if (rank >= l.slabs * l.parts)
        return box;
    take_run(&l, 2, l.slabs, rank / l.parts, &box);
    take_run(&l, 1, l.parts, rank % l.parts, &box);
    return box;
}

snow_status snow_share_agree(snow_comm *comm, bool here, bool *all) {
    int64_t word = here;
    SNOW_TRY(snow_comm_reduce_ints(comm, &word, 1, SNOW_REDUCE_MIN));
    *all = word != 0;
    return SNOW_STATUS_OK;
}

/* --- one after another ---------------------------------------------------- */

/* What is handed on is the beginning of a relay. */
#define HANDED_BYTES offsetof(snow_relay, seen)

typedef struct turns {
    snow_comm *comm;
    snow_relay *relay;
    int readers;
    snow_share_fn *read;
    void *user;
    snow_status status; /* of this rank's reading */
} turns;

/* How it goes on after a turn. */
typedef enum { IN_TURN, SIDE_BY_SIDE, FAILED } course;

/* The last one looks at what lies behind the data. */
static void read_own(turns *t) {
    t->relay->last = snow_comm_rank(t->comm) == t->readers - 1;
    t->status = t->read(t->user, t->relay);
}

/* Collective.  Ranks wait anew in each turn: one that waited for all turns
 * would be taken for one that hangs.  A reader that skips nothing keeps nobody
 * waiting. */
static snow_status end_turn(turns *t, int turn, course *next) {
    snow_monitor *monitor = snow_comm_context(t->comm)->monitor;
    int64_t words[2] = {t->status != SNOW_STATUS_OK,
                        snow_comm_rank(t->comm) == turn && t->relay->skips};
    SNOW_TRY(snow_comm_reduce_ints(t->comm, words, 2, SNOW_REDUCE_MAX));
    *next = words[0] ? FAILED : words[1] ? IN_TURN : SIDE_BY_SIDE;
    if (*next == IN_TURN)
        snow_monitor_report(monitor, SNOW_STAGE_READ, turn + 1, t->readers);
    if (t->status == SNOW_STATUS_OK)
        t->status = snow_monitor_status(monitor);
    return SNOW_STATUS_OK;
}

/* From the rank whose turn it was to the one behind it. */
static snow_status hand_on(const turns *t, int turn) {
    const int rank = snow_comm_rank(t->comm), next = turn + 1;
    snow_message message = {0};
    if ((rank != turn && rank != next) || next >= t->readers)
        return SNOW_STATUS_OK;
    SNOW_TRY(rank == turn ? snow_comm_send(t->comm, t->relay, HANDED_BYTES,
                                           next, SNOW_TAG_VOXELS, &message)
                          : snow_comm_receive(t->comm, t->relay, HANDED_BYTES,
                                              turn, SNOW_TAG_VOXELS, &message));
    return snow_comm_wait_all(t->comm, &message, 1);
}

/* Collective.  Errors: of the transport; those of reading are in `status`. */
static snow_status take_turns(turns *t) {
    const int rank = snow_comm_rank(t->comm);
    course next = IN_TURN;
    int turn = 0;
    if (rank >= t->readers)
        t->status = t->read(t->user, NULL);
    for (; turn < t->readers && next == IN_TURN; turn++) {
        if (rank == turn)
            read_own(t);
        SNOW_TRY(end_turn(t, turn, &next));
        if (next == IN_TURN)
            SNOW_TRY(hand_on(t, turn));
    }
    if (next == SIDE_BY_SIDE && rank >= turn && rank < t->readers)
        read_own(t);
    return SNOW_STATUS_OK;
}

/* Collective.  The first rank says what the last one has noticed. */
static snow_status warn_about_file(snow_comm *comm, const snow_relay *relay,
                                   const char *path) {
    int64_t words[2] = {relay->foreign, (int64_t)relay->left};
    SNOW_TRY(snow_comm_reduce_ints(comm, words, 2, SNOW_REDUCE_MAX));
    if (snow_comm_rank(comm) == 0)
        snow_relay_warn(snow_comm_context(comm), path, words[0] != 0,
                        (uint64_t)words[1]);
    return SNOW_STATUS_OK;
}

/* Collective.  Turns of all ranks are what progress counts. */
static snow_status read_in_turn(turns *t, const char *path) {
    snow_monitor monitor;
    snow_monitor_begin_reading(snow_comm_context(t->comm), &monitor);
    snow_status status = take_turns(t);
    if (status == SNOW_STATUS_OK)
        status = warn_about_file(t->comm, t->relay, path);
    return snow_monitor_end(&monitor,
                            status == SNOW_STATUS_OK ? t->status : status);
}

snow_status snow_shares_in_turn(snow_comm *comm, int readers, const char *path,
                                snow_share_fn *read, void *user) {
    snow_context *context = snow_comm_context(comm);
    snow_relay *relay = snow_allocate_clear(context, sizeof *relay);
    turns t = {comm, relay, readers, read, user, SNOW_STATUS_OK};
    snow_status status = snow_comm_agree_status(
        comm, relay ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY);
    if (status == SNOW_STATUS_OK)
        status = read_in_turn(&t, path);
    snow_release(context, relay);
    return status;
}

snow_status snow_share_is_packed(snow_context *context, snow_share_fn *read,
                                 void *user, bool *packed) {
    snow_relay *relay = snow_allocate_clear(context, sizeof *relay);
    if (!relay)
        return SNOW_STATUS_NO_MEMORY;
    const snow_status status = read(user, relay);
    *packed = relay->source != 0;
    snow_release(context, relay);
    return status;
}
