/* ranks_cut.c - from a picture and a number of ranks to boxes. */
#include "ranks_cut.h"

#include "classify/tally.h"
#include "frame.h"
#include "ghosts.h"
#include "simd/isa.h"

#include <string.h>

/* Slabs of fewer slices on the average are too coarse to be made equal. */
#define LEAST_SLICES 5

snow_ranks_options snow_ranks_options_known(const snow_ranks_options *how) {
    snow_ranks_options known = {0};
    size_t size = how ? how->size : 0;
    if (size > 0)
        memcpy(&known, how, size < sizeof known ? size : sizeof known);
    return known;
}

/* By count, but for one rank, which has all, and for the method that splats
 * every voxel. */
static snow_cut choose_cut(const snow_cut_order *order, snow_method method) {
    int64_t slices = order->grid.dims[order->grid.axis];
    if (method == SNOW_METHOD_ORIGINAL)
        return SNOW_CUT_EQUAL;
    if (order->slabs_only || order->ranks <= slices / LEAST_SLICES)
        return SNOW_CUT_COUNTED;
    return SNOW_CUT_BRICKS;
}

/* The groups that have slices, which come first. */
static void set_borders(snow_cut_order *order) {
    snow_cut_grid *grid = &order->grid;
    int64_t slices = grid->dims[grid->axis];
    for (int group = 0; group < SNOW_GROUPS; group++) {
        snow_slab slab = snow_group_slab(slices, group);
        if (!slab.count)
            break;
        order->borders[grid->count++] = slab.first;
    }
    order->borders[grid->count] = slices;
    grid->borders = order->borders;
}

snow_status snow_cut_order_make(snow_context *context,
                                const snow_volume_info *whole,
                                const snow_view *view,
                                const snow_settings *settings,
                                const snow_ranks_options *asked, bool fades,
                                int ranks, snow_cut_order *out) {
    snow_ranks_options how = snow_ranks_options_known(asked);
    snow_settings resolved = snow_settings_known(settings);
    snow_placement placement;
    bool chooses = how.cut == SNOW_CUT_AUTO || how.cut == SNOW_CUT_MEASURED;
    if (how.cut < SNOW_CUT_AUTO || how.cut > SNOW_CUT_MEASURED)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "cut %d is none; take a value of snow_cut", how.cut);
    SNOW_TRY(snow_settings_resolve(context, whole, &resolved));
    SNOW_TRY(snow_placement_make(context, whole, view, &placement));
    *out = (snow_cut_order){.ranks = ranks,
                            .grid = {.axis = placement.slice_axis},
                            .threshold = resolved.threshold,
                            .isa = resolved.isa};
    memcpy(out->grid.dims, whole->dims, sizeof out->grid.dims);
    SNOW_TRY(snow_ghosts_needed(context, whole, view, settings, fades,
                                how.turns, out->layers));
    if (resolved.deterministic)
        set_borders(out);
    /* Groups of slices are laid over one another as such. */
    out->slabs_only = resolved.deterministic || how.cut == SNOW_CUT_EQUAL ||
                      how.cut == SNOW_CUT_COUNTED;
    out->cut = chooses ? choose_cut(out, resolved.method) : how.cut;
    if (out->cut == SNOW_CUT_BRICKS && resolved.deterministic) {
        snow_notify(context, "bricks cannot share a deterministic picture; "
                             "slabs are cut");
        out->cut = SNOW_CUT_COUNTED;
    }
    return SNOW_OK;
}

/* Collective.  Local counts become those of all ranks. */
static snow_status count_all(snow_comm *comm, const snow_cut_order *order,
                             const snow_volume *volume,
                             const snow_transfer *transfer, snow_tally *tally) {
    size_t blocks = snow_tally_blocks(tally);
    snow_status status = SNOW_NO_MEMORY;
    tally->counts =
        snow_allocate_array(volume->context, blocks, sizeof *tally->counts);
    if (tally->counts) {
        memset(tally->counts, 0, blocks * sizeof *tally->counts);
        status = snow_tally_count(volume, transfer, order->threshold,
                                  order->isa, tally);
    }
    if (!comm)
        return status;
    SNOW_TRY(snow_comm_agree(comm, status));
    return snow_comm_reduce_ints(comm, tally->counts, blocks, SNOW_SUM);
}

static snow_status cut_tally(snow_context *context, const snow_cut_order *order,
                             const snow_tally *tally, snow_box *boxes) {
    if (order->cut == SNOW_CUT_COUNTED)
        return snow_cut_counted(context, tally, order->ranks, boxes);
    if (order->cut == SNOW_CUT_BRICKS)
        return snow_cut_bricks(context, tally, order->ranks, boxes);
    snow_cut_equal(&order->grid, order->ranks, boxes);
    return SNOW_OK;
}

