/* tests/reference/raycast.c - see raycast.h. */
#include "reference/raycast.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the field ------------------------------------------------------------ */

/* A voxel's data value, or its logarithm; NaN is a hole.  In mode over an
 * infinite one is the largest, or smallest, of the others. */
static double voxel_value(const reference_cast *cast, const int64_t at[3]) {
    const reference_scene *scene = cast->scene;
    const int64_t *dims = scene->info.dims;
    double value =
        scene->info.slope * reference_native(scene, at[0], at[1], at[2]) +
        scene->info.intercept;
    bool over = scene->settings.mode == SNOW_MODE_OVER;
    if (isinf(value) && !over)
        return NAN;
    if (isinf(value)) {
        double end = value > 0 ? -INFINITY : INFINITY;
        for (int64_t n = 0; n < dims[0] * dims[1] * dims[2]; n++) {
            double other =
                scene->info.slope * reference_native(scene, n % dims[0],
                                                     n / dims[0] % dims[1],
                                                     n / dims[0] / dims[1]) +
                scene->info.intercept;
            if (isfinite(other))
                end = value > 0 ? fmax(end, other) : fmin(end, other);
        }
        value = end;
    }
    if (scene->log && over)
        return value > 0 ? log10(value) : NAN;
    return value;
}

/* Beyond the ends: v[-k] = 2 v[0] - v[k], along each axis in turn. */
static double voxel(const reference_cast *cast, const int64_t at[3]) {
    const int64_t *dims = cast->scene->info.dims;
    for (int axis = 0; axis < 3; axis++) {
        int64_t last = dims[axis] - 1, end = at[axis] < 0 ? 0 : last;
        int64_t border[3] = {at[0], at[1], at[2]};
        int64_t mirrored[3] = {at[0], at[1], at[2]};
        border[axis] = end;
        mirrored[axis] = 2 * end - at[axis];
        if (at[axis] >= 0 && at[axis] <= last)
            continue;
        if (last == 0)
            return voxel(cast, border);
        return 2 * voxel(cast, border) - voxel(cast, mirrored);
    }
    return voxel_value(cast, at);
}

/* The kernel at distance t: the tent, or the cubic B-spline. */
static double kernel(const reference_cast *cast, double t) {
    t = fabs(t);
    if (cast->scene->settings.kernel != SNOW_KERNEL_BSPLINE)
        return fmax(1 - t, 0);
    if (t < 1)
        return 2.0 / 3 - t * t + t * t * t / 2;
    return t < 2 ? (2 - t) * (2 - t) * (2 - t) / 6 : 0;
}

typedef void visit_fn(void *user, double weight, double value);

/* Visits the voxels around a position. */
static void visit(const reference_cast *cast, const double position[3],
                  visit_fn *fn, void *user) {
    int64_t from[3];
    double weights[3][4];
    for (int n = 0; n < 3; n++) {
        double last = (double)(cast->scene->info.dims[n] - 1);
        double here = position[n];
        if (last == 0)
            here = fmin(fmax(here, 0), last);
        from[n] = (int64_t)floor(here) - 1;
        for (int i = 0; i < 4; i++)
            weights[n][i] = kernel(cast, here - (double)(from[n] + i));
    }
    for (int k = 0; k < 4; k++)
        for (int j = 0; j < 4 && weights[2][k] > 0; j++)
            for (int i = 0; i < 4 && weights[1][j] > 0; i++)
                if (weights[0][i] > 0)
                    fn(user, weights[0][i] * weights[1][j] * weights[2][k],
                       voxel(cast, (int64_t[]){from[0] + i, from[1] + j,
                                               from[2] + k}));
}

typedef struct field_sums {
    double values, weights, missing;
    double label; /* whose weights are summed */
} field_sums;

static void add_value(void *user, double weight, double value) {
    field_sums *sums = user;
    if (isnan(value)) {
        sums->missing += weight;
        return;
    }
    sums->values += weight * value;
    sums->weights += weight;
}

