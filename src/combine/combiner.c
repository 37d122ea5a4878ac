/* combine/combiner.c - what an exchange is planned by, and its memory.
 *
 * Memory is allocated when the shape of the params changes, or when counted
 * regions are larger than any before. All ranks know that, and agree on the
 * status: a rank that failed alone would leave the others waiting. There is
 * room for parts all of whose pixels are active; only the memory of received
 * pixels is touched, so the system provides no more pages. */
#include "combine/combiner.h"

#include <string.h>

/* --- memory --------------------------------------------------------------- */

snow_status snow_combiner_new(snow_comm *comm, snow_combiner **out) {
    snow_combiner *combiner =
        snow_allocate_clear(comm->context, sizeof *combiner);
    if (!combiner)
        return SNOW_STATUS_NO_MEMORY;
    combiner->comm = comm;
    *out = combiner;
    return SNOW_STATUS_OK;
}

/* Drops the memory of messages to send. */
static void drop_send_buffers(snow_combiner *combiner) {
    if (combiner->lends)
        snow_comm_drop_shared(combiner->comm);
    for (int i = 0; i < 2; i++) {
        if (!combiner->lends)
            snow_release(combiner->comm->context, combiner->out[i].bytes);
        combiner->out[i].bytes = NULL;
    }
    combiner->lends = false;
}

static void drop_buffers(snow_combiner *combiner) {
    snow_context *context = combiner->comm->context;
    drop_send_buffers(combiner);
    for (int i = 0; i < 2; i++) {
        snow_traffic *both[] = {&combiner->in[i], &combiner->out[i]};
        for (int k = 0; k < 2; k++) {
            snow_release(context, both[k]->bytes);
            snow_release(context, both[k]->messages);
            snow_release(context, both[k]->loans);
            snow_release(context, both[k]->returns);
            *both[k] = (snow_traffic){0};
        }
    }
    SNOW_DROP(context, combiner->rounds.shares);
    SNOW_DROP(context, combiner->ranks);
    SNOW_DROP(context, combiner->table);
    SNOW_DROP(context, combiner->layers);
    SNOW_DROP(context, combiner->parts);
    SNOW_DROP(context, combiner->words);
    SNOW_DROP(context, combiner->part);
    SNOW_DROP(context, combiner->region);
    combiner->needs = (snow_exchange_needs){0};
    combiner->shape = (snow_exchange_params){0};
}

void snow_combiner_free(snow_combiner *combiner) {
    if (!combiner)
        return;
    /* After an exchange that has not ended there is nobody to wait for. */
    if (combiner->lends &&
        !(combiner->exchange.ended && !snow_comm_broken(combiner->comm) &&
          snow_traffic_await_returns(combiner) == SNOW_STATUS_OK)) {
        /* others may read there */
        combiner->out[0].bytes = combiner->out[1].bytes = NULL;
        combiner->lends = false; /* it stays taken */
    }
    drop_buffers(combiner);
    snow_gather_free(combiner);
    snow_release(combiner->comm->context, combiner);
}

static size_t more(size_t a, size_t b) {
    return a > b ? a : b;
}

/* The most pixels that a rank holds after `level` rounds. Groups have at most
 * two sizes, and regions are largest in one of them. */
static int64_t most_held(const snow_combiner *combiner, int level) {
    const snow_rounds *rounds = &combiner->rounds;
    const snow_region_bounds *bounds = &combiner->bounds;
    int group = rounds->rank_count;
    for (int i = rounds->count - 1; i >= level && group > 1; i--)
        group = group / rounds->radices[i] > 1 ? group / rounds->radices[i] : 1;
    if (rounds->tree || level == 0)
        return snow_region_capacity(bounds, 1);
    const int64_t a = snow_region_capacity(bounds, group);
    const int64_t b = snow_region_capacity(bounds, group + 1);
    return a > b ? a : b;
}

