/* splat/rake.h - the footprint of a slice that is scaled as it is moved, along
 * one axis: pixels and voxels have different pitches, so that each pixel has
 * its own weights, where those of a comb (splat/comb.h) repeat. */
#ifndef SNOW_RAKE_H
#define SNOW_RAKE_H

#include "splat/comb.h"
#include "splat/kernel.h"

/* Pixel n = 0 .. count - 1 is at voxel position start + n * step; step > 0. */
typedef struct snow_rake {
    snow_taper taper;
    int taps; /* snow_comb_taps of the taper */
    double start, step;
    int count;
} snow_rake;

/* The first voxel that pixel n sums: non-decreasing with n. */
int64_t snow_rake_first(const snow_rake *rake, int64_t n);

/* Those of pixels `from` to `to` - 1 into first[n], and their weights: tap m of
 * pixel n is weights[m * stride + n], for voxel first[n] + m.  Those of a pixel
 * add up to 1. */
void snow_rake_fill(const snow_rake *rake, int from, int to, size_t stride,
                    int32_t *first, float *weights);

#endif
