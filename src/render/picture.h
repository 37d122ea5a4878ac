/* render/picture.h - a picture in the making: the records over which figure 8
 * (frame.c) is one loop.
 *
 *   plan       a picture's job, and the passes that it is made in
 *   parts      of the volume (parts.h): all of it in memory, the slabs of a
 *              file in turn, or this rank's own
 *   method     from a part to its local image: lines 02 to 13
 *   combiner   from local images to the picture: lines 14 to 20
 *
 * Most pictures take one pass.  Depths of mode over are a pass of footprints
 * after it, unless the method makes them itself. */
#ifndef SNOW_RENDER_PICTURE_H
#define SNOW_RENDER_PICTURE_H

#include "render/job.h"

typedef struct snow_picture snow_picture;

/* How a part's voxels become its local image, job->pixels and job->depths or,
 * by those that warp, picture->local.image.  A step that a method does not need
 * is NULL.  The job is that of the picture's pass, or of a slab of it. */
typedef snow_status snow_method_fn(snow_picture *picture, snow_job *job);
typedef struct snow_render_method {
    snow_method_fn *begin;              /* before the slabs of a file are cut */
    snow_method_fn *classify_and_shade; /* 02 - 03 */
    snow_method_fn *encode;             /* 04 - 06 */
    snow_method_fn *splat_and_composite; /* 07 - 13 */
    snow_method_fn *show;                /* 19 - 20: the image to all of the
                                            picture, of one process, by those
                                            that warp */
    snow_method_fn *figures;             /* of a job whose image is made; NULL:
                                            snow_job_finish */
    /* Slabs of a file whose encoding is kept from picture to picture are not
     * read again: says which there are; then of each slab that was drawn
     * whether it is one.  NULL: none. */
    void (*cut)(snow_picture *picture, snow_job *job, snow_slab_cut *cut);
    void (*keep)(snow_picture *picture, snow_job *job, snow_slabs *slabs);
    bool warps;  /* the local image is an intermediate one */
    bool ahead;  /* and may be left to be drawn: picture->drawing */
    bool depths; /* those of mode over are made with the local image */
} snow_render_method;

/* How local images become the picture.  The functions are collective, and each
 * is handed what became of this process's own work; what they return is the
 * same for all.  One process has nobody to wait for. */
typedef snow_status snow_combine_fn(snow_picture *picture, snow_status status);
typedef struct snow_combine_ops {
    /* Not collective: when the plan is made.  Says whether the local image is
     * drawn ahead, before it is asked for. */
    snow_combine_fn *begin;
    /* Before all that is not drawn ahead; makes the range of values known. */
    snow_combine_fn *synchronize;
    /* A place for the pass's local image, which is cleared. */
    snow_combine_fn *place;
    /* 14 - 18 */ snow_status (*combine)(snow_picture *picture,
                                         const snow_job *part,
                                         snow_status status);
    /* 19 - 20 */ snow_combine_fn *display;
    snow_combine_fn *agree;
    /* Collective.  Numbers of all, element by element. */
    snow_status (*reduce)(snow_picture *picture, int64_t *values, size_t count,
                          snow_reduce by);
} snow_combine_ops;

/* One walk over the parts. */
typedef struct snow_render_pass {
    const snow_render_method *method;
    snow_job job; /* the picture's, with what is different in this pass */
    bool depth;   /* it makes the depths of mode over */
} snow_render_pass;

/* The local image of a part. */
typedef struct snow_local_image {
    float *pixels, *depths; /* of the picture's pixels; depths may be NULL */
    /* Deterministic ones of the footprint methods have a layer for each node.
     */
    int layers;
    snow_group_node nodes[SNOW_NODES_MOST];
    /* Methods that warp fill these. */
    snow_placement placement;
    snow_shear_warp_image image;
    bool begun; /* by shear-warp: it has what all parts share */
} snow_local_image;

#define SNOW_PASSES_MOST 4

struct snow_picture {
    snow_frame *frame;
    const snow_combine_ops *combiner;
    snow_monitor monitor; /* stop and progress */
    snow_status refused;  /* of a record of the caller that cannot be read */
    snow_view view;       /* as job.view */
    snow_job job; /* without volume and transfer function when it is begun
                     ahead, as its passes' */
    snow_render_pass passes[SNOW_PASSES_MOST], *pass; /* the present one */
    int pass_count;
    snow_local_image local;
    snow_image *image, *depth; /* NULL where another rank has them */
    const snow_bytes *bytes;   /* wanted instead of the image, which is made by
                                  methods that do not write them; or NULL */
    snow_image *near;          /* depths of the local image */
    snow_stats stats, unused; /* of the passes that draw the picture; depths' */
    snow_ranks_stats ranks_stats;
    double start, start_cpu, start_shared, start_longest;
    bool ahead; /* the local image is begun before it is asked for */
    snow_line_batch *drawing; /* of it, until its end; or NULL */
    bool aside;      /* another picture's local image is still needed */
    double begin_at; /* where drawing begins (snow_value_params) */
};

/* Begins the monitor with settings.stop; `settings` may be NULL. */
void snow_picture_watch(snow_picture *picture, const snow_settings *settings);

/* The plan: the job and, in mode over, the passes. */
snow_status snow_picture_plan(snow_picture *picture,
                              const snow_request *request);

/* Refuses bytes that such a picture cannot be made as. */
snow_status snow_picture_check_bytes(snow_context *context,
                                     const snow_request *request,
                                     const snow_bytes *bytes);

/* The passes of other modes, when the range of values is known. */
snow_status snow_picture_plan_mode(snow_picture *picture);

/* Depths that the local image gets, NaN as yet.  Errors: SNOW_STATUS_NO_MEMORY.
 */
snow_status snow_picture_new_depths(snow_picture *picture, snow_image **out);

/* A step of a method, which may have none. */
static inline snow_status snow_step(snow_method_fn *step, snow_picture *picture,
                                    snow_job *job) {
    return step ? step(picture, job) : SNOW_STATUS_OK;
}

static inline snow_status snow_method_figures(const snow_render_method *method,
                                              snow_picture *picture,
                                              snow_job *job) {
    return method->figures ? method->figures(picture, job)
                           : snow_job_finish(picture->frame, job);
}

/* Returns whether of a node's two halves the one of lower slices is in
 * front. */
bool snow_group_rises(const snow_placement *placement, snow_group_node node);

extern const snow_render_method snow_method_footprint, snow_method_groups,
    snow_method_raycast, snow_method_shear_warp;

/* These belong to snow_method_footprint (footprint/footprint.c). The first
 * frees its buffers, which are kept from picture to picture; adds a job's
 * voxels and bytes to job->stats, once its image is made. Errors:
 * SNOW_STATUS_NO_MEMORY. */
void snow_footprint_buffers_free(snow_footprint_buffers *buffers);
snow_status snow_footprint_count(snow_footprint_buffers *buffers,
                                 const snow_job *job);

/* One process has nothing to combine. */
extern const snow_combine_ops snow_combine_alone;

/* Collective.  Darkens a picture that has its depths, by settings.occlusion and
 * depth_darkening.  Errors: `status`; no memory; a stop; of reading slabs. */
snow_status snow_darken(snow_picture *picture, snow_status status);

/* The part of settings.occlusion (modes/occlusion.c). */
snow_status snow_occlude(snow_picture *picture);

/* Ends a picture, whatever became of it: the frame gets its figures and depths,
 * and the caller its image; where it failed, its images are freed. */
snow_status snow_picture_end(snow_picture *picture, snow_status status,
                             snow_image **image);

#endif