/* The most messages of a rank in a round (snow_rounds_capacity). */
static size_t peers_in(const snow_rounds *rounds, int level) {
    int radix = rounds->radices[level];
    return 2 * (size_t)(radix < rounds->rank_count ? radix
                                                   : rounds->rank_count) +
           4;
}

static void count_round(const snow_combiner *combiner, int level,
                        snow_exchange_needs *out) {
    const snow_rounds *rounds = &combiner->rounds;
    const size_t pixel_bytes = (size_t)combiner->shape.channels * sizeof(float);
    const int64_t before = most_held(combiner, level),
                  after = most_held(combiner, level + 1);
    const size_t peers = peers_in(rounds, level), radix = (peers - 4) / 2;
    const int parity = level & 1;
    size_t spare =
        peers * (SNOW_ALIGNMENT + snow_active_capacity(0, pixel_bytes));
    size_t sent = snow_active_capacity(before, pixel_bytes) + spare;
    size_t came =
        (radix - 1) * snow_active_capacity(after, pixel_bytes) + spare;
    size_t words = radix * ((size_t)after / 64 + 2) + 2 * peers;
    out->out[parity] = more(out->out[parity], sent);
    out->in[parity] = more(out->in[parity], came);
    out->words = more(out->words, words * sizeof(uint64_t));
}

static void count_needs(const snow_combiner *combiner,
                        snow_exchange_needs *out) {
    const snow_rounds *rounds = &combiner->rounds;
    const size_t channels = (size_t)combiner->shape.channels;
    *out = (snow_exchange_needs){0};
    if (!rounds->count) {
        out->out[0] = snow_align(snow_active_capacity(
            most_held(combiner, 0), channels * sizeof(float)));
        out->words =
            ((size_t)most_held(combiner, 0) / 64 + 2) * sizeof(uint64_t);
    }
    for (int i = 0; i < rounds->count; i++)
        count_round(combiner, i, out);
    out->region =
        (size_t)most_held(combiner, rounds->count) * channels * sizeof(float);
}

/* Allocates what does not depend on the borders of regions. */
static snow_status allocate_lists(snow_combiner *combiner) {
    snow_context *context = combiner->comm->context;
    const size_t rank_count = (size_t)combiner->comm->ranks;
    size_t peers = 8;
    for (int i = 0; i < combiner->rounds.count; i++)
        peers = more(peers, peers_in(&combiner->rounds, i));
    for (int i = 0; i < 2; i++) {
        SNOW_TRY(SNOW_RESERVE(context, combiner->in[i].messages, 0, peers));
        SNOW_TRY(SNOW_RESERVE(context, combiner->out[i].messages, 0, peers));
        SNOW_TRY(SNOW_RESERVE(context, combiner->in[i].loans, 0, peers));
        SNOW_TRY(SNOW_RESERVE(context, combiner->out[i].loans, 0, peers));
        SNOW_TRY(SNOW_RESERVE(context, combiner->out[i].returns, 0, peers));
    }
    SNOW_TRY(SNOW_RESERVE(context, combiner->rounds.shares, 0,
                          snow_rounds_capacity(&combiner->rounds)));
    SNOW_TRY(SNOW_RESERVE(context, combiner->ranks, 0, rank_count));
    SNOW_TRY(SNOW_RESERVE(context, combiner->table, 0, rank_count));
    SNOW_TRY(SNOW_RESERVE(context, combiner->layers, 0,
                          SNOW_COMBINE_THREADS * peers));
    combiner->layer_room = (int)peers;
    SNOW_TRY(SNOW_RESERVE(context, combiner->parts, 0, peers));
    return SNOW_RESERVE(context, combiner->part, 0,
                        (size_t)most_held(combiner, 0) / 64 + 2 + peers);
}

/* Replaces a block by one of another size; its contents are lost. */
static bool replace_block(snow_context *context, void *block_pointer,
                          size_t bytes) {
    void *block;
    memcpy(&block, block_pointer, sizeof block);
    snow_release(context, block);
    block = bytes ? snow_allocate(context, bytes) : NULL;
    memcpy(block_pointer, &block, sizeof block);
    return block || !bytes;
}

