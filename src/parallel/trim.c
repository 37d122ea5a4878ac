/* parallel/trim.c - see trim.h.
 *
 *   what ranks are cut for       what they hold
 *   +----------+----------+
 *   | . . .  : | :  . . . |           +-+-+        . air
 *   | . .  ::# | #::  . . |       +---+-+-+---+    : # what the look shows
 *   | . .  ::# | #::  . . |       |  ::#|#::  |
 *   | . . .  : | :  . . . |       +-----+-----+
 *   +----------+----------+
 *
 * The outer slabs of a volume, which take as long to draw as the inner ones,
 * are mostly air.  The look shows nothing of the values in one range, so that
 * samples between two such voxels are transparent too.  Each rank keeps the
 * bounding box of the other voxels, and layers around it for what samples
 * reach.  Of the voxels left out only the range is known afterwards; it counts
 * for the scale of values.  Another look that shows some of it, another mode
 * and views that need more layers are refused. */
#include "parallel/trim.h"

#include "classify/hidden.h"
#include "classify/shear_warp/table.h"

#include <math.h>
#include <string.h>

/* Parts stay whole unless so much of all voxels is left out. */
#define LEAST_PART 16

/* The scale of 14 bits may be an eighth longer than the range of the data. */
#define SCALE_MOST 1.125

/* Around the other voxels so many times as many layers are kept as a picture
 * needs of ghosts: for parts that are cut anew for a view that needs more. */
#define RINGS 2

typedef struct trimming {
    snow_comm *comm;
    const snow_partition_params *order;
    const snow_box *boxes;
    const snow_volume *held;
    const snow_transfer *transfer;
    int threads;
    snow_box whole, mine; /* of the grid; owned by the volume held */
    int64_t stored[3];    /* its first voxel */
    snow_left_out *left;
    snow_bounds *bounds; /* of each rank */
} trimming;

/* --- the range ------------------------------------------------------------ */

static double data_of(const trimming *t, double native) {
    return t->held->info.slope * native + t->held->info.intercept;
}

/* Collective.  The range of all stored values; *can: voxels may be left out. */
static snow_status find_stored(const trimming *t, snow_data_range *all,
                               bool *can) {
    enum { MINUS_LOW, HIGH, CANNOT, COUNT };
    const snow_volume *held = t->held;
    snow_data_range here = {.low = INFINITY, .high = -INFINITY};
    snow_status status = SNOW_STATUS_OK;
    snow_volume plain = *held; /* whose data values are those stored */
    plain.info.slope = 1;
    plain.info.intercept = 0;
    if (snow_box_voxels(&t->mine))
        status =
            snow_data_range_measure(&plain, (snow_scale){0}, t->threads, &here);
    SNOW_TRY(snow_comm_agree_status(t->comm, status));
    double words[COUNT] = {-here.low, here.high,
                           held->masked || held->clip || held->lost_clip ||
                               held->info.type == SNOW_TYPE_INT64 ||
                               held->info.type == SNOW_TYPE_UINT64};
    SNOW_TRY(snow_comm_reduce_doubles(t->comm, words, COUNT, SNOW_REDUCE_MAX));
    all->low = -words[MINUS_LOW];
    all->high = words[HIGH];
    *can = words[CANNOT] == 0 && all->low < all->high;
    return SNOW_STATUS_OK;
}

/* How many rows begin with a value of each range, and the least such one.  A
 * stop ends it, which the next pass reports. */
static void count_rows(const trimming *t, const snow_hidden_range *ranges,
                       int count, int64_t *rows, double *least) {
    const snow_box *box = &t->mine;
    const int64_t end[2] = {box->first[1] + box->count[1],
                            box->first[2] + box->count[2]};
    snow_monitor *monitor = t->held->context->monitor;
    for (int64_t z = box->first[2];
         z < end[1] && !snow_monitor_look(monitor, 0); z++)
        for (int64_t y = box->first[1]; y < end[0]; y++) {
            /* The place of a voxel among those stored. */
            const int64_t *dims = t->held->info.dims, *stored = t->stored;
            const double native = snow_volume_native(
                t->held, ((z - stored[2]) * dims[1] + y - stored[1]) * dims[0] +
                             box->first[0] - stored[0]);
            const double value = data_of(t, native);
            for (int n = 0; n < count; n++)
                if (value >= ranges[n].low && value <= ranges[n].high) {
                    rows[n]++;
                    least[n] = fmin(least[n], native);
                }
        }
}

