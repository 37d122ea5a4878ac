/* render/modes/projection.c - the modes whose order does not matter as a method
 * of figure 8, by shear-warp: pairs (value, weight) of the slices' lattice. */
#include "render/modes/sums.h"
#include "render/picture.h"

static bool is_largest(const snow_job *job) {
    snow_mode mode = job->settings.mode;
    return mode == SNOW_MODE_MIP || mode == SNOW_MODE_MINIP;
}

static snow_status encode(snow_picture *p, snow_job *job) {
    snow_local_image *local = &p->local;
    SNOW_TRY(snow_job_shear_warp_params(job, p->pass->axis, &local->placement,
                                        &local->params));
    SNOW_TRY(snow_shear_warp_new(job->context, &p->frame->shear_warp[0]));
    local->shear_warp = p->frame->shear_warp[0];
    local->params.share =
        is_largest(job) ? 1 : 1 / (float)local->placement.slices;
    return snow_shear_warp_encode(local->shear_warp, &local->params,
                                  job->stats);
}

/* There is nothing between slices. */
static snow_status reduce(snow_picture *p, snow_job *job) {
    snow_local_image *local = &p->local;
    const snow_identity_transfer *identity = &p->frame->identity;
    double range =
        identity->high > identity->low ? identity->high - identity->low : 1;
    const snow_value_scale scale = {identity->kind.inverted ? identity->high
                                                            : identity->low,
                                    identity->kind.inverted ? -range : range};
    if (!local->placement.perspective)
        return snow_shear_warp_project(local->shear_warp, &local->params,
                                       is_largest(job), &scale, job->stats,
                                       &local->image);
    SNOW_TRY(snow_shear_warp_begin(local->shear_warp, &local->params, false,
                                   job->stats, &local->image));
    p->drawing = snow_shear_warp_batch(local->shear_warp);
    return SNOW_STATUS_OK;
}

const snow_render_method snow_method_projection = {
    .encode = encode,
    .splat_and_composite = reduce,
    .warps = true,
};
