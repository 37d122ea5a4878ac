/* render/raycast/over.c - mode over: samples in the middle of steps, coloured,
 * shaded and composited front to back. */
#include "render/raycast/raycast.h"

#include "base/exp_log.h"
#include "base/vec3.h"

#include <math.h>

/* A ray ends where less than this is left to be seen. */
#define CLOSED 1e-6

/* Samples that are shaded together. */
#define BATCH 8

typedef struct over_batch {
    float samples[4 * BATCH]; /* straight colours, and opacities of steps */
    double t[BATCH];
    int count;
} over_batch;

/* The pixel so far; the last channel is its opacity. */
typedef struct over_state {
    double pixel[4];
    float *depth;
    over_batch batch;
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
    for (int n = 0; n < 2 && pass->field.log; n++)
        if (isfinite(pass->visible[n]))
            pass->visible[n] = snow_log2_rising(pass->visible[n]);
}

/* --- compositing ---------------------------------------------------------- */

/* Opacity grows within a step as that of even matter does. */
static void note_depth(const snow_raycast_pass *pass, const snow_ray *ray,
                       double before, double alpha, double t, float *depth) {
    double share = 0;
    if (alpha < 1)
        share = snow_log(0.5 / (1 - before)) / snow_log(1 - alpha);
    *depth = snow_raycast_depth(pass, ray, t + (share - 0.5) * ray->step);
}

static void composite(const snow_raycast_pass *pass, const snow_ray *ray,
                      over_state *state, const float *sample, double t) {
    int last = pass->job->channels - 1;
    double before = state->pixel[last], alpha = (double)sample[last];
    double through = 1 - before;
    for (int c = 0; c < last; c++)
        state->pixel[c] += through * (double)sample[c];
    state->pixel[last] += through * alpha;
    if (state->depth && before < 0.5 && state->pixel[last] >= 0.5)
        note_depth(pass, ray, before, alpha, t, state->depth);
}

static void multiply_colors(int channels, over_batch *batch) {
    for (int n = 0; n < batch->count; n++)
        for (int c = 0; c < channels - 1; c++)
            batch->samples[n * channels + c] *=
                batch->samples[n * channels + channels - 1];
}

/* Shades and composites what is gathered. */
static void flush(const snow_raycast_pass *pass, const snow_ray *ray,
                  snow_raycast_eye *eye, over_state *state) {
    over_batch *batch = &state->batch;
    int channels = pass->job->channels;
    if (pass->shaded)
        snow_shade_gradients(&eye->shader,
                             (const double(*)[SNOW_SHADE_BLOCK])eye->gradients,
                             batch->count, channels, batch->samples);
    else
        multiply_colors(channels, batch);
    for (int n = 0; n < batch->count; n++)
        composite(pass, ray, state, batch->samples + n * channels, batch->t[n]);
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
    return snow_transfer_evaluate_gradient(pass->transfer, magnitude);
}

static void find_gradient(const snow_raycast_pass *pass, const double at[3],
                          double value, snow_raycast_eye *eye,
                          double gradient[3]) {
    if (pass->labels)
        snow_field_label_gradient(&pass->field, at, value, eye->sides,
                                  gradient);
    else
        snow_field_gradient(&pass->field, at, value, eye->sides, gradient);
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
    if (pass->shaded || pass->gradient_factors)
        find_gradient(pass, at, value, eye, gradient);
    if (pass->gradient_factors)
        opacity *= gradient_factor(pass, data, gradient);
    return snow_is_interesting(opacity, threshold) ? opacity : 0;
}

/* Adds a sample to the batch. */
static void add_sample(const snow_raycast_pass *pass, const snow_ray *ray,
                       double t, const double at[3], double value,
                       snow_raycast_eye *eye, over_state *state) {
    over_batch *batch = &state->batch;
    int n = batch->count, channels = pass->job->channels;
    double data = pass->field.log ? snow_exp2(value) : value;
    double gradient[3] = {0, 0, 0}, rgb[3];
    double opacity = find_opacity(pass, at, value, data, eye, gradient);
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
    batch->count++;
}

static bool is_visible(const snow_raycast_pass *pass,
                       const snow_field_window *window) {
    return window->least <= pass->visible[1] &&
           window->most >= pass->visible[0];
}

void snow_raycast_over(const snow_raycast_pass *pass, const snow_ray *ray,
                       snow_raycast_eye *eye, float *pixel, float *depth) {
    over_state state = {.depth = depth};
    int channels = pass->job->channels;
    int64_t skip = 1;
    for (int64_t i = 0; i < ray->steps; i += skip) {
        double t = ray->enter + ((double)i + 0.5) * ray->step, at[3];
        snow_ray_at(ray, t, at);
        snow_field_place(&pass->field, at, &eye->near);
        skip = 1;
        if (!is_visible(pass, &eye->near)) {
            skip = snow_ray_skip(ray, at);
            continue;
        }
        double value =
            pass->labels
                ? snow_field_label(&pass->field, at, &eye->near, pass->nearest)
                : snow_field_value(&eye->near);
        if (!isnan(value))
            add_sample(pass, ray, t, at, value, eye, &state);
        if (state.batch.count < BATCH)
            continue;
        flush(pass, ray, eye, &state);
        if (state.pixel[channels - 1] > 1 - CLOSED)
            break;
    }
    flush(pass, ray, eye, &state);
    for (int c = 0; c < channels; c++)
        pixel[c] = (float)state.pixel[c];
}
