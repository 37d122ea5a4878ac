/* tests/values/truth.c - a fine ray caster, to hold the value model
 * against.
 *
 * Values first, colours after, by the shortest steps that are affordable: what
 * the value model approximates (Levoy 1988; docs/model.md).  The
 * field lives between the outermost voxels; beyond, for gradients only, it is
 * continued oddly. */
#include "values/value_model.h"

#include <math.h>
#include <stdlib.h>

struct value_truth {
    const value_scene *scene;
    reference_camera camera;
    const int64_t *dims;
    double *voxels;
    double inverse[3][3];
    double step, length; /* world length of a step and of an opacity */
};

static double spacing_of(const reference_scene *scene) {
    double smallest = INFINITY;
    for (int c = 0; c < 3; c++)
        smallest = fmin(smallest, hypot(hypot(scene->info.matrix[0][c],
                                              scene->info.matrix[1][c]),
                                        scene->info.matrix[2][c]));
    return smallest;
}

value_truth *value_truth_new(const value_scene *scene, int fine) {
    value_truth *truth = calloc(1, sizeof *truth);
    const int64_t *n = scene->base.info.dims;
    truth->scene = scene;
    truth->dims = n;
    reference_camera_of(&scene->base, &truth->camera);
    reference_inverse(scene->base.info.matrix, truth->inverse);
    truth->step = spacing_of(&scene->base) / fine;
    truth->length = reference_opacity_length(&scene->base);
    truth->voxels = calloc((size_t)(n[0] * n[1] * n[2]), sizeof(double));
    double *to = truth->voxels;
    for (int64_t k = 0; k < n[2]; k++)
        for (int64_t j = 0; j < n[1]; j++)
            for (int64_t i = 0; i < n[0]; i++)
                *to++ = value_data(scene, (int64_t[]){i, j, k});
    return truth;
}

void value_truth_free(value_truth *truth) {
    free(truth->voxels);
    free(truth);
}

/* Tri-linear between voxels; `at` is inside the box. */
static double inside(const value_truth *truth, const double at[3]) {
    const int64_t *n = truth->dims;
    int64_t cell[3], next[3], stride = 1;
    double part[3];
    for (int c = 0; c < 3; c++) {
        int64_t below = (int64_t)floor(at[c]);
        below = below >= n[c] - 1 ? n[c] - 2 : below;
        below = below < 0 ? 0 : below;
        part[c] = at[c] - (double)below;
        cell[c] = below * stride;
        next[c] = n[c] > 1 ? stride : 0;
        stride *= n[c];
    }
    const double *v = truth->voxels + cell[0] + cell[1] + cell[2];
    double plane[2];
    for (int k = 0; k < 2; k++) {
        double row[2];
        for (int j = 0; j < 2; j++) {
            const double *p = v + k * next[2] + j * next[1];
            row[j] = p[0] + part[0] * (p[next[0]] - p[0]);
        }
        plane[k] = row[0] + part[1] * (row[1] - row[0]);
    }
    return plane[0] + part[2] * (plane[1] - plane[0]);
}

/* The field one step beside a position inside the box, along one axis. */
static double beside(const value_truth *truth, const double at[3], int axis,
                     double way) {
    double last = (double)truth->dims[axis] - 1;
    double to[3] = {at[0], at[1], at[2]};
    to[axis] += way;
    if (to[axis] >= 0 && to[axis] <= last)
        return inside(truth, to);
    double end = to[axis] < 0 ? 0 : last, mirror = 2 * end - to[axis];
    to[axis] = fmin(fmax(mirror, 0), last);
    double mirrored = inside(truth, to);
    to[axis] = end;
    return 2 * inside(truth, to) - mirrored;
}

static void slope_at(const value_truth *truth, const double at[3],
                     double gradient[3]) {
    for (int n = 0; n < 3; n++)
        gradient[n] =
            truth->dims[n] == 1
                ? 0
                : (beside(truth, at, n, 1) - beside(truth, at, n, -1)) / 2;
}

/* --- light ---------------------------------------------------------------- */

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void shade(const value_truth *truth, const double eye[3],
                  const double gradient[3], double rgb[3]) {
    const snow_settings *s = &truth->scene->base.settings;
    double normal[3] = {0}, lit[2];
    for (int r = 0; r < 3; r++)
        for (int k = 0; k < 3; k++)
            normal[r] += truth->inverse[k][r] * gradient[k];
    reference_light(s, &truth->camera, normal, eye, lit);
    for (int k = 0; k < 3; k++)
        rgb[k] = fmin(1, rgb[k] * lit[0] + lit[1]);
}

/* --- rays ----------------------------------------------------------------- */

/* Keeps the t of a ray at which height + t rise <= most. */
static void keep_below(double height, double rise, double most, double t[2]) {
    double at = (most - height) / rise;
    if (fabs(rise) < 1e-12)
        t[1] = height <= most ? t[1] : -INFINITY;
    else if (rise > 0)
        t[1] = fmin(t[1], at);
    else
        t[0] = fmax(t[0], at);
}

