/* parallel/partition.c - from a picture and a number of ranks to boxes. */
#include "parallel/partition.h"

#include "classify/count_interesting.h"
#include "render/ghosts.h"
#include "render/job.h"
#include "simd/isa.h"
#include "volume/stream.h"

#include <string.h>

/* Slabs of fewer slices on the average are too coarse to be made equal. */
#define LEAST_SLICES 3

/* What a span of a row costs to be drawn, in interesting voxels (measured:
 * docs/measurements/ranks.md). */
#define COST_OF_SPAN 24

/* About so many slices of a volume that has more are counted: slabs by those
 * of a step are as equal. */
#define SLICES_COUNTED 256

SNOW_RECORD_OF_ZEROS(snow_ranks_options);

/* By count, but for one rank, which has all, and for the method that splats
 * every voxel. */
static snow_partition choose_partition(const snow_partition_params *order,
                                       snow_method method) {
    int64_t slices = order->grid.dims[order->grid.axis];
    if (method == SNOW_METHOD_ORIGINAL)
        return SNOW_PARTITION_EQUAL;
    if (order->slabs_only || order->ranks <= slices / LEAST_SLICES)
        return SNOW_PARTITION_COUNTED;
    return SNOW_PARTITION_BRICKS;
}

/* The groups that have slices, which come first. */
static void set_borders(snow_partition_params *order) {
    snow_partition_grid *grid = &order->grid;
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

/* Pixels end only where colours are composited. */
static void set_rays(const snow_placement *p, const snow_settings *resolved,
                     snow_partition_params *out) {
    out->hides = resolved->method == SNOW_METHOD_SHEAR_WARP &&
                 resolved->mode == SNOW_MODE_OVER && !resolved->deterministic;
    out->rays = (snow_ray_view){.axes = {p->u_axis, p->v_axis, p->slice_axis},
                                .path = p->path / resolved->opacity_length,
                                .nearest_first = p->nearest_first};
    for (int n = 0; n < 2; n++)
        out->rays.slope[n] = -p->inverse[n][0] * p->step_slice[0] -
                             p->inverse[n][1] * p->step_slice[1];
}

snow_status
snow_partition_params_make(snow_context *context, const snow_volume_info *whole,
                           const snow_view *view, const snow_settings *settings,
                           const snow_ranks_options *asked, int slopes,
                           int ranks, snow_partition_params *out) {
    snow_view known;
    snow_ranks_options how;
    snow_settings resolved;
    snow_placement placement;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &known));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_ranks_options, asked, &how));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_settings, settings, &resolved));
    const snow_settings unresolved = resolved;
    bool chooses = how.cut == SNOW_PARTITION_AUTO;
    if (how.cut < SNOW_PARTITION_AUTO || how.cut > SNOW_PARTITION_BRICKS)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "invalid partition %d; use a value of snow_partition",
                         how.cut);
    SNOW_TRY(snow_settings_resolve(context, whole, &resolved));
    SNOW_TRY(snow_placement_make(context, whole, &known, &placement));
    *out = (snow_partition_params){.ranks = ranks,
                                   .grid = {.axis = placement.slice_axis},
                                   .threshold = resolved.threshold,
                                   .isa = resolved.isa,
                                   .threads = resolved.threads,
                                   .stop = resolved.stop,
                                   .stop_user = resolved.stop_user};
    if (resolved.method == SNOW_METHOD_SHEAR_WARP)
        out->span = COST_OF_SPAN;
    set_rays(&placement, &resolved, out);
    memcpy(out->grid.dims, whole->dims, sizeof out->grid.dims);
    SNOW_TRY(snow_ghosts_needed(context, whole, &known, &unresolved, slopes,
                                how.turns, out->layers));
    if (resolved.deterministic)
        set_borders(out);
    /* Groups of slices are laid over one another as such. */
    out->slabs_only = resolved.deterministic ||
                      how.cut == SNOW_PARTITION_EQUAL ||
                      how.cut == SNOW_PARTITION_COUNTED;
    out->cut = chooses ? choose_partition(out, resolved.method) : how.cut;
    /* In perspective what samples reach depends on the camera. */
    out->trims = how.one_look && out->cut != SNOW_PARTITION_EQUAL &&
                 !(known.fov > 0) && snow_can_lack_voxels(&resolved);
    if (out->cut == SNOW_PARTITION_BRICKS && resolved.deterministic) {
        snow_notify(context, "bricks cannot share a deterministic picture; "
                             "slabs are cut");
        out->cut = SNOW_PARTITION_COUNTED;
    }
    return SNOW_STATUS_OK;
}

