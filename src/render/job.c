/* render/job.c - see job.h. */
#include "render/job.h"

#include "classify/count_interesting.h"
#include "classify/hidden.h"
#include "render/ghosts.h"

#include <string.h>

/* The slices that the volume answers for. */
static void place_slab(snow_job *job) {
    snow_clip *clip = &job->clip;
    snow_clip_make(job->volume, &job->placement, clip);
    snow_clip_placement(clip, &job->placement, &job->stored);
    job->slab = (snow_slab){clip->first[2], clip->count[2]};
    job->stored_slab = job->slab;
    job->stored_slab.first -= clip->stored[2];
}

/* A deterministic picture is one of whole slices. */
static snow_status check_part(const snow_job *job) {
    if (!job->volume->is_part)
        return SNOW_STATUS_OK;
    if (job->settings.deterministic && job->clip.cuts)
        return snow_fail(
            job->context, SNOW_STATUS_BAD_USAGE,
            "deterministic pictures need slabs along %c, and this part of the "
            "volume is not one; partition the volume into slabs",
            "xyz"[job->placement.slice_axis]);
    return snow_ghosts_check(
        job->context, job->volume, job->view, &job->settings,
        snow_transfer_slopes(job->transfer, &job->volume->info));
}

bool snow_can_lack_voxels(const snow_settings *settings) {
    return settings->mode == SNOW_MODE_OVER && !settings->depth &&
           !settings->deterministic &&
           settings->method == SNOW_METHOD_SHEAR_WARP;
}

/* Checks a part that lacks what another look showed nothing of. */
static snow_status check_left_out(const snow_job *job) {
    const snow_volume_info *info = &job->volume->info;
    const snow_left_out *left = &job->volume->left_out;
    const double a = info->slope * left->low + info->intercept;
    const double b = info->slope * left->high + info->intercept;
    if (!left->any ||
        (snow_can_lack_voxels(&job->settings) && !job->layer_count &&
         !(job->view->fov > 0) &&
         snow_is_hidden(job->transfer, info, job->settings.threshold,
                        left->spare, a < b ? a : b, a < b ? b : a)))
        return SNOW_STATUS_OK;
    return snow_fail(job->context, SNOW_STATUS_BAD_USAGE,
                     "the volume was opened for one look, without the voxels "
                     "of values %g to %g, which this picture needs; open it "
                     "without one_look (snow_ranks_options)",
                     a < b ? a : b, a < b ? b : a);
}

/* Rays are walked from end to end by one process; only surfaces are met by
 * parts, too. */
static snow_status check_raycast(const snow_job *job) {
    const snow_settings *s = &job->settings;
    if (s->method != SNOW_METHOD_RAYCAST || s->mode == SNOW_MODE_ISO)
        return SNOW_STATUS_OK;
    if (job->volume->stream)
        return snow_fail(
            job->context, SNOW_STATUS_NO_MEMORY,
            "%s: method raycast needs all voxels in memory, but they stay in "
            "the file; allow more memory, open a part by --crop, or take "
            "another method",
            job->volume->path);
    if (!snow_job_whole(job))
        return snow_fail(
            job->context, SNOW_STATUS_BAD_USAGE,
            "method raycast needs the whole volume in one process; render on "
            "one rank, or take another method");
    return SNOW_STATUS_OK;
}

/* What shear-warp cannot draw is left to footprints; isosurfaces, which they
 * have none of, to rays. */
static void choose_method(snow_job *job, const snow_volume_info *whole) {
    snow_settings *s = &job->settings;
    const bool iso = s->mode == SNOW_MODE_ISO;
    if (s->method == SNOW_METHOD_SHEAR_WARP &&
        !snow_value_fits(whole, &job->placement, s))
        s->method = iso ? SNOW_METHOD_RAYCAST : SNOW_METHOD_FOOTPRINT;
}

snow_status snow_job_begin(snow_context *context, const snow_request *request,
                           snow_stats *stats, snow_job *job) {
    snow_volume_info whole;
    *stats = (snow_stats){.size = sizeof *stats};
    *job = (snow_job){
        .context = context,
        .volume = request->volume,
        .transfer = request->transfer,
        .view = request->view,
        .settings = *request->settings,
        .channels = request->transfer->grey ? 2 : 4,
        .layers = request->layers,
        .layer_count = request->layer_count,
        .stats = stats,
    };
    snow_volume_whole(job->volume, &whole);
    SNOW_TRY(
        snow_settings_resolve(context, &job->volume->info, &job->settings));
    SNOW_TRY(snow_placement_make(context, &whole, job->view, &job->placement));
    SNOW_TRY(check_left_out(job));
    choose_method(job, &whole);
    place_slab(job);
    SNOW_TRY(check_raycast(job));
    SNOW_TRY(snow_layers_check(job));
    return check_part(job);
}

bool snow_job_whole(const snow_job *job) {
    const snow_placement *p = &job->placement;
    const int64_t *count = job->clip.count;
    return count[0] == p->columns && count[1] == p->rows &&
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

/* --- figures -------------------------------------------------------------- */

/* Where neighbours' voxels are encoded too, for what their kernels reach: the
 * part's own are counted, when they were encoded anew. */
static snow_status count_own(snow_frame *frame, const snow_job *job) {
    snow_stats *stats = job->stats;
    const int64_t *count = job->clip.count;
    stats->voxels = count[0] * count[1] * count[2];
    if (job->settings.method == SNOW_METHOD_SHEAR_WARP ||
        job->volume->stream) /* what was counted serves, of slabs too */
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_count_interesting(
        job->volume, job->transfer, job->settings.threshold, job->settings.isa,
        job->settings.threads, &frame->own_interesting));
    stats->interesting = frame->own_interesting;
    return SNOW_STATUS_OK;
}

snow_status snow_job_finish(snow_frame *frame, const snow_job *job) {
    snow_stats *stats = job->stats;
    stats->method = job->settings.method;
    stats->footprint = job->settings.footprint;
    stats->slice_axis = job->placement.slice_axis;
    stats->threads = job->settings.threads;
    stats->isa = job->settings.isa;
    stats->quality = job->settings.quality;
    stats->kernel = job->settings.kernel;
    stats->voxels = job->stored.columns * job->stored.rows * job->slab.count;
    if (stats->method == SNOW_METHOD_FOOTPRINT)
        stats->encoded = true; /* for every picture */
    const bool ghosts =
        memcmp(job->clip.size, job->clip.count, sizeof job->clip.size) != 0;
    if (ghosts)
        SNOW_TRY(count_own(frame, job));
    if (job->volume->left_out.any)
        stats->voxels = snow_box_voxels(&job->volume->left_out.box);
    if (stats->voxels > 0)
        stats->sparse_ratio =
            1 - (double)stats->interesting / (double)stats->voxels;
    return SNOW_STATUS_OK;
}