/* Along a direction or of a position of the index space, in the world. */
static double on_plane(const reference_scene *scene, const double at[3],
                       const double plane[4], double origin) {
    double sum = 0;
    for (int r = 0; r < 3; r++)
        sum += plane[r] * (dot(scene->info.matrix[r], at) +
                           origin * scene->info.matrix[r][3]);
    return sum;
}

/* The stretch of a ray that is seen. */
static bool stretch(const value_truth *truth, const reference_ray *ray,
                    double t[2]) {
    const value_scene *scene = truth->scene;
    t[0] = truth->camera.distance > 0 ? 0 : -INFINITY;
    t[1] = INFINITY;
    for (int n = 0; n < 3; n++) {
        bool single = truth->dims[n] == 1;
        double low = single ? -0.5 : 0;
        double high = single ? 0.5 : (double)truth->dims[n] - 1;
        if (scene->cropped && !single) {
            low = fmax(low, scene->keep[n][0]);
            high = fmin(high, scene->keep[n][1]);
        }
        keep_below(ray->start[n], ray->step[n], high, t);
        keep_below(-ray->start[n], -ray->step[n], -low, t);
    }
    for (size_t n = 0; n < scene->clip_count; n++)
        keep_below(on_plane(&scene->base, ray->start, scene->clips[n], 1),
                   on_plane(&scene->base, ray->step, scene->clips[n], 0),
                   scene->clips[n][3], t);
    return t[0] < t[1];
}

/* What a ray has gathered: over, and sums of values. */
typedef struct gathered {
    double rgba[4], most, least, sum, length;
} gathered;

static void gather_step(const value_truth *truth, const double eye[3],
                        const double at[3], double step, gathered *out) {
    const reference_scene *scene = &truth->scene->base;
    double value = inside(truth, at), rgba[4], gradient[3];
    out->most = fmax(out->most, value);
    out->least = fmin(out->least, value);
    out->sum += value * step;
    out->length += step;
    if (scene->settings.mode != SNOW_MODE_OVER)
        return;
    reference_classify(scene, scene->log ? pow(10, value) : value, rgba);
    double threshold = scene->settings.threshold;
    if (!(rgba[3] > 0) ||
        (threshold > 0 && 255 * rgba[3] <= threshold + 0.0001))
        return;
    if (scene->gradient_count || scene->settings.shade == SNOW_SHADE_PHONG)
        slope_at(truth, at, gradient);
    if (scene->gradient_count) {
        double native[3];
        for (int n = 0; n < 3; n++)
            native[n] = gradient[n] / scene->info.slope *
                        (scene->log ? log(10) * pow(10, value) : 1);
        rgba[3] *= reference_fade(scene, native);
    }
    if (scene->settings.shade == SNOW_SHADE_PHONG)
        shade(truth, eye, gradient, rgba);
    double alpha =
        (1 - out->rgba[3]) * (1 - pow(1 - rgba[3], step / truth->length));
    for (int c = 0; c < 3; c++)
        out->rgba[c] += alpha * rgba[c];
    out->rgba[3] += alpha;
}

static void finish(const value_truth *truth, const gathered *g, double out[4]) {
    const reference_scene *scene = &truth->scene->base;
    double value = g->most;
    switch (scene->settings.mode) {
    case SNOW_MODE_OVER:
    case SNOW_MODE_ISO:
        for (int c = 0; c < 4; c++)
            out[c] = g->rgba[c];
        return;
    case SNOW_MODE_MEAN:
        out[0] = g->length > 0 ? g->sum / g->length : (double)NAN;
        return;
    case SNOW_MODE_SUM:
        out[0] = g->length > 0 ? g->sum / truth->length : (double)NAN;
        return;
    case SNOW_MODE_MINIP:
        value = g->least;
    case SNOW_MODE_MIP:
        break;
    }
    out[0] = out[1] = out[2] = out[3] = 0;
    if (!(g->length > 0))
        return;
    reference_classify(scene, scene->log ? pow(10, value) : value, out);
    out[3] = 1;
}

void value_truth_pixel(const value_truth *truth, double x, double y,
                       double out[4]) {
    const reference_scene *scene = &truth->scene->base;
    gathered g = {.most = -INFINITY, .least = INFINITY};
    double t[2], eye[3];
    reference_ray ray = reference_ray_at(scene, &truth->camera, x, y);
    for (int r = 0; r < 3; r++)
        eye[r] = -dot(scene->info.matrix[r], ray.step);
    if (stretch(truth, &ray, t)) {
        int count = (int)ceil((t[1] - t[0]) / truth->step);
        double step = (t[1] - t[0]) / count;
        for (int n = 0; n < count && g.rgba[3] < 1 - 1e-7; n++) {
            double at[3];
            for (int c = 0; c < 3; c++)
                at[c] = ray.start[c] + (t[0] + (n + 0.5) * step) * ray.step[c];
            gather_step(truth, eye, at, step, &g);
        }
    }
    finish(truth, &g, out);
}
