/* snowglass/view.h - the camera and the size of the image.
 *
 * The camera looks at the middle of the voxel boxes from a named side, turned
 * by angles; at zoom 1 all is in the picture (docs/model.md, section 2). Or
 * place it by points of the world (docs/output.md). */
#ifndef SNOWGLASS_VIEW_H
#define SNOWGLASS_VIEW_H

#include <snowglass/volume.h>

/* Degrees; the default is the tool's, where perspective is asked for alone. */
#define SNOW_FOV_MIN 0.001
#define SNOW_FOV_MAX 120
#define SNOW_FOV_DEFAULT 30

/* By default: the view "+z" at 512x512 pixels, angles 0, zoom 1, parallel. */
typedef struct snow_view {
    size_t size;
    int width, height; /* image in pixels, 1 to 32768 each */
    double back[3];    /* unit vector, target to camera, in the world */
    double up[3];      /* unit vector, perpendicular to back */
    double azimuth;    /* degrees: moves the camera to its right */
    double elevation;  /* degrees: moves the camera up */
    double roll;       /* degrees: turns the camera clockwise */
    double zoom;       /* above 0; 2 shows everything twice as large */
    double fov;        /* degrees over the shorter side, SNOW_FOV_MIN to
                          SNOW_FOV_MAX; 0: a parallel projection */
    bool has_position, has_target, has_view_up; /* these count, instead of `back`,
                                              the middle, `up`: */
    double position[3], target[3];         /* world; camera, what it looks at */
    double view_up[3]; /* world; up in the picture. Without it a camera with a
                         position has +z up, or +y if it looks along z */
    double strip;     /* of the width at the right, for a legend: 0 to 0.5 */
} snow_view;
SNOW_RECORD(snow_view);
/* By name, of any case: a side of the world (docs/model.md), where the camera
 * is; +z is up, for z sides +y. Other fields have their defaults. */
SNOW_API snow_status snow_view_from_name(
    snow_context *context, const char *name, snow_view *out);

/* The usual one of a volume (docs/output.md), into a record that snow_view_init
 * has begun; its name (NULL), and what a name means for a volume: axial,
 * coronal, sagittal, front and back are other sides of a patient. */
SNOW_API snow_status snow_view_default(const snow_volume *, snow_view *out);
SNOW_API const char *snow_view_name_for(
    const snow_volume_info *info, const char *name);

/* Name of view `index` (from 0); NULL past the end. */
SNOW_API const char *snow_view_name(size_t index);

/* The zoom at which a step of the smallest spacing is one pixel. */
SNOW_API double snow_view_zoom_for_voxels(const snow_volume *, int w, int h);

#endif
