/* render/value/method.c - the value path as a method of figure 8.  Its image
 * is warped within, so that the local image is the picture. */
#include "render/picture.h"
#include "render/value/value.h"

static snow_value_params params_of(const snow_job *job) {
    return (snow_value_params){.volume = job->volume,
                               .transfer = job->transfer,
                               .view = job->view,
                               .settings = &job->settings,
                               .placement = &job->placement,
                               .channels = job->channels,
                               .whole = snow_job_whole(job)};
}

static snow_status classify(snow_picture *p, snow_job *job) {
    const snow_value_params params = params_of(job);
    SNOW_TRY(snow_value_path_new(job->context, &p->frame->value_path));
    return snow_value_classify(p->frame->value_path, &params, job->stats);
}

static snow_status encode(snow_picture *p, snow_job *job) {
    const snow_value_params params = params_of(job);
    return snow_value_encode(p->frame->value_path, &params, job->stats);
}

static snow_status draw(snow_picture *p, snow_job *job) {
    const snow_value_params params = params_of(job);
    return snow_value_draw(p->frame->value_path, &params, job->pixels,
                           job->stats);
}

const snow_render_method snow_method_value = {
    .classify_and_shade = classify,
    .encode = encode,
    .splat_and_composite = draw,
};
