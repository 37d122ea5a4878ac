/* tests/values/slab.c - the value model's gradients, cuts and light.
 *
 * docs/model.md, the value model, points 4, 6, 7 and 9. */
#include "values/value_model.h"

#include <math.h>

/* --- gradients ------------------------------------------------------------ */

/* Twice a difference quotient over a way of one to either side: of both
 * neighbours, of the one that is there, or none. */
static int quotient(int before, int here, int after) {
    if (before != VALUE_HOLE && after != VALUE_HOLE)
        return value_saturate((int64_t)after - before);
    if (after != VALUE_HOLE)
        return value_saturate(2 * ((int64_t)after - here));
    if (before != VALUE_HOLE)
        return value_saturate(2 * ((int64_t)here - before));
    return 0;
}

/* How much wider the lattice is on a sheet than on the front one. */
static double widening(const value_plan *plan, int sheet) {
    if (!plan->perspective)
        return 1;
    return (value_sheet_at(plan, sheet) - plan->eye[2]) /
           (plan->first - plan->eye[2]);
}

/* Along u (`n` 0) or v: the lattice pixels that are one voxel away, or the
 * nearest to that. */
static int slope_in_plane(const value_field *field, const value_ray *ray,
                          int sheet, int n) {
    const value_plan *plan = field->plan;
    double m = widening(plan, sheet), at[3];
    int cells = plan->cells[n], reach = (int)rint(cells / m);
    reach = reach < 1 ? 1 : reach;
    double far = reach * m / cells;
    int value[3];
    value_ray_at(plan, ray, sheet, at);
    for (int side = -1; side <= 1; side++)
        value[side + 1] =
            value_sheet(field, sheet, at[0] + (n == 0 ? side * far : 0),
                        at[1] + (n == 1 ? side * far : 0));
    int twice = quotient(value[0], value[1], value[2]);
    return m == 1 ? twice : value_saturate((int64_t)floor(twice / far + 0.5));
}

/* The slices that a sheet lies between; of a slice the sheets half way to those
 * beside it. */
static void near_sheets(const value_plan *plan, int sheet, int *before,
                        int *after) {
    int count = plan->per_slice, past = sheet % count;
    int front = past > 0 ? sheet - past : sheet - count / 2;
    *before = plan->direction > 0 ? front : front + count;
    *after = plan->direction > 0 ? front + count : front;
}

/* The difference of two sheets at a place in the plane, as a sheet is
 * interpolated: of voxels that are all there; false where one is not. */
static bool difference_at(const value_field *field, int before, int after,
                          const double at[3], int times, int *out) {
    int64_t i = (int64_t)floor(at[0]), j = (int64_t)floor(at[1]);
    int wu = value_weight(at[0] - (double)i);
    int wv = value_weight(at[1] - (double)j), row[2];
    for (int y = 0; y < 2; y++) {
        int ends[2];
        for (int x = 0; x < 2; x++) {
            value_part a = value_voxel(field, before, i + x, j + y);
            value_part b = value_voxel(field, after, i + x, j + y);
            if (a.weight < VALUE_FULL || b.weight < VALUE_FULL)
                return false;
            ends[x] = value_saturate(
                times * (int64_t)value_saturate(b.value - a.value));
        }
        row[y] = value_between(ends[0], ends[1], wu);
    }
    *out = value_between(row[0], row[1], wv);
    return true;
}

/* Along P, at the very place in the plane, where no voxel is missing. */
static bool slope_in_place(const value_field *field, const value_ray *ray,
                           int sheet, int *slope) {
    const value_plan *plan = field->plan;
    int step = plan->direction * plan->per_slice, times = 1;
    int before = sheet - step, after = sheet + step;
    double at[3];
    bool lacks[2] = {before < 0 || before >= plan->sheets,
                     after < 0 || after >= plan->sheets};
    value_ray_at(plan, ray, sheet, at);
    if (lacks[0] && lacks[1]) {
        near_sheets(plan, sheet, &before, &after);
        times = 2;
    } else if (lacks[0] || lacks[1]) {
        before = lacks[0] ? sheet : before;
        after = lacks[1] ? sheet : after;
        times = 2;
    }
    return difference_at(field, before, after, at, times, slope);
}

