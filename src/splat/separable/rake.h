/* splat/separable/rake.h - the footprint of a slice that is scaled and sheared,
 * along one axis. Pixels and voxels have different pitches, so each pixel has
 * its own weights, while those of a comb (splat/separable/comb.h) repeat. */
#ifndef SNOW_SPLAT_SEPARABLE_RAKE_H
#define SNOW_SPLAT_SEPARABLE_RAKE_H

#include "splat/kernel.h"
#include "splat/separable/comb.h"

/* Pixel n = 0 .. count - 1 is at voxel position start + n * step; step > 0. */
typedef struct snow_rake {
    snow_scaled_kernel scaled_kernel;
    int taps; /* snow_comb_taps of the scaled kernel */
    double start, step;
    int count;
} snow_rake;

/* The first voxel that pixel n sums: non-decreasing with n. */
int64_t snow_rake_first(const snow_rake *rake, int64_t n);

/* Fills in pixels `from` to `to` - 1: the first voxels first[n], and the
 * weights: tap m of pixel n is weights[m * stride + n], for voxel first[n] + m.
 * The weights of a pixel add up to 1. */
void snow_rake_fill(const snow_rake *rake, int from, int to, size_t stride,
                    int32_t *first, float *weights);

#endif
