/* decompose/bricks.c - bricks with about equally many interesting voxels, by
 * bisection: a k-d tree over blocks of the grid.
 *
 * A node has a box of blocks and some ranks. It is cut where the costs for each
 * rank of both sides are as equal as the borders of blocks permit. The number
 * of ranks of a side is free within limits, which makes the upper cuts almost
 * perfect. The remaining imbalance comes from the last cuts, of boxes few
 * blocks wide.
 *
 * The cost of a box comes from the sums of all blocks before a corner (F. C.
 * Crow, "Summed-area tables for texture mapping", SIGGRAPH 1984) with eight
 * look-ups, whatever its size. */
#include "decompose/partition.h"

#include <stdlib.h>
#include <string.h>

/* Number of blocks: for each rank, and the minimum and maximum in all. */
#define BLOCKS_A_RANK 16384
#define LEAST_BLOCKS (INT64_C(1) << 20)
#define MOST_BLOCKS (INT64_C(1) << 22)

/* An axis other than the longest must be better by this factor to be cut: long
 * thin boxes have many ghost voxels. */
#define LONGEST_BONUS 1.01

/* The same for a cut whose larger side has all ranks, not half of them. */
#define HALVES_BONUS 0.01

static bool lay_blocks(int64_t edge, int64_t most, snow_block_counts *counts) {
    const snow_partition_grid *grid = &counts->grid;
    uint64_t blocks = 1;
    for (int i = 0; i < 3; i++) {
        counts->block[i] = edge < grid->dims[i] ? edge : grid->dims[i];
        counts->blocks[i] = (grid->dims[i] - 1) / counts->block[i] + 1;
        if (grid->borders && i == grid->axis)
            counts->blocks[i] = grid->count;
        if (!snow_mul_u64(blocks, (uint64_t)counts->blocks[i], &blocks))
            return false;
    }
    return blocks <= (uint64_t)most;
}

snow_block_counts snow_block_counts_for_bricks(const snow_partition_grid *grid,
                                               int ranks) {
    snow_block_counts counts = {.grid = *grid};
    int64_t most = (int64_t)ranks * BLOCKS_A_RANK, edge = 1;
    if (most < LEAST_BLOCKS)
        most = LEAST_BLOCKS;
    if (most > MOST_BLOCKS)
        most = MOST_BLOCKS;
    while (!lay_blocks(edge, most, &counts))
        edge *= 2;
    return counts;
}

/* A box of blocks: first .. end - 1. */
typedef struct node {
    int64_t first[3], end[3];
    int rank, ranks;
} node;

/* sums[corner] is the sum of the blocks before it along all axes. */
typedef struct tree {
    const snow_block_counts *counts;
    int64_t *sums;
    size_t step[3];   /* from corner to corner */
    double emptiness; /* cost of a voxel, relative to an interesting one */
    snow_box *boxes;
} tree;

static void sum_up(tree *t) {
    const int64_t *blocks = t->counts->blocks, *count = t->counts->counts;
    t->step[0] = 1;
    t->step[1] = (size_t)blocks[0] + 1;
    t->step[2] = t->step[1] * ((size_t)blocks[1] + 1);
    memset(t->sums, 0, t->step[2] * sizeof *t->sums);
    for (int64_t z = 1; z <= blocks[2]; z++)
        for (int64_t y = 0; y <= blocks[1]; y++) {
            int64_t *row =
                t->sums + (size_t)z * t->step[2] + (size_t)y * t->step[1];
            const int64_t *before = row - t->step[2];
            int64_t sum = 0;
            memset(row, 0, t->step[1] * sizeof *row);
            for (int64_t x = 1; y && x <= blocks[0]; x++) {
                sum += *count++;
                row[x] = sum + before[x] + row[x - (int64_t)t->step[1]] -
                         before[x - (int64_t)t->step[1]];
            }
        }
}

static snow_box voxels_of(const snow_block_counts *counts, const node *n) {
    return snow_block_counts_box(counts, n->first, n->end);
}

