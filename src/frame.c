/* frame.c - one picture, from voxels to pixels: figure 8 of the paper, whose
 * line numbers stand in the margins here and in footprint.c, which holds lines
 * 03 to 13.  How a stage works is told in its folder. */
#include "frame.h"
#include "base/base.h"
#include "classify/transfer.h"
#include "combine/combine.h"
#include "footprint.h"
#include "ghosts.h"
#include "image/image.h"
#include "perspective.h"
#include "sheared.h"
#include "volume/volume.h"

struct snow_frame {
    snow_context *context;
    snow_stats stats;
    /* Buffers of the methods, kept from picture to picture.  Those of sheared
     * are made when it is first used; one for each axis where a picture is
     * blended of several, else the first. */
    snow_exact *exact;
    snow_sheared *sheared[3];
    float *layer; /* a picture to be blended */
    size_t layer_capacity;
};

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
    snow_exact_free(frame->exact);
    for (int axis = 0; axis < 3; axis++)
        snow_sheared_free(frame->sheared[axis]);
    snow_release(frame->context, frame->layer);
    snow_release(frame->context, frame);
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

/* Lines 01 and 02 for every method: settings, camera, slab. */
static snow_status place(snow_job *job, const snow_view *view, int parts,
                         int part) {
    snow_volume_info whole;
    snow_volume_whole(job->volume, &whole);
    SNOW_TRY(snow_settings_resolve(job->context, &job->volume->info,
                                   &job->settings));
    SNOW_TRY(snow_placement_make(job->context, &whole, view, &job->placement));
    if (job->settings.method == SNOW_METHOD_SHEARED &&
        !snow_sheared_fits(&job->placement, &job->settings))
        job->settings.method = SNOW_METHOD_FOOTPRINT;
    if (job->volume->is_part)
        SNOW_TRY(
            snow_ghosts_check(job->context, job->volume, view, &job->settings));
    cut_slab(job, parts, part);
    return SNOW_OK;
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

/* Lines 03 to 13 by the sheared method, with slices as `placement` says: those
 * of the job's slab, or all that the volume answers for. */
static snow_status render_sheared(snow_job *job, const snow_view *view,
                                  const snow_placement *placement,
                                  snow_sheared **sheared, float *pixels) {
    snow_sheared_order order = {.volume = job->volume,
                                .transfer = job->transfer,
                                .view = view,
                                .settings = &job->settings,
                                .placement = placement,
                                .slab = job->slab,
                                .channels = job->channels};
    snow_clip_make(job->volume, placement, &order.clip);
    if (job->all)
        order.slab = (snow_slab){order.clip.first[2], order.clip.count[2]};
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

/* The axes' shares; one that the method cannot draw leaves its to the others.
 */
static snow_status share_axes(const snow_job *job, const snow_view *view,
                              double shares[3]) {
    snow_volume_info info;
    double left = 1;
    snow_volume_whole(job->volume, &info);
    snow_placement_shares(&info, &job->placement, shares);
    for (int axis = 0; axis < 3; axis++) {
        snow_placement placement;
        if (shares[axis] == 0 || axis == job->placement.slice_axis)
            continue;
        SNOW_TRY(snow_placement_make_along(job->context, &info, view, axis,
                                           &placement));
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
static snow_status render_blended(snow_frame *frame, snow_job *job,
                                  const snow_view *view) {
    snow_volume_info info;
    size_t floats =
        (size_t)view->width * (size_t)view->height * (size_t)job->channels;
    double shares[3];
    snow_volume_whole(job->volume, &info);
    SNOW_TRY(share_axes(job, view, shares));
    SNOW_TRY(snow_reserve(frame->context, &frame->layer, &frame->layer_capacity,
                          0, floats * sizeof *frame->layer));
    for (int axis = 0; axis < 3; axis++) {
        snow_placement placement;
        if (shares[axis] == 0)
            continue;
        SNOW_TRY(snow_placement_make_along(frame->context, &info, view, axis,
                                           &placement));
        SNOW_TRY(render_sheared(job, view, &placement, &frame->sheared[axis],
                                frame->layer));
        blend(job->pixels, frame->layer, (float)shares[axis], floats);
    }
    return SNOW_OK;
}

/* Lines 03 to 13, by the picture's method. */
static snow_status render_slab(snow_frame *frame, snow_job *job,
                               const snow_view *view) {
    if (job->settings.method != SNOW_METHOD_SHEARED &&
        job->placement.perspective)
        return snow_perspective_render(job);
    if (job->settings.method != SNOW_METHOD_SHEARED)
        return snow_exact_render(frame->exact, job);
    if (job->settings.quality == SNOW_QUALITY_HIGH && job->all)
        return render_blended(frame, job, view);
    return render_sheared(job, view, &job->placement, &frame->sheared[0],
                          job->pixels);
}

/* What was chosen for the picture, and counts of voxels and bytes. */
static snow_status fill_stats(snow_frame *frame, const snow_job *job) {
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
        stats->encoded = 1; /* for every picture */
    if (stats->method != SNOW_METHOD_SHEARED && job->placement.perspective)
        return SNOW_OK; /* snow_perspective_render has counted */
    if (stats->method != SNOW_METHOD_SHEARED)
        return snow_exact_count(frame->exact, job);
    if (stats->voxels > 0)
        stats->sparse_ratio =
            1 - (double)stats->interesting / (double)stats->voxels;
    return SNOW_OK;
}

snow_status snow_frame_render_slab(snow_frame *frame, const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   const snow_view *view,
                                   const snow_settings *settings, int parts,
                                   int part, snow_image **out) {
    double start = snow_seconds(), cpu = snow_cpu_seconds();
    frame->stats = (snow_stats){0};
    snow_job job = {
        .context = frame->context,
        .volume = volume,
        .transfer = transfer,
        .settings = snow_settings_known(settings),
        .channels = transfer->grey ? 2 : 4,
        .stats = &frame->stats,
    };
    snow_image *image = NULL;
    /* 01 */ SNOW_TRY(place(&job, view, parts, part));
    SNOW_TRY(snow_image_new(frame->context, view->width, view->height,
                            job.channels, &image));
    job.pixels = snow_image_pixels(image);
    snow_status status = render_slab(frame, &job, view);
    frame->stats.seconds_frame = snow_seconds() - start;
    frame->stats.cpu_frame = snow_cpu_seconds() - cpu;
    if (status == SNOW_OK)
        status = fill_stats(frame, &job);
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
    SNOW_TRY(snow_frame_render_slab(frame, volume, transfer, view, settings, 1,
                                    0, &local));
    /* 14 - 18: one processor has no partner; its local image is the picture. */
    float *pixels = snow_image_pixels(local);
    snow_combine_tree(&pixels, 1, (size_t)view->width * (size_t)view->height,
                      snow_image_channels(local));
    /* 19 - 20 */ *image = local;
    return SNOW_OK;
}