void snow_partition_watch(snow_context *context,
                          const snow_partition_params *order,
                          snow_monitor *monitor) {
    snow_monitor_begin(context, monitor, order->stop, order->stop_user);
    monitor->last = SNOW_STAGE_READ;
}

/* What is counted of slabs. */
typedef struct counting {
    const snow_partition_params *order;
    const snow_transfer *transfer;
    snow_block_counts *counts;
} counting;

/* Blocks of slabs are few enough for counts of each thread. */
static snow_status count_slab(const snow_volume *slab, void *user) {
    const counting *c = user;
    const int threads =
        c->order->cut == SNOW_PARTITION_COUNTED ? c->order->threads : 1;
    return snow_count_interesting_blocks(slab, c->transfer, c->order->threshold,
                                         c->order->isa,
                                         threads > 1 ? threads : 1, c->counts);
}

/* A slice that was not counted costs what the nearest one does that was. */
static void fill_steps(snow_block_counts *counts) {
    const int64_t step = counts->step, last = counts->blocks[2] - 1;
    for (int64_t z = 0; z <= last; z++) {
        const int64_t near = (z + step / 2) / step * step;
        counts->counts[z] =
            counts->counts[near <= last ? near : last / step * step];
    }
}

/* Zeros, which are counted up. */
static snow_status clear_counts(snow_context *context,
                                snow_block_counts *counts) {
    const size_t blocks = snow_block_counts_blocks(counts);
    SNOW_TRY(SNOW_RESERVE(context, counts->counts, 0, blocks));
    memset(counts->counts, 0, blocks * sizeof *counts->counts);
    if (!counts->rays)
        return SNOW_STATUS_OK;
    const size_t cells = snow_ray_grid_cells(counts->rays);
    SNOW_TRY(SNOW_RESERVE(context, counts->rays->sums, 0, cells));
    memset(counts->rays->sums, 0, cells * sizeof *counts->rays->sums);
    return SNOW_STATUS_OK;
}

static snow_status add_counts(snow_comm *comm, snow_block_counts *counts) {
    SNOW_TRY(snow_comm_reduce_ints(comm, counts->counts,
                                   snow_block_counts_blocks(counts),
                                   SNOW_REDUCE_SUM));
    return counts->rays
               ? snow_comm_reduce_ints(comm, counts->rays->sums,
                                       snow_ray_grid_cells(counts->rays),
                                       SNOW_REDUCE_SUM)
               : SNOW_STATUS_OK;
}

/* What the volume answers for. */
static snow_status count_own(const snow_partition_params *order,
                             const snow_volume *volume,
                             const snow_transfer *transfer,
                             snow_block_counts *counts) {
    const snow_slab_cut cut = {
        .ghosts = transfer && snow_transfer_has_gradient_opacity(transfer)};
    counting c = {order, transfer, counts};
    snow_monitor monitor;
    SNOW_TRY(clear_counts(volume->context, counts));
    snow_partition_watch(volume->context, order, &monitor);
    return snow_monitor_end(&monitor,
                            snow_slabs_visit(volume, &cut, count_slab, &c));
}

/* Collective.  Local counts become those of all ranks. */
static snow_status count_all(snow_comm *comm,
                             const snow_partition_params *order,
                             const snow_volume *volume,
                             const snow_transfer *transfer,
                             snow_block_counts *counts) {
    counts->span = order->span;
    counts->emptiness = order->span ? SNOW_EMPTINESS : SNOW_EMPTINESS_ENCODED;
    snow_status status = count_own(order, volume, transfer, counts);
    if (comm) {
        SNOW_TRY(snow_comm_agree_status(comm, status));
        status = add_counts(comm, counts);
    }
    if (status == SNOW_STATUS_OK && counts->step > 1 && counts->grid.axis == 2)
        fill_steps(counts);
    return status;
}