snow_status snow_cut_boxes(snow_comm *comm, const snow_cut_order *order,
                           const snow_volume *volume,
                           const snow_transfer *transfer, snow_box *boxes,
                           int64_t *loads) {
    if (order->cut == SNOW_CUT_EQUAL && !loads) {
        snow_cut_equal(&order->grid, order->ranks, boxes);
        return SNOW_OK;
    }
    snow_tally tally = order->cut == SNOW_CUT_BRICKS
                           ? snow_tally_for_bricks(&order->grid, order->ranks)
                           : snow_tally_for_slabs(&order->grid);
    snow_status status = count_all(comm, order, volume, transfer, &tally);
    if (status == SNOW_OK)
        status = cut_tally(volume->context, order, &tally, boxes);
    if (status == SNOW_OK && loads)
        snow_cut_loads(&tally, boxes, order->ranks, loads);
    snow_release(volume->context, tally.counts);
    return comm ? snow_comm_agree(comm, status) : status;
}

int64_t snow_cut_slices(const snow_cut_order *order) {
    return snow_tally_for_slabs(&order->grid).blocks[order->grid.axis];
}

snow_status snow_cut_count(snow_comm *comm, const snow_cut_order *order,
                           const snow_volume *volume,
                           const snow_transfer *transfer, double *costs) {
    snow_tally tally = snow_tally_for_slabs(&order->grid);
    snow_status status = count_all(comm, order, volume, transfer, &tally);
    for (size_t n = 0; n < snow_tally_blocks(&tally) && status == SNOW_OK; n++)
        costs[n] = (double)tally.counts[n];
    snow_release(volume->context, tally.counts);
    return status;
}

/* What all costs become together in whole numbers. */
#define COST_OF_ALL 0x1p40

snow_status snow_cut_costs(snow_context *context, const snow_cut_order *order,
                           const double *costs, snow_box *boxes) {
    snow_tally tally = snow_tally_for_slabs(&order->grid);
    size_t slices = snow_tally_blocks(&tally);
    double sum = 0;
    tally.counts = snow_allocate_array(context, slices, sizeof *tally.counts);
    if (!tally.counts)
        return SNOW_NO_MEMORY;
    for (size_t n = 0; n < slices; n++)
        sum += costs[n];
    for (size_t n = 0; n < slices; n++)
        tally.counts[n] =
            sum > 0 ? (int64_t)(costs[n] / sum * COST_OF_ALL + 0.5) : 0;
    snow_status status = snow_cut_counted(context, &tally, order->ranks, boxes);
    snow_release(context, tally.counts);
    return status;
}

snow_status snow_ranks_plan(const snow_volume *volume,
                            const snow_transfer *transfer, double threshold,
                            snow_cut cut, int slice_axis, int ranks,
                            snow_part *parts, int64_t *loads) {
    snow_context *context = volume->context;
    if (ranks < 1 || slice_axis < 0 || slice_axis > 2 || cut < SNOW_CUT_AUTO ||
        cut > SNOW_CUT_BRICKS)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "cut %d for %d ranks along axis %d is none; take a "
                         "value of snow_cut, at least one rank, and axis 0 to "
                         "2",
                         cut, ranks, slice_axis);
    const int64_t *dims = volume->info.dims;
    snow_cut_order order = {
        .ranks = ranks,
        .grid = {.dims = {dims[0], dims[1], dims[2]}, .axis = slice_axis},
        .threshold = threshold,
        .isa = snow_isa_resolve(SNOW_ISA_AUTO)};
    order.cut = cut ? cut : choose_cut(&order, SNOW_METHOD_SHEARED);
    snow_box *boxes =
        snow_allocate_array(context, (uint64_t)ranks, sizeof *boxes);
    if (!boxes)
        return SNOW_NO_MEMORY;
    snow_status status =
        snow_cut_boxes(NULL, &order, volume, transfer, boxes, loads);
    for (int rank = 0; rank < ranks && parts && status == SNOW_OK; rank++) {
        memcpy(parts[rank].dims, dims, sizeof parts[rank].dims);
        memcpy(parts[rank].stored, boxes[rank].first,
               sizeof parts[rank].stored);
        memcpy(parts[rank].first, boxes[rank].first, sizeof parts[rank].first);
        memcpy(parts[rank].count, boxes[rank].count, sizeof parts[rank].count);
    }
    snow_release(context, boxes);
    return status;
}
