/* frame.h - what the top of the library shares: settings made definite, and
 * rendering one processor's part. */
#ifndef SNOW_FRAME_H
#define SNOW_FRAME_H

#include "base/base.h"
#include "decompose/slab.h"
#include "transform/transform.h"

#include <snowglass/render.h>

/* What one picture is made from; lives as long as the call that makes it. */
typedef struct snow_job {
    snow_context *context;
    const snow_volume *volume;
    const snow_transfer *transfer;
    snow_settings settings; /* resolved, but perhaps for the encoding */
    snow_placement placement;
    snow_slab slab;
    int channels;
    float *pixels; /* the local image: transparent, to be filled */
    snow_stats *stats;
} snow_job;

/* The settings as far as the caller's record reaches (its `size`), defaults
 * beyond. */
snow_settings snow_settings_known(const snow_settings *asked);

/* Checks every setting and replaces what is 0 or AUTO by what is meant for
 * this volume, but for the encoding, which is measured later.
 * Errors: SNOW_BAD_USAGE with the setting's name and range. */
snow_status snow_settings_resolve(snow_context *context,
                                  const snow_volume_info *info,
                                  snow_settings *settings);

/* Renders the slab `part` of `parts` (decompose/slab.h), in the place where it
 * lies in the whole picture: the local image of one processor. */
snow_status snow_frame_render_slab(snow_frame *frame, const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   const snow_view *view,
                                   const snow_settings *settings, int parts,
                                   int part, snow_image **out);

#endif
