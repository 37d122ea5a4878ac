/* render/modes/depth.h - how far away a picture is: world distances from the
 * target's plane along the camera's line of sight. */
#ifndef SNOW_RENDER_MODES_DEPTH_H
#define SNOW_RENDER_MODES_DEPTH_H

#include "render/job.h"

/* The depth of index position (u, v, k) of a placement is
 * of[0] u + of[1] v + of[2] k + of[3]. */
void snow_depth_place(const snow_job *job, double of[4]);

/* Notes where opacity passes 1/2 before a sheet is laid behind what the local
 * image holds.  What a sheet adds grows evenly from half a slice before it to
 * half a slice behind, so that an opaque one is where its slice is. */
void snow_depth_note_sheet(const snow_job *job, int64_t slice,
                           const snow_sheet *sheet);

/* Grid position (u, v, k) at a depth on the ray of pixel (x, y), and the way to
 * where depth is larger by 1; `of` as above. */
void snow_depth_find(const snow_placement *placement, const double of[4], int x,
                     int y, double depth, double at[3], double away[3]);

/* --- darken.c: what lies behind that beside it is darker (docs/model.md) ---

 * Darkens the colours of `image` by settings.depth_darkening; `depth` is of its
 * size, NaN where there is nothing. Errors: no memory, a stop; then `image` is
 * as before. */
snow_status snow_depth_darken(const snow_job *job, const snow_image *depth,
                              snow_image *image);

/* Blurs a plane in its place; what is at its borders goes on beyond them.
 * Errors: a stop, with the plane half blurred. */
snow_status snow_blur_plane(snow_context *context, float *plane, float *spare,
                            int width, int height, double deviation);

#endif
