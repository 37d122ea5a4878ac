/* frame.c - one picture, from voxels to pixels: figure 8 of the paper, whose
 * line numbers stand in the margins here and in footprint.c, which holds lines
 * 03 to 13.  How a stage works is told in its folder. */
#include "frame.h"
#include "base/base.h"
#include "classify/fade.h"
#include "classify/tally.h"
#include "classify/transfer.h"
#include "combine/combine.h"
#include "composite/over.h"
#include "depth.h"
#include "footprint.h"
#include "ghosts.h"
#include "image/image.h"
#include "perspective.h"
#include "ranks_parts.h"
#include "sheared.h"
#include "slabs.h"
#include "volume/stream.h"

#include <string.h>

snow_status snow_frame_new(snow_context *context, snow_frame **out) {
    snow_frame *frame = snow_allocate_clear(context, sizeof *frame);
    if (!frame)
        return SNOW_NO_MEMORY;
    frame->context = context;
    snow_status status = snow_exact_new(context, &frame->exact);
    if (status == SNOW_OK)
        *out = frame;
    else
        snow_frame_free(frame);
    return status;
}

void snow_frame_free(snow_frame *frame) {
    if (!frame)
        return;
    snow_ranks_free(frame->ranks);
    snow_exact_free(frame->exact);
    for (int axis = 0; axis < 3; axis++)
        snow_sheared_free(frame->sheared[axis]);
    for (int n = 0; n < SNOW_GROUP_RANKS; n++)
        snow_release(frame->context, frame->spare[n]);
    snow_release(frame->context, frame->layer);
    snow_ramp_fini(&frame->ramp);
    snow_iso_free(frame->iso);
    snow_levels_free(frame->levels);
    snow_work_fini(frame->context, &frame->work);
    snow_image_free(frame->depth);
    snow_release(frame->context, frame);
}

const snow_image *snow_frame_depth(const snow_frame *frame) {
    return frame->depth;
}

const snow_stats *snow_frame_stats(const snow_frame *frame) {
    return &frame->stats;
}

/* Slab `part` of `parts` of the slices that the volume answers for. */
static void cut_slab(snow_job *job, int parts, int part) {
    snow_clip *clip = &job->clip;
    snow_clip_make(job->volume, &job->placement, clip);
    snow_clip_placement(clip, &job->placement, &job->stored);
    job->slab = snow_slab_equal(clip->count[2], parts, part);
    job->stored_slab = job->slab;
    job->slab.first += clip->first[2];
    job->stored_slab.first += clip->first[2] - clip->stored[2];
    job->all = job->slab.count == clip->count[2];
}

/* A deterministic picture is one of whole slices. */
static snow_status check_part(const snow_job *job) {
    if (!job->volume->is_part)
        return SNOW_OK;
    if (job->settings.deterministic && job->clip.cuts)
        return snow_fail(job->context, SNOW_BAD_USAGE,
                         "deterministic pictures are made of slabs along %c; "
                         "this part of the volume is none",
                         "xyz"[job->placement.slice_axis]);
    return snow_ghosts_check(job->context, job->volume, job->view,
                             &job->settings,
                             snow_transfer_fades(job->transfer));
}

/* Of a volume whose voxels stay in their file, bands are made, or pictures of
 * parts (slabs.h), and nothing else sees voxels. */
static snow_status check_stream(const snow_job *job, int parts) {
    if (!job->volume->stream || parts == 1)
        return SNOW_OK;
    return snow_fail(job->context, SNOW_BAD_USAGE,
                     "slabs: a volume whose voxels stay in their file is "
                     "rendered as a whole; open it with snow_volume_open");
}

/* What the kernel has to know of a level. */
static void tell_level(const snow_volume *volume, snow_placement *p) {
    if (volume->fine[0] == 0)
        return;
    p->fine[0] = volume->fine[p->u_axis];
    p->fine[1] = volume->fine[p->v_axis];
}

