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

/* Interesting voxels, counted by blocks of the grid.  Those at the far ends
 * may be smaller than the others. */
typedef struct snow_tally {
    int64_t dims[3];   /* of the grid, voxels */
    int64_t block[3];  /* of a block, voxels */
    int64_t blocks[3]; /* along each axis */
    int64_t *counts;   /* x fastest; the caller's */
} snow_tally;

/* Lays blocks for slabs along `axis`, one for each `multiple` slices; or for
 * bricks of so many ranks, whose cuts along `axis` are to lie at multiples of
 * `multiple` as well, so many that bricks come out about equal and so few that
 * the counts of all take 32 MiB at most.  No counts yet. */
snow_tally snow_tally_for_slabs(const int64_t dims[3], int axis,
                                int64_t multiple);
snow_tally snow_tally_for_bricks(const int64_t dims[3], int axis,
                                 int64_t multiple, int ranks);

/* How many blocks. */
size_t snow_tally_blocks(const snow_tally *tally);

/* Slabs as equal as can be along an axis, larger ones first, cut at multiples
 * of `multiple`. */
void snow_cut_equal(const int64_t dims[3], int axis, int64_t multiple,
                    int ranks, snow_box *boxes);

/* What a part costs: its interesting voxels, and a little for all its voxels,
 * so that no rank stores all that is empty.  Those of the whole grid together
 * cost 1 / SNOW_EMPTINESS of what the interesting ones do: a part is at most
 * SNOW_EMPTINESS + 1 times as large as an equal one, and the interesting voxels
 * are as unequal as 1 : 1 + 1 / SNOW_EMPTINESS for it. */
#define SNOW_EMPTINESS 32

/* Slabs along an axis whose most expensive one is as cheap as can be; the
 * tally's blocks span the others.  Errors: SNOW_NO_MEMORY. */
snow_status snow_cut_counted(snow_context *context, const snow_tally *tally,
                             int axis, int ranks, snow_box *boxes);

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