/* Whether a position lies within the field, but for rounding. */
static bool is_within(const reference_cast *cast, const double at[3]) {
    for (int n = 0; n < 3; n++) {
        double last = (double)(cast->scene->info.dims[n] - 1);
        if (last > 0 && (at[n] < -1e-7 || at[n] > last + 1e-7))
            return false;
    }
    return true;
}

double reference_field(const reference_cast *cast, const double at[3]) {
    field_sums sums = {0};
    visit(cast, at, add_value, &sums);
    bool enough =
        is_within(cast, at) ? sums.weights >= 0.5 - 1e-9 : sums.missing == 0;
    return enough ? sums.values / sums.weights : (double)NAN;
}

/* --- labels --------------------------------------------------------------- */

static void add_label(void *user, double weight, double value) {
    field_sums *sums = user;
    if (value == sums->label)
        sums->weights += weight;
}

static double share_of(const reference_cast *cast, const double at[3],
                       double label) {
    const int64_t *dims = cast->scene->info.dims;
    field_sums sums = {.label = label};
    /* Beyond the ends shares go on oddly, as values do. */
    for (int n = 0; n < 3; n++) {
        double last = (double)(dims[n] - 1);
        double end = at[n] < 0 ? 0 : last;
        double border[3] = {at[0], at[1], at[2]};
        double mirrored[3] = {at[0], at[1], at[2]};
        if (last == 0 || (at[n] >= 0 && at[n] <= last))
            continue;
        border[n] = end;
        mirrored[n] = 2 * end - at[n];
        return 2 * share_of(cast, border, label) -
               share_of(cast, mirrored, label);
    }
    visit(cast, at, add_label, &sums);
    return sums.weights;
}

/* Labels are whole numbers up to 15 in the tests. */
static double label_at(const reference_cast *cast, const double at[3]) {
    double best = (double)NAN, most = 1e-9;
    if (cast->scene->settings.quality == SNOW_QUALITY_DRAFT) {
        int64_t nearest[3];
        for (int n = 0; n < 3; n++)
            nearest[n] =
                cast->scene->info.dims[n] == 1 ? 0 : (int64_t)rint(at[n]);
        return voxel_value(cast, nearest);
    }
    for (int label = 0; label < 16; label++) {
        double share = share_of(cast, at, label);
        if (share >= most - 1e-12) {
            most = share;
            best = label;
        }
    }
    return best;
}

/* --- gradients ------------------------------------------------------------ */

typedef struct member {
    const reference_cast *cast;
    double label;
} member;

static bool is_member(const void *of, const int64_t voxel[3]) {
    const member *m = of;
    return voxel_value(m->cast, voxel) == m->label;
}

static void label_gradient_at(const reference_cast *cast, const double at[3],
                              double label, double gradient[3]) {
    const member m = {cast, label};
    reference_membership_gradient(cast->scene->info.dims, 3, true, is_member,
                                  &m, at, gradient);
    for (int a = 0; a < 3; a++)
        gradient[a] = fabs(gradient[a]) < 1e-9 ? 0 : gradient[a];
}

static void gradient_at(const reference_cast *cast, const double at[3],
                        double label, double gradient[3]) {
    double here = reference_field(cast, at);
    if (cast->labels) {
        label_gradient_at(cast, at, label, gradient);
        return;
    }
    for (int n = 0; n < 3; n++) {
        double before[3] = {at[0], at[1], at[2]};
        double after[3] = {at[0], at[1], at[2]};
        before[n] -= 1;
        after[n] += 1;
        double a = reference_field(cast, before);
        double b = reference_field(cast, after);
        gradient[n] = (b - a) / 2;
        if (isnan(a))
            gradient[n] = b - here;
        if (isnan(b))
            gradient[n] = here - a;
        if (isnan(gradient[n]) || cast->scene->info.dims[n] == 1)
            gradient[n] = 0;
    }
}

/* The range of all values that are finite numbers. */
static double range_of(const reference_cast *cast) {
    const int64_t *dims = cast->scene->info.dims;
    double low = INFINITY, high = -INFINITY;
    for (int64_t n = 0; n < dims[0] * dims[1] * dims[2]; n++) {
        double value =
            voxel_value(cast, (int64_t[]){n % dims[0], n / dims[0] % dims[1],
                                          n / dims[0] / dims[1]});
        low = fmin(low, value);
        high = fmax(high, value);
    }
    return high > low ? high - low : 1;
}