static snow_status place(snow_job *job, int parts, int part) {
    snow_volume_info whole;
    snow_volume_whole(job->volume, &whole);
    SNOW_TRY(snow_settings_resolve(job->context, &job->volume->info,
                                   &job->settings));
    SNOW_TRY(
        snow_placement_make(job->context, &whole, job->view, &job->placement));
    tell_level(job->volume, &job->placement);
    if (job->settings.method == SNOW_METHOD_SHEARED &&
        !snow_sheared_fits(&job->placement, &job->settings))
        job->settings.method = SNOW_METHOD_FOOTPRINT;
    SNOW_TRY(check_stream(job, parts));
    cut_slab(job, parts, part);
    return check_part(job);
}

snow_status snow_job_begin(snow_frame *frame, const snow_volume *volume,
                           const snow_transfer *transfer, const snow_view *view,
                           const snow_settings *settings, int parts, int part,
                           snow_job *job) {
    frame->stats = (snow_stats){.ranks = 1};
    *job = (snow_job){
        .context = frame->context,
        .volume = volume,
        .transfer = transfer,
        .view = view,
        .settings = snow_settings_known(settings),
        .channels = transfer->grey ? 2 : 4,
        .stats = &frame->stats,
    };
    return place(job, parts, part);
}

bool snow_job_whole(const snow_job *job) {
    const snow_placement *p = &job->placement;
    const int64_t *count = job->clip.count;
    return job->all && count[0] == p->columns && count[1] == p->rows &&
           count[2] == p->slices;
}

void snow_job_clip_sheet(const snow_job *job, int64_t slice,
                         snow_sheet *sheet) {
    if (!job->clip.cuts || sheet->x0 >= sheet->x1)
        return;
    for (int y = sheet->y0; y < sheet->y1; y++)
        snow_clip_pixels(
            &job->clip, &job->placement, slice + job->clip.stored[2], sheet->x0,
            y, sheet->x1 - sheet->x0, job->channels,
            sheet->pixels + ((size_t)(y - sheet->top) * (size_t)sheet->width +
                             (size_t)sheet->x0) *
                                (size_t)job->channels);
}

/* --- the sheared method ---------------------------------------------------
 */

snow_status snow_job_order(const snow_job *job, int axis,
                           snow_placement *placement,
                           snow_sheared_order *order) {
    snow_volume_info whole;
    snow_volume_whole(job->volume, &whole);
    SNOW_TRY(snow_placement_make_along(job->context, &whole, job->view, axis,
                                       placement));
    tell_level(job->volume, placement);
    *order = (snow_sheared_order){.volume = job->volume,
                                  .transfer = job->transfer,
                                  .view = job->view,
                                  .settings = &job->settings,
                                  .placement = placement,
                                  .slab = job->slab,
                                  .channels = job->channels,
                                  .lay = job->lay};
    snow_clip_make(job->volume, placement, &order->clip);
    if (job->all)
        order->slab = (snow_slab){order->clip.first[2], order->clip.count[2]};
    return SNOW_OK;
}

/* Lines 03 to 13 with slices along an axis. */
static snow_status render_sheared(snow_job *job, int axis,
                                  snow_sheared **sheared, float *pixels) {
    snow_placement placement;
    snow_sheared_order order;
    SNOW_TRY(snow_job_order(job, axis, &placement, &order));
    if (!*sheared)
        SNOW_TRY(snow_sheared_new(job->context, sheared));
    return snow_sheared_render(*sheared, &order, pixels, job->stats);
}

/* Adds share * layer to the picture. */
static void blend(float *pixels, const float *layer, float share,
                  size_t count) {
    for (size_t i = 0; i < count; i++)
        pixels[i] += share * layer[i];
}

