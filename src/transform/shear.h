/* transform/shear.h - a parallel view as a shear and a warp (Lacroute and Levoy
 * 1994, in the affine form of their section 2).
 *
 * Slice k, sheared by (k * slope_u, k * slope_v) voxels in its own plane, is
 * aligned with slice 0 for the viewer. The sheets of sheared slices are sampled
 * on one lattice, the intermediate image, and composited there; one affine warp
 * maps the result to the picture:
 *
 *   slice k      .  .  .  .            lattice of the intermediate image,
 *   slice 1    .  .  .  .       --->   2 pixels a voxel:  ' ' ' ' ' ' ' ' '
 *   slice 0   .  .  .  .                                 (P / 2 - k * slope) */
#ifndef SNOW_SHEAR_H
#define SNOW_SHEAR_H

#include "transform/transform.h"

/* The intermediate image along one axis of the slices.  Lattice pixel P, which
 * is pixel P - first of the image, samples slice k at
 *
 *   P / phases - k * slope     voxels
 */
typedef struct snow_lattice {
    int phases; /* pixels a voxel */
    double slope;
    int64_t first; /* a multiple of phases */
    int count;     /* pixels; 0 if nothing is in view */
} snow_lattice;

typedef struct snow_shear {
    snow_lattice u, v;
    /* Pixel (x, y) of the picture, whose centre is at (x + 1/2, y + 1/2), maps
     * to start + x * along_x + y * along_y in pixels of the intermediate image,
     * whose samples are at integers. */
    double start[2], along_x[2], along_y[2];
} snow_shear;

/* The part of the lattice that both is within `reach` of voxels and in view,
 * with a border of SNOW_SHEAR_BORDER pixels that are empty or out of view: two
 * that a warp reads beyond its place, and its distance from the ends. Phases
 * are along u and v. Errors: SNOW_STATUS_BAD_USAGE (the intermediate image is
 * too large). */
#define SNOW_SHEAR_BORDER 5
snow_status snow_shear_make(snow_context *context,
                            const snow_placement *placement,
                            const int phases[2], double reach, snow_shear *out);

#endif