static bool is_there(const void *of, const int64_t voxel[3]) {
    return !isnan(voxel_value(of, voxel));
}

/* Adds that of what is there, smoothly: the border of holes is lit as if values
 * fell off there by their whole range. */
static void add_border(const reference_cast *cast, double range,
                       const double at[3], double gradient[3]) {
    double border[3];
    if (cast->labels || !cast->scene->masked)
        return;
    reference_membership_gradient(cast->scene->info.dims, 2, false, is_there,
                                  cast, at, border);
    for (int n = 0; n < 3; n++)
        if (fabs(border[n]) > 1e-9)
            gradient[n] += range * border[n];
}

/* --- rays ----------------------------------------------------------------- */

typedef struct walk {
    const reference_cast *cast;
    const reference_camera *camera;
    reference_ray ray;
    double enter, leave, step;
    const double *range; /* of the values, of each cast */
    int64_t steps;
} walk;

/* Leaves of a walk what lies where a + t b <= most. */
static void cut(walk *w, double a, double b, double most) {
    if (fabs(b) < 1e-12) {
        if (a > most)
            w->leave = -INFINITY;
    } else if (b > 0)
        w->leave = fmin(w->leave, (most - a) / b);
    else
        w->enter = fmax(w->enter, (most - a) / b);
}

/* A plane of the world over index positions. */
static void index_plane(const walk *w, int n, double out[4]) {
    const double(*m)[4] = w->cast->scene->info.matrix;
    const double *plane = w->cast->planes[n];
    out[3] = plane[3];
    for (int r = 0; r < 3; r++)
        out[3] -= plane[r] * m[r][3];
    for (int c = 0; c < 3; c++)
        out[c] = plane[0] * m[0][c] + plane[1] * m[1][c] + plane[2] * m[2][c];
}

static void cut_planes(walk *w) {
    for (int n = 0; n < w->cast->plane_count; n++) {
        double plane[4];
        index_plane(w, n, plane);
        cut(w, reference_dot(plane, w->ray.start),
            reference_dot(plane, w->ray.step), plane[3]);
    }
}

/* How much of the light at a place is that of cut faces, which a ray has
 * entered through. */
static double flatness(const walk *w, const double at[3]) {
    double length = sqrt(reference_dot(w->ray.step, w->ray.step)), flat = 0;
    for (int n = 0; n < w->cast->plane_count; n++) {
        double plane[4];
        index_plane(w, n, plane);
        double deeper = -reference_dot(plane, w->ray.step) / length;
        double voxels = (plane[3] - reference_dot(plane, at)) / deeper;
        if (deeper > 0)
            flat = fmax(flat, fmin(1, 2 - voxels / 2));
    }
    return flat;
}

static double smallest_spacing(const reference_scene *scene) {
    double smallest = INFINITY;
    for (int c = 0; c < 3; c++)
        smallest = fmin(smallest, hypot(hypot(scene->info.matrix[0][c],
                                              scene->info.matrix[1][c]),
                                        scene->info.matrix[2][c]));
    return smallest;
}

/* False where the ray misses the field. */
static bool begin(walk *w) {
    const reference_scene *scene = w->cast->scene;
    double parts = scene->settings.quality == SNOW_QUALITY_DRAFT  ? 2
                   : scene->settings.quality == SNOW_QUALITY_HIGH ? 16
                                                                  : 4;
    w->enter = scene->view.fov > 0 ? 0 : -INFINITY;
    w->leave = INFINITY;
    for (int n = 0; n < 3; n++) {
        double low = scene->info.dims[n] == 1 ? -0.5 : 0;
        double high = (double)(scene->info.dims[n] - 1) - low;
        cut(w, w->ray.start[n], w->ray.step[n], high);
        cut(w, -w->ray.start[n], -w->ray.step[n], -low);
    }
    cut_planes(w);
    double length = w->leave - w->enter;
    if (!(length > 0))
        return false;
    w->steps = (int64_t)ceil(length * parts / smallest_spacing(scene) - 1e-9);
    w->steps = w->steps < 1 ? 1 : w->steps;
    w->step = length / (double)w->steps;
    return true;
}

