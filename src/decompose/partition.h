/* decompose/partition.h - partitions a grid into boxes, one for each rank (SD
 * in figure 7): the paper's equal slabs, slabs with about equally many
 * interesting voxels, and bricks of them where slabs would be thin.
 *
 * The boxes cover the grid and do not overlap; a rank's may be empty.
 * Partitions are computed from counts of interesting voxels in blocks of the
 * grid, summed over all ranks: no rank needs the whole volume. They depend on
 * the counts alone, so that every rank computes the same ones; but where rays
 * are followed (ray_grid.h), which is done in floating point. */
#ifndef SNOW_DECOMPOSE_PARTITION_H
#define SNOW_DECOMPOSE_PARTITION_H

#include "base/base.h"

/* What is partitioned, and where: along `axis`, the slices' axis, only before
 * voxels borders[0] = 0, borders[1], ... borders[count] = dims[axis], which
 * rise; NULL: anywhere. The caller owns the borders. */
typedef struct snow_partition_grid {
    int64_t dims[3]; /* voxels */
    int axis;
    const int64_t *borders;
    int64_t count;
} snow_partition_grid;

/* What drawing costs, in interesting voxels, by blocks of the grid: one for
 * each of them, and `span` more for each SNOW_COST_SPAN voxels of a row of a
 * slice that hold any, since rows are drawn by so many samples at a time. */
#define SNOW_COST_SPAN 32
typedef struct snow_block_counts {
    snow_partition_grid grid;
    int span;          /* 0: interesting voxels are counted */
    int emptiness;     /* of slabs; 0: SNOW_EMPTINESS */
    int64_t step;      /* of the slices along z that are counted; 0: all are */
    int64_t block[3];  /* voxels of a block; not along an axis with borders, and
                          those at the far ends may be smaller */
    int64_t blocks[3]; /* along each axis */
    int64_t *counts;   /* x fastest; owned by the caller */
    struct snow_ray_grid *rays; /* filled together with the counts of slabs:
                          hidden slices then cost less; NULL: all cost alike */
} snow_block_counts;

/* Makes blocks for slabs, one for each slice of the axis; or for bricks of a
 * number of ranks, with enough blocks for about equal bricks and few enough
 * that all counts take at most 32 MiB. Both respect borders. Counts are not
 * set. */
snow_block_counts snow_block_counts_for_slabs(const snow_partition_grid *grid);
snow_block_counts snow_block_counts_for_bricks(const snow_partition_grid *grid,
                                               int ranks);

/* The number of blocks; the first voxel of block `n` along an axis (dims for
 * the one past the last); the block that contains a voxel. */
size_t snow_block_counts_blocks(const snow_block_counts *block_counts);
int64_t snow_block_counts_begin(const snow_block_counts *block_counts, int axis,
                                int64_t n);
int64_t snow_block_counts_find(const snow_block_counts *block_counts, int axis,
                               int64_t voxel);

/* The voxels of blocks first .. end - 1 along each axis. */
snow_box snow_block_counts_box(const snow_block_counts *block_counts,
                               const int64_t first[3], const int64_t end[3]);

/* Slabs with numbers of slices as equal as possible, or runs between borders,
 * larger ones first. */
void snow_partition_equal(const snow_partition_grid *grid, int ranks,
                          snow_box *boxes);

/* The cost of a part: its blocks', and a little for each voxel, so that no rank
 * stores everything that is empty. Those of the whole grid together cost
 * 1 / SNOW_EMPTINESS of the blocks: a part is at most SNOW_EMPTINESS + 1 times
 * as large as an equal one. */
#define SNOW_EMPTINESS 64

/* The same of slabs for methods that splat voxels, which encode all of them: in
 * the paper's volumes that is a tenth to a sixth of their time
 * (docs/measurements/ranks.md, the paper's figures). */
#define SNOW_EMPTINESS_ENCODED 8

/* Slabs whose most expensive one is as cheap as possible, from block counts for
 * slabs; none is thicker than SNOW_THICKEST equal ones. Errors:
 * SNOW_STATUS_NO_MEMORY.
 */
#define SNOW_THICKEST 4
snow_status snow_partition_counted(snow_context *context,
                                   const snow_block_counts *block_counts,
                                   int ranks, snow_box *boxes);

/* Bricks: the grid is cut in two across an axis, and so are its parts, each
 * with its share of the ranks (a k-d tree). Such boxes have an order from front
 * to back from any direction and any point. Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_partition_bricks(snow_context *context,
                                  const snow_block_counts *block_counts,
                                  int ranks, snow_box *boxes);

/* The counts of boxes that are aligned with the blocks. */
void snow_partition_loads(const snow_block_counts *block_counts,
                          const snow_box *boxes, int ranks, int64_t *loads);

#endif
