/* transform/eye.h - perspective: the rays of an eye (model, points 2, 5 to 7).
 *
 * In index space, seen from the eye e = (eu, ev, ek), the ray of direction
 * (a, b, 1) meets slice k at
 *
 *   (u, v) = (eu, ev) + (k - ek) (a, b)
 *
 * so that all slices are one another's images, scaled about (eu, ev), and what
 * a ray meets on any slice is known by its slopes (a, b).  Those are a
 * projective function of the place in the picture, one for all slices:
 *
 *       e                       e  the eye, outside of the voxel boxes
 *      /|\
 *     / | \      slice 0        the box of slice 0, seen from e, covers more
 *    /  |  \                    of the picture than that of slice 1
 *   /   |   \    slice 1
 *
 * No voxel is behind the camera: the eye is farther than R from the target, or
 * snow_camera_make has seen to it.
 * Yet with a wide field of view the plane of a slice may pass beside the eye,
 * and slices on either side of it are seen, in different parts of the picture:
 * a ray meets those in front of it only. */
#ifndef SNOW_EYE_H
#define SNOW_EYE_H

#include "transform/transform.h"

/* A slice nearer to the eye than this, in slices, is seen from its edge: it
 * shows nothing. */
#define SNOW_EDGE_ON 1e-6

/* Sets the eye of a placement that holds everything else.  False where a
 * number is beyond all measure. */
bool snow_eye_place(const snow_volume_info *info, const snow_camera *camera,
                    snow_placement *placement);

/* The direction of the ray through pixel position (x, y). */
static inline void snow_eye_ray(const snow_eye *eye, double x, double y,
                                double ray[3]) {
    for (int i = 0; i < 3; i++)
        ray[i] = eye->ray[i][0] + x * eye->ray[i][1] + y * eye->ray[i][2];
}

/* The pixel position of a step from the eye; false where it does not lie in
 * front of the camera. */
bool snow_eye_sees(const snow_eye *eye, const double step[3], double pixel[2]);

/* How many voxels a pixel is wide along u and v, at the middle of slice k
 * (which need not be a whole number): the lengths of the rows of the inverse of
 * the slice's map there. */
void snow_eye_pixel_width(const snow_placement *placement, double slice,
                          double width[2]);

/* The world length of the ray to voxel (u, v) of slice k, from one slice plane
 * to the next. */
double snow_eye_path(const snow_eye *eye, double u, double v, double slice);

/* The n-th of `count` slices from `first` on, in an order in which no ray meets
 * one before another that is nearer: away from the eye on its lower side, then
 * on the upper one.  Where the eye's plane cuts the volume no order of whole
 * slabs is that of all rays, so that such views are not split into slabs. */
int64_t snow_eye_nth_slice(const snow_eye *eye, int64_t first, int64_t count,
                           int64_t n);

#endif
