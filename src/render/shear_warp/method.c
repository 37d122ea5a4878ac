/* render/shear_warp/method.c - shear-warp as a method of figure 8.  A
 * picture's parts, of which those of a file come one after another, share a
 * lattice, a table and an image. */
#include "render/picture.h"

static snow_value_params params_of(const snow_picture *p, const snow_job *job) {
    bool surface = job->settings.mode == SNOW_MODE_ISO;
    const int *lines = p->frame->lines;
    const uint64_t of = job->volume->generation; /* 0: of no other picture */
    return (snow_value_params){
        .volume = job->volume,
        .transfer = job->transfer,
        .counted = surface ? p->frame->identity.transfer : job->transfer,
        .view = job->view,
        .settings = &job->settings,
        .placement = &job->placement,
        .stored = &job->stored,
        .clip = &job->clip,
        .slab = job->slab,
        .channels = job->channels,
        .layers = job->layers,
        .layer_count = job->layer_count,
        .shared = p->combiner != &snow_combine_alone,
        .aside = p->aside,
        .resumes = p->local.image.layers > 0,
        .begin_at = p->begin_at,
        .bytes = p->local.pixels ? NULL : p->bytes,
        .lines = {lines[0], lines[1] ? lines[1] : p->view.height},
        .more = p->frame->more && of && p->frame->tiles_of == of};
}

/* Once.  The image comes first, for the slabs of a file are cut to the memory
 * that it leaves. */
static snow_status begin_picture(snow_picture *p, snow_job *job) {
    if (p->local.begun)
        return SNOW_STATUS_OK;
    if (job->volume->stream && job->settings.encoding == SNOW_ENCODING_AUTO)
        job->settings.encoding = SNOW_ENCODING_BITMAP; /* one for all slabs */
    const snow_value_params params = params_of(p, job);
    SNOW_TRY(snow_value_path_new(job->context, &p->frame->value_path));
    if (job->volume->stream)
        snow_value_forget(p->frame->value_path);
    else
        snow_value_forget_slabs(p->frame->value_path);
    p->local.placement = job->placement;
    p->local.begun = true;
    return snow_value_begin(p->frame->value_path, &params, job->stats);
}

static snow_status encode(snow_picture *p, snow_job *job) {
    const snow_value_params params = params_of(p, job);
    SNOW_TRY(snow_value_encode_layers(p->frame->value_path, &params));
    return snow_value_encode(p->frame->value_path, &params, job->stats);
}

static snow_status draw_part(snow_picture *p, snow_job *job) {
    const snow_value_params params = params_of(p, job);
    SNOW_TRY(snow_value_place_layers(p->frame->value_path, &params));
    p->frame->tiles_of = 0;
    SNOW_TRY(snow_value_draw(p->frame->value_path, &params, job->stats,
                             &p->local.image, p->ahead ? &p->drawing : NULL));
    p->frame->tiles_of = job->volume->generation;
    return SNOW_STATUS_OK;
}

static snow_status show(snow_picture *p, snow_job *job) {
    const snow_value_params params = params_of(p, job);
    if (params.bytes && p->local.image.width == 0) {
        snow_bytes_clear(p->view.width, p->view.height, params.bytes);
        return SNOW_STATUS_OK;
    }
    return snow_value_display(p->frame->value_path, &params, &p->local.image,
                              p->local.pixels, job->stats);
}

/* --- slabs of a file ------------------------------------------------------ */

static const snow_volume *kept(void *user, const snow_extent *part,
                               int64_t slices) {
    const snow_picture *p = user;
    const snow_value_params params = params_of(p, &p->pass->job);
    return snow_value_kept(p->frame->value_path, &params, part, slices);
}

static void cut(snow_picture *p, snow_job *job, snow_slab_cut *slabs) {
    const snow_value_params params = params_of(p, job);
    snow_value_cut_slabs(p->frame->value_path, &params, slabs);
    slabs->kept = kept;
    slabs->user = p;
}

static void keep(snow_picture *p, snow_job *job, snow_slabs *slabs) {
    const snow_value_params params = params_of(p, job);
    if (p->pass_count > 1) /* which reads them in another way */
        snow_value_forget(p->frame->value_path);
    else
        snow_value_keep(p->frame->value_path, &params, slabs);
}

const snow_render_method snow_method_shear_warp = {
    .begin = begin_picture,
    .classify_and_shade = begin_picture,
    .encode = encode,
    .splat_and_composite = draw_part,
    .show = show,
    .cut = cut,
    .keep = keep,
    .warps = true,
    .ahead = true,
};
