/* snowglass/view.h - where the camera stands, and the image it exposes.
 *
 * The camera looks at the middle of the voxel boxes from a named side; azimuth
 * turns it about the up axis, elevation about the new right, roll about the
 * line of sight.  R is the distance from the middle to the farthest corner.
 *
 * Parallel projection: the pixel pitch is 2R / (zoom min(W, H)).  Perspective:
 * the eye is R / sin(fov / 2) from the target, and at zoom 1 the field of view
 * spans the shorter side of the image; zoom scales the image.  In both, at zoom
 * 1, the whole volume is in the picture whatever its turn.
 *
 * A camera may also be placed by points of the world: `target` is what it looks
 * at in place of the middle, and falls on the middle of the picture; `position`
 * is where it stands, so that the line of sight leads from there to the target.
 * In perspective the eye is there, whatever R; in parallel projection, which
 * has no eye, only the direction counts, and the pitch stays as it is.  The
 * angles then turn the camera about the target. */
#ifndef SNOWGLASS_VIEW_H
#define SNOWGLASS_VIEW_H

#include <snowglass/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SNOW_FOV_MIN 0.001
#define SNOW_FOV_MAX 120
#define SNOW_FOV_DEFAULT                                   \
    30 /* where perspective is asked for, and no more told \
        */

/* By default: the view "+z" at 512x512 pixels, angles 0, zoom 1, parallel. */
typedef struct snow_view {
    size_t size;
    int width, height;  /* image in pixels, 1 to 32768 each */
    double back[3];     /* unit vector, target to camera, in the world */
    double up[3];       /* unit vector, at right angles to back */
    double azimuth;     /* degrees: moves the camera to its right */
    double elevation;   /* degrees: moves the camera up */
    double roll;        /* degrees: turns the camera clockwise */
    double zoom;        /* above 0; 2 shows everything twice as large */
    double fov;         /* degrees over the shorter side, SNOW_FOV_MIN to
                           SNOW_FOV_MAX; 0: a parallel projection */
    bool has_position;  /* `position` counts, in place of `back` */
    bool has_target;    /* `target` counts, in place of the middle */
    bool has_up;        /* `upward` counts, in place of `up` */
    double position[3]; /* world; of the camera */
    double target[3];   /* world; what it looks at */
    double upward[3];   /* a direction in the world that is up in the picture;
                           neither 0 nor along the line of sight.  Without it a
                           camera with a position has +z up, or +y where it
                           looks along z, as named views have */
} snow_view;
SNOW_RECORD(snow_view);

/* The view by name: anterior posterior left right superior inferior iso +x -x
 * +y -y +z -z, at 512x512, angles 0, zoom 1, parallel.  +z: the camera sits on
 * the +z side, +y is up; for x and y sides +z is up; anterior is +y, left -x,
 * superior +z; iso looks from (1, 1, 1), +z up.  Letters may be of either case.
 * Errors: SNOW_STATUS_BAD_USAGE. */
SNOW_API snow_status snow_view_from_name(snow_context *context,
                                         const char *name, snow_view *out);

/* The default view of a volume: anterior when its file gives a medical
 * orientation, +z otherwise; at 512x512, angles 0, zoom 1. */
SNOW_API snow_status snow_view_default(const snow_volume *volume,
                                       snow_view *out);

/* Name of view `index` (from 0); NULL past the end. */
SNOW_API const char *snow_view_name(size_t index);

/* The zoom at which one step of the smallest spacing is one pixel: a footprint
 * of K voxels is then K pixels wide, as in the paper's Tables 2 and 3. */
SNOW_API double snow_view_zoom_for_voxels(const snow_volume *volume, int width,
                                          int height);

#ifdef __cplusplus
}
#endif
#endif