/* What a sheet has where the ray meets another; a hole where there is none. */
static int beside(const value_field *field, int sheet, const double at[3]) {
    if (sheet < 0 || sheet >= field->plan->sheets)
        return VALUE_HOLE;
    return value_sheet(field, sheet, at[0], at[1]);
}

/* Along P, at a fixed place in the plane. */
static int slope_across(const value_field *field, const value_ray *ray,
                        int sheet) {
    const value_plan *plan = field->plan;
    int step = plan->direction * plan->per_slice, slope;
    double at[3];
    if (plan->dims[2] == 1)
        return 0;
    if (!plan->scene->cubic && slope_in_place(field, ray, sheet, &slope))
        return slope;
    value_ray_at(plan, ray, sheet, at);
    int before = beside(field, sheet - step, at);
    int after = beside(field, sheet + step, at);
    if (before == VALUE_HOLE && after == VALUE_HOLE && plan->per_slice > 1) {
        int near[2];
        near_sheets(plan, sheet, &near[0], &near[1]);
        before = beside(field, near[0], at);
        after = beside(field, near[1], at);
        if (before != VALUE_HOLE && after != VALUE_HOLE)
            return value_saturate(2 * ((int64_t)after - before));
        return 0;
    }
    return quotient(before, beside(field, sheet, at), after);
}

static bool is_member(const void *of, const int64_t voxel[3]) {
    const value_field *field = of;
    return value_code(field, voxel) == field->member;
}

/* Twice that of the smooth membership of the field's label. */
static void label_gradient(const value_field *field, const double at[3],
                           double gradient[3]) {
    reference_membership_gradient(field->plan->dims, 3, true, is_member, field,
                                  at, gradient);
    for (int a = 0; a < 3; a++)
        gradient[a] = floor(2 * VALUE_MOST * gradient[a] + 0.5);
}

void value_gradient(const value_field *field, const value_ray *ray, int slab,
                    int place, double gradient[3]) {
    if (field->plan->scene->labels) {
        double at[3];
        value_ray_at(field->plan, ray, slab + place / 32768.0, at);
        label_gradient(field, at, gradient);
        return;
    }
    for (int n = 0; n < 3; n++) {
        int ends[2];
        for (int end = 0; end < 2; end++)
            ends[end] = n == 2 ? slope_across(field, ray, slab + end)
                               : slope_in_plane(field, ray, slab + end, n);
        gradient[n] = value_between(ends[0], ends[1], place);
    }
}

static bool is_there(const void *of, const int64_t voxel[3]) {
    return value_code(of, voxel) != VALUE_HOLE;
}

void value_add_border(const value_field *field, const value_ray *ray, int slab,
                      int place, double gradient[3]) {
    const value_scene *scene = field->plan->scene;
    double ends[2][3];
    for (int end = 0; end < 2; end++) {
        double at[3];
        value_ray_at(field->plan, ray, slab + end, at);
        reference_membership_gradient(field->plan->dims, 2, false, is_there,
                                      field, at, ends[end]);
    }
    for (int a = 0; a < 3 && scene->base.masked && !scene->labels; a++) {
        int twice[2];
        for (int end = 0; end < 2; end++)
            twice[end] = (int)floor(2 * VALUE_MOST * ends[end][a] + 0.5);
        gradient[a] = value_saturate((int64_t)gradient[a] +
                                     value_between(twice[0], twice[1], place));
    }
}

/* --- cuts ----------------------------------------------------------------- */