snow_status snow_job_shares(const snow_job *job, double shares[3]) {
    snow_volume_info info;
    double left = 1;
    shares[0] = shares[1] = shares[2] = 0;
    shares[job->placement.slice_axis] = 1;
    if (job->settings.quality != SNOW_QUALITY_HIGH)
        return SNOW_OK;
    snow_volume_whole(job->volume, &info);
    snow_placement_shares(&info, &job->placement, shares);
    for (int axis = 0; axis < 3; axis++) {
        snow_placement placement;
        if (shares[axis] == 0 || axis == job->placement.slice_axis)
            continue;
        SNOW_TRY(snow_placement_make_along(job->context, &info, job->view, axis,
                                           &placement));
        tell_level(job->volume, &placement);
        if (!snow_sheared_fits(&placement, &job->settings)) {
            left -= shares[axis];
            shares[axis] = 0;
        }
    }
    for (int axis = 0; axis < 3; axis++)
        shares[axis] /= left;
    return SNOW_OK;
}

/* High quality of a whole volume: where two or three axes are nearly as good,
 * the picture is a blend of theirs, so that a turning one does not jump. */
static snow_status render_blended(snow_frame *frame, snow_job *job) {
    size_t floats = (size_t)job->view->width * (size_t)job->view->height *
                    (size_t)job->channels;
    double shares[3];
    SNOW_TRY(snow_job_shares(job, shares));
    SNOW_TRY(snow_reserve(frame->context, &frame->layer, &frame->layer_capacity,
                          0, floats * sizeof *frame->layer));
    for (int axis = 0; axis < 3; axis++) {
        if (shares[axis] == 0)
            continue;
        SNOW_TRY(
            render_sheared(job, axis, &frame->sheared[axis], frame->layer));
        blend(job->pixels, frame->layer, (float)shares[axis], floats);
    }
    return SNOW_OK;
}

/* --- the exact methods ----------------------------------------------------
 */

snow_status snow_job_render_exact(snow_frame *frame, snow_job *job) {
    return job->placement.perspective ? snow_perspective_render(job)
                                      : snow_exact_render(frame->exact, job);
}

/* What the exact methods know of a slab only when it is made; outside of the
 * frame's seconds. */
static snow_status count_exact(snow_frame *frame, const snow_job *job) {
    if (job->placement.perspective) /* snow_perspective_render has counted */
        return SNOW_OK;
    return snow_exact_count(frame->exact, job);
}

/* One group, as a slab: what is counted of it is added to what was. */
static snow_status render_group(snow_frame *frame, const snow_job *job,
                                snow_slab slab, float *pixels) {
    snow_stats *stats = job->stats, before = *stats;
    snow_job group = *job;
    group.slab = group.stored_slab = slab;
    group.stored_slab.first -= job->clip.stored[2];
    group.pixels = pixels;
    stats->interesting = 0;
    stats->ea_bytes = stats->ia_bytes = stats->pa_bytes = 0;
    SNOW_TRY(snow_job_render_exact(frame, &group));
    SNOW_TRY(count_exact(frame, &group));
    stats->interesting += before.interesting;
    stats->ea_bytes += before.ea_bytes;
    stats->ia_bytes += before.ia_bytes;
    stats->pa_bytes += before.pa_bytes;
    return SNOW_OK;
}

bool snow_group_rises(const snow_placement *p, snow_group_node node) {
    if (!p->perspective)
        return p->nearest_first;
    int middle = (2 * node.index + 1) << (node.rank - 1);
    return p->eye.at[2] <
           (double)snow_group_slab(p->slices, middle).first - 0.5;
}