/* Collective.  Of the ranges that the look hides that in which most rows begin,
 * as air does; none: *left stays as it is. */
static snow_status choose_range(const trimming *t, const snow_data_range *all) {
    snow_hidden_range ranges[SNOW_HIDDEN_MOST];
    int64_t rows[SNOW_HIDDEN_MOST] = {0};
    double least[SNOW_HIDDEN_MOST];
    int most = 0;
    const double range = data_of(t, all->high) - data_of(t, all->low);
    const double spare =
        SCALE_MOST * fabs(range) * SNOW_VALUE_NODE_MOST / SNOW_VALUE_MOST;
    const int count = snow_hidden_ranges(t->transfer, &t->held->info,
                                         t->order->threshold, spare, ranges);
    for (int n = 0; n < SNOW_HIDDEN_MOST; n++)
        least[n] = INFINITY;
    if (snow_box_voxels(&t->mine))
        count_rows(t, ranges, count, rows, least);
    SNOW_TRY(snow_comm_reduce_ints(t->comm, rows, SNOW_HIDDEN_MOST,
                                   SNOW_REDUCE_SUM));
    SNOW_TRY(snow_comm_reduce_doubles(t->comm, least, SNOW_HIDDEN_MOST,
                                      SNOW_REDUCE_MIN));
    for (int n = 1; n < count; n++)
        most = rows[n] > rows[most] ? n : most;
    if (!count || !rows[most])
        return SNOW_STATUS_OK;
    const double a =
        (ranges[most].low - t->held->info.intercept) / t->held->info.slope;
    const double b =
        (ranges[most].high - t->held->info.intercept) / t->held->info.slope;
    t->left->any = true;
    t->left->low = fmax(fmin(a, b), all->low);
    t->left->high = fmin(fmax(a, b), all->high);
    t->left->fill = least[most];
    t->left->spare = spare * 0.999; /* ends are rounded */
    return SNOW_STATUS_OK;
}

/* --- what is outside of it ------------------------------------------------ */

/* What is least becomes most, and the other way round. */
static void turn_firsts(const trimming *t) {
    for (int n = 0; n < t->order->ranks; n++)
        for (int i = 0; i < 3; i++)
            t->bounds[n].first[i] *= -1;
}

/* Collective.  The bounds of all boxes in what all ranks hold. */
static snow_status share_bounds(trimming *t) {
    const int ranks = t->order->ranks;
    snow_status status = SNOW_RESERVE(t->held->context, t->bounds, 0, ranks);
    if (status == SNOW_STATUS_OK)
        status = snow_bounds_find(t->held, t->left, t->boxes, ranks, t->threads,
                                  t->bounds);
    SNOW_TRY(snow_comm_agree_status(t->comm, status));
    turn_firsts(t);
    SNOW_TRY(snow_comm_reduce_ints(
        t->comm, (int64_t *)t->bounds,
        (size_t)ranks * sizeof *t->bounds / sizeof(int64_t), SNOW_REDUCE_MAX));
    turn_firsts(t);
    return SNOW_STATUS_OK;
}

