/* splat/separable/comb.h - the footprint of a sheared slice (R in figure 7).
 *
 * All voxels of a sheared slice have the same footprint, up to the phase of the
 * pixel. It is separable: a comb of weights along u and one along v. */
#ifndef SNOW_SPLAT_SEPARABLE_COMB_H
#define SNOW_SPLAT_SEPARABLE_COMB_H

#include "splat/kernel.h"
#include "transform/shear.h"

/* The most voxels that a pixel sums along one axis. */
#define SNOW_TAPS_MOST 30

/* The kernel of one slice along one axis of the lattice: pixel P, of phase
 * P mod phases, sums the voxels
 *
 *   P / phases * stride + offset + lead[phase] + m,   m = 0 .. taps - 1
 *
 * with weights[phase][m]; a lead is 0 or 1, and one of them is 0. */
typedef struct snow_comb {
    int64_t offset;
    int lead[2];
    float weights[2][SNOW_TAPS_MOST];
} snow_comb;

/* The most voxels that a pixel can have in reach; may exceed SNOW_TAPS_MOST. */
int snow_comb_taps(const snow_scaled_kernel *scaled_kernel);

/* The comb of slice k, which need not be a whole number; the weights of each
 * phase add up to 1. */
void snow_comb_make(const snow_scaled_kernel *scaled_kernel,
                    const snow_lattice *lattice, double slice, snow_comb *out);

#endif
