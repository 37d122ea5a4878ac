/* perspective.h - figure 8 of the paper in perspective, by the methods that
 * throw footprints onto the picture itself. */
#ifndef SNOW_PERSPECTIVE_H
#define SNOW_PERSPECTIVE_H

#include "base/base.h"
#include "decompose/slab.h"
#include "transform/transform.h"

#include <snowglass/render.h>

/* What a picture is made of; settings are resolved. */
typedef struct snow_perspective_order {
    const snow_volume *volume;
    const snow_transfer *transfer;
    const snow_settings *settings;
    const snow_placement *placement; /* of a perspective view */
    snow_slab slab;
    int channels; /* 2 or 4 */
} snow_perspective_order;

/* Lines 02 to 13 for the slab, onto `pixels`: width * height * channels floats,
 * zeros at first.  Fills the times and the counts of `stats`.  Errors:
 * SNOW_BAD_USAGE, SNOW_NO_MEMORY. */
snow_status snow_perspective_render(snow_context *context,
                                    const snow_perspective_order *order,
                                    float *pixels, snow_stats *stats);

#endif
