/* render/shear_warp/method.c - shear-warp as a method of figure 8: the encoding
 * is of data values, so that the tables of look and light (lines 02 and 03) are
 * made after it, for what is drawn of it. */
#include "render/picture.h"

static snow_status encode(snow_picture *p, snow_job *job) {
    snow_local_image *local = &p->local;
    bool high = job->settings.quality == SNOW_QUALITY_HIGH && job->all;
    snow_shear_warp **shear_warp =
        &p->frame->shear_warp[high ? p->pass->axis : 0];
    SNOW_TRY(snow_job_shear_warp_params(job, p->pass->axis, &local->placement,
                                        &local->params));
    local->params.begin_at = p->begin_at;
    if (job->settings.deterministic && local->params.clip.cuts)
        return snow_fail(job->context, SNOW_STATUS_BAD_USAGE,
                         "deterministic pictures of several ranks cannot blend "
                         "several axes; use quality normal");
    SNOW_TRY(snow_shear_warp_new(job->context, shear_warp));
    local->shear_warp = *shear_warp;
    return snow_shear_warp_encode(*shear_warp, &local->params, job->stats);
}

/* The bands are left to be drawn. */
static snow_status begin_bands(snow_picture *p, snow_job *job) {
    snow_local_image *local = &p->local;
    SNOW_TRY(snow_shear_warp_begin(local->shear_warp, &local->params, p->aside,
                                   job->stats, &local->image));
    p->drawing = snow_shear_warp_batch(local->shear_warp);
    return SNOW_STATUS_OK;
}

const snow_render_method snow_method_shear_warp = {
    .encode = encode,
    .splat_and_composite = begin_bands,
    .warps = true,
    .ahead = true,
};