/* A node into `pixels`, which are transparent. */
static snow_status render_node(snow_frame *frame, const snow_job *job,
                               snow_group_node node, float *pixels) {
    size_t count = (size_t)job->view->width * (size_t)job->view->height;
    size_t bytes = count * (size_t)job->channels * sizeof *pixels;
    int64_t slices = job->placement.slices;
    snow_slab first = snow_group_slab(slices, node.index << node.rank);
    if (first.count == 0)
        return SNOW_OK; /* as all behind it */
    if (node.rank == 0)
        return render_group(frame, job, first, pixels);
    float **spare = &frame->spare[node.rank - 1];
    SNOW_TRY(snow_reserve(frame->context, spare,
                          &frame->spare_capacity[node.rank - 1], 0, bytes));
    memset(*spare, 0, bytes);
    bool rises = snow_group_rises(&job->placement, node);
    snow_group_node near = {node.rank - 1, 2 * node.index + !rises};
    snow_group_node far = {node.rank - 1, 2 * node.index + rises};
    SNOW_TRY(render_node(frame, job, near, pixels));
    SNOW_TRY(render_node(frame, job, far, *spare));
    snow_over_row(pixels, *spare, count, job->channels);
    return SNOW_OK;
}

snow_status snow_job_render_node(snow_frame *frame, snow_job *job,
                                 snow_group_node node) {
    return render_node(frame, job, node, job->pixels);
}

/* Deterministic: all groups, for a part of a volume is no picture. */
static snow_status render_groups(snow_frame *frame, snow_job *job) {
    const snow_group_node root = {SNOW_GROUP_RANKS, 0};
    if (job->slab.count != job->placement.slices)
        return snow_fail(job->context, SNOW_BAD_USAGE,
                         "a deterministic picture of one part of many is none; "
                         "render all of them with snow_ranks_render");
    return snow_job_render_node(frame, job, root);
}

/* --- a picture ------------------------------------------------------------
 */

/* Lines 03 to 13, by the picture's method. */
static snow_status render_slab(snow_frame *frame, snow_job *job) {
    if (job->settings.method != SNOW_METHOD_SHEARED)
        return job->volume->stream ? snow_slabs_exact(frame, job)
               : job->settings.deterministic
                   ? render_groups(frame, job)
                   : snow_job_render_exact(frame, job);
    if (job->settings.quality == SNOW_QUALITY_HIGH && job->all)
        return render_blended(frame, job);
    return render_sheared(job, job->placement.slice_axis, &frame->sheared[0],
                          job->pixels);
}

static bool has_ghosts(const snow_clip *clip) {
    return memcmp(clip->size, clip->count, sizeof clip->size) != 0;
}

/* Where neighbours' voxels are encoded too, for what their kernels reach: the
 * part's own are counted, when they were encoded anew. */
static snow_status count_own(snow_frame *frame, const snow_job *job) {
    snow_stats *stats = job->stats;
    const int64_t *count = job->clip.count;
    if (stats->encoded || job->settings.method != SNOW_METHOD_SHEARED)
        SNOW_TRY(snow_count_interesting(
            job->volume, job->transfer, job->settings.threshold,
            job->settings.isa, &frame->own_interesting));
    stats->voxels = count[0] * count[1] * count[2];
    stats->interesting = frame->own_interesting;
    return SNOW_OK;
}

snow_status snow_job_finish(snow_frame *frame, const snow_job *job) {
    snow_stats *stats = job->stats;
    bool sheared = job->settings.method == SNOW_METHOD_SHEARED;
    stats->method = job->settings.method;
    stats->footprint = job->settings.footprint;
    stats->slice_axis = job->placement.slice_axis;
    stats->threads = job->settings.threads;
    stats->isa = job->settings.isa;
    stats->quality = job->settings.quality;
    stats->kernel = job->settings.kernel;
    stats->voxels = job->stored.columns * job->stored.rows * job->slab.count;
    if (stats->method == SNOW_METHOD_FOOTPRINT)
        stats->encoded = 1; /* for every picture */
    /* Else groups have counted, or slabs. */
    if (!sheared && !job->settings.deterministic && !job->volume->stream)
        SNOW_TRY(count_exact(frame, job));
    if (has_ghosts(&job->clip) && job->all)
        SNOW_TRY(count_own(frame, job));
    if (stats->voxels > 0)
        stats->sparse_ratio =
            1 - (double)stats->interesting / (double)stats->voxels;
    return SNOW_OK;
}

