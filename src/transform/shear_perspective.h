/* transform/shear_perspective.h - a perspective view as a scaling, a shear and
 * a warp (Lacroute and Levoy 1994, section 4).
 *
 * Slice k, scaled about the foot (eu, ev) of the eye by (k0 - ek) / (k - ek),
 * is aligned with slice k0 for the eye (transform/perspective.h). The scaled
 * sheets are sampled on one lattice in the plane of k0, the intermediate image;
 * one projective warp maps the result to the picture.  k0 is the slice nearest
 * to the eye, so that no slice is scaled up. */
#ifndef SNOW_TRANSFORM_SHEAR_PERSPECTIVE_H
#define SNOW_TRANSFORM_SHEAR_PERSPECTIVE_H

#include "transform/perspective.h"

/* The intermediate image along one axis of the slices: pixel n is at
 * (first + n) * pitch voxels of slice k0. */
typedef struct snow_perspective_shear_axis {
    double pitch; /* voxels of slice k0 a pixel */
    double eye;   /* eu or ev */
    int64_t first;
    int count; /* 0 if nothing is in view */
} snow_perspective_shear_axis;

typedef struct snow_perspective_shear {
    snow_perspective_shear_axis u, v;
    double height; /* k0 - ek */
    /* Pixel position (x, y) of the picture maps to (warp[0], warp[1]) / warp[2]
     * in pixels of the intermediate image, with warp[i] = warp[i][0] + x
     * warp[i][1] + y warp[i][2]; the volume is visible where warp[2] > 0. */
    double warp[3][3];
} snow_perspective_shear;

/* The ratio of the farthest to the nearest slice's distance from the eye;
 * infinite if the eye's own plane cuts the slices. */
double snow_perspective_shear_ratio(const snow_placement *placement);

/* The part of the lattice that both holds voxels and is in view, with a border
 * of pixels that are empty or out of view, in a plane k0 = ek + `height`, in
 * which the volume covers covered[axis][0] .. covered[axis][1] voxels. The eye
 * must be outside of the slices. Errors: SNOW_STATUS_BAD_USAGE (the
 * intermediate image is too large). */
snow_status snow_perspective_shear_cover(snow_context *context,
                                         const snow_placement *placement,
                                         double height, const double pitch[2],
                                         double covered[2][2],
                                         snow_perspective_shear *out);

#endif
