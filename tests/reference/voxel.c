/* tests/reference/voxel.c - the reference's voxels, from value to
 * sample.
 *
 * Points 3, 4 and 6 of the model. */
#include "reference/reference.h"

#include <math.h>
#include <stdlib.h>

double reference_native(const reference_scene *scene, int64_t i, int64_t j,
                        int64_t k) {
    const int64_t *dims = scene->info.dims;
    if (i < 0 || j < 0 || k < 0 || i >= dims[0] || j >= dims[1] || k >= dims[2])
        return (double)NAN;
    int64_t at = (k * dims[1] + j) * dims[0] + i;
    switch (scene->info.type) {
#define NATIVE(name, type, text) \
    case SNOW_TYPE_##name:       \
        return (double)((const type *)scene->voxels)[at];
        SNOW_TYPE_MAP(NATIVE)
#undef NATIVE
    case SNOW_TYPE_NONE:
        break;
    }
    return (double)NAN;
}

static double between(bool log, double x0, double y0, double x1, double y1,
                      double x) {
    if (log)
        return y0 +
               (y1 - y0) * (log10(x) - log10(x0)) / (log10(x1) - log10(x0));
    return y0 + (y1 - y0) * ((x - x0) / (x1 - x0));
}

static void color_at(const reference_scene *scene, double value,
                     double rgb[3]) {
    const snow_color_point *p = scene->colors;
    size_t next = 0; /* the first point beyond the value */
    while (next < scene->color_count && p[next].value <= value)
        next++;
    const snow_color_point *b = &p[next < scene->color_count ? next : next - 1];
    const snow_color_point *a = next > 0 ? &p[next - 1] : b;
    bool inner = a->value < b->value;
    rgb[0] =
        inner ? between(scene->log, a->value, a->red, b->value, b->red, value)
              : a->red;
    rgb[1] = inner ? between(scene->log, a->value, a->green, b->value, b->green,
                             value)
                   : a->green;
    rgb[2] =
        inner ? between(scene->log, a->value, a->blue, b->value, b->blue, value)
              : a->blue;
}

static double opacity_of(const snow_opacity_point *p, size_t count, bool log,
                         double value) {
    size_t next = 0;
    while (next < count && p[next].value <= value)
        next++;
    if (next == 0)
        return p[0].opacity;
    if (next == count)
        return p[count - 1].opacity;
    return between(log, p[next - 1].value, p[next - 1].opacity, p[next].value,
                   p[next].opacity, value);
}

void reference_classify(const reference_scene *scene, double value,
                        double rgba[4]) {
    if (isnan(value) || (scene->log && value <= 0)) {
        rgba[0] = rgba[1] = rgba[2] = rgba[3] = 0;
        return;
    }
    color_at(scene, value, rgba);
    rgba[3] =
        opacity_of(scene->opacities, scene->opacity_count, scene->log, value);
}

/* Half the difference of both neighbours, or the difference to the one that is
 * there.  An infinite value has no slope to it: it counts as NaN does. */
static double difference(double before, double here, double after) {
    if (isfinite(before) && isfinite(after))
        return (after - before) / 2;
    if (!isfinite(here))
        return 0;
    if (isfinite(after))
        return after - here;
    return isfinite(before) ? here - before : 0;
}

void reference_gradient(const reference_scene *scene, const int64_t at[3],
                        double gradient[3]) {
    int64_t i = at[0], j = at[1], k = at[2];
    double here = reference_native(scene, i, j, k);
    gradient[0] = difference(reference_native(scene, i - 1, j, k), here,
                             reference_native(scene, i + 1, j, k));
    gradient[1] = difference(reference_native(scene, i, j - 1, k), here,
                             reference_native(scene, i, j + 1, k));
    gradient[2] = difference(reference_native(scene, i, j, k - 1), here,
                             reference_native(scene, i, j, k + 1));
}

/* By the transpose of the inverse. */
static void to_world(const reference_scene *scene, const double gradient[3],
                     double world[3]) {
    double inverse[3][3];
    reference_inverse(scene->info.matrix, inverse);
    for (int c = 0; c < 3; c++)
        world[c] = inverse[0][c] * gradient[0] + inverse[1][c] * gradient[1] +
                   inverse[2][c] * gradient[2];
}