static void at_step(const walk *w, double i, double at[3]) {
    for (int n = 0; n < 3; n++)
        at[n] = w->ray.start[n] + (w->enter + i * w->step) * w->ray.step[n];
}

static double depth_at(const walk *w, double i) {
    double at[3];
    at_step(w, i, at);
    return reference_behind(w->cast->scene, w->camera, at);
}

static void normalise(double a[3]) {
    double length = sqrt(reference_dot(a, a));
    for (int n = 0; length > 0 && n < 3; n++)
        a[n] /= length;
}

/* Phong's model, seen along the ray; none on a cut face. */
static void shade(const walk *w, const double at[3], const double gradient[3],
                  double rgb[3]) {
    const snow_settings *s = &w->cast->scene->settings;
    const double(*m)[4] = w->cast->scene->info.matrix;
    double inverse[3][3], normal[3], viewer[3], lit[2];
    reference_inverse(m, inverse);
    for (int c = 0; c < 3; c++) {
        normal[c] = inverse[0][c] * gradient[0] + inverse[1][c] * gradient[1] +
                    inverse[2][c] * gradient[2];
        viewer[c] = -m[c][0] * w->ray.step[0] - m[c][1] * w->ray.step[1] -
                    m[c][2] * w->ray.step[2];
    }
    normalise(viewer);
    reference_light(s, w->camera, normal, viewer, lit);
    const double flat = flatness(w, at);
    for (int c = 0; c < 3; c++)
        rgb[c] = fmin(1, rgb[c] * (flat + (1 - flat) * lit[0]) +
                             (1 - flat) * lit[1]);
}

/* --- mode over ------------------------------------------------------------ */

/* The opacity of a reference length, and a shaded colour. */
static void sample_at(const walk *w, const double at[3], double rgba[4]) {
    const reference_scene *scene = w->cast->scene;
    double value =
        w->cast->labels ? label_at(w->cast, at) : reference_field(w->cast, at);
    double data = scene->log ? pow(10, value) : value, gradient[3], native[3];
    rgba[3] = 0;
    if (isnan(value))
        return;
    reference_classify(scene, data, rgba);
    if (!(rgba[3] > 0))
        return;
    gradient_at(w->cast, at, value, gradient);
    for (int n = 0; n < 3; n++)
        native[n] =
            gradient[n] * (scene->log ? log(10) * data : 1) / scene->info.slope;
    rgba[3] *= reference_fade(scene, native);
    if (scene->settings.threshold > 0 &&
        255 * rgba[3] <= scene->settings.threshold + 0.0001)
        rgba[3] = 0;
    if (scene->settings.shade != SNOW_SHADE_PHONG)
        return;
    add_border(w->cast, *w->range, at, gradient);
    shade(w, at, gradient, rgba);
}

static void cast_over(const walk *w, double pixel[4], double *depth) {
    double length = reference_opacity_length(w->cast->scene);
    for (int64_t i = 0; i < w->steps; i++) {
        double at[3], color[3] = {0, 0, 0}, alpha = 0, through = 1 - pixel[3];
        at_step(w, (double)i + 0.5, at);
        for (walk one = *w; one.cast; one.cast = one.cast->next, one.range++) {
            double rgba[4];
            sample_at(&one, at, rgba);
            double own =
                rgba[3] > 0 ? 1 - pow(1 - rgba[3], w->step / length) : 0;
            for (int c = 0; c < 3 && own > 0; c++)
                color[c] += rgba[c] * own;
            alpha = fmax(alpha, own);
        }
        for (int c = 0; c < 3; c++)
            pixel[c] += through * color[c];
        pixel[3] += through * alpha;
        /* through (1 - alpha)^share = 1/2 */
        if (depth && through > 0.5 && pixel[3] >= 0.5)
            *depth = depth_at(
                w, (double)i +
                       (alpha < 1 ? log(0.5 / through) / log1p(-alpha) : 0));
    }
    for (int c = 0; c < 3 && w->cast->next; c++)
        pixel[c] = fmin(pixel[c], pixel[3]);
}

