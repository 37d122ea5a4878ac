/* render/picture.c - the plan of a picture: its job and the passes that it
 * is made in. */
#include "render/picture.h"

#include "render/modes/depth.h"

#include <math.h>
#include <string.h>

/* --- passes --------------------------------------------------------------- */

static const snow_render_method *method_of(const snow_job *job) {
    const snow_settings *s = &job->settings;
    if (s->method == SNOW_METHOD_RAYCAST)
        return &snow_method_raycast;
    if (s->method == SNOW_METHOD_SHEAR_WARP)
        return &snow_method_shear_warp;
    return s->deterministic ? &snow_method_groups : &snow_method_footprint;
}

static snow_render_pass *add_pass(snow_picture *p, const snow_job *job) {
    snow_render_pass *pass = &p->passes[p->pass_count++];
    *pass = (snow_render_pass){.job = *job, .method = method_of(job)};
    return pass;
}

/* Depths of over are found by footprints once more, of opacity alone; those of
 * isosurfaces by rays. */
static void add_depth(snow_picture *p) {
    const bool iso = p->job.settings.mode == SNOW_MODE_ISO;
    snow_render_pass *pass = add_pass(p, &p->job);
    pass->depth = true;
    pass->job.stats = &p->unused;
    pass->job.settings.method =
        iso ? SNOW_METHOD_RAYCAST : SNOW_METHOD_FOOTPRINT;
    pass->job.settings.shade = SNOW_SHADE_NONE;
    pass->job.settings.deterministic =
        false; /* it has one order of operations */
    pass->method = method_of(&pass->job);
}

/* What fails has a pass too, for other ranks wait for this one in it. */
snow_status snow_picture_plan_mode(snow_picture *p) {
    snow_job job = p->job;
    snow_status status = SNOW_STATUS_OK;
    if (job.settings.mode == SNOW_MODE_OVER)
        return SNOW_STATUS_OK;
    if (job.settings.mode != SNOW_MODE_ISO)
        status = snow_modes_value_weight(p->frame, &p->job, &job);
    else if (job.settings.method == SNOW_METHOD_SHEAR_WARP)
        status = snow_identity_transfer_above(&job, &p->frame->identity);
    if (job.settings.mode != SNOW_MODE_MEAN &&
        job.settings.mode != SNOW_MODE_SUM)
        job.settings.deterministic = false; /* bits do not depend on parts */
    const snow_render_pass *pass = add_pass(p, &job);
    if (job.settings.mode == SNOW_MODE_ISO && job.settings.depth &&
        !pass->method->depths)
        add_depth(p);
    return status;
}

/* --- the plan ------------------------------------------------------------- */

static snow_status check_depth(const snow_job *job) {
    const snow_mode mode = job->settings.mode;
    if (!job->settings.depth || mode == SNOW_MODE_OVER || mode == SNOW_MODE_ISO)
        return SNOW_STATUS_OK;
    return snow_fail(job->context, SNOW_STATUS_BAD_USAGE,
                     "mode %s has no depth; use mode over or iso",
                     snow_mode_name(mode));
}

static snow_status plan_job(snow_picture *p, snow_request *request) {
    snow_status status = SNOW_STATUS_OK;
    if (!request->volume->stream) {
        status = snow_layers_place(p->frame, request);
        request->layers = p->frame->placed;
    }
    if (status != SNOW_STATUS_OK)
        request->layer_count = 0;
    SNOW_TRY(snow_job_begin(p->frame->context, request, &p->stats, &p->job));
    SNOW_TRY(status);
    SNOW_TRY(check_depth(&p->job));
    if (p->job.settings.mode != SNOW_MODE_OVER)
        return SNOW_STATUS_OK;
    const snow_render_pass *pass = add_pass(p, &p->job);
    if (p->job.settings.depth && !pass->method->depths)
        add_depth(p);
    return SNOW_STATUS_OK;
}

/* A record that cannot be read is refused by the plan. */
void snow_picture_watch(snow_picture *p, const snow_settings *settings) {
    snow_settings known;
    SNOW_RECORD_READ(NULL, snow_settings, settings, &known);
    snow_monitor_begin(p->frame->context, &p->monitor, known.stop,
                       known.stop_user);
}

/* The caller's view and settings; the defaults where they cannot be read. */
static snow_status read_request(snow_picture *p, const snow_request *asked,
                                snow_settings *settings) {
    snow_context *context = p->frame->context;
    snow_view_init(&p->view);
    snow_settings_init(settings);
    SNOW_TRY(p->refused);
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, asked->view, &p->view));
    return SNOW_RECORD_READ(context, snow_settings, asked->settings, settings);
}