static snow_box trimmed(const trimming *t, int rank) {
    const snow_bounds *b = &t->bounds[rank];
    snow_box box = {{0, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < 3 && b->last[0] >= b->first[0]; i++) {
        box.first[i] = b->first[i];
        box.count[i] = b->last[i] - b->first[i] + 1;
    }
    return snow_box_voxels(&box)
               ? snow_box_widen(&box, t->left->ring, &t->boxes[rank])
               : box;
}

/* Returns whether a part of all voxels is left out, and some are not. */
static bool is_worthwhile(const trimming *t) {
    int64_t kept = 0, all = snow_box_voxels(&t->whole);
    for (int n = 0; n < t->order->ranks; n++) {
        const snow_box box = trimmed(t, n);
        kept += snow_box_voxels(&box);
    }
    return kept > 0 && kept <= all - all / LEAST_PART;
}

/* --- the parts ------------------------------------------------------------ */

/* What was left out before is not to be had again. */
static snow_status check_rings(const trimming *t) {
    for (int i = 0; i < 3; i++)
        if (t->order->layers[i] > t->left->ring[i])
            return snow_fail(
                t->held->context, SNOW_STATUS_BAD_USAGE,
                "this view needs %lld voxels around what the look shows, but "
                "only %lld were kept when the volume was opened for one look; "
                "open it for this view, or without one_look "
                "(snow_ranks_options)",
                (long long)t->order->layers[i], (long long)t->left->ring[i]);
    return SNOW_STATUS_OK;
}

/* Collective.  Voxels that were left out may be missing when parts change
 * hands, so that no count of voxels shows whether all is there; but each of
 * them has one rank that answers for it. */
static snow_status check_boxes(const trimming *t) {
    int64_t voxels = snow_box_voxels(&t->held->left_out.box);
    const int64_t all = snow_box_voxels(&t->whole);
    SNOW_TRY(snow_comm_reduce_ints(t->comm, &voxels, 1, SNOW_REDUCE_SUM));
    if (voxels == all)
        return SNOW_STATUS_OK;
    return snow_fail(t->held->context, SNOW_STATUS_BAD_USAGE,
                     "ranks answer for %lld voxels, but the volume has %lld: "
                     "every voxel must belong to exactly one rank; open the "
                     "volume on all ranks together",
                     (long long)voxels, (long long)all);
}

/* Collective.  The range that is left out, and the layers that are kept, unless
 * they are known.  Later cuts keep as many layers as the first one. */
static snow_status find_range(const trimming *t) {
    snow_data_range all;
    bool can;
    if (t->left->any) {
        SNOW_TRY(check_boxes(t));
        return check_rings(t);
    }
    snow_hidden_range ranges[SNOW_HIDDEN_MOST];
    if (!(snow_hidden_ranges(t->transfer, &t->held->info, t->order->threshold,
                             0, ranges) > 0)) /* on no rank */
        return SNOW_STATUS_OK;
    SNOW_TRY(find_stored(t, &all, &can));
    if (can)
        SNOW_TRY(choose_range(t, &all));
    for (int i = 0; i < 3; i++)
        t->left->ring[i] = RINGS * t->order->layers[i];
    return SNOW_STATUS_OK;
}

static snow_status trim(trimming *t, snow_box *own) {
    const bool before = t->left->any;
    SNOW_TRY(find_range(t));
    if (!t->left->any)
        return SNOW_STATUS_OK;
    SNOW_TRY(share_bounds(t));
    if (before || is_worthwhile(t))
        *own = trimmed(t, snow_comm_rank(t->comm));
    else
        *t->left = (snow_left_out){.any = false};
    return SNOW_STATUS_OK;
}

snow_status snow_ranks_trim(snow_comm *comm, const snow_partition_params *order,
                            const snow_box *boxes, const snow_volume *held,
                            const snow_transfer *transfer, snow_box *own,
                            snow_left_out *left) {
    snow_extent part;
    snow_monitor monitor;
    trimming t = {.comm = comm,
                  .order = order,
                  .boxes = boxes,
                  .held = held,
                  .transfer = transfer,
                  .threads = order->threads > 1 ? order->threads : 1,
                  .left = left};
    snow_volume_find_extent(held, &part);
    memcpy(t.whole.count, order->grid.dims, sizeof t.whole.count);
    memcpy(t.mine.first, part.first, sizeof part.first);
    memcpy(t.mine.count, part.count, sizeof part.count);
    memcpy(t.stored, part.stored, sizeof part.stored);
    left->box = *own = boxes[snow_comm_rank(comm)];
    snow_partition_watch(held->context, order, &monitor);
    const snow_status status = snow_monitor_end(&monitor, trim(&t, own));
    snow_release(held->context, t.bounds);
    return status;
}
