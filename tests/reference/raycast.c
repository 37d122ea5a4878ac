/* tests/reference/raycast.c - an ordinary ray caster, to say how a volume looks
 * to everybody else (Levoy 1988; classification after interpolation). */
#include "reference/reference.h"

#include <math.h>
#include <stdlib.h>

/* Steps per smallest spacing. */
#define OVERSAMPLING 4

/* The trilinear value at an index position; the outer half of the border's
 * boxes has the border's value. */
static double value_at(const reference_scene *scene, const double at[3]) {
    const int64_t *dims = scene->info.dims;
    int64_t cell[3];
    double part[3], value = 0;
    for (int n = 0; n < 3; n++) {
        double clamped = fmin(fmax(at[n], 0), (double)(dims[n] - 1));
        cell[n] = (int64_t)floor(clamped);
        part[n] = clamped - (double)cell[n];
    }
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1;
        int64_t p[3];
        for (int n = 0; n < 3; n++) {
            int far = corner >> n & 1;
            weight *= far ? part[n] : 1 - part[n];
            p[n] = cell[n] + far;
        }
        if (weight > 0)
            value += weight * reference_native(scene, p[0], p[1], p[2]);
    }
    return value;
}

/* Central differences of the interpolated value, one voxel to either side. */
static void slope_at(const reference_scene *scene, const double at[3],
                     double gradient[3]) {
    for (int n = 0; n < 3; n++) {
        double before[3] = {at[0], at[1], at[2]};
        double after[3] = {at[0], at[1], at[2]};
        before[n] -= 1;
        after[n] += 1;
        gradient[n] = (value_at(scene, after) - value_at(scene, before)) / 2;
    }
}

/* The stretch of a ray within the voxel boxes; false when it misses them. */
static bool clip(const reference_scene *scene, const reference_ray *ray,
                 double *enter, double *leave) {
    *enter = scene->view.fov > 0 ? 0 : -INFINITY; /* from the eye on */
    *leave = INFINITY;
    for (int n = 0; n < 3; n++) {
        double low = -0.5, high = (double)scene->info.dims[n] - 0.5;
        if (fabs(ray->step[n]) < 1e-12) {
            if (ray->start[n] < low || ray->start[n] > high)
                return false;
            continue;
        }
        double a = (low - ray->start[n]) / ray->step[n];
        double b = (high - ray->start[n]) / ray->step[n];
        *enter = fmax(*enter, fmin(a, b));
        *leave = fmin(*leave, fmax(a, b));
    }
    return *enter < *leave;
}

static void march(const reference_scene *scene, const reference_camera *camera,
                  const reference_ray *ray, double step, double length,
                  double pixel[4]) {
    double enter, leave;
    if (!clip(scene, ray, &enter, &leave))
        return;
    for (double t = enter + step / 2; t < leave; t += step) {
        double at[3], rgba[4], gradient[3];
        for (int n = 0; n < 3; n++)
            at[n] = ray->start[n] + t * ray->step[n];
        double value = value_at(scene, at);
        reference_classify(
            scene, scene->info.slope * value + scene->info.intercept, rgba);
        if (!(rgba[3] > 0))
            continue;
        if (scene->settings.shade == SNOW_SHADE_PHONG) {
            slope_at(scene, at, gradient);
            reference_shade(scene, camera, gradient, rgba);
        }
        double alpha = 1 - pow(1 - rgba[3], step / length);
        double through = 1 - pixel[3];
        for (int c = 0; c < 3; c++)
            pixel[c] += through * rgba[c] * alpha;
        pixel[3] += through * alpha;
    }
}

/* The length of the shortest column: of a step, and of an opacity. */
static double smallest_spacing(const reference_scene *scene) {
    double smallest = INFINITY;
    for (int c = 0; c < 3; c++)
        smallest = fmin(smallest, hypot(hypot(scene->info.matrix[0][c],
                                              scene->info.matrix[1][c]),
                                        scene->info.matrix[2][c]));
    return smallest;
}

double *reference_raycast(const reference_scene *scene) {
    reference_camera camera;
    reference_camera_of(scene, &camera);
    double spacing = smallest_spacing(scene);
    double length = scene->settings.opacity_length > 0
                        ? scene->settings.opacity_length
                        : spacing;
    int width = scene->view.width, height = scene->view.height;
    double *pixels = calloc((size_t)width * (size_t)height * 4, sizeof(double));
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            reference_ray ray =
                reference_ray_at(scene, &camera, x + 0.5, y + 0.5);
            size_t at = (size_t)y * (size_t)width + (size_t)x;
            march(scene, &camera, &ray, spacing / OVERSAMPLING, length,
                  pixels + 4 * at);
        }
    return pixels;
}