snow_status snow_picture_plan(snow_picture *p, const snow_request *asked) {
    snow_settings settings;
    snow_request request = *asked;
    char message[SNOW_MESSAGE_BYTES];
    p->ranks_stats =
        (snow_ranks_stats){.size = sizeof p->ranks_stats, .ranks = 1};
    p->start = snow_seconds();
    p->start_cpu = snow_cpu_seconds();
    p->start_shared = p->frame->context->shared;
    p->start_longest = p->frame->context->longest;
    request.settings = &settings;
    request.view = &p->view;
    snow_status found = read_request(p, asked, &settings);
    memcpy(message, p->frame->context->message, sizeof message);
    /* This is done even where there is nothing to plan, so that all ranks
     * begin in the same way. */
    snow_status status = plan_job(p, &request);
    /* It is as in snow_picture_plan_mode. */
    if (status != SNOW_STATUS_OK && !p->pass_count)
        add_pass(p, &p->job);
    return found == SNOW_STATUS_OK
               ? status
               : snow_fail(p->frame->context, found, "%s", message);
}

snow_status snow_picture_check_bytes(snow_context *context,
                                     const snow_request *request,
                                     const snow_bytes *bytes) {
    snow_view view;
    snow_settings settings;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, request->view, &view));
    SNOW_TRY(
        SNOW_RECORD_READ(context, snow_settings, request->settings, &settings));
    if (bytes->stride / 4 < (size_t)(view.width > 0 ? view.width : 0))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "a row of %d pixels does not fit %zu bytes; use a "
                         "stride of 4 bytes a pixel or more",
                         view.width, bytes->stride);
    for (int n = 0; bytes->background && n < 3; n++)
        if (!(bytes->background[n] >= 0 && bytes->background[n] <= 1))
            return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                             "the background has a channel of %g; use 0 to 1",
                             bytes->background[n]);
    if (settings.mode == SNOW_MODE_MEAN || settings.mode == SNOW_MODE_SUM)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "mode %s makes data values, not colours; use "
                         "snow_frame_render and snow_image_apply_colormap",
                         snow_mode_name(settings.mode));
    return SNOW_STATUS_OK;
}

snow_status snow_picture_new_depths(snow_picture *p, snow_image **out) {
    snow_monitor *monitor = p->job.context->monitor;
    const int width = p->view.width, height = p->view.height;
    SNOW_TRY(snow_image_make(p->job.context, width, height, 1, out));
    float *line = p->local.depths = (*out)->pixels;
    for (int y = 0; y < height && !snow_monitor_look(monitor, 0); y++)
        for (int x = 0; x < width; x++)
            *line++ = NAN;
    return snow_monitor_status(monitor);
}

/* --- the end -------------------------------------------------------------- */

snow_status snow_darken(snow_picture *p, snow_status status) {
    const double mark = snow_seconds(), mark_cpu = snow_cpu_seconds();
    const snow_settings *settings = &p->job.settings;
    if (status == SNOW_STATUS_OK && settings->occlusion > 0)
        status = snow_occlude(p);
    if (status == SNOW_STATUS_OK && settings->depth_darkening > 0) {
        if (p->image && p->depth)
            status = snow_depth_darken(&p->job, p->depth, p->image);
        status = p->combiner->agree(p, status);
    }
    if (p->combiner == &snow_combine_alone) { /* others count their calls */
        p->stats.seconds_frame += snow_seconds() - mark;
        p->stats.cpu_frame += snow_cpu_seconds() - mark_cpu;
    }
    return status;
}

snow_status snow_picture_end(snow_picture *p, snow_status status,
                             snow_image **image) {
    snow_frame *frame = p->frame;
    frame->pictures++;
    frame->stats = p->stats;
    frame->ranks_stats = p->ranks_stats;
    snow_image_free(p->near);
    snow_image_free(frame->depth);
    frame->depth = NULL;
    if (status != SNOW_STATUS_OK) {
        snow_image_free(p->image);
        snow_image_free(p->depth);
        return status;
    }
    frame->depth = p->depth;
    /* To write a picture to a file: a copy of its pixels, and the state of who
     * packs them.  Ranks had room for the exchange, and may draw the next
     * picture.
     */
    const uint64_t pixels = (uint64_t)p->view.width * (uint64_t)p->view.height;
    if (p->frame->value_path && p->combiner == &snow_combine_alone)
        snow_value_leave_memory(p->frame->value_path, 16 * pixels + (1 << 20));
    *image = p->image;
    return SNOW_STATUS_OK;
}
