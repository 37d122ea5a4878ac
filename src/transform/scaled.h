/* transform/scaled.h - a perspective view as a scaling, a shear and a warp
 * (Lacroute and Levoy 1994, section 4).
 *
 * Slice k, scaled about the foot (eu, ev) of the eye by (k0 - ek) / (k - ek),
 * lies on slice k0 as the eye sees it (transform/eye.h).  Sheets so scaled are
 * sampled on one lattice in the plane of k0, the intermediate image; one
 * projective warp takes the result to the picture.  k0 is the slice nearest to
 * the eye, so that no slice is scaled up. */
#ifndef SNOW_SCALED_H
#define SNOW_SCALED_H

#include "transform/eye.h"

/* The intermediate image along one axis of the slices: pixel n is at
 * (first + n) * pitch voxels of slice k0. */
typedef struct snow_scaled_axis {
    double pitch; /* voxels of slice k0 a pixel */
    double eye;   /* eu or ev */
    int64_t first;
    int count; /* 0 when nothing is in view */
} snow_scaled_axis;

typedef struct snow_scaled {
    snow_scaled_axis u, v;
    double height; /* k0 - ek */
    double level;  /* ek */
    /* Pixel position (x, y) of the picture is at (warp[0], warp[1]) / warp[2]
     * pixels of the intermediate image, for warp[i] = warp[i][0] + x warp[i][1]
     * + y warp[i][2]; it sees the volume where warp[2] is above 0. */
    double warp[3][3];
} snow_scaled;

/* How an intermediate image is asked for, along u and v. */
typedef struct snow_scaled_options {
    double pitch[2];
    /* Per slice of the placement: how far the kernel reaches, voxels. */
    const double *reach[2];
} snow_scaled_options;

/* How many times as far from the eye as the nearest slice the farthest one is;
 * infinite where the eye's own plane cuts the slices. */
double snow_scaled_ratio(const snow_placement *placement);

/* By how much slice k's plane is farther than k0's: voxels of slice k for one
 * of slice k0. */
static inline double snow_scaled_step(const snow_scaled *scaled, double slice) {
    return (slice - scaled->level) / scaled->height;
}

/* The voxel position of pixel 0 on a slice, of snow_scaled_step `step`. */
static inline double snow_scaled_start(const snow_scaled_axis *axis,
                                       double step) {
    double seen = (double)axis->first * axis->pitch;
    return axis->eye + (seen - axis->eye) * step;
}

/* The part of the lattice that both holds voxels and is in view, with a border
 * of pixels that are empty or out of view.  The eye is outside of the slices.
 * Errors: SNOW_BAD_USAGE (an intermediate image beyond all measure). */
snow_status snow_scaled_make(snow_context *context,
                             const snow_placement *placement,
                             const snow_scaled_options *options,
                             snow_scaled *out);

#endif
