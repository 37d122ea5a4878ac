/* transform/transform.h - the transformation stage (T in figure 7): where the
 * camera stands, which slices the volume is cut into, and where a slice's
 * voxels fall in the picture.
 *
 * Parallel projection is affine: voxel (u, v) of slice k has its centre at
 *
 *   (x, y) = origin + u * step_u + v * step_v + k * step_slice
 *
 * in pixels, x to the right, y down, the first pixel's centre at (1/2, 1/2).
 *
 * Perspective is told in transform/eye.h. */
#ifndef SNOW_TRANSFORM_H
#define SNOW_TRANSFORM_H

#include "base/base.h"

#include <snowglass/view.h>

/* Where a camera stands, told from its target, which falls on the middle of the
 * picture. */
typedef struct snow_camera {
    /* A right-handed frame of unit vectors in the world. */
    double right[3], up[3], back[3];
    double middle[3]; /* of the voxel boxes: steps along right, up and back */
    double distance;  /* of the eye; 0: a parallel projection */
    double pitch;     /* world length of a pixel's side, at the target */
} snow_camera;

/* An eye that sees the volume in perspective.  Vectors are in steps of (u, v,
 * slice). */
typedef struct snow_eye {
    double at[3];        /* place: voxel (u, v) of slice k, not whole numbers */
    double middle[3];    /* of the whole volume */
    double ray[3][3];    /* through pixel position (x, y), away from the eye:
                            ray[i][0] + x ray[i][1] + y ray[i][2] */
    double pixel[3][3];  /* a step from the eye to x and y times its depth, and
                            its depth: rows of a matrix */
    double metric[3][3]; /* squared world length of a step s: s . metric s */
} snow_eye;

typedef struct snow_placement {
    /* The camera as a right-handed frame of unit vectors in the world. */
    double right[3], up[3], back[3];

    int width, height; /* image, pixels */

    /* How the volume is cut: u runs along a slice's rows, v across them. */
    int slice_axis, u_axis, v_axis; /* 0 x, 1 y, 2 z */
    int64_t columns, rows, slices;
    bool nearest_first; /* slice 0 is the nearest to the viewer */

    double origin[2], step_u[2], step_v[2], step_slice[2]; /* pixels */
    double inverse[2][2]; /* pixels to (u, v): the inverse of step_u, step_v */
    double fine[2]; /* along u and v: 1, or of voxels that are means of others
                       (levels.h) the others' step in theirs */

    double path; /* world length of a ray between two slice planes */

    /* In perspective the maps above are those of a parallel camera that sees
     * the target alike, and path is that of the ray to the target; the true
     * ones depend on the voxel. */
    bool perspective;
    snow_eye eye;
} snow_placement;

/* The camera of a view before a volume.  Errors: SNOW_BAD_USAGE: a number out
 * of range; a position that is the target; an up along the line of sight; in
 * perspective a voxel that is not in front of the camera. */
snow_status snow_camera_make(snow_context *context,
                             const snow_volume_info *info,
                             const snow_view *view, snow_camera *out);

/* Places a volume before a camera (model, points 2, 5 and 6).  The slice axis
 * is the one whose slice normal is most parallel to the line of sight; within
 * 1e-6, z before y before x.  Errors: SNOW_BAD_USAGE (the view), SNOW_BAD_INPUT
 * (a geometry that no float can hold). */
snow_status snow_placement_make(snow_context *context,
                                const snow_volume_info *info,
                                const snow_view *view, snow_placement *out);

/* The same with slices along an axis of the caller's choice. */
snow_status snow_placement_make_along(snow_context *context,
                                      const snow_volume_info *info,
                                      const snow_view *view, int slice_axis,
                                      snow_placement *out);

/* Shares of the pictures along the three axes in one that does not change
 * abruptly where the slice axis does: they add up to 1, and all but the
 * placement's own are 0 unless the line of sight is within SNOW_BLEND_DEGREES
 * of a direction at which another axis is as good. */
#define SNOW_BLEND_DEGREES 5
void snow_placement_shares(const snow_volume_info *info,
                           const snow_placement *placement, double shares[3]);

/* Turns a frame of unit vectors: azimuth about up, then elevation about the
 * new right, then roll about the line of sight; degrees, as VTK's camera. */
void snow_frame_turn(double right[3], double up[3], double back[3],
                     double azimuth, double elevation, double roll);

/* World distance from the middle of the voxel boxes to their farthest corner.
 */
double snow_volume_radius(const snow_volume_info *info);

#endif
