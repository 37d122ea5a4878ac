/* transform/transform.h - the transformation stage (T in figure 7): the camera,
 * the slices of the volume, and the positions of a slice's voxels in the
 * picture.
 *
 * Parallel projection is affine: voxel (u, v) of slice k has its centre at
 *
 *   (x, y) = origin + u * step_u + v * step_v + k * step_slice
 *
 * in pixels, x to the right, y down, the first pixel's centre at (1/2, 1/2).
 *
 * For perspective projection see transform/perspective.h. */
#ifndef SNOW_TRANSFORM_H
#define SNOW_TRANSFORM_H

#include "base/base.h"

#include <snowglass/view.h>

/* The pixels of a picture's width that are not left to a legend. */
int snow_view_room(const snow_view *view);

/* A camera relative to its target, which is in the middle of the picture, but
 * for what is left to a legend. */
typedef struct snow_camera {
    /* A right-handed frame of unit vectors in world space. */
    double right[3], up[3], back[3];
    double middle[3]; /* of the voxel boxes along right, up and back */
    double distance;  /* of the eye; 0: a parallel projection */
    double pitch;     /* world length of a pixel's side, at the target */
    double target[2]; /* where it is in the picture, in pixels */
} snow_camera;

/* The eye of a perspective view. Vectors are in steps of (u, v, slice). */
typedef struct snow_perspective {
    double at[3];       /* position: voxel (u, v) of slice k, not integers */
    double middle[3];   /* of the whole volume */
    double ray[3][3];   /* ray through pixel position (x, y), away from the eye:
                           ray[i][0] + x ray[i][1] + y ray[i][2] */
    double pixel[3][3]; /* maps a vector from the eye to x and y times its
                           depth, and its depth: rows of a matrix */
    double metric[3][3]; /* squared world length of a step s: s . metric s */
} snow_perspective;

typedef struct snow_placement {
    /* The camera as a right-handed frame of unit vectors in world space. */
    double right[3], up[3], back[3];

    int width, height; /* image, pixels */

    /* The slices: u runs along a slice's rows, v across them. */
    int slice_axis, u_axis, v_axis; /* 0 x, 1 y, 2 z */
    int64_t columns, rows, slices;
    bool nearest_first; /* slice 0 is the nearest to the viewer */

    double origin[2], step_u[2], step_v[2], step_slice[2]; /* pixels */
    double inverse[2][2]; /* pixels to (u, v): the inverse of step_u, step_v */

    double pitch; /* world length of a pixel's side, at the target */
    double path;  /* world length of a ray between two slice planes */

    /* In perspective the maps above are those of a parallel camera with the
     * same view of the target, and path is that of the ray to the target; the
     * exact ones differ from voxel to voxel. */
    bool perspective;
    snow_perspective eye;
} snow_placement;

/* The camera of a view for a volume. Errors: SNOW_STATUS_BAD_USAGE: a number
 * out of range; a position equal to the target; an up vector along the line of
 * sight; in perspective a voxel that is not in front of the camera. */
snow_status snow_camera_make(snow_context *context,
                             const snow_volume_info *info,
                             const snow_view *view, snow_camera *out);

/* The point of a place in the world, along right, up and back of the target;
 * and the place of a point. */
void snow_camera_point(const snow_camera *camera, const snow_volume_info *info,
                       const double place[3], double point[3]);
void snow_camera_place(const snow_camera *camera, const snow_volume_info *info,
                       const double point[3], double place[3]);

/* Where a point is in the picture, in pixels.  In perspective it must be in
 * front of the eye. */
void snow_camera_pixel(const snow_camera *camera, const double point[3],
                       double pixel[2]);

/* Places a volume before a camera (model, sections 2, 5 and 6). The slice axis
 * is the one whose slice normal is most parallel to the line of sight; within
 * 1e-6, z before y before x. Errors: SNOW_STATUS_BAD_USAGE (the view),
 * SNOW_STATUS_BAD_INPUT (a geometry beyond the range of float). */
snow_status snow_placement_make(snow_context *context,
                                const snow_volume_info *info,
                                const snow_view *view, snow_placement *out);

/* Turns a frame of unit vectors: azimuth about up, then elevation about the new
 * right, then roll about the line of sight; degrees, like VTK's camera. */
void snow_frame_turn(double right[3], double up[3], double back[3],
                     double azimuth, double elevation, double roll);

/* The unit normal of the slices along `axis`. */
void snow_slice_normal(const snow_volume_info *info, int axis,
                       double normal[3]);

/* World distance from the middle of the voxel boxes to a farthest corner. */
double snow_volume_radius(const snow_volume_info *info);

#endif