/* --- other modes ---------------------------------------------------------- */

static double value_at(const walk *w, double i) {
    double at[3];
    at_step(w, i, at);
    for (int n = 0; n < 3; n++) { /* rounding */
        double last = (double)(w->cast->scene->info.dims[n] - 1);
        if (last > 0)
            at[n] = fmin(fmax(at[n], 0), last);
    }
    return reference_field(w->cast, at);
}

static void cast_largest(const walk *w, double pixel[4]) {
    double sign = w->cast->scene->settings.mode == SNOW_MODE_MIP ? 1 : -1;
    double largest = -INFINITY;
    for (int64_t i = 0; i <= w->steps; i++)
        largest = fmax(largest, sign * value_at(w, (double)i));
    if (isinf(largest))
        return;
    reference_classify(w->cast->scene, sign * largest, pixel);
    pixel[3] = 1;
}

static double cast_sum(const walk *w) {
    double length = reference_opacity_length(w->cast->scene);
    double sum = 0, weights = 0;
    for (int64_t i = 0; i < w->steps; i++) {
        double mean = (value_at(w, (double)i) + value_at(w, (double)i + 1)) / 2;
        if (isnan(mean))
            continue;
        sum += mean * w->step / length;
        weights += w->step / length;
    }
    if (!(weights > 0))
        return (double)NAN;
    return w->cast->scene->settings.mode == SNOW_MODE_MEAN ? sum / weights
                                                           : sum;
}

static void cast_iso(const walk *w, double pixel[4], double *depth) {
    const reference_scene *scene = w->cast->scene;
    double level = scene->settings.iso, at[3], gradient[3];
    int64_t i = 0;
    while (i <= w->steps && !(value_at(w, (double)i) >= level))
        i++;
    if (i > w->steps)
        return;
    double low = (double)i - 1, high = (double)i;
    for (int n = 0; n < 60 && i > 0; n++) {
        double middle = (low + high) / 2;
        if (value_at(w, middle) >= level)
            high = middle;
        else
            low = middle;
    }
    at_step(w, high, at);
    reference_classify(scene, level, pixel);
    pixel[3] = 1;
    if (depth)
        *depth = depth_at(w, high);
    if (scene->settings.shade != SNOW_SHADE_PHONG)
        return;
    gradient_at(w->cast, at, 0, gradient);
    add_border(w->cast, *w->range, at, gradient);
    shade(w, at, gradient, pixel);
}

double *reference_cast_rays(const reference_cast *cast, double *depth) {
    const reference_scene *scene = cast->scene;
    snow_mode mode = scene->settings.mode;
    bool sums = mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM;
    int width = scene->view.width, height = scene->view.height;
    size_t count = (size_t)width * (size_t)height;
    double *pixels = calloc(count * (sums ? 1 : 4), sizeof *pixels);
    reference_camera camera;
    double range[8], *to = range;
    reference_camera_of(scene, &camera);
    for (const reference_cast *one = cast; one; one = one->next)
        *to++ = range_of(one);
    for (size_t n = 0; n < count; n++) {
        walk w = {.cast = cast, .camera = &camera, .range = range};
        double *pixel = pixels + n * (sums ? 1 : 4);
        w.ray =
            reference_ray_at(scene, &camera, (double)(n % (size_t)width) + 0.5,
                             (double)(n / (size_t)width) + 0.5);
        if (depth)
            depth[n] = (double)NAN;
        bool met = begin(&w);
        if (sums)
            *pixel = met ? cast_sum(&w) : (double)NAN;
        else if (met && mode == SNOW_MODE_OVER)
            cast_over(&w, pixel, depth ? depth + n : NULL);
        else if (met && mode == SNOW_MODE_ISO)
            cast_iso(&w, pixel, depth ? depth + n : NULL);
        else if (met)
            cast_largest(&w, pixel);
    }
    return pixels;
}
