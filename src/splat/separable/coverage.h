/* splat/separable/coverage.h - which part of a slice's kernels is inside the
 * grid.
 *
 * Pixel n of one phase sums the voxels start + n * stride + m with weights[m],
 * m = 0 .. taps - 1 (splat/separable/comb.h).  In a grid without holes the sum
 * of the weights inside depends on n alone, and is 1 except at the ends:
 *
 *   weights    0  .2  .8  1   1   1   1  .8  .2  0
 *   pixel n       from    in             out     to */
#ifndef SNOW_SPLAT_SEPARABLE_COVERAGE_H
#define SNOW_SPLAT_SEPARABLE_COVERAGE_H

#include "splat/separable/comb.h"

typedef struct snow_coverage {
    int64_t start;
    int stride, taps;
    const float *weights;
    int64_t voxels;
    /* Pixels from .. to - 1 reach a voxel; in .. out - 1 reach all of theirs.
     * Thin grids have in > out. */
    int from, in, out, to;
} snow_coverage;

/* The coverage of one phase of a comb: `first` is the first voxel of pixel 0,
 * without the phase's lead; there are `pixels` pixels. */
snow_coverage snow_coverage_make(const snow_comb *comb, int phase, int taps,
                                 int64_t first, int stride, int64_t voxels,
                                 int pixels);

/* The sum of the weights that pixel n finds inside the grid, 0 to 1. */
float snow_coverage_at(const snow_coverage *cover, int n);

/* Pixels range[0] .. range[1] - 1 have a coverage of at least `least` > 0. */
void snow_coverage_range(const snow_coverage *cover, float least, int range[2]);

#endif
