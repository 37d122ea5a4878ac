/* render/job.h - the plan of a picture (line 01 of figure 8): settings made
 * definite, the camera, and the part of the volume that is drawn.  It is made
 * once and then only read, but for the places of its pixels. */
#ifndef SNOW_RENDER_JOB_H
#define SNOW_RENDER_JOB_H

#include "composite/over.h"
#include "decompose/slab.h"
#include "render/modes/modes.h"
#include "render/shear_warp/shear_warp.h"

#include <snowglass/ranks.h>

typedef struct snow_footprint_buffers
    snow_footprint_buffers;           /* render/footprint/footprint.c */
typedef struct snow_ranks snow_ranks; /* parallel/internal.h */

/* What was read of a layer in its file (layers.c); `of` it and for `part`. */
typedef struct snow_layer_file {
    snow_volume *volume; /* or NULL */
    uint64_t of, part;   /* generations */
} snow_layer_file;

/* Buffers of the methods, kept from picture to picture. */
struct snow_frame {
    snow_context *context;
    snow_stats stats;
    snow_ranks_stats ranks_stats;
    snow_footprint_buffers *footprint;
    float *layer; /* local pixels that are not the picture's */
    float *spare[SNOW_GROUP_RANKS];  /* pictures of groups, to be combined */
    int64_t own_interesting;         /* of the part that was encoded last */
    snow_identity_transfer identity; /* of the pass; of modes but over */
    snow_mode_colors mode_colors;
    snow_image *depth;           /* of the last picture; NULL: not asked for */
    snow_value_path *value_path; /* of method shear-warp; NULL until needed */
    snow_layer layers[SNOW_LAYERS_MAX]; /* as the caller gave them; */
    snow_layer placed[SNOW_LAYERS_MAX]; /* what the present part has of them */
    snow_layer_file read[SNOW_LAYERS_MAX];
    int layer_count;
    snow_ranks *ranks; /* of pictures by many ranks; NULL until needed */
    /* The first line of the picture that is drawn, and one past the last; {0,
     * 0}: all.  Others are undefined.  `more`: the volume, the look, the view
     * and the settings are those of the last picture, whose tiles are there; it
     * is ignored where the volume is another.  Of shear-warp in one process. */
    int lines[2];
    bool more;
    uint64_t pictures; /* so far */
    uint64_t
        tiles_of; /* generation of the volume whose tiles are there; 0: none */
};

/* Frees a frame, but for what many ranks need (parallel/internal.h). */
void snow_buffers_free(snow_frame *frame);

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
    /* The same for the footprint methods, which see the stored voxels only. */
    snow_placement stored;
    snow_slab stored_slab;
    int channels;
    const snow_layer *layers; /* volumes on the same grid, or their files */
    int layer_count;
    snow_composite_fn *composite; /* in the place of over; NULL: over */
    float *pixels; /* the local image: transparent, to be filled */
    float
        *depths; /* of its pixels (render/modes/depth.h); NULL: not asked for */
    snow_stats *stats;
} snow_job;

/* Checks every setting and replaces what is 0 or AUTO by what is meant for
 * this volume, but for the encoding, which is measured later.
 * Errors: SNOW_STATUS_BAD_USAGE with the setting's name and range. */
snow_status snow_settings_resolve(snow_context *context,
                                  const snow_volume_info *info,
                                  snow_settings *settings);

/* Returns whether pictures are made without voxels of which the look shows
 * nothing, by resolved settings. */
bool snow_can_lack_voxels(const snow_settings *settings);

/* What a picture is to be made of. */
typedef struct snow_request {
    const snow_volume *volume;
    const snow_transfer *transfer;
    const snow_view *view;
    const snow_settings *settings; /* of the caller, or resolved */
    const snow_layer *layers;
    int layer_count;
} snow_request;

/* --- layers.c ---

 * Places what the request's volume, in memory, needs of the frame's layers.
 * Errors: of snow_volume_take_box, and of views. */
snow_status snow_layers_place(snow_frame *frame, const snow_request *request);

/* What was read of layers from `first` on. */
void snow_layers_drop(snow_frame *frame, int first);

/* Refuses layers that cannot be drawn; where one has colours, so has the
 * picture. */
snow_status snow_layers_check(snow_job *job);

/* --- job.c ---

 * Settings, camera and part.  Fills a job as far as it gets: method and slice
 * axis are known where settings and view are right. */
snow_status snow_job_begin(snow_context *context, const snow_request *request,
                           snow_stats *stats, snow_job *job);

/* Returns whether the job draws all voxels that there are. */
bool snow_job_whole(const snow_job *job);

/* What was chosen for the picture, and how much of it is interesting, when its
 * method has counted. */
snow_status snow_job_finish(snow_frame *frame, const snow_job *job);

/* How sheets get into the local image. */
static inline snow_composite_fn *snow_job_composite(const snow_job *job) {
    return job->composite ? job->composite : snow_over_of(job->channels);
}

/* Clears what a sheet of slice `slice` of the stored ones holds of samples that
 * are not the part's. */
void snow_job_clip_sheet(const snow_job *job, int64_t slice, snow_sheet *sheet);

/* Bytes of the local pixels. */
static inline size_t snow_job_bytes(const snow_job *job) {
    return (size_t)job->view->width * (size_t)job->view->height *
           (size_t)job->channels * sizeof(float);
}

#endif
