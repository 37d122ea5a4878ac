/* sheared.h - the sheared method: figure 8 of the paper with slices that are
 * moved instead of footprints that are turned. */
#ifndef SNOW_SHEARED_H
#define SNOW_SHEARED_H

#include "base/base.h"
#include "decompose/slab.h"
#include "transform/transform.h"

#include <snowglass/render.h>

/* Everything that is kept from picture to picture. */
typedef struct snow_sheared snow_sheared;

/* Errors: SNOW_NO_MEMORY. */
snow_status snow_sheared_new(snow_context *context, snow_sheared **out);
void snow_sheared_free(snow_sheared *sheared);

/* What a picture is made of; settings are resolved. */
typedef struct snow_sheared_order {
    const snow_volume *volume;
    const snow_transfer *transfer;
    const snow_view *view;
    const snow_settings *settings;
    const snow_placement *placement;
    snow_slab slab;
    int channels; /* 2 or 4 */
} snow_sheared_order;

/* Whether the method can make this picture.  Where a kernel, widened for
 * pixels that are many voxels wide, has more than SNOW_TAPS_MOST voxels in
 * reach, it is left to footprint splatting, which has few pixels to fill
 * then. */
bool snow_sheared_fits(const snow_placement *placement,
                       const snow_settings *settings);

/* Renders the slab into `pixels`, width * height * channels floats, all of
 * which are written; fills the figures of `stats` that the method knows.
 * Errors: SNOW_BAD_USAGE, SNOW_NO_MEMORY. */
snow_status snow_sheared_render(snow_sheared *sheared,
                                const snow_sheared_order *order, float *pixels,
                                snow_stats *stats);

#endif
