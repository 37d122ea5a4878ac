/* render/value/value.h - the value path: sheets of values are splatted, slabs
 * between them coloured.  It is to become the method shear-warp. */
#ifndef SNOW_RENDER_VALUE_VALUE_H
#define SNOW_RENDER_VALUE_VALUE_H

#include "render/value/lattice.h"

/* Everything that is kept from picture to picture. */
typedef struct snow_value_path snow_value_path;

/* Unless *out is there already.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_value_path_new(snow_context *context, snow_value_path **out);
void snow_value_path_free(snow_value_path *path);

/* What a picture is made of; settings are resolved. */
typedef struct snow_value_params {
    const snow_volume *volume;
    const snow_transfer *transfer;
    const snow_view *view;
    const snow_settings *settings;
    const snow_placement *placement;
    int channels; /* 2 or 4 */
    bool whole;   /* all voxels that there are */
} snow_value_params;

/* Whether the value path draws this picture.  Errors: SNOW_STATUS_BAD_USAGE,
 * with what to use instead. */
snow_status snow_value_check(snow_context *context,
                             const snow_value_params *params);

/* The table of colours, and the encoding unless it is there.  Errors:
 * SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY, SNOW_STATUS_STOPPED. */
snow_status snow_value_classify(snow_value_path *path,
                                const snow_value_params *params,
                                snow_stats *stats);
snow_status snow_value_encode(snow_value_path *path,
                              const snow_value_params *params,
                              snow_stats *stats);

/* Then all pixels: width * height * channels floats.  Errors: as above. */
snow_status snow_value_draw(snow_value_path *path,
                            const snow_value_params *params, float *pixels,
                            snow_stats *stats);

#endif
