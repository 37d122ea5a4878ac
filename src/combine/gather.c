/* combine/gather.c - gathers regions of the picture at the display processor.
 *
 * A tree of ranks: 0 .. n - 1 are split into near-equal runs, the first rank of
 * each leads it, and so on; each rank sends what it received from those below
 * once, unchanged, with its own:
 *
 *   block:  | u64 runs | u64 pixel bytes | x y count, u16 each ... | pixels |
 *
 * Wide trees have few steps, narrow ones few messages for one rank; with as
 * many branches as ranks all send to the display processor directly.
 *
 * No rank knows the length of a message in advance. So a message begins with
 * its length and has at most SLOT bytes; the rest of a longer one is a second
 * message, for which the receiver then has the right buffer. Runs of all ranks
 * are disjoint, and gaps between those of a rank are no shorter than the cost
 * of a run, which bounds the data: no memory is allocated on the way. A rank
 * without children has room for its own pixels only. */
#include "combine/combiner.h"

#include <string.h>

#define SLOT 4096
#define HEAD 8 /* bytes of a message's length */

typedef struct block_head {
    uint64_t runs, bytes;
} block_head;

#define EMPTY (HEAD + sizeof(block_head)) /* bytes of a block without runs */

void snow_gather_radix(snow_combiner *combiner, int radix) {
    combiner->gather.radix = radix;
}

static void drop_buffers(snow_combiner *combiner) {
    snow_gather_state *state = &combiner->gather;
    snow_context *context = combiner->comm->context;
    snow_release(context, state->children);
    snow_release(context, state->bytes);
    snow_release(context, state->slots);
    snow_release(context, state->messages);
    snow_release(context, state->places);
    snow_release(context, state->queue);
    *state = (snow_gather_state){.radix = state->radix, .own = state->own};
}

void snow_gather_free(snow_combiner *combiner) {
    snow_release(combiner->comm->context, combiner->gather.own);
    drop_buffers(combiner);
}

/* --- the tree ------------------------------------------------------------- */

/* Part i of `parts` of `count` ranks, beginning with `first`. */
static int part_first(int first, int count, int parts, int i) {
    return first + (int)((int64_t)count * i / parts);
}

/* Walks down the tree until `rank` leads nothing more: counts its children, and
 * lists them unless `children` is NULL. */
static int walk_tree(int rank, int ranks, int radix, int *children,
                     int *parent) {
    int first = 0, count = ranks, found = 0;
    *parent = -1;
    while (count > 1) {
        int parts = count < radix ? count : radix, mine = 0;
        while (part_first(first, count, parts, mine + 1) <= rank)
            mine++;
        if (rank == first) {
            for (int i = 1; i < parts; i++, found++)
                if (children)
                    children[found] = part_first(first, count, parts, i);
        }
        int start = part_first(first, count, parts, mine);
        int end = part_first(first, count, parts, mine + 1);
        if (mine > 0 && rank == start)
            *parent = first;
        first = start;
        count = end - start;
    }
    return found;
}

/* Wide if pixels take longer than messages: from about 2 MB on. */
static int chosen_radix(const snow_combiner *combiner, int width, int height,
                        size_t pixel_bytes) {
    const int ranks = combiner->comm->ranks;
    double bytes = (double)width * height * (double)pixel_bytes;
    int radix = bytes < 2e6 ? 8 : 32;
    if (combiner->gather.radix >= 2)
        radix = combiner->gather.radix;
    return radix < ranks ? radix : ranks < 2 ? 2 : ranks;
}

/* --- memory --------------------------------------------------------------- */

/* Bytes of all blocks: a run with the gap behind it costs no more than its
 * pixels and those of the gap, unless it is the last of a rank's part of a
 * line. */
static size_t most_bytes(const snow_gather_state *state, int ranks) {
    const uint64_t width = (uint64_t)state->width,
                   height = (uint64_t)state->height;
    const uint64_t parts = (uint64_t)ranks < width ? (uint64_t)ranks : width;
    return (size_t)(height *
                    (width * state->pixel_bytes + parts * SNOW_RUN_BYTES)) +
           (size_t)(ranks + 2) * (HEAD + sizeof(block_head)) + SLOT;
}