/* Room for the depths of a picture, if they are asked for. */
static snow_status make_depth(snow_frame *frame, const snow_job *job) {
    snow_mode mode = job->settings.mode;
    snow_image_free(frame->depth);
    frame->depth = NULL;
    if (!job->settings.depth)
        return SNOW_OK;
    if (mode != SNOW_MODE_OVER && mode != SNOW_MODE_ISO)
        return snow_fail(frame->context, SNOW_BAD_USAGE,
                         "mode %s has no depth; take over or iso",
                         snow_mode_name(mode));
    return snow_image_new(frame->context, job->view->width, job->view->height,
                          1, &frame->depth);
}

/* Lines 03 to 13 and the picture of them. */
static snow_status render_over(snow_frame *frame, snow_job *job,
                               snow_image **out) {
    snow_image *image = NULL;
    /* A sheared picture that is not blended is written once, and whole. */
    bool written = job->settings.method == SNOW_METHOD_SHEARED &&
                   job->settings.quality != SNOW_QUALITY_HIGH;
    SNOW_TRY((written ? snow_image_make : snow_image_new)(
        frame->context, job->view->width, job->view->height, job->channels,
        &image));
    job->pixels = snow_image_pixels(image);
    snow_status status = render_slab(frame, job);
    if (status == SNOW_OK)
        *out = image;
    else
        snow_image_free(image);
    return status;
}

snow_status snow_frame_render_slab(snow_frame *frame, const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   const snow_view *view,
                                   const snow_settings *settings, int parts,
                                   int part, snow_image **out) {
    double start = snow_seconds(), cpu = snow_cpu_seconds();
    snow_job job;
    snow_image *image = NULL;
    snow_settings resolved = snow_settings_known(settings);
    int halvings[3] = {0, 0, 0};
    if (parts == 1) {
        SNOW_TRY(
            snow_settings_resolve(frame->context, &volume->info, &resolved));
        SNOW_TRY(snow_levels_take(&frame->levels, volume, transfer, view,
                                  &resolved, &volume, halvings));
    }
    /* 01 - 02 */ SNOW_TRY(snow_job_begin(frame, volume, transfer, view,
                                          &resolved, parts, part, &job));
    memcpy(frame->stats.halvings, halvings, sizeof halvings);
    bool over = job.settings.mode == SNOW_MODE_OVER;
    SNOW_TRY(make_depth(frame, &job));
    SNOW_TRY(over ? render_over(frame, &job, &image)
                  : snow_modes_render(frame, &job, &image));
    frame->stats.seconds_frame = snow_seconds() - start;
    frame->stats.cpu_frame = snow_cpu_seconds() - cpu;
    snow_status status = over ? snow_job_finish(frame, &job) : SNOW_OK;
    if (status == SNOW_OK && over && frame->depth)
        status = volume->stream ? snow_slabs_depth(frame, &job)
                                : snow_depth_over(frame, &job);
    if (status == SNOW_OK)
        *out = image;
    else
        snow_image_free(image);
    return status;
}

snow_status snow_frame_render(snow_frame *frame, const snow_volume *volume,
                              const snow_transfer *transfer,
                              const snow_view *view,
                              const snow_settings *settings,
                              snow_image **image) {
    snow_image *local;
    if (frame->ranks && snow_ranks_busy(frame->ranks))
        return snow_fail(frame->context, SNOW_BAD_USAGE,
                         "a picture of many ranks is under way in this frame; "
                         "finish it first");
    SNOW_TRY(snow_frame_render_slab(frame, volume, transfer, view, settings, 1,
                                    0, &local));
    /* 14 - 18: one processor has no partner; its local image is the picture. */
    float *pixels = snow_image_pixels(local);
    snow_combine_tree(&pixels, 1, (size_t)view->width * (size_t)view->height,
                      snow_image_channels(local));
    /* 19 - 20 */ *image = local;
    return SNOW_OK;
}