double reference_fade(const reference_scene *scene, const double gradient[3]) {
    double world[3];
    if (!scene->gradient_count)
        return 1;
    to_world(scene, gradient, world);
    return opacity_of(scene->gradients, scene->gradient_count, false,
                      fabs(scene->info.slope) *
                          sqrt(reference_dot(world, world)));
}

void reference_shade(const reference_scene *scene,
                     const reference_camera *camera, const double gradient[3],
                     double rgb[3]) {
    double normal[3], lit[2];
    to_world(scene, gradient, normal);
    reference_light(&scene->settings, camera, normal, camera->back, lit);
    for (int c = 0; c < 3; c++)
        rgb[c] = fmin(1, rgb[c] * lit[0] + lit[1]);
}

static bool interesting(double opacity, double threshold) {
    return opacity > 0 &&
           !(threshold > 0 && 255 * opacity <= threshold + 0.0001);
}

/* The world length that an opacity is for: the shortest column by default. */
double reference_opacity_length(const reference_scene *scene) {
    if (scene->settings.opacity_length > 0)
        return scene->settings.opacity_length;
    double smallest = INFINITY;
    for (int c = 0; c < 3; c++) {
        double column[3];
        for (int r = 0; r < 3; r++)
            column[r] = scene->info.matrix[r][c];
        smallest = fmin(smallest, sqrt(reference_dot(column, column)));
    }
    return smallest;
}

double *reference_samples(const reference_scene *scene,
                          const reference_camera *camera, int axis) {
    const int64_t *dims = scene->info.dims;
    double length = reference_opacity_length(scene);
    size_t count = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
    double *samples = calloc(count * 4, sizeof(double)), *sample = samples;
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++, sample += 4) {
                double rgba[4], gradient[3];
                reference_classify(scene,
                                   scene->info.slope *
                                           reference_native(scene, i, j, k) +
                                       scene->info.intercept,
                                   rgba);
                reference_gradient(scene, (int64_t[]){i, j, k}, gradient);
                rgba[3] *= reference_fade(scene, gradient);
                if (!interesting(rgba[3], scene->settings.threshold))
                    continue;
                if (scene->settings.shade == SNOW_SHADE_PHONG)
                    reference_shade(scene, camera, gradient, rgba);
                double index[3] = {(double)i, (double)j, (double)k};
                double step = reference_slice_step(scene, camera, axis, index);
                sample[3] = 1 - pow(1 - rgba[3], step / length);
                for (int c = 0; c < 3; c++)
                    sample[c] = rgba[c] * sample[3];
            }
    return samples;
}

/* --- labels --------------------------------------------------------------- */

/* A bell over some voxels to either side, and its slope. */
static double bell(double t, int reach, bool slope) {
    double x = fabs(t) / reach;
    if (x >= 1)
        return 0;
    if (slope)
        return (t < 0 ? 1 : -1) * (6 * x - 6 * x * x) / (reach * reach);
    return (1 - 3 * x * x + 2 * x * x * x) / reach;
}

void reference_membership_gradient(const int64_t dims[3], int reach, bool sides,
                                   reference_member_fn *is_member,
                                   const void *user, const double at[3],
                                   double gradient[3]) {
    int64_t n[3], voxel[3];
    gradient[0] = gradient[1] = gradient[2] = 0;
    for (n[2] = -reach; n[2] <= reach; n[2]++)
        for (n[1] = -reach; n[1] <= reach; n[1]++)
            for (n[0] = -reach; n[0] <= reach; n[0]++) {
                double way[3];
                bool there = true;
                for (int a = 0; a < 3; a++) {
                    double place = dims[a] == 1 ? 0 : at[a];
                    voxel[a] = (int64_t)floor(place) + n[a];
                    way[a] = place - (double)voxel[a];
                    there = there && voxel[a] >= 0 && voxel[a] < dims[a];
                    if (!sides)
                        voxel[a] = voxel[a] < 0         ? 0
                                   : voxel[a] < dims[a] ? voxel[a]
                                                        : dims[a] - 1;
                }
                if ((sides && !there) || !is_member(user, voxel))
                    continue;
                for (int a = 0; a < 3; a++)
                    gradient[a] += bell(way[0], reach, a == 0) *
                                   bell(way[1], reach, a == 1) *
                                   bell(way[2], reach, a == 2);
            }
}
