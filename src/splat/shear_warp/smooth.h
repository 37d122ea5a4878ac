/* splat/shear_warp/smooth.h - where a sample is among the voxels, and the
 * bells around it by which voxels of a kind are summed: a label's, or holes.
 * Surfaces that are voxels' steps are lit by the gradient of such sums. */
#ifndef SNOW_SPLAT_SHEAR_WARP_SMOOTH_H
#define SNOW_SPLAT_SHEAR_WARP_SMOOTH_H

#include "splat/shear_warp/splat.h"

/* A sample of the lattice, on the resampled slices of a slab. */
typedef struct value_sample {
    const snow_value_splat *splat;
    int slab, phase, row, lane;
    const int *tile;
} value_sample;

/* Where a sample is on a resampled slice. */
typedef struct value_spot {
    const snow_resampled_slice *resampled;
    int64_t i, j;
    int wu, wv;
} value_spot;

/* A sample on an end of its slab. */
value_spot value_spot_of(const value_sample *at, int end);

/* Its place along u, v and p. */
void value_place_of(const value_spot *spot, double out[3]);

/* Bells reach so many voxels to either side, at most. */
#define VALUE_BELL_MOST 3

/* The voxels within a reach along an axis, what they weigh, and how that grows
 * with the place.  Those beyond 0 .. count - 1 are there, too. */
typedef struct value_bell {
    int taps;
    int64_t at[2 * VALUE_BELL_MOST];
    double weight[2 * VALUE_BELL_MOST], slope[2 * VALUE_BELL_MOST];
} value_bell;

value_bell value_bell_at(double place, int64_t count, int reach);

#endif
