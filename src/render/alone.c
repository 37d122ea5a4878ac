/* render/alone.c - the combiner of one process, which has no partner: its local
 * image is the picture.  Slabs of a file come in turn, from front to back: each
 * is drawn on top of what the slabs in front of it have left, which is over in
 * order. */
#include "render/picture.h"

#include "base/clear.h"

/* --- before the local image ----------------------------------------------- */

/* What one process finds is what all find. */
static snow_status nobody(snow_picture *p, snow_status status) {
    (void)p;
    return status;
}

static snow_status keep(snow_picture *p, int64_t *values, size_t count,
                        snow_reduce by) {
    (void)p, (void)values, (void)count, (void)by;
    return SNOW_STATUS_OK;
}

static snow_status fail_part(const snow_picture *p, const char *what,
                             const char *name) {
    return snow_fail(p->job.context, SNOW_STATUS_BAD_USAGE,
                     "%s%s needs all parts of the volume, and this is one of "
                     "several; call snow_ranks_render",
                     what, name);
}

static snow_status find_values(snow_picture *p) {
    snow_frame *frame = p->frame;
    snow_data_range range, layers[SNOW_LAYERS_MAX];
    SNOW_TRY(snow_value_path_new(frame->context, &frame->value_path));
    SNOW_TRY(snow_value_measure(
        frame->value_path, p->job.volume,
        p->job.settings.mode == SNOW_MODE_OVER ? p->job.transfer : NULL,
        p->job.settings.threads, &range));
    snow_value_set_range(frame->value_path, &range);
    for (int n = 0; n < p->job.layer_count; n++)
        SNOW_TRY(snow_value_measure_layer(frame->value_path, n,
                                          &p->job.layers[n],
                                          p->job.settings.threads, &layers[n]));
    return snow_value_set_layers(frame->value_path, layers, p->job.layer_count);
}

static snow_status synchronize(snow_picture *p, snow_status status) {
    const snow_settings *s = &p->job.settings;
    SNOW_TRY(status);
    snow_image_free(p->frame->depth);
    p->frame->depth = NULL;
    if (s->method == SNOW_METHOD_SHEAR_WARP)
        SNOW_TRY(find_values(p));
    if (s->mode == SNOW_MODE_OVER)
        return s->depth && !snow_job_whole(&p->job) ? fail_part(p, "depth", "")
                                                    : SNOW_STATUS_OK;
    if (!snow_job_whole(&p->job))
        return fail_part(p, "mode ", snow_mode_name(s->mode));
    return snow_identity_transfer_measure(&p->job, &p->frame->identity);
}

/* --- places --------------------------------------------------------------- */

/* The frame's layer, cleared for what is drawn into it. */
static snow_status take_layer(snow_picture *p, size_t bytes, bool clear) {
    snow_frame *frame = p->frame;
    SNOW_TRY(snow_reserve(frame->context, &frame->layer, 0, 1, bytes));
    p->local.pixels = frame->layer;
    return clear ? snow_clear(frame->context, frame->layer, bytes)
                 : SNOW_STATUS_OK;
}

/* A shear-warp picture is written once, and whole. */
static snow_status make_image(snow_picture *p) {
    bool written = p->pass->method->warps;
    if (written && p->bytes && p->job.settings.depth_darkening == 0 &&
        p->job.settings.occlusion == 0)
        return SNOW_STATUS_OK;
    if (p->image)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_image_make(p->job.context, p->view.width, p->view.height,
                             p->job.channels, &p->image));
    return written ? SNOW_STATUS_OK
                   : snow_clear(p->job.context, p->image->pixels,
                                snow_job_bytes(&p->job));
}

static snow_status place_over(snow_picture *p) {
    const snow_job *job = &p->pass->job;
    SNOW_TRY(make_image(p));
    if (job->settings.depth && p->pass->method->depths)
        SNOW_TRY(snow_picture_new_depths(p, &p->depth));
    p->local.pixels = p->image ? p->image->pixels : NULL;
    return SNOW_STATUS_OK;
}

static snow_status place_volume(snow_picture *p, snow_status status) {
    const snow_job *job = &p->pass->job;
    SNOW_TRY(status);
    p->local.layers = 1;
    p->local.nodes[0] = (snow_group_node){SNOW_GROUP_RANKS, 0};
    if (p->pass->method == &snow_method_groups &&
        job->slab.count != job->placement.slices)
        return fail_part(p, "deterministic rendering", "");
    if (p->pass->depth) {
        SNOW_TRY(snow_picture_new_depths(p, &p->depth));
        return take_layer(p, snow_job_bytes(job), true);
    }
    if (job->settings.mode == SNOW_MODE_OVER ||
        job->settings.mode == SNOW_MODE_ISO)
        return place_over(p);
    /* Pairs, which become the image when they are shown: also those of lines
     * that are not drawn. */
    return take_layer(p, snow_job_bytes(job),
                      !p->pass->method->warps || p->frame->lines[1]);
}

/* --- combination ---------------------------------------------------------- */

static snow_status combine(snow_picture *p, const snow_job *part,
                           snow_status status) {
    (void)part;
    SNOW_TRY(status);
    if (p->drawing) {
        double mark = snow_seconds();
        snow_line_batch_end(p->drawing);
        p->stats.seconds_splat += snow_seconds() - mark;
        p->drawing = NULL;
    }
    return SNOW_STATUS_OK;
}

/* --- the picture ---------------------------------------------------------- */

static snow_status show(snow_picture *p) {
    snow_mode mode = p->job.settings.mode;
    if (mode != SNOW_MODE_OVER && mode != SNOW_MODE_ISO) {
        SNOW_TRY(snow_step(p->pass->method->show, p, &p->pass->job));
        return snow_modes_paint(p->frame, &p->job, p->local.pixels, &p->image);
    }
    if (!p->pass->method->warps)
        return SNOW_STATUS_OK;
    if (p->local.image.layers > 1)
        return fail_part(p, "deterministic rendering", "");
    return p->pass->method->show(p, &p->pass->job);
}

static snow_status display(snow_picture *p, snow_status status) {
    SNOW_TRY(status);
    if (!p->pass->depth)
        SNOW_TRY(show(p));
    p->stats.seconds_frame = snow_seconds() - p->start;
    p->stats.cpu_frame = snow_cpu_seconds() - p->start_cpu;
    if (p->stats.threads > 1)
        return SNOW_STATUS_OK;
    p->stats.seconds_shared = p->frame->context->shared - p->start_shared;
    p->stats.seconds_longest = p->frame->context->longest - p->start_longest;
    return SNOW_STATUS_OK;
}

const snow_combine_ops snow_combine_alone = {.begin = nobody,
                                             .synchronize = synchronize,
                                             .place = place_volume,
                                             .combine = combine,
                                             .display = display,
                                             .agree = nobody,
                                             .reduce = keep};
