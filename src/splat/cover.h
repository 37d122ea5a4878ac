/* splat/cover.h - where the kernels of a slice lie within the grid.
 *
 * Pixel n of one phase sums the voxels start + n * stride + m with weights[m],
 * m = 0 .. taps - 1 (splat/comb.h).  Of a grid without holes the weights that
 * it finds depend on n alone, and are all but at the ends 1:
 *
 *   weights    0  .2  .8  1   1   1   1  .8  .2  0
 *   pixel n       from    in             out     to                          */
#ifndef SNOW_COVER_H
#define SNOW_COVER_H

#include "splat/comb.h"

typedef struct snow_cover {
    int64_t start;
    int stride, taps;
    const float *weights;
    int64_t voxels;
    /* Pixels from .. to - 1 find a voxel, in .. out - 1 all of theirs; thin
     * grids have in > out. */
    int from, in, out, to;
} snow_cover;

/* The cover of one phase of a comb: `first` is the first voxel of pixel 0 but
 * for the phase's lead; there are `pixels` pixels. */
snow_cover snow_cover_make(const snow_comb *comb, int phase, int taps,
                           int64_t first, int stride, int64_t voxels,
                           int pixels);

/* The weights that pixel n finds, 0 to 1. */
float snow_cover_at(const snow_cover *cover, int n);

/* Pixels range[0] .. range[1] - 1 find at least `least` > 0. */
void snow_cover_range(const snow_cover *cover, float least, int range[2]);

#endif