static double cost_of(const tree *t, const node *n) {
    int64_t count = 0;
    for (int corner = 0; corner < 8; corner++) {
        size_t at = 0;
        int ends = 0;
        for (int i = 0; i < 3; i++) {
            bool end = corner >> i & 1;
            at += (size_t)(end ? n->end[i] : n->first[i]) * t->step[i];
            ends += end;
        }
        count += ends % 2 ? t->sums[at] : -t->sums[at];
    }
    snow_box box = voxels_of(t->counts, n);
    return (double)count + t->emptiness * (double)box.count[0] *
                               (double)box.count[1] * (double)box.count[2];
}

/* A cut of a node: its parts, and its badness: the larger cost for each rank
 * over the mean, with the bonuses for shape. */
typedef struct cut {
    node low, high;
    double score;
} cut;

/* Cuts before block `at` of an axis, and distributes the ranks by cost; no side
 * gets less than a third of them if there are three. */
static cut cut_at(const tree *t, const node *n, double cost, int axis,
                  int64_t at) {
    cut c = {*n, *n, 0};
    c.low.end[axis] = c.high.first[axis] = at;
    double low = cost_of(t, &c.low), high = cost - low;
    double wanted = n->ranks * (low / cost);
    int least = n->ranks > 3 ? n->ranks / 3 : 1;
    int ranks = (int)(wanted + 0.5);
    if (ranks < least)
        ranks = least;
    if (ranks > n->ranks - least)
        ranks = n->ranks - least;
    c.low.ranks = ranks;
    c.high.rank += ranks;
    c.high.ranks -= ranks;
    double a = low / ranks, b = high / c.high.ranks;
    c.score = (a > b ? a : b) * n->ranks / cost;
    c.score *= 1 + HALVES_BONUS * abs(2 * ranks - n->ranks) / n->ranks;
    return c;
}

/* The best cut of a node with at least two blocks. */
static cut best_cut(const tree *t, const node *n) {
    snow_box box = voxels_of(t->counts, n);
    double cost = cost_of(t, n);
    int longest = -1;
    cut best = {.score = 0};
    for (int axis = 0; axis < 3; axis++)
        if (n->end[axis] - n->first[axis] > 1 &&
            (longest < 0 || box.count[axis] > box.count[longest]))
            longest = axis;
    for (int i = 0; i < 3; i++) {
        int axis = (longest + i) % 3;
        double bonus = i ? LONGEST_BONUS : 1;
        for (int64_t at = n->first[axis] + 1; at < n->end[axis]; at++) {
            cut c = cut_at(t, n, cost, axis, at);
            if (best.score == 0 || c.score * bonus < best.score) {
                best = c;
                best.score *= bonus;
            }
        }
    }
    return best;
}

/* Recursive: the number of ranks shrinks by at least a third, so the depth is
 * small. A single block goes to the first of its ranks. */
static void cut_node(const tree *t, const node *n) {
    bool single = true;
    for (int i = 0; i < 3; i++)
        single = single && n->end[i] - n->first[i] == 1;
    if (n->ranks == 1 || single) {
        snow_box box = voxels_of(t->counts, n), none = box;
        memset(none.count, 0, sizeof none.count);
        for (int i = 0; i < n->ranks; i++)
            t->boxes[n->rank + i] = i ? none : box;
        return;
    }
    cut c = best_cut(t, n);
    cut_node(t, &c.low);
    cut_node(t, &c.high);
}

snow_status snow_partition_bricks(snow_context *context,
                                  const snow_block_counts *counts, int ranks,
                                  snow_box *boxes) {
    const int64_t *blocks = counts->blocks;
    tree t = {.counts = counts, .boxes = boxes};
    uint64_t corners = (uint64_t)(blocks[0] + 1) * (uint64_t)(blocks[1] + 1) *
                       (uint64_t)(blocks[2] + 1);
    SNOW_TRY(SNOW_RESERVE(context, t.sums, 0, corners));
    sum_up(&t);
    node root = {.ranks = ranks};
    memcpy(root.end, blocks, sizeof root.end);
    const int64_t *dims = counts->grid.dims;
    double voxels = (double)dims[0] * (double)dims[1] * (double)dims[2];
    int64_t all = t.sums[corners - 1];
    t.emptiness = all ? (double)all / (SNOW_EMPTINESS * voxels) : 1;
    cut_node(&t, &root);
    snow_release(context, t.sums);
    return SNOW_STATUS_OK;
}