static snow_status count_for_partition(snow_context *context,
                                       const snow_partition_params *order,
                                       const snow_block_counts *counts,
                                       snow_box *boxes) {
    if (order->cut == SNOW_PARTITION_COUNTED && counts->rays)
        return snow_partition_by_rays(context, counts, order->ranks, boxes);
    if (order->cut == SNOW_PARTITION_COUNTED)
        return snow_partition_counted(context, counts, order->ranks, boxes);
    if (order->cut == SNOW_PARTITION_BRICKS)
        return snow_partition_bricks(context, counts, order->ranks, boxes);
    snow_partition_equal(&order->grid, order->ranks, boxes);
    return SNOW_STATUS_OK;
}

/* Collective.  Rays are followed in floating point, which may differ between
 * machines: all ranks take the first one's boxes. */
static snow_status share_boxes(snow_comm *comm,
                               const snow_partition_params *order,
                               snow_status status, snow_box *boxes) {
    SNOW_TRY(snow_comm_agree_status(comm, status));
    if (!order->hides || order->cut != SNOW_PARTITION_COUNTED)
        return SNOW_STATUS_OK;
    return snow_comm_broadcast(comm, boxes,
                               (size_t)order->ranks * sizeof *boxes, 0);
}

snow_status snow_partition_boxes(snow_comm *comm,
                                 const snow_partition_params *order,
                                 const snow_volume *volume,
                                 const snow_transfer *transfer, snow_box *boxes,
                                 int64_t *loads) {
    if (order->cut == SNOW_PARTITION_EQUAL && !loads) {
        snow_partition_equal(&order->grid, order->ranks, boxes);
        return SNOW_STATUS_OK;
    }
    snow_block_counts counts =
        order->cut == SNOW_PARTITION_BRICKS
            ? snow_block_counts_for_bricks(&order->grid, order->ranks)
            : snow_block_counts_for_slabs(&order->grid);
    /* Slices of slabs are like those beside them; blocks have no slice to
     * spare. */
    const int64_t step = order->grid.dims[2] / SLICES_COUNTED;
    const bool slabs =
        order->cut == SNOW_PARTITION_COUNTED && !order->grid.borders;
    counts.step = slabs && step > 1 ? step : 1;
    snow_ray_grid rays;
    if (order->hides && order->cut == SNOW_PARTITION_COUNTED) {
        snow_ray_grid_make(&order->rays, order->grid.dims, counts.step, &rays);
        counts.rays = &rays;
    }
    snow_status status = count_all(comm, order, volume, transfer, &counts);
    if (status == SNOW_STATUS_OK)
        status = count_for_partition(volume->context, order, &counts, boxes);
    if (comm)
        status = share_boxes(comm, order, status, boxes);
    if (counts.rays)
        snow_release(volume->context, rays.sums);
    counts.rays = NULL;
    if (loads && counts.step > 1) {
        counts.step = 1;
        if (status == SNOW_STATUS_OK)
            status = count_all(comm, order, volume, transfer, &counts);
    }
    if (status == SNOW_STATUS_OK && loads)
        snow_partition_loads(&counts, boxes, order->ranks, loads);
    snow_release(volume->context, counts.counts);
    return status;
}

snow_status snow_ranks_partition(const snow_volume *volume,
                                 const snow_transfer *transfer,
                                 double threshold, snow_partition cut,
                                 int slice_axis, int ranks, snow_box *parts,
                                 int64_t *loads) {
    snow_context *context = volume->context;
    if (ranks < 1 || slice_axis < 0 || slice_axis > 2 ||
        cut < SNOW_PARTITION_AUTO || cut > SNOW_PARTITION_BRICKS)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "invalid partition %d for %d ranks along axis %d; use a value of "
            "snow_partition, at least one rank, and axis 0 to 2",
            cut, ranks, slice_axis);
    const int64_t *dims = volume->info.dims;
    snow_partition_params order = {
        .ranks = ranks,
        .grid = {.dims = {dims[0], dims[1], dims[2]}, .axis = slice_axis},
        .threshold = threshold,
        .isa = snow_isa_resolve(SNOW_ISA_AUTO)};
    order.cut = cut ? cut : choose_partition(&order, SNOW_METHOD_SHEAR_WARP);
    snow_box *boxes = NULL;
    SNOW_TRY(SNOW_RESERVE(context, boxes, 0, ranks));
    snow_status status =
        snow_partition_boxes(NULL, &order, volume, transfer, boxes, loads);
    if (parts && status == SNOW_STATUS_OK)
        memcpy(parts, boxes, (size_t)ranks * sizeof *boxes);
    snow_release(context, boxes);
    return status;
}
