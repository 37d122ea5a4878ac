/* frame.h - what the top of the library shares: settings made definite, and
 * rendering one processor's part. */
#ifndef SNOW_FRAME_H
#define SNOW_FRAME_H

#include "base/base.h"
#include "composite/over.h"
#include "decompose/slab.h"
#include "iso.h"
#include "levels.h"
#include "modes.h"
#include "ranks_work.h"
#include "sheared.h"
#include "splat/splat.h"
#include "transform/clip.h"

#include <snowglass/render.h>

typedef struct snow_exact snow_exact; /* footprint.h */
typedef struct snow_ranks snow_ranks; /* ranks_parts.h */

/* Buffers of the methods, kept from picture to picture. */
struct snow_frame {
    snow_context *context;
    snow_stats stats;
    snow_exact *exact;
    /* Made when first used; one for each axis where a picture is blended of
     * several, else the first. */
    snow_sheared *sheared[3];
    float *layer; /* a picture to be blended */
    size_t layer_capacity;
    float *spare[SNOW_GROUP_RANKS]; /* pictures of groups, to be combined */
    size_t spare_capacity[SNOW_GROUP_RANKS];
    snow_ranks *ranks;       /* of snow_ranks_render; NULL until needed */
    int64_t own_interesting; /* of the part that was encoded last */
    snow_ramp ramp;          /* of modes other than over */
    snow_mode_colors mode_colors;
    snow_iso *iso;       /* of mode iso; NULL until needed */
    snow_image *depth;   /* of the last picture; NULL: not asked for */
    snow_levels *levels; /* of the volume; NULL until needed */
    snow_work work;      /* of pictures by many ranks */
};

/* What one picture is made from; lives as long as the call that makes it. */
typedef struct snow_job {
    snow_context *context;
    const snow_volume *volume;
    const snow_transfer *transfer;
    const snow_view *view;
    snow_settings settings;   /* resolved, but perhaps for the encoding */
    snow_placement placement; /* of the whole that the volume is a part of */
    snow_clip clip;           /* what of it the part has and answers for */
    snow_slab slab;           /* slices of the whole that are drawn */
    bool all;                 /* these are all that the part answers for */
    /* The same for the exact methods, which see the stored voxels only. */
    snow_placement stored;
    snow_slab stored_slab;
    int channels;
    snow_over_fn *lay; /* in the place of over; NULL: over */
    float *pixels;     /* the local image: transparent, to be filled */
    float *depths;     /* of its pixels (depth.h); NULL: not asked for */
    snow_stats *stats;
} snow_job;

/* Lines 01 and 02 for every method: settings, camera, and slab `part` of
 * `parts` of the slices that the volume answers for.  Fills a job. */
snow_status snow_job_begin(snow_frame *frame, const snow_volume *volume,
                           const snow_transfer *transfer, const snow_view *view,
                           const snow_settings *settings, int parts, int part,
                           snow_job *job);

/* Whether the job draws all voxels that there are: one part of one is that. */
bool snow_job_whole(const snow_job *job);

/* What snow_sheared_splat wants, with slices along an axis: those of the job's
 * slab, or all that the volume answers for.  `placement` is filled and must
 * last as long as the order. */
snow_status snow_job_order(const snow_job *job, int axis,
                           snow_placement *placement,
                           snow_sheared_order *order);

/* The axes' shares in the picture; only the job's own has one but in quality
 * high.  One that the method cannot draw leaves its share to the others. */
snow_status snow_job_shares(const snow_job *job, double shares[3]);

/* Lines 03 to 13 by an exact method, into job->pixels; deterministic ones group
 * by group (decompose/part.h), a node of them. */
snow_status snow_job_render_exact(snow_frame *frame, snow_job *job);
snow_status snow_job_render_node(snow_frame *frame, snow_job *job,
                                 snow_group_node node);

/* Whether of a node's two halves the one of lower slices is in front. */
bool snow_group_rises(const snow_placement *placement, snow_group_node node);

/* What was chosen for the picture, and counts of voxels and bytes. */
snow_status snow_job_finish(snow_frame *frame, const snow_job *job);

/* How sheets get into the local image. */
static inline snow_over_fn *snow_job_lay(const snow_job *job) {
    return job->lay ? job->lay : snow_over_pick(SNOW_ISA_SCALAR, job->channels);
}

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
