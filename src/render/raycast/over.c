/* render/raycast/over.c - mode over: samples in the middle of steps, coloured,
 * shaded and composited front to back. */
#include "render/raycast/raycast.h"

#include "base/exp_log.h"
#include "base/vec3.h"
#include "transfer/scale.h"

#include <math.h>

/* A ray ends where less than this is left to be seen. */
#define CLOSED 1e-6

/* Samples that are shaded together. */
#define BATCH 8

typedef struct over_batch {
    float samples[4 * BATCH]; /* straight colours, and opacities of steps */
    double t[BATCH];
    float flat[BATCH]; /* how much of their light is that of cut faces */
    bool own[BATCH];   /* of the picture's volume, not of a layer */
    int group[BATCH];  /* samples of one number are mixed */
    int count;
} over_batch;

/* The pixel so far; the last channel is its opacity. */
typedef struct over_state {
    double pixel[4];
    double opaque; /* of its volume alone, whose depth it has */
    float *depth;
    over_batch batch;
    double mixed[4];   /* of the group that is gathered */
    int group, mixing; /* of the next sample; of that */
    bool ground;       /* that has the picture's volume */
} over_state;

void snow_raycast_see_look(snow_raycast_pass *pass) {
    const snow_transfer *transfer = pass->transfer;
    const snow_opacity_point *points = transfer->opacities;
    size_t first = 0, last = transfer->opacity_count;
    while (first < last && points[first].opacity == 0)
        first++;
    while (last > first && points[last - 1].opacity == 0)
        last--;
    if (first == last) { /* nothing is seen */
        pass->visible[0] = INFINITY;
        return;
    }
    if (first > 0)
        pass->visible[0] = points[first - 1].value;
    if (last < transfer->opacity_count)
        pass->visible[1] = points[last].value;
    const snow_scale scale = {pass->field.log, pass->field.linear};
    for (int n = 0; n < 2 && (scale.log || scale.linear > 0); n++)
        if (isfinite(pass->visible[n]))
            pass->visible[n] = snow_scale_place(scale, pass->visible[n]);
}

/* --- compositing ---------------------------------------------------------- */

/* The group that is gathered; that of the picture may have a white ground. */
static void composite(const snow_raycast_pass *pass, int last,
                      over_state *state) {
    double *mixed = state->mixed, through = 1 - state->pixel[last];
    if (state->ground && pass->transfer->white > 0 && last == 3)
        through *= snow_white_share(pass->transfer->white,
                                    fmin(mixed[0], fmin(mixed[1], mixed[2])),
                                    mixed[last]);
    for (int c = 0; c <= last; c++) {
        state->pixel[c] += through * mixed[c];
        mixed[c] = 0;
    }
    state->ground = false;
}

/* Colours of samples in one place add up, of opacities the largest counts. */
static void gather(const snow_raycast_pass *pass, const snow_ray *ray,
                   over_state *state, int n) {
    const int last = pass->job->channels - 1;
    const float *sample = state->batch.samples + n * (last + 1);
    const double before = state->opaque, alpha = (double)sample[last];
    if (state->batch.group[n] != state->mixing)
        composite(pass, last, state);
    state->mixing = state->batch.group[n];
    for (int c = 0; c < last; c++)
        state->mixed[c] += (double)sample[c];
    state->mixed[last] = fmax(state->mixed[last], alpha);
    if (!state->batch.own[n])
        return;
    state->ground = true;
    state->opaque += (1 - before) * alpha;
    if (!state->depth || before >= 0.5 || state->opaque < 0.5)
        return;
    /* Opacity grows within a step as that of even matter does. */
    double share = 0;
    if (alpha < 1)
        share = snow_log(0.5 / (1 - before)) / snow_log(1 - alpha);
    *state->depth = snow_raycast_depth(
        pass, ray, state->batch.t[n] + (share - 0.5) * ray->step);
}

/* Shades and composites what is gathered. */
static void flush(const snow_raycast_pass *pass, const snow_ray *ray,
                  snow_raycast_eye *eye, over_state *state) {
    over_batch *batch = &state->batch;
    int channels = pass->job->channels;
    if (pass->shaded)
        snow_shade_gradients(
            &eye->shader, (const double(*)[SNOW_SHADE_BLOCK])eye->gradients,
            batch->flat, batch->count, channels, batch->samples);
    else {
        for (int n = 0; n < batch->count; n++)
            for (int c = 0; c < channels - 1; c++)
                batch->samples[n * channels + c] *=
                    batch->samples[n * channels + channels - 1];
    }
    for (int n = 0; n < batch->count; n++)
        gather(pass, ray, state, n);
    batch->count = 0;
}

/* --- samples -------------------------------------------------------------- */

/* The factor of a gradient opacity: of the gradient of data values, where the
 * field is of their logarithms too. */
