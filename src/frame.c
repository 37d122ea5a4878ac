/* frame.c - one picture: figure 8 of the paper, with its line numbers in the
 * margin.  render/picture.h has its records, README.md the folder of each. */
#include "parallel/internal.h"
#include "render/parts.h"

/* Lines 02 to 13: from a part of the volume to its local image. */
static snow_status draw(snow_picture *p, snow_job *part) {
    const snow_render_method *m = p->pass->method;
    /* 02 - 03 */ SNOW_TRY(snow_step(m->classify_and_shade, p, part));
    /* 04 - 06 */ SNOW_TRY(snow_step(m->encode, p, part));
    /* 07 - 13 */ return m->splat_and_composite(p, part);
}

/* Figure 8.  A local image that was begun ahead is there already. */
static snow_status render_pass(snow_picture *p, snow_status status) {
    const snow_combine_ops *combiner = p->combiner;
    snow_parts parts;
    snow_job *part;
    if (!p->ahead)
        status = combiner->place(p, status);
    /* 01 */ status = snow_parts_open(&parts, p, status);
    while ((part = snow_parts_next(&parts, &status)))
        if (status == SNOW_STATUS_OK && !p->ahead)
            /* 02 - 13 */ status = draw(p, part);
    status = snow_parts_close(&parts, status);
    /* 14 - 18 */ status = combiner->combine(p, &p->pass->job, status);
    /* 19 - 20 */ return combiner->display(p, status);
}

/* The plan, and the local image where it is drawn ahead. */
static snow_status begin(snow_picture *p, const snow_request *request) {
    snow_status status = p->combiner->begin(p, snow_picture_plan(p, request));
    p->pass = p->passes;
    return status == SNOW_STATUS_OK && p->ahead ? draw(p, &p->pass->job)
                                                : status;
}

/* All passes.  Depths come last, when the picture's figures are known. */
static snow_status complete(snow_picture *p, snow_status status) {
    if (!p->ahead) {
        SNOW_TRY(p->combiner->synchronize(p, status));
        status = snow_picture_plan_mode(p);
    }
    for (int n = 0; n < p->pass_count; n++) {
        const snow_render_pass *next = &p->passes[n + 1];
        p->pass = &p->passes[n];
        SNOW_TRY(status = render_pass(p, status));
        if (!p->ahead && !p->pass->depth &&
            (n + 1 == p->pass_count || next->depth))
            status = snow_method_figures(p->pass->method, p, &p->pass->job);
    }
    return p->ahead ? status : snow_darken(p, p->combiner->agree(p, status));
}

/* --- a picture of one process --------------------------------------------- */

/* Where `bytes` are wanted and the method has written them, *image is NULL. */
static snow_status render_alone(snow_frame *frame, const snow_request *request,
                                const snow_bytes *bytes, snow_image **image) {
    if (frame->ranks && snow_ranks_busy(frame->ranks))
        return snow_fail(frame->context, SNOW_STATUS_BAD_USAGE,
                         "this frame has a picture of several ranks in flight; "
                         "call snow_ranks_finish first");
    snow_picture p = {
        .frame = frame, .combiner = &snow_combine_alone, .bytes = bytes};
    snow_picture_watch(&p, request->settings);
    snow_status status = complete(&p, begin(&p, request));
    return snow_picture_end(&p, snow_monitor_end(&p.monitor, status), image);
}

snow_status snow_frame_render(snow_frame *frame, const snow_volume *volume,
                              const snow_transfer *transfer,
                              const snow_view *view,
                              const snow_settings *settings,
                              snow_image **image) {
    const snow_request request = {volume,   transfer,      view,
                                  settings, frame->layers, frame->layer_count};
    return render_alone(frame, &request, NULL, image);
}

snow_status snow_frame_render_bytes(
    snow_frame *frame, const snow_volume *volume, const snow_transfer *transfer,
    const snow_view *view, const snow_settings *settings,
    const double background[3], unsigned char *pixels, size_t stride) {
    const snow_request request = {volume,   transfer,      view,
                                  settings, frame->layers, frame->layer_count};
    const snow_bytes bytes = {pixels, stride, background};
    snow_image *image = NULL;
    SNOW_TRY(snow_picture_check_bytes(frame->context, &request, &bytes));
    SNOW_TRY(render_alone(frame, &request, &bytes, &image));
    if (image) /* of a method that did not write them */
        snow_bytes_image(image, frame->stats.isa, &bytes);
    snow_image_free(image);
    return SNOW_STATUS_OK;
}

/* --- pictures of many ranks, two of which may be under way ---------------- */

static void complete_waiting(snow_picture *p) {
    snow_pipeline_done(p, complete(p, snow_pipeline_resume(p)));
}

snow_status
snow_ranks_begin(snow_frame *frame, snow_comm *comm, const snow_volume *volume,
                 const snow_transfer *transfer, const snow_view *view,
                 const snow_settings *settings, const snow_ranks_options *how) {
    const snow_request request = {volume,   transfer,      view,
                                  settings, frame->layers, frame->layer_count};
    snow_picture *p, *waiting;
    SNOW_TRY(snow_pipeline_open(frame, comm, settings, how, &p));
    snow_pipeline_begun(p, begin(p, &request));
    while (!p->ahead && (waiting = snow_pipeline_waiting(frame)))
        complete_waiting(waiting);
    return SNOW_STATUS_OK;
}

snow_status snow_ranks_finish(snow_frame *frame, snow_image **image) {
    snow_picture *p = snow_pipeline_oldest(frame);
    if (p)
        complete_waiting(p);
    return snow_pipeline_take(frame, image);
}

snow_status
snow_ranks_render(snow_frame *frame, snow_comm *comm, const snow_volume *volume,
                  const snow_transfer *transfer, const snow_view *view,
                  const snow_settings *settings, const snow_ranks_options *how,
                  snow_image **image) {
    if (frame->ranks && frame->ranks->in_flight)
        return snow_fail(
            frame->context, SNOW_STATUS_BAD_USAGE,
            "this frame has a picture in flight; call snow_ranks_finish first");
    snow_status status;
    do { /* once more where only some ranks could begin ahead */
        SNOW_TRY(snow_ranks_begin(frame, comm, volume, transfer, view, settings,
                                  how));
        status = snow_ranks_finish(frame, image);
    } while (frame->ranks->apart);
    return status;
}