/* Messages to send are written where the ranks of the node can read them, if
 * they have such memory. */
static snow_status share_send_buffers(snow_combiner *combiner,
                                      const snow_exchange_needs *need) {
    const size_t first = snow_align(need->out[0]);
    void *shared;
    drop_send_buffers(combiner);
    SNOW_TRY(snow_comm_take_shared(combiner->comm,
                                   first + snow_align(need->out[1]), &shared));
    if (!shared)
        return SNOW_STATUS_OK;
    combiner->lends = true;
    combiner->out[0].bytes = shared;
    combiner->out[1].bytes = combiner->out[0].bytes + first;
    return SNOW_STATUS_OK;
}

static snow_status allocate_buffers(snow_combiner *combiner,
                                    const snow_exchange_needs *need) {
    snow_context *context = combiner->comm->context;
    const bool shown = !combiner->rounds.tree || combiner->comm->rank == 0;
    bool fine = true;
    for (int i = 0; i < 2; i++) {
        fine =
            fine && replace_block(context, &combiner->in[i].bytes, need->in[i]);
        if (!combiner->lends)
            fine = fine && replace_block(context, &combiner->out[i].bytes,
                                         need->out[i]);
    }
    fine = fine && replace_block(context, &combiner->words, need->words) &&
           replace_block(context, &combiner->region, shown ? need->region : 0);
    return fine ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

/* Needs are the same on all ranks, so either all ranks call
 * snow_comm_agree_status or none does. */
snow_status snow_combiner_fit(snow_combiner *combiner) {
    snow_exchange_needs *had = &combiner->needs, need;
    size_t *now = need.bytes, *before = had->bytes;
    bool fits = true;
    count_needs(combiner, &need);
    for (int i = 0; i < SNOW_NEEDS; i++)
        fits = fits && now[i] <= before[i];
    if (fits)
        return SNOW_STATUS_OK;
    for (int i = 0; i < SNOW_NEEDS; i++) {
        /* Counted regions of the next view may be a little larger. */
        if (combiner->bounds.counted)
            now[i] += now[i] / 8;
        now[i] = more(now[i], before[i]);
    }
    SNOW_TRY(snow_traffic_await_returns(combiner));
    snow_status status = share_send_buffers(combiner, &need);
    if (status == SNOW_STATUS_OK)
        status = snow_comm_agree_status(combiner->comm,
                                        allocate_buffers(combiner, &need));
    if (status != SNOW_STATUS_OK)
        drop_buffers(combiner);
    else
        *had = need;
    return status;
}

/* --- the plan ------------------------------------------------------------- */

/* AUTO counts if messages are so large that unequal regions cost more than the
 * reduction: about 2 us for each doubling of ranks, against a tenth of the
 * picture's pixels at 12 GB/s, a third of which can be saved. */
static bool counts_regions(const snow_exchange_params *order, int ranks) {
    double bytes = (double)order->width * order->height * order->channels * 4;
    int doublings = 0;
    while (((int64_t)1 << doublings) < ranks)
        doublings++;
    if (order->method == SNOW_COMBINE_TREE || ranks < 3)
        return false;
    if (order->regions == SNOW_IMAGE_PARTITION_AUTO)
        return bytes > 720e3 * doublings;
    return order->regions == SNOW_IMAGE_PARTITION_COUNTED;
}

static snow_combine chosen_method(const snow_exchange_params *order) {
    return order->method == SNOW_COMBINE_AUTO ? SNOW_COMBINE_RADIX
                                              : order->method;
}

/* Makes a plan for the params; all ranks call it together. */
static snow_status plan_shape(snow_combiner *combiner,
                              const snow_exchange_params *order) {
    snow_comm *comm = combiner->comm;
    SNOW_TRY(snow_traffic_await_returns(combiner));
    drop_buffers(combiner);
    combiner->filled = false;
    combiner->shape = *order;
    snow_region_bounds_even(&combiner->bounds, order->width, order->height,
                            order->grain);
    combiner->bounds.counted = counts_regions(order, comm->ranks);
    snow_rounds_choose(&combiner->rounds, chosen_method(order), order->radix,
                       comm->ranks, snow_comm_ranks_per_node(comm),
                       (int64_t)order->width * order->height,
                       (size_t)order->channels * sizeof(float));
    snow_status status = snow_comm_agree_status(comm, allocate_lists(combiner));
    if (status != SNOW_STATUS_OK)
        drop_buffers(combiner);
    return status;
}

static snow_status check_params(const snow_combiner *combiner,
                                const snow_exchange_params *order) {
    snow_context *context = combiner->comm->context;
    if (order->width < 1 || order->height < 1 ||
        (order->channels != 2 &&
         (order->channels != 4 || order->composite_op != SNOW_COMPOSITE_OVER)))
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "cannot combine a picture of %d x %d pixels and %d channels: sides "
            "must be at least 1, and channels 2 or 4",
            order->width, order->height, order->channels);
    if (order->grain < 1 || order->width % order->grain != 0 ||
        order->radix < 0 || order->radix == 1)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "cannot divide the picture into regions of %d pixels by radix %d: "
            "grain must be 1 or the width, radix 0 or at least 2",
            order->grain, order->radix);
    return SNOW_STATUS_OK;
}

