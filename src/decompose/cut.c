/* decompose/cut.c - equal slabs, counted slabs, and what holds for all cuts.
 *
 * "The entire volume is partitioned into n most equal sized slabs" (section 4
 * of the paper): of a head, which is an ellipsoid, the largest load is then 1.5
 * times the mean one.  Counted slabs are the linear partition problem, with
 * costs in whole numbers, so that the optimum is found exactly by halving its
 * range. */
#include "decompose/cut.h"
#include "decompose/slab.h"

#include <string.h>

static int64_t blocks_of(int64_t voxels, int64_t block) {
    return (voxels - 1) / block + 1;
}

snow_tally snow_tally_for_slabs(const int64_t dims[3], int axis,
                                int64_t multiple) {
    snow_tally tally = {.blocks = {1, 1, 1}};
    memcpy(tally.dims, dims, sizeof tally.dims);
    memcpy(tally.block, dims, sizeof tally.block);
    tally.block[axis] = multiple < dims[axis] ? multiple : dims[axis];
    tally.blocks[axis] = blocks_of(dims[axis], tally.block[axis]);
    return tally;
}

size_t snow_tally_blocks(const snow_tally *tally) {
    return (size_t)(tally->blocks[0] * tally->blocks[1] * tally->blocks[2]);
}

/* The box of `count` blocks along an axis from block `first` on. */
static void set_blocks(const snow_tally *tally, int axis, int64_t first,
                       int64_t count, snow_box *box) {
    int64_t begin = first * tally->block[axis];
    int64_t end = (first + count) * tally->block[axis];
    box->first[axis] = begin < tally->dims[axis] ? begin : tally->dims[axis];
    box->count[axis] =
        (end < tally->dims[axis] ? end : tally->dims[axis]) - box->first[axis];
}

static snow_box slab_box(const snow_tally *tally, int axis, int64_t first,
                         int64_t count) {
    snow_box box = {{0, 0, 0}, {0, 0, 0}};
    memcpy(box.count, tally->dims, sizeof box.count);
    set_blocks(tally, axis, first, count, &box);
    return box;
}

void snow_cut_equal(const int64_t dims[3], int axis, int64_t multiple,
                    int ranks, snow_box *boxes) {
    snow_tally tally = snow_tally_for_slabs(dims, axis, multiple);
    for (int rank = 0; rank < ranks; rank++) {
        snow_slab slab = snow_slab_equal(tally.blocks[axis], ranks, rank);
        boxes[rank] = slab_box(&tally, axis, slab.first, slab.count);
    }
}

/* --- linear partition ----------------------------------------------------- */

/* The farthest end of a run that begins at `from` and costs at most `most`:
 * sums[i] is the cost of items 0 .. i - 1. */
static int64_t reach(const int64_t *sums, int64_t items, int64_t from,
                     int64_t most) {
    int64_t low = from, high = items;
    while (low < high) {
        int64_t middle = high - (high - low) / 2;
        if (sums[middle] - sums[from] <= most)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

static bool suffices(const int64_t *sums, int64_t items, int parts,
                     int64_t most) {
    int64_t at = 0;
    for (int part = 0; part < parts && at < items; part++) {
        int64_t end = reach(sums, items, at, most);
        if (end == at)
            return false;
        at = end;
    }
    return at == items;
}

/* The smallest cost that the most expensive of `parts` runs can have. */
static int64_t least_cost(const int64_t *sums, int64_t items, int parts) {
    int64_t low = sums[items] / parts, high = sums[items];
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (suffices(sums, items, parts, middle))
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Where the last of those runs begins that ends at `end`. */
static int64_t reach_back(const int64_t *sums, int64_t end, int64_t most) {
    int64_t low = 0, high = end;
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (sums[end] - sums[middle] <= most)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* The border nearest to a cost. */
static int64_t nearest(const int64_t *sums, int64_t items, int64_t wanted) {
    int64_t at = reach(sums, items, 0, wanted);
    if (at < items && sums[at + 1] - wanted < wanted - sums[at])
        at++;
    return at;
}

/* Many partitions have the least cost, and runs filled to the brim would leave
 * nothing for the last ranks: each border goes where it would be ideal, or as
 * near to there as the cost allows.  starts[part] is first the earliest
 * border from which the parts behind it suffice. */
static void partition(const int64_t *sums, int64_t items, int parts,
                      int64_t *starts) {
    int64_t most = least_cost(sums, items, parts);
    starts[parts] = items;
    for (int part = parts - 1; part > 0; part--)
        starts[part] = reach_back(sums, starts[part + 1], most);
    starts[0] = 0;
    for (int part = 1; part < parts; part++) {
        double ideal = (double)sums[items] / parts * part;
        int64_t border = nearest(sums, items, (int64_t)ideal);
        int64_t last = reach(sums, items, starts[part - 1], most);
        if (border > last)
            border = last;
        if (border > starts[part])
            starts[part] = border;
        if (starts[part] < starts[part - 1])
            starts[part] = starts[part - 1];
    }
}

snow_status snow_cut_counted(snow_context *context, const snow_tally *tally,
                             int axis, int ranks, snow_box *boxes) {
    int64_t items = tally->blocks[axis], all = 0;
    int64_t *sums = snow_allocate_array(
        context, (uint64_t)items + 1 + (uint64_t)ranks + 1, sizeof *sums);
    if (!sums)
        return SNOW_NO_MEMORY;
    for (int64_t i = 0; i < items; i++)
        all += tally->counts[i];
    sums[0] = 0;
    for (int64_t i = 0; i < items; i++) {
        snow_box slab = slab_box(tally, axis, i, 1);
        double share = (double)slab.count[axis] / (double)tally->dims[axis];
        sums[i + 1] = sums[i] + SNOW_EMPTINESS * tally->counts[i] + 1 +
                      (int64_t)((double)all * share);
    }
    int64_t *starts = sums + items + 1;
    partition(sums, items, ranks, starts);
    for (int rank = 0; rank < ranks; rank++)
        boxes[rank] = slab_box(tally, axis, starts[rank],
                               starts[rank + 1] - starts[rank]);
    snow_release(context, sums);
    return SNOW_OK;
}

/* --- loads ---------------------------------------------------------------- */

void snow_cut_loads(const snow_tally *tally, const snow_box *boxes, int ranks,
                    int64_t *loads) {
    for (int rank = 0; rank < ranks; rank++) {
        int64_t first[3], end[3], load = 0;
        for (int i = 0; i < 3; i++) {
            first[i] = boxes[rank].first[i] / tally->block[i];
            end[i] = first[i] + (boxes[rank].count[i] + tally->block[i] - 1) /
                                    tally->block[i];
        }
        for (int64_t z = first[2]; z < end[2]; z++)
            for (int64_t y = first[1]; y < end[1]; y++)
                for (int64_t x = first[0]; x < end[0]; x++)
                    load += tally->counts[(z * tally->blocks[1] + y) *
                                              tally->blocks[0] +
                                          x];
        loads[rank] = snow_box_voxels(&boxes[rank]) ? load : 0;
    }
}

double snow_cut_imbalance(const int64_t *loads, int ranks) {
    double sum = 0, most = 0;
    for (int rank = 0; rank < ranks; rank++) {
        sum += (double)loads[rank];
        if ((double)loads[rank] > most)
            most = (double)loads[rank];
    }
    return sum > 0 ? most * ranks / sum : 1;
}
