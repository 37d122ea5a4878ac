/* tests/reference/modes.c - the reference's pictures in other modes.
 *
 * Point 8 of the model: every pixel visits every slice, and every slice is
 * interpolated anew from all its finite voxels. */
#include "reference/gather.h"

#include <math.h>
#include <stdlib.h>

/* Half a weight, and a little less for rounding. */
#define ENOUGH 0.499

/* What a ray meets of one slice: sums over voxels of weight times value, of
 * weight, and of both times the length of the voxel's ray. */
typedef struct sheet_sums {
    double values, weights, long_values, long_weights;
} sheet_sums;

static double value_at(const reference_scene *scene, const int64_t at[3]) {
    return scene->info.slope * reference_native(scene, at[0], at[1], at[2]) +
           scene->info.intercept;
}

static sheet_sums sums_of(const reference_gather *g,
                          const reference_camera *camera,
                          const reference_ray *ray, int64_t slice) {
    const int64_t *dims = g->scene->info.dims;
    sheet_sums sums = {0};
    int64_t u0, u1, v0, v1;
    double u, v, length = reference_opacity_length(g->scene);
    if (!reference_meet_slice(g, ray, slice, &u, &v))
        return sums;
    reference_weights(g->kernel, g->support, g->u_width[slice], u,
                      dims[g->u_axis], g->u_weights, &u0, &u1);
    reference_weights(g->kernel, g->support, g->v_width[slice], v,
                      dims[g->v_axis], g->v_weights, &v0, &v1);
    for (int64_t j = v0; j <= v1; j++)
        for (int64_t i = u0; i <= u1; i++) {
            int64_t at[3];
            at[g->axis] = slice;
            at[g->u_axis] = i;
            at[g->v_axis] = j;
            double index[3] = {(double)at[0], (double)at[1], (double)at[2]};
            double value = value_at(g->scene, at);
            double weight = g->u_weights[i] * g->v_weights[j];
            if (!isfinite(value) || weight == 0)
                continue;
            double step =
                reference_slice_step(g->scene, camera, g->axis, index) / length;
            sums.values += weight * value;
            sums.weights += weight;
            sums.long_values += weight * value * step;
            sums.long_weights += weight * step;
        }
    return sums;
}

/* The pixel of one ray: four numbers, or one. */
static void pixel_of(const reference_gather *g, const reference_camera *camera,
                     const reference_ray *ray, double *pixel) {
    const reference_scene *scene = g->scene;
    snow_mode mode = scene->settings.mode;
    double best = mode == SNOW_MODE_MIP ? -INFINITY : INFINITY;
    sheet_sums all = {0};
    for (int64_t k = 0; k < scene->info.dims[g->axis]; k++) {
        sheet_sums s = sums_of(g, camera, ray, k);
        all.values += s.values;
        all.weights += s.weights;
        all.long_values += s.long_values;
        all.long_weights += s.long_weights;
        if (s.weights >= ENOUGH)
            best = mode == SNOW_MODE_MIP ? fmax(best, s.values / s.weights)
                                         : fmin(best, s.values / s.weights);
    }
    if (mode == SNOW_MODE_MEAN) {
        *pixel = all.weights >= ENOUGH ? all.values / all.weights : (double)NAN;
    } else if (mode == SNOW_MODE_SUM) {
        double middle[3];
        for (int n = 0; n < 3; n++)
            middle[n] = (double)(scene->info.dims[n] - 1) / 2;
        double step = reference_slice_step(scene, camera, g->axis, middle) /
                      reference_opacity_length(scene);
        *pixel =
            all.long_weights >= ENOUGH * step ? all.long_values : (double)NAN;
    } else if (isfinite(best)) {
        reference_classify(scene, best, pixel);
        pixel[3] = 1;
    }
}

/* How far a ray's point on a slice is behind the target's plane. */
static double depth_of(const reference_gather *g,
                       const reference_camera *camera, const reference_ray *ray,
                       double slice) {
    double t = (slice - ray->start[g->axis]) / ray->step[g->axis], at[3];
    for (int n = 0; n < 3; n++)
        at[n] = ray->start[n] + t * ray->step[n];
    return reference_behind(g->scene, camera, at);
}

double *reference_depth(const reference_scene *scene) {
    reference_camera camera;
    reference_gather g;
    int width = scene->view.width, height = scene->view.height;
    double *depths = calloc((size_t)width * (size_t)height, sizeof(double));
    reference_camera_of(scene, &camera);
    reference_gather_begin(scene, &camera, &g);
    double *samples = reference_samples(scene, &camera, g.axis);
    g.samples = samples;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            reference_ray ray =
                reference_ray_at(scene, &camera, x + 0.5, y + 0.5);
            depths[(size_t)y * (size_t)width + (size_t)x] =
                depth_of(&g, &camera, &ray, reference_passes(&g, &ray));
        }
    free(samples);
    reference_gather_end(&g);
    return depths;
}

double *reference_mode(const reference_scene *scene) {
    reference_camera camera;
    reference_gather g;
    snow_mode mode = scene->settings.mode;
    size_t channels = mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM ? 1 : 4;
    int width = scene->view.width, height = scene->view.height;
    double *pixels =
        calloc((size_t)width * (size_t)height * channels, sizeof(double));
    reference_camera_of(scene, &camera);
    reference_gather_begin(scene, &camera, &g);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            reference_ray ray =
                reference_ray_at(scene, &camera, x + 0.5, y + 0.5);
            size_t at = (size_t)y * (size_t)width + (size_t)x;
            pixel_of(&g, &camera, &ray, pixels + channels * at);
        }
    reference_gather_end(&g);
    return pixels;
}