static snow_status allocate_buffers(snow_combiner *combiner) {
    snow_gather_state *state = &combiner->gather;
    snow_context *context = combiner->comm->context;
    const int ranks = combiner->comm->ranks;
    int count = walk_tree(combiner->comm->rank, ranks, state->used_radix, NULL,
                          &state->parent);
    const int some = count + 1;
    SNOW_TRY(SNOW_RESERVE(context, state->children, 0, some));
    if (count)
        SNOW_TRY(
            SNOW_RESERVE(context, state->bytes, 0, most_bytes(state, ranks)));
    SNOW_TRY(SNOW_RESERVE(context, state->own, 0, EMPTY));
    SNOW_TRY(snow_reserve(context, &state->slots, 0, (uint64_t)some, SLOT));
    SNOW_TRY(SNOW_RESERVE(context, state->messages, 0, 2 * some));
    SNOW_TRY(SNOW_RESERVE(context, state->places, 0, some));
    SNOW_TRY(SNOW_RESERVE(context, state->queue, 0, some));
    state->child_count =
        walk_tree(combiner->comm->rank, ranks, state->used_radix,
                  state->children, &state->parent);
    return SNOW_STATUS_OK;
}

static snow_status plan_tree(snow_combiner *combiner, int width, int height,
                             size_t pixel_bytes) {
    snow_gather_state *state = &combiner->gather;
    const int radix = chosen_radix(combiner, width, height, pixel_bytes);
    if (width < 1 || height < 1 || width > 65535 || height > 65535 ||
        pixel_bytes < 1 || pixel_bytes > 1024)
        return snow_fail(combiner->comm->context, SNOW_STATUS_BAD_USAGE,
                         "cannot gather a picture of %d x %d pixels of %zu "
                         "bytes: sides must be 1 to 65535",
                         width, height, pixel_bytes);
    if (state->width == width && state->height == height &&
        state->pixel_bytes == pixel_bytes && state->used_radix == radix)
        return SNOW_STATUS_OK;
    drop_buffers(combiner);
    state->width = width;
    state->height = height;
    state->pixel_bytes = pixel_bytes;
    state->used_radix = radix;
    snow_status status =
        snow_comm_agree_status(combiner->comm, allocate_buffers(combiner));
    if (status != SNOW_STATUS_OK)
        drop_buffers(combiner);
    return status;
}

/* --- blocks --------------------------------------------------------------- */

/* Returns whether a run is inside the picture. */
static bool run_fits(const snow_gather_state *state,
                     const snow_pixel_run *run) {
    return run->x >= 0 && run->y >= 0 && run->count >= 0 &&
           run->y < state->height && run->x < state->width &&
           run->count <= state->width - run->x;
}

snow_status snow_gather_reserve(snow_combiner *combiner, int width, int height,
                                size_t run_count, int64_t pixels,
                                size_t pixel_bytes) {
    snow_gather_state *state = &combiner->gather;
    const int radix = chosen_radix(combiner, width, height, pixel_bytes);
    int parent;
    if (walk_tree(combiner->comm->rank, combiner->comm->ranks, radix, NULL,
                  &parent) > 0 ||
        parent < 0)
        return SNOW_STATUS_OK;
    size_t bytes =
        EMPTY + run_count * SNOW_RUN_BYTES + (size_t)pixels * pixel_bytes;
    return SNOW_RESERVE(combiner->comm->context, state->own, 0, bytes);
}

/* This rank's runs may be invalid, or its memory short, and the others do not
 * know: it continues without runs then, and fails in the end. */
static snow_status check_runs(snow_combiner *combiner,
                              const snow_pixel_run *runs, size_t count) {
    const snow_gather_state *state = &combiner->gather;
    const int64_t all = (int64_t)state->width * state->height;
    int64_t left = all;
    bool good = count <= (uint64_t)left;
    for (size_t i = 0; i < count && good; i++) {
        good = run_fits(state, &runs[i]) && runs[i].count <= left;
        /* a gap is not shorter than the cost of a run */
        if (i && runs[i].y == runs[i - 1].y)
            good &= ((int64_t)runs[i].x - runs[i - 1].x - runs[i - 1].count) *
                        (int64_t)state->pixel_bytes >=
                    SNOW_RUN_BYTES;
        left -= runs[i].count;
    }
    if (good)
        return snow_gather_reserve(combiner, state->width, state->height, count,
                                   all - left, state->pixel_bytes);
    return snow_fail(
        combiner->comm->context, SNOW_STATUS_BAD_USAGE,
        "invalid runs: they must be inside the picture of %d x %d pixels, have "
        "no more pixels than it, and gaps of at least %d bytes",
        state->width, state->height, SNOW_RUN_BYTES);
}

