/* render/modes/darken.h - depth darkening: what lies behind that beside it is
 * darker (docs/model.md). */
#ifndef SNOW_RENDER_MODES_DARKEN_H
#define SNOW_RENDER_MODES_DARKEN_H

#include "render/job.h"

/* Darkens the colours of `image` by settings.depth_darkening; `depth` is of its
 * size, NaN where there is nothing; the time is added to `stats`. Errors: no
 * memory; then `image` is as before. */
snow_status snow_depth_darken(const snow_job *job, const snow_image *depth,
                              snow_image *image, snow_stats *stats);

/* Blurs a plane in its place; what is at its borders goes on beyond them. */
void snow_blur_plane(float *plane, float *spare, int width, int height,
                     double deviation);

#endif
