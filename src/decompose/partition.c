/* decompose/partition.c - equal slabs, counted slabs, and the common part of
 * all partitions.
 *
 * "The entire volume is partitioned into n most equal sized slabs" (section 4
 * of the paper): for a head, which is an ellipsoid, the largest load is then
 * 1.5 times the mean one. Counted slabs are the linear partition problem with
 * integer costs, so that bisection finds the optimum exactly. */
#include "decompose/partition.h"
#include "decompose/slab.h"

#include <string.h>

snow_block_counts snow_block_counts_for_slabs(const snow_partition_grid *grid) {
    snow_block_counts block_counts = {.grid = *grid, .blocks = {1, 1, 1}};
    memcpy(block_counts.block, grid->dims, sizeof block_counts.block);
    block_counts.block[grid->axis] = 1;
    block_counts.blocks[grid->axis] =
        grid->borders ? grid->count : grid->dims[grid->axis];
    return block_counts;
}

size_t snow_block_counts_blocks(const snow_block_counts *block_counts) {
    return (size_t)(block_counts->blocks[0] * block_counts->blocks[1] *
                    block_counts->blocks[2]);
}

int64_t snow_block_counts_begin(const snow_block_counts *block_counts, int axis,
                                int64_t n) {
    const snow_partition_grid *grid = &block_counts->grid;
    if (grid->borders && axis == grid->axis)
        return grid->borders[n];
    int64_t begin = n * block_counts->block[axis];
    return begin < grid->dims[axis] ? begin : grid->dims[axis];
}

int64_t snow_block_counts_find(const snow_block_counts *block_counts, int axis,
                               int64_t voxel) {
    const snow_partition_grid *grid = &block_counts->grid;
    if (!grid->borders || axis != grid->axis)
        return voxel / block_counts->block[axis];
    return snow_last_up_to(grid->borders, 0, grid->count - 1, voxel);
}

snow_box snow_block_counts_box(const snow_block_counts *block_counts,
                               const int64_t first[3], const int64_t end[3]) {
    snow_box box;
    for (int i = 0; i < 3; i++) {
        box.first[i] = snow_block_counts_begin(block_counts, i, first[i]);
        box.count[i] =
            snow_block_counts_begin(block_counts, i, end[i]) - box.first[i];
    }
    return box;
}

/* Blocks first .. end - 1 of block counts for slabs. */
static snow_box slab_box(const snow_block_counts *block_counts, int64_t first,
                         int64_t end) {
    int64_t from[3] = {0, 0, 0}, to[3] = {1, 1, 1};
    from[block_counts->grid.axis] = first;
    to[block_counts->grid.axis] = end;
    return snow_block_counts_box(block_counts, from, to);
}

void snow_partition_equal(const snow_partition_grid *grid, int ranks,
                          snow_box *boxes) {
    snow_block_counts block_counts = snow_block_counts_for_slabs(grid);
    for (int rank = 0; rank < ranks; rank++) {
        snow_slab slab =
            snow_slab_equal(block_counts.blocks[grid->axis], ranks, rank);
        boxes[rank] =
            slab_box(&block_counts, slab.first, slab.first + slab.count);
    }
}

/* --- linear partition ----------------------------------------------------- */

/* Items in a row, to be divided into runs. */
typedef struct row {
    int64_t *sums; /* sums[i]: the cost of items 0 .. i - 1 */
    int64_t items;
    int64_t longest; /* longest run allowed */
    int parts;
} row;

/* The farthest end of a run that begins at `from` and costs at most `most`. */
static int64_t reach(const row *r, int64_t from, int64_t most) {
    int64_t high = r->items;
    if (high - from > r->longest)
        high = from + r->longest;
    return snow_last_up_to(r->sums, from, high, r->sums[from] + most);
}

