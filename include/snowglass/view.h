/* snowglass/view.h - the camera and the size of the picture.
 *
 * The camera looks at the middle of the volume from a named side, turned by
 * angles; at zoom 1 all of it is in the picture (docs/model.md, section 2). Or
 * it is placed by points of the world (docs/output.md). */
#ifndef SNOWGLASS_VIEW_H
#define SNOWGLASS_VIEW_H

#include <snowglass/volume.h>

/* Degrees; the default is the tool's, where perspective is asked for alone. */
#define SNOW_FOV_MIN 0.001
#define SNOW_FOV_MAX 120
#define SNOW_FOV_DEFAULT 30

/* A camera. By default: the view "+z" at 512x512 pixels, angles 0, zoom 1, a
 * parallel projection. `back` and `up` are those of a named view. The points of
 * the world below count where their has_ is set: position and target instead of
 * `back` and the middle of the volume, view_up instead of `up`. A camera with a
 * position and no view_up has +z up, or +y if it looks along z. */
typedef struct snow_view {
    size_t size;
    int width, height; /* image in pixels, 1 to 32768 each */
    double back[3];    /* unit vector, target to camera, in the world */
    double up[3];      /* unit vector, perpendicular to back */
    double azimuth;    /* degrees, finite: moves the camera to its right */
    double elevation;  /* degrees: moves the camera up */
    double roll;       /* degrees: turns the camera clockwise */
    double zoom;       /* above 0; 2 shows everything twice as large */
    double fov;        /* degrees over the shorter side, SNOW_FOV_MIN to
                          SNOW_FOV_MAX; 0: a parallel projection */
    bool has_position, has_target, has_view_up;
    double position[3]; /* where the camera is */
    double target[3];   /* what it looks at, in the middle of the picture */
    double view_up[3];  /* a direction that points up in the picture */
    double strip;       /* share of the width that is left free at the right,
                           for a legend: 0 to 0.5 */
} snow_view;
SNOW_RECORD(snow_view);

/* Makes the view of a name, of any case: a side of the world (docs/model.md),
 * where the camera is. +z is up, for z sides +y; all else has its default.
 * Errors: BAD_USAGE (no such name). */
SNOW_API snow_status snow_view_from_name(
    snow_context *context, const char *name, snow_view *out);

/* Makes the usual view of a volume (docs/output.md). *out is a record that
 * snow_view_init has begun. */
SNOW_API snow_status snow_view_default(
    const snow_volume *volume, snow_view *out);

/* Returns the name of a volume's usual view (`name` NULL), or the one that a
 * name means for it: axial, coronal, sagittal, front and back are other sides
 * of a patient. */
SNOW_API const char *snow_view_name_for(
    const snow_volume_info *info, const char *name);

/* Returns the name of view `index` (from 0), NULL past the end. */
SNOW_API const char *snow_view_name(size_t index);

/* Returns the zoom at which the smallest spacing of a volume is one pixel of a
 * picture of that size. */
SNOW_API double snow_view_zoom_for_voxels(
    const snow_volume *volume, int width, int height);

/* Finds where `count` points of the world are seen in a view's picture of a
 * volume. A point has three numbers, x, y and z. So has a pixel: x to the
 * right, y down (the middle of the first pixel is at 0.5, 0.5), and its depth,
 * as snow_frame_depth gives it. What is behind the eye of a perspective view is
 * NaN. `info` is that of the whole volume, `view` the one that was drawn. Both
 * arrays may be one. Errors: BAD_USAGE (a view that cannot be drawn). */
SNOW_API snow_status snow_view_world_to_pixel(snow_context *context,
    const snow_volume_info *info, const snow_view *view, const double *points,
    size_t count, double *pixels);

/* Finds the points of the world that are seen at pixels with depths: the way
 * back. Those without a depth, which is NaN, are NaN. Errors: as above. */
SNOW_API snow_status snow_view_pixel_to_world(snow_context *context,
    const snow_volume_info *info, const snow_view *view, const double *pixels,
    size_t count, double *points);

#endif