/* Fills in the lists for this rank's position. */
static snow_status plan_rank_order(snow_combiner *combiner,
                                   const snow_exchange_params *order) {
    snow_rounds *rounds = &combiner->rounds;
    int rank_position = -1, display = -1;
    for (int i = 0; i < rounds->rank_count; i++) {
        if (order->ranks[i] == combiner->comm->rank)
            rank_position = i;
        if (order->ranks[i] == 0)
            display = i;
    }
    if (rank_position < 0 || display < 0)
        return snow_fail(combiner->comm->context, SNOW_STATUS_BAD_USAGE,
                         "rank %d is missing in the order from front to back: "
                         "name every rank once",
                         rank_position < 0 ? combiner->comm->rank : 0);
    bool same = combiner->filled && rounds->rank_position == rank_position &&
                (rounds->display == display || !rounds->tree);
    if (!same)
        snow_rounds_fill(rounds, rank_position, display, combiner->table);
    combiner->filled = true;
    memcpy(combiner->ranks, order->ranks,
           (size_t)rounds->rank_count * sizeof *order->ranks);
    return SNOW_STATUS_OK;
}

snow_status snow_combiner_plan(snow_combiner *combiner,
                               const snow_exchange_params *order) {
    SNOW_TRY(check_params(combiner, order));
    const bool same_shape = order->width == combiner->shape.width &&
                            order->height == combiner->shape.height &&
                            order->channels == combiner->shape.channels &&
                            order->radix == combiner->shape.radix &&
                            order->grain == combiner->shape.grain &&
                            order->method == combiner->shape.method &&
                            order->regions == combiner->shape.regions;
    if (!same_shape)
        SNOW_TRY(plan_shape(combiner, order));
    combiner->loops =
        snow_pixels_pick(SNOW_ISA_AUTO, order->channels, order->composite_op);
    SNOW_TRY(plan_rank_order(combiner, order));
    combiner->figures =
        (snow_exchange_figures){.method = chosen_method(order),
                                .rounds = combiner->rounds.count,
                                .counted = combiner->bounds.counted};
    memcpy(combiner->figures.radices, combiner->rounds.radices,
           sizeof combiner->figures.radices);
    return SNOW_STATUS_OK;
}

/* --- figures -------------------------------------------------------------- */

const snow_exchange_figures *
snow_exchange_get_figures(const snow_combiner *combiner) {
    return &combiner->figures;
}