/* The earliest begin of a run that ends at `end` and costs at most `most`. */
static int64_t reach_back(const row *r, int64_t end, int64_t most) {
    int64_t low = end > r->longest ? end - r->longest : 0, high = end;
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (r->sums[end] - r->sums[middle] <= most)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static bool suffices(const row *r, int64_t most) {
    int64_t at = 0;
    for (int part = 0; part < r->parts && at < r->items; part++) {
        int64_t end = reach(r, at, most);
        if (end == at)
            return false;
        at = end;
    }
    return at == r->items;
}

/* Many partitions have the least cost, and runs filled completely would leave
 * nothing for the last ranks. So each border goes where it would be ideal, or
 * as near to there as the cost permits. starts[part] is first the earliest
 * border from which the parts behind it suffice. */
static void partition(const row *r, int64_t *starts) {
    /* The smallest possible cost of the most expensive run. */
    int64_t most = r->sums[r->items] / r->parts, high = r->sums[r->items];
    while (most < high) {
        int64_t middle = most + (high - most) / 2;
        if (suffices(r, middle))
            high = middle;
        else
            most = middle + 1;
    }
    starts[r->parts] = r->items;
    for (int part = r->parts - 1; part > 0; part--)
        starts[part] = reach_back(r, starts[part + 1], most);
    starts[0] = 0;
    for (int part = 1; part < r->parts; part++) {
        double ideal = (double)r->sums[r->items] / r->parts * part;
        /* The border nearest to a cost. */
        const int64_t wanted = (int64_t)ideal;
        int64_t border = snow_last_up_to(r->sums, 0, r->items, wanted);
        if (border < r->items &&
            r->sums[border + 1] - wanted < wanted - r->sums[border])
            border++;
        int64_t last = reach(r, starts[part - 1], most);
        if (border > last)
            border = last;
        if (border > starts[part])
            starts[part] = border;
        if (starts[part] < starts[part - 1])
            starts[part] = starts[part - 1];
    }
}

snow_status snow_partition_counted(snow_context *context,
                                   const snow_block_counts *block_counts,
                                   int ranks, snow_box *boxes) {
    int axis = block_counts->grid.axis;
    int64_t items = block_counts->blocks[axis], all = 0;
    const int64_t emptiness =
        block_counts->emptiness ? block_counts->emptiness : SNOW_EMPTINESS;
    int64_t *sums = NULL;
    SNOW_TRY(SNOW_RESERVE(context, sums, 0, items + 1 + ranks + 1));
    for (int64_t i = 0; i < items; i++)
        all += block_counts->counts[i];
    sums[0] = 0;
    for (int64_t i = 0; i < items; i++) {
        snow_box slab = slab_box(block_counts, i, i + 1);
        double share =
            (double)slab.count[axis] / (double)block_counts->grid.dims[axis];
        sums[i + 1] = sums[i] + emptiness * block_counts->counts[i] + 1 +
                      (int64_t)((double)all * share);
    }
    int64_t *starts = sums + items + 1;
    row r = {sums, items, SNOW_THICKEST * ((items - 1) / ranks + 1), ranks};
    partition(&r, starts);
    for (int rank = 0; rank < ranks; rank++)
        boxes[rank] = slab_box(block_counts, starts[rank], starts[rank + 1]);
    snow_release(context, sums);
    return SNOW_STATUS_OK;
}

/* --- loads ---------------------------------------------------------------- */

static int64_t load_of(const snow_block_counts *block_counts,
                       const snow_box *box) {
    int64_t first[3], last[3], load = 0;
    for (int i = 0; i < 3; i++) {
        first[i] = snow_block_counts_find(block_counts, i, box->first[i]);
        last[i] = snow_block_counts_find(block_counts, i,
                                         box->first[i] + box->count[i] - 1);
    }
    for (int64_t z = first[2]; z <= last[2]; z++)
        for (int64_t y = first[1]; y <= last[1]; y++) {
            const int64_t *counts =
                block_counts->counts +
                (z * block_counts->blocks[1] + y) * block_counts->blocks[0];
            for (int64_t x = first[0]; x <= last[0]; x++)
                load += counts[x];
        }
    return load;
}

void snow_partition_loads(const snow_block_counts *block_counts,
                          const snow_box *boxes, int ranks, int64_t *loads) {
    for (int rank = 0; rank < ranks; rank++) {
        const snow_box *box = &boxes[rank];
        loads[rank] = snow_box_voxels(box) ? load_of(block_counts, box) : 0;
    }
}