/* Keeps the part of [t[0], t[1]] where from + t (to - from) <= most. */
static void keep_below(double from, double to, double most, double t[2]) {
    double rest = most - from, way = to - from;
    if (way > 0)
        t[1] = fmin(t[1], rest / way);
    else if (way < 0)
        t[0] = fmax(t[0], rest / way);
    else if (rest < 0)
        t[1] = -1;
}

static double height_of(const value_plan *plan, const double at[3],
                        const double clip[4]) {
    double sum = 0;
    for (int r = 0; r < 3; r++) {
        double world = plan->scene->base.info.matrix[r][3];
        for (int n = 0; n < 3; n++)
            world += plan->scene->base.info.matrix[r][plan->axis[n]] * at[n];
        sum += clip[r] * world;
    }
    return sum;
}

bool value_cut(const value_plan *plan, const value_ray *ray, int slab,
               int part[2]) {
    const value_scene *scene = plan->scene;
    double from[3], to[3], t[2] = {0, 1};
    value_ray_at(plan, ray, slab, from);
    value_ray_at(plan, ray, slab + 1, to);
    for (int n = 0; n < 3; n++) {
        bool single = plan->dims[n] == 1;
        double low = single ? -0.5 : 0;
        double high = single ? 0.5 : (double)plan->dims[n] - 1;
        if (scene->cropped && !single) {
            low = fmax(low, scene->keep[plan->axis[n]][0]);
            high = fmin(high, scene->keep[plan->axis[n]][1]);
        }
        keep_below(from[n], to[n], high, t);
        keep_below(-from[n], -to[n], -low, t);
    }
    for (size_t n = 0; n < scene->clip_count; n++)
        keep_below(height_of(plan, from, scene->clips[n]),
                   height_of(plan, to, scene->clips[n]), scene->clips[n][3], t);
    for (int n = 0; n < 2; n++)
        part[n] = (int)floor(32768 * fmin(fmax(t[n], -1), 2) + 0.5);
    return part[1] > part[0];
}

/* --- light ---------------------------------------------------------------- */

void value_shade(const value_plan *plan, const value_ray *ray,
                 const double gradient[3], double rgba[4]) {
    const reference_scene *scene = &plan->scene->base;
    double inverse[3][3], n[3] = {0}, eye[3] = {0}, lit[2];
    reference_inverse(scene->info.matrix, inverse);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            n[r] += inverse[plan->axis[c]][r] * gradient[c];
            eye[r] += scene->info.matrix[r][plan->axis[c]] * ray->eye[c];
        }
    reference_light(&scene->settings, &plan->camera, n, eye, lit);
    for (int c = 0; c < 3; c++)
        rgba[c] = fmin(rgba[3], rgba[c] * lit[0] + rgba[3] * lit[1]);
}

void value_lengthen(double rgba[4], double share) {
    if (share == 1 || !(rgba[3] > 0))
        return;
    double alpha = 1 - pow(1 - fmin(1, rgba[3]), share);
    for (int c = 0; c < 3; c++)
        rgba[c] *= alpha / rgba[3];
    rgba[3] = alpha;
}

void value_fade(const value_plan *plan, const double gradient[3], double v,
                double rgba[4]) {
    const reference_scene *scene = &plan->scene->base;
    double range = plan->scene->labels ? 1 : plan->high - plan->low;
    double unit = range / VALUE_MOST, native[3], factor;
    if (!scene->gradient_count)
        return;
    for (int n = 0; n < 3; n++)
        native[plan->axis[n]] = gradient[n] / 2 * unit / scene->info.slope;
    if (scene->log) /* of the data, not of their logarithms */
        for (int n = 0; n < 3; n++)
            native[n] *= log(10) * pow(10, plan->low + v * unit);
    factor = reference_fade(scene, native);
    double share = plan->path / reference_opacity_length(scene);
    if (!plan->plain_fade)
        value_lengthen(rgba, 1 / share);
    for (int c = 0; c < 4; c++)
        rgba[c] *= factor;
    if (!plan->plain_fade)
        value_lengthen(rgba, share);
}
