/* transform/perspective.h - perspective projection: the rays of an eye (model,
 * points 2, 5 to 7).
 *
 * In index space, seen from the eye e = (eu, ev, ek), the ray of direction (a,
 * b, 1) meets slice k at
 *
 *   (u, v) = (eu, ev) + (k - ek) (a, b)
 *
 * so all slices are scaled images of each other, with centre (eu, ev), and its
 * slopes (a, b) determine where a ray meets any slice. The slopes are a
 * projective function of the pixel position, the same for all slices:
 *
 *       e                       e  the eye, outside of the voxel boxes
 *      /|
 *     / | \      slice 0        the box of slice 0, seen from e, covers more
 *    /  |  \                    of the picture than that of slice 1
 *   /   |   \    slice 1
 *
 * No voxel is behind the camera: the eye is farther than R from the target, or
 * snow_camera_make has checked it. But with a wide field of view the plane of a
 * slice may pass beside the eye, and slices on both sides of the eye are
 * visible, in different parts of the picture: a ray meets only those in front
 * of it. */
#ifndef SNOW_TRANSFORM_PERSPECTIVE_H
#define SNOW_TRANSFORM_PERSPECTIVE_H

#include "transform/transform.h"

/* A slice nearer to the eye than this, in slices, is seen edge-on: it shows
 * nothing. */
#define SNOW_EDGE_ON 1e-6

/* Sets the eye of a placement, whose other fields are set. Returns false if a
 * number overflows. */
bool snow_perspective_place(const snow_volume_info *info,
                            const snow_camera *camera,
                            snow_placement *placement);

/* The direction of the ray through pixel position (x, y). */
static inline void snow_perspective_ray(const snow_perspective *eye, double x,
                                        double y, double ray[3]) {
    for (int i = 0; i < 3; i++)
        ray[i] = eye->ray[i][0] + x * eye->ray[i][1] + y * eye->ray[i][2];
}

/* The pixel position of a vector from the eye; false if it is not in front of
 * the camera. */
bool snow_perspective_sees(const snow_perspective *eye, const double step[3],
                           double pixel[2]);

/* The width of a pixel in voxels along u and v, at the middle of slice k (which
 * may be fractional): the lengths of the rows of the inverse of the slice's map
 * there. */
void snow_perspective_pixel_width(const snow_placement *placement, double slice,
                                  double width[2]);

/* The length in world units of the ray to voxel (u, v) of slice k, from one
 * slice plane to the next. */
double snow_perspective_path(const snow_perspective *eye, double u, double v,
                             double slice);

/* The n-th of `count` slices from `first` on, in visibility order for every
 * ray: away from the eye on its lower side, then on the upper one. Where the
 * eye's plane cuts the volume no order of whole slabs is correct for all rays,
 * so such views are not split into slabs. */
int64_t snow_perspective_nth_slice(const snow_perspective *eye, int64_t first,
                                   int64_t count, int64_t n);

#endif