static double gradient_factor(const snow_raycast_pass *pass, double data,
                              const double gradient[3]) {
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += snow_dot(pass->shader.metric[i], gradient) * gradient[i];
    double magnitude = sqrt(fmax(square, 0));
    if (pass->field.log)
        magnitude *= 0.69314718055994530942 * data;
    if (pass->field.linear > 0)
        magnitude *= fmax(fabs(data), pass->field.linear);
    return snow_transfer_evaluate_gradient(pass->transfer, magnitude);
}

/* The opacity of a reference length at a position, 0 where it is not
 * interesting, and the gradient where it is wanted. */
static double find_opacity(const snow_raycast_pass *pass, const double at[3],
                           double value, double data, snow_raycast_eye *eye,
                           double gradient[3]) {
    double threshold = pass->job->settings.threshold;
    double opacity = snow_transfer_opacity(pass->transfer, data);
    if (!snow_is_interesting(opacity, threshold))
        return 0;
    if (pass->labels && (pass->shaded || pass->gradient_factors))
        snow_field_label_gradient(&pass->field, at, value, gradient);
    else if (pass->shaded || pass->gradient_factors)
        snow_field_gradient(&pass->field, at, value, eye->sides, gradient);
    if (pass->gradient_factors)
        opacity *= gradient_factor(pass, data, gradient);
    if (pass->shaded && !pass->labels)
        snow_field_add_border(&pass->field, at, gradient);
    return snow_is_interesting(opacity, threshold) ? opacity : 0;
}

/* Adds a sample to the batch. */
static void add_sample(const snow_raycast_pass *pass, const snow_ray *ray,
                       double t, const double at[3], double value,
                       snow_raycast_eye *own, snow_raycast_eye *eye,
                       over_state *state) {
    over_batch *batch = &state->batch;
    int n = batch->count, channels = pass->job->channels;
    const snow_scale scale = {pass->field.log, pass->field.linear};
    double data =
        scale.log || scale.linear > 0 ? snow_scale_value(scale, value) : value;
    double gradient[3] = {0, 0, 0}, rgb[3];
    double opacity = find_opacity(pass, at, value, data, own, gradient);
    if (opacity == 0)
        return;
    snow_transfer_color(pass->transfer, data, rgb);
    for (int c = 0; c < channels - 1; c++)
        batch->samples[n * channels + c] = (float)rgb[c];
    batch->samples[n * channels + channels - 1] = (float)snow_opacity_of(
        snow_clarity(opacity),
        snow_exponent_within(ray->step / pass->job->settings.opacity_length));
    for (int axis = 0; axis < 3; axis++)
        eye->gradients[axis][n] = gradient[axis];
    batch->t[n] = t;
    batch->flat[n] = snow_raycast_flatness(pass, at);
    batch->own[n] = own == eye;
    batch->group[n] = state->group;
    batch->count++;
}

/* A step of a ray in a layer; false: nothing is seen between these voxels. */
static bool step(const snow_raycast_pass *pass, const snow_raycast_pass *base,
                 const snow_ray *ray, double t, const double at[3],
                 snow_raycast_eye *own, snow_raycast_eye *eye,
                 over_state *state) {
    snow_field_place(&pass->field, at, &own->near);
    const bool visible = own->near.least <= pass->visible[1] &&
                         own->near.most >= pass->visible[0];
    if (!visible)
        return false;
    double value = pass->labels ? snow_field_label(&pass->field, at, &own->near,
                                                   pass->nearest)
                                : snow_field_value(&own->near);
    if (!isnan(value))
        add_sample(pass, ray, t, at, value, own, eye, state);
    if (state->batch.count == BATCH)
        flush(base, ray, eye, state);
    return true;
}

void snow_raycast_over(const snow_raycast_pass *pass, const snow_ray *ray,
                       snow_raycast_eye *eye, float *pixel, float *depth) {
    over_state state = {.depth = depth};
    int channels = pass->job->channels;
    int64_t skip = 1;
    for (int64_t i = 0; i < ray->steps; i += skip) {
        double t = ray->enter + ((double)i + 0.5) * ray->step, at[3];
        bool seen = false;
        snow_ray_at(ray, t, at);
        for (int n = pass->layer_count - 1; n >= 0; n--) {
            seen |= step(&pass->layers[n], pass, ray, t, at, &eye->layers[n],
                         eye, &state);
            state.group += !pass->layers[n].mixes;
        }
        seen |= step(pass, pass, ray, t, at, eye, eye, &state);
        state.group++;
        skip = seen ? 1 : snow_ray_skip(ray, at);
        if (state.pixel[channels - 1] > 1 - CLOSED &&
            (!depth || state.opaque >= 0.5))
            break;
    }
    flush(pass, ray, eye, &state);
    composite(pass, channels - 1, &state);
    const double most =
        pass->layer_count ? state.pixel[channels - 1] : INFINITY;
    for (int c = 0; c < channels; c++)
        pixel[c] = (float)fmin(state.pixel[c], most);
}
