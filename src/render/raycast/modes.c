/* render/raycast/modes.c - modes other than over: the value at both ends of
 * each step. */
#include "render/raycast/raycast.h"

#include <math.h>
#include <string.h>

/* Where step i begins; i is `steps` at the ray's end. */
static void end_of(const snow_raycast_pass *pass, const snow_ray *ray, double i,
                   double at[3]) {
    snow_ray_at(ray, ray->enter + i * ray->step, at);
    /* Rounding must not carry a ray's ends beyond those of the field. */
    for (int axis = 0; axis < 3; axis++)
        at[axis] =
            fmin(fmax(at[axis], pass->field.low[axis]), pass->field.high[axis]);
}

/* The value there. */
static double value_at(const snow_raycast_pass *pass, const snow_ray *ray,
                       double i, snow_raycast_eye *eye, double at[3]) {
    end_of(pass, ray, i, at);
    snow_field_place(&pass->field, at, &eye->near);
    return snow_field_value(&eye->near);
}

/* --- largest values ------------------------------------------------------- */

/* A value as a number from 0 to 1. */
static double number_of(const snow_raycast_pass *pass, double value) {
    return fmin(fmax((value - pass->from) / pass->range, 0), 1);
}

void snow_raycast_largest(const snow_raycast_pass *pass, const snow_ray *ray,
                          snow_raycast_eye *eye, float *pixel, float *depth) {
    double largest = -1, at[3];
    int64_t skip = 1;
    (void)depth;
    for (int64_t i = 0; i <= ray->steps; i += skip) {
        double value = value_at(pass, ray, (double)i, eye, at);
        if (!isnan(value))
            largest = fmax(largest, number_of(pass, value));
        /* The largest number that the window can give. */
        double most =
            number_of(pass, pass->range > 0 ? eye->near.most : eye->near.least);
        skip = most <= largest ? snow_ray_skip(ray, at) : 1;
    }
    if (largest < 0)
        return;
    pixel[0] = (float)largest;
    pixel[1] = 1;
}

/* --- means and sums ------------------------------------------------------- */

/* By the trapezoid rule, over steps with a value at both ends.  Weights are
 * reference lengths. */
void snow_raycast_sum(const snow_raycast_pass *pass, const snow_ray *ray,
                      snow_raycast_eye *eye, float *pixel, float *depth) {
    double share = ray->step / pass->job->settings.opacity_length;
    double sum = 0, weights = 0, before = NAN, at[3];
    (void)depth;
    for (int64_t i = 0; i <= ray->steps; i++) {
        double value = value_at(pass, ray, (double)i, eye, at);
        if (!isnan(value))
            value = number_of(pass, value);
        if (!isnan(value) && !isnan(before)) {
            sum += share * (before + value) / 2;
            weights += share;
        }
        before = value;
    }
    pixel[0] = (float)sum;
    pixel[1] = (float)weights;
}

/* --- surfaces ------------------------------------------------------------- */

/* Halvings of a step: to a billionth of it. */
#define HALVINGS 30

static bool is_above(const snow_raycast_pass *pass, double value) {
    return !isnan(value) && value >= pass->isovalue;
}

/* Returns where between i - 1 and i a surface is met. */
static double find_crossing(const snow_raycast_pass *pass, const snow_ray *ray,
                            int64_t i, snow_raycast_eye *eye) {
    double low = (double)(i - 1), high = (double)i, at[3];
    for (int n = 0; n < HALVINGS; n++) {
        double middle = (low + high) / 2;
        if (is_above(pass, value_at(pass, ray, middle, eye, at)))
            high = middle;
        else
            low = middle;
    }
    return high;
}

static void shade_surface(const snow_raycast_pass *pass, const snow_ray *ray,
                          double i, snow_raycast_eye *eye, float *pixel) {
    int channels = pass->job->channels;
    double at[3], gradient[3];
    memcpy(pixel, pass->rgb, (size_t)(channels - 1) * sizeof *pixel);
    pixel[channels - 1] = 1;
    if (!pass->shaded)
        return;
    double value = value_at(pass, ray, i, eye, at);
    snow_field_gradient(&pass->field, at, value, eye->sides, gradient);
    snow_field_add_border(&pass->field, at, gradient);
    const float flat = snow_raycast_flatness(pass, at);
    for (int axis = 0; axis < 3; axis++)
        eye->gradients[axis][0] = gradient[axis];
    snow_shade_gradients(&eye->shader,
                         (const double(*)[SNOW_SHADE_BLOCK])eye->gradients,
                         &flat, 1, channels, pixel);
}

/* Returns whether a position is next to a voxel of the part. */
static bool is_own(const snow_raycast_pass *pass, const double at[3]) {
    for (int axis = 0; pass->cut && axis < 3; axis++) {
        double last = (double)(pass->field.dims[axis] - 1);
        int64_t voxel = (int64_t)fmin(floor(at[axis] + 0.5), last);
        if (voxel < pass->own[axis][0] || voxel > pass->own[axis][1])
            return false;
    }
    return true;
}

void snow_raycast_iso(const snow_raycast_pass *pass, const snow_ray *ray,
                      snow_raycast_eye *eye, float *pixel, float *depth) {
    int64_t skip;
    double at[3];
    for (int64_t i = ray->first; i <= ray->last; i += skip) {
        end_of(pass, ray, (double)i, at);
        skip = 1;
        if (!is_own(pass, at))
            continue;
        double value = value_at(pass, ray, (double)i, eye, at);
        skip = eye->near.most >= pass->isovalue ? 1 : snow_ray_skip(ray, at);
        if (!is_above(pass, value))
            continue;
        double met = i ? find_crossing(pass, ray, i, eye) : 0;
        shade_surface(pass, ray, met, eye, pixel);
        if (depth)
            *depth =
                snow_raycast_depth(pass, ray, ray->enter + met * ray->step);
        return;
    }
}
