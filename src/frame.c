/* frame.c - one picture, from voxels to pixels: figure 8 of the paper, whose
 * line numbers stand in the margins here and in footprint.c, which holds lines
 * 03 to 13.  How a stage works is told in its folder. */
#include "frame.h"
#include "base/base.h"
#include "classify/transfer.h"
#include "combine/combine.h"
#include "footprint.h"
#include "image/image.h"

struct snow_frame {
    snow_context *context;
    snow_stats stats;
    snow_exact *exact; /* buffers of original, tested and footprint */
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
    snow_release(frame->context, frame);
}

const snow_stats *snow_frame_stats(const snow_frame *frame) {
    return &frame->stats;
}

/* What was chosen for the picture. */
static void tell_choices(const snow_job *job) {
    snow_stats *stats = job->stats;
    stats->method = job->settings.method;
    stats->footprint = job->settings.footprint;
    stats->slice_axis = job->placement.slice_axis;
    stats->threads = job->settings.threads;
    stats->isa = job->settings.isa;
    stats->quality = job->settings.quality;
    stats->voxels =
        job->placement.columns * job->placement.rows * job->slab.count;
}

/* Figure 8, lines 01 to 03, and room for the stages to come. */
static snow_status prepare(snow_frame *frame, const snow_view *view, int parts,
                           int part, snow_job *job) {
    SNOW_TRY(snow_settings_resolve(job->context, job->volume, &job->settings));
    /* 02 */ SNOW_TRY(snow_placement_make(job->context, &job->volume->info,
                                          view, &job->placement));
    /* 01 */ job->slab = snow_slab_equal(job->placement.slices, parts, part);
    /* 03 */ return snow_exact_prepare(frame->exact, job);
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
    SNOW_TRY(prepare(frame, view, parts, part, &job));
    SNOW_TRY(snow_image_new(frame->context, view->width, view->height,
                            job.channels, &image));
    job.pixels = snow_image_pixels(image);
    /* 04 - 13 */ snow_status status = snow_exact_render(frame->exact, &job);
    frame->stats.seconds_frame = snow_seconds() - start;
    frame->stats.cpu_frame = snow_cpu_seconds() - cpu;
    tell_choices(&job);
    if (status == SNOW_OK)
        status = snow_exact_count(frame->exact, &job);
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