/* Copies one run into the picture. */
static void copy_run(const snow_gather_state *state, const snow_pixel_run *run,
                     const unsigned char *pixels, unsigned char *picture) {
    size_t at = (size_t)run->y * (size_t)state->width + (size_t)run->x;
    memcpy(picture + at * state->pixel_bytes, pixels,
           (size_t)run->count * state->pixel_bytes);
}

/* Writes a block of this rank's runs to `out`; returns its length. */
static size_t write_block(const snow_gather_state *state,
                          const snow_pixel_run *runs, size_t run_count,
                          const void *pixels, unsigned char *out) {
    int64_t count = 0;
    unsigned char *at = out + sizeof(block_head);
    for (size_t i = 0; i < run_count; i++) {
        const uint16_t packed[3] = {(uint16_t)runs[i].x, (uint16_t)runs[i].y,
                                    (uint16_t)runs[i].count};
        memcpy(at, packed, sizeof packed);
        at += sizeof packed;
        count += runs[i].count;
    }
    size_t bytes = (size_t)count * state->pixel_bytes;
    const block_head head = {run_count, bytes};
    memcpy(out, &head, sizeof head);
    if (bytes)
        memcpy(at, pixels, bytes);
    return (size_t)(at - out) + bytes;
}

/* Copies the pixels of blocks into the picture; false if they are invalid. */
static bool copy_blocks(const snow_gather_state *state, const unsigned char *at,
                        size_t bytes, unsigned char *picture) {
    const unsigned char *end = at + bytes;
    while (at < end) {
        block_head head;
        if ((size_t)(end - at) < sizeof head)
            return false;
        memcpy(&head, at, sizeof head);
        at += sizeof head;
        const uint64_t left = (uint64_t)(end - at);
        if (head.runs > left / SNOW_RUN_BYTES ||
            head.bytes > left - head.runs * SNOW_RUN_BYTES)
            return false;
        const unsigned char *pixels = at + (size_t)head.runs * SNOW_RUN_BYTES;
        const unsigned char *pixels_end = pixels + head.bytes;
        for (uint64_t i = 0; i < head.runs; i++, at += SNOW_RUN_BYTES) {
            uint16_t packed[3];
            memcpy(packed, at, sizeof packed);
            const snow_pixel_run run = {packed[0], packed[1], packed[2]};
            size_t length = (size_t)run.count * state->pixel_bytes;
            if (!run_fits(state, &run) ||
                length > (size_t)(pixels_end - pixels))
                return false;
            copy_run(state, &run, pixels, picture);
            pixels += length;
        }
        at = pixels_end;
    }
    return true;
}

/* --- messages ------------------------------------------------------------- */

static snow_status begin_receives(snow_combiner *combiner) {
    snow_gather_state *state = &combiner->gather;
    for (int i = 0; i < state->child_count; i++) {
        state->messages[state->child_count + i] = (snow_message){0};
        SNOW_TRY(snow_comm_receive(
            combiner->comm, state->slots + (size_t)i * SLOT, SLOT,
            state->children[i], SNOW_TAG_GATHER, &state->messages[i]));
    }
    return SNOW_STATUS_OK;
}

/* The number of long messages in flight to a rank. Two saturate its network; if
 * all were, they would end together, and the display processor could not copy
 * one while the next is received. */
#define IN_FLIGHT 2

/* What a rank has received so far. */
typedef struct intake {
    size_t used; /* bytes that blocks take, including those still to come */
    int queued, asked, arrived; /* children with long messages: found, asked to
                                   send, done */
} intake;

static uint64_t message_length(const snow_gather_state *state, int child) {
    uint64_t length;
    memcpy(&length, state->slots + (size_t)child * SLOT, sizeof length);
    return length;
}

/* The beginning of a child's message has arrived: it is appended to the data;
 * if there is a rest, the child is queued. */
static snow_status append_beginning(snow_combiner *combiner, int child,
                                    intake *in) {
    snow_gather_state *state = &combiner->gather;
    const size_t here = state->messages[child].bytes;
    const uint64_t length = here >= HEAD ? message_length(state, child) : 0;
    if (here < HEAD || length < here - HEAD ||
        length > snow_block_bytes(state->bytes) - in->used)
        return snow_fail(combiner->comm->context, SNOW_STATUS_FAILED,
                         "rank %d sent more pixels than the picture has: runs "
                         "of different ranks must not overlap",
                         state->children[child]);
    memcpy(state->bytes + in->used, state->slots + (size_t)child * SLOT + HEAD,
           here - HEAD);
    state->places[child] = in->used;
    in->used += (size_t)length;
    if (length > here - HEAD)
        state->queue[in->queued++] = child;
    return SNOW_STATUS_OK;
}

