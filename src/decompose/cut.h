/* decompose/cut.h - a grid dealt out to ranks as boxes, one to each (SD in
 * figure 7): the paper's equal slabs, slabs of about equally many interesting
 * voxels, and bricks of them where slabs would be thin.
 *
 * The boxes cover the grid and do not overlap; a rank's may be empty.  Cuts are
 * made from counts of interesting voxels in blocks of the grid, which ranks
 * have added up: nobody needs to see the whole volume.  They are functions of
 * the counts alone, so that every rank finds the same ones. */
#ifndef SNOW_CUT_H
#define SNOW_CUT_H

#include "base/base.h"
#include "decompose/box.h"

/* What is cut, and where: along `axis`, the slices', only before voxels
 * borders[0] = 0, borders[1], ... borders[count] = dims[axis], which rise;
 * NULL: anywhere.  The borders are the caller's. */
typedef struct snow_cut_grid {
    int64_t dims[3]; /* voxels */
    int axis;
    const int64_t *borders;
    int64_t count;
} snow_cut_grid;

/* Interesting voxels, counted by blocks of the grid. */
typedef struct snow_tally {
    snow_cut_grid grid;
    int64_t block[3];  /* voxels of a block; not along an axis with borders,
                          and those at the far ends may be smaller */
    int64_t blocks[3]; /* along each axis */
    int64_t *counts;   /* x fastest; the caller's */
} snow_tally;

/* Lays blocks for slabs along the slices' axis, a slice each; or for bricks of
 * so many ranks, so many blocks that bricks come out about equal and so few
 * that the counts of all take 32 MiB at most.  Borders are heeded by both.  No
 * counts yet. */
snow_tally snow_tally_for_slabs(const snow_cut_grid *grid);
snow_tally snow_tally_for_bricks(const snow_cut_grid *grid, int ranks);

/* How many blocks in all; the first voxel of block `n` along an axis (dims for
 * the one past the last); the block that a voxel lies in. */
size_t snow_tally_blocks(const snow_tally *tally);
int64_t snow_tally_begin(const snow_tally *tally, int axis, int64_t n);
int64_t snow_tally_find(const snow_tally *tally, int axis, int64_t voxel);

/* The voxels of blocks first .. end - 1 along each axis. */
snow_box snow_tally_box(const snow_tally *tally, const int64_t first[3],
                        const int64_t end[3]);

/* Slabs of as equally many slices as can be, or runs between borders, larger
 * ones first. */
void snow_cut_equal(const snow_cut_grid *grid, int ranks, snow_box *boxes);

/* What a part costs: its interesting voxels, and a little for all its voxels,
 * so that no rank stores all that is empty.  Those of the whole grid together
 * cost 1 / SNOW_EMPTINESS of what the interesting ones do: a part is at most
 * SNOW_EMPTINESS + 1 times as large as an equal one. */
#define SNOW_EMPTINESS 64

/* Slabs whose most expensive one is as cheap as can be, from a tally for them;
 * none is thicker than SNOW_THICKEST equal ones.  Errors: SNOW_NO_MEMORY. */
#define SNOW_THICKEST 4
snow_status snow_cut_counted(snow_context *context, const snow_tally *tally,
                             int ranks, snow_box *boxes);

/* Bricks: the grid is cut in two across an axis, and so are its parts, each
 * with its share of the ranks (a k-d tree).  From every direction, and from
 * every point, such boxes have an order from front to back.
 * Errors: SNOW_NO_MEMORY. */
snow_status snow_cut_bricks(snow_context *context, const snow_tally *tally,
                            int ranks, snow_box *boxes);

/* The interesting voxels of boxes that lie on the borders of blocks. */
void snow_cut_loads(const snow_tally *tally, const snow_box *boxes, int ranks,
                    int64_t *loads);

/* The largest load over the mean one: how much longer all ranks take than if
 * each had as much; 1 where there is nothing. */
double snow_cut_imbalance(const int64_t *loads, int ranks);

#endif
