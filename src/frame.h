/* frame.h - what the top of the library shares: settings made definite, and
 * rendering one processor's part. */
#ifndef SNOW_FRAME_H
#define SNOW_FRAME_H

#include "base/base.h"
#include "decompose/slab.h"
#include "splat/splat.h"
#include "transform/clip.h"

#include <snowglass/render.h>

/* What one picture is made from; lives as long as the call that makes it. */
typedef struct snow_job {
    snow_context *context;
    const snow_volume *volume;
    const snow_transfer *transfer;
    snow_settings settings;   /* resolved, but perhaps for the encoding */
    snow_placement placement; /* of the whole that the volume is a part of */
    snow_clip clip;           /* what of it the part has and answers for */
    snow_slab slab;           /* slices of the whole that are drawn */
    bool all;                 /* these are all that the part answers for */
    /* The same for the exact methods, which see the stored voxels only. */
    snow_placement stored;
    snow_slab stored_slab;
    int channels;
    float *pixels; /* the local image: transparent, to be filled */
    snow_stats *stats;
} snow_job;

/* Clears what a sheet of slice `slice` of the stored ones holds of samples that
 * are not the part's. */
void snow_job_clip_sheet(const snow_job *job, int64_t slice, snow_sheet *sheet);

/* The settings as far as the caller's record reaches (its `size`), defaults
 * beyond. */
snow_settings snow_settings_known(const snow_settings *asked);

/* Checks every setting and replaces what is 0 or AUTO by what is meant for
 * this volume, but for the encoding, which is measured later.
 * Errors: SNOW_BAD_USAGE with the setting's name and range. */
snow_status snow_settings_resolve(snow_context *context,
                                  const snow_volume_info *info,
                                  snow_settings *settings);

/* Renders the slab `part` of `parts` (decompose/slab.h) of the slices that the
 * volume answers for, in the place where it lies in the whole picture. */
snow_status snow_frame_render_slab(snow_frame *frame, const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   const snow_view *view,
                                   const snow_settings *settings, int parts,
                                   int part, snow_image **out);

#endif