/* Starts the receives of rests, for the children whose turn it is. */
static snow_status ask_rests(snow_combiner *combiner, intake *in) {
    snow_gather_state *state = &combiner->gather;
    const size_t here = SLOT - HEAD;
    while (in->asked < in->queued && in->asked - in->arrived < IN_FLIGHT) {
        int child = state->queue[in->asked++];
        SNOW_TRY(snow_comm_receive(
            combiner->comm, state->bytes + state->places[child] + here,
            (size_t)message_length(state, child) - here, state->children[child],
            SNOW_TAG_GATHER, &state->messages[state->child_count + child]));
    }
    return SNOW_STATUS_OK;
}

/* Sends a message of `length` bytes, which is preceded by its own length. */
static snow_status send_up(snow_combiner *combiner, unsigned char *bytes,
                           size_t length) {
    snow_gather_state *state = &combiner->gather;
    snow_message messages[2] = {{0}};
    const uint64_t given = length;
    memcpy(bytes, &given, HEAD);
    size_t all = length + HEAD, beginning = all < SLOT ? all : SLOT;
    SNOW_TRY(snow_comm_send(combiner->comm, bytes, beginning, state->parent,
                            SNOW_TAG_GATHER, &messages[0]));
    if (all > beginning)
        SNOW_TRY(snow_comm_send(combiner->comm, bytes + beginning,
                                all - beginning, state->parent, SNOW_TAG_GATHER,
                                &messages[1]));
    return snow_comm_wait_all(combiner->comm, messages, 2);
}

/* All of a child's blocks have arrived: the display processor copies them. */
static bool copy_child(snow_combiner *combiner, int child,
                       unsigned char *picture) {
    const snow_gather_state *state = &combiner->gather;
    const size_t length = (size_t)message_length(state, child);
    if (state->parent >= 0)
        return true;
    return copy_blocks(state, state->bytes + state->places[child], length,
                       picture);
}

/* Receives what children send, in order of arrival, behind the first `used`
 * bytes. */
static snow_status receive_children(snow_combiner *combiner, size_t *used,
                                    unsigned char *picture) {
    snow_gather_state *state = &combiner->gather;
    const int count = state->child_count;
    intake in = {.used = *used};
    bool good = true;
    for (;;) {
        int which;
        SNOW_TRY(snow_comm_wait_any(combiner->comm, state->messages, 2 * count,
                                    &which));
        if (which < 0)
            break;
        const int child = which % count, queued = in.queued;
        if (which < count)
            SNOW_TRY(append_beginning(combiner, child, &in));
        else
            in.arrived++;
        SNOW_TRY(ask_rests(combiner, &in));
        if (in.queued == queued)
            good = copy_child(combiner, child, picture) && good;
    }
    *used = in.used;
    if (!good)
        return snow_fail(combiner->comm->context, SNOW_STATUS_FAILED,
                         "received invalid runs: they must be inside the "
                         "picture of %d x %d pixels",
                         state->width, state->height);
    return SNOW_STATUS_OK;
}

snow_status snow_gather(snow_combiner *combiner, int width, int height,
                        const snow_pixel_run *runs, size_t run_count,
                        const void *pixels, size_t pixel_bytes, void *picture) {
    snow_gather_state *state = &combiner->gather;
    const unsigned char *from = pixels;
    size_t used = HEAD;
    SNOW_TRY(plan_tree(combiner, width, height, pixel_bytes));
    snow_status status = check_runs(combiner, runs, run_count);
    if (status != SNOW_STATUS_OK)
        run_count = 0;
    SNOW_TRY(begin_receives(combiner));
    unsigned char *block = state->child_count ? state->bytes : state->own;
    if (state->parent >= 0)
        used += write_block(state, runs, run_count, pixels, block + used);
    for (size_t i = 0; i < run_count && state->parent < 0; i++) {
        copy_run(state, &runs[i], from, picture);
        from += (size_t)runs[i].count * pixel_bytes;
    }
    SNOW_TRY(receive_children(combiner, &used, picture));
    if (state->parent >= 0)
        SNOW_TRY(send_up(combiner, block, used - HEAD));
    return status;
}
