/* tests/values/field.c - the value model's voxels and sheets.
 *
 * docs/model.md, the value model, points 2 and 3: voxels as integers, odd
 * beyond the box, holes by weights; sheets interpolated from them. */
#include "values/value_model.h"

#include <math.h>
#include <stdlib.h>

int value_saturate(int64_t x) {
    return x < INT16_MIN ? INT16_MIN : x > INT16_MAX ? INT16_MAX : (int)x;
}

static int64_t divide_down(int64_t x, int64_t by) {
    return x >= 0 ? x / by : -((-x + by - 1) / by);
}

int value_scale(int64_t x, int w) {
    return (int)divide_down(x * w + 16384, 32768);
}

int value_between(int a, int b, int w) {
    return a + value_scale(value_saturate((int64_t)b - a), w);
}

int value_weight(double part) {
    int w = (int)floor(32768 * part + 0.5);
    return w > 32767 ? 32767 : w;
}

/* --- voxels --------------------------------------------------------------- */

value_rule value_rule_of(int steps) {
    value_rule rule = {VALUE_MOST / steps, 1, 32768};
    if (steps <= 2047)
        return rule;
    rule.factor = 1;
    rule.divisor = steps >= 32768 ? 2 : 1;
    while (steps * rule.factor * 2 / rule.divisor < 32768)
        rule.factor *= 2;
    rule.weight =
        (int64_t)VALUE_MOST * 32768 / (steps * rule.factor / rule.divisor);
    return rule;
}

static int whole_code(const value_plan *plan, double value) {
    value_rule rule = value_rule_of(plan->stored);
    double n = rint((value - plan->low) / plan->step);
    int64_t t = (int64_t)fmin(fmax(n, 0), plan->stored) * rule.factor;
    return value_scale(t / rule.divisor, (int)rule.weight);
}

static int code_of(const value_plan *plan, double value) {
    if (isnan(value))
        return VALUE_HOLE;
    if (plan->stored)
        return whole_code(plan, value);
    if (!(plan->high > plan->low))
        return 0;
    value = fmin(fmax(value, plan->low), plan->high);
    return (int)rint((value - plan->low) * VALUE_MOST /
                     (plan->high - plan->low));
}

/* The number of a label, which is given when it is seen first. */
static int number_of(value_field *field, double name) {
    if (isnan(name))
        return VALUE_HOLE;
    for (int n = 0; n < field->name_count; n++)
        if (field->names[n] == name)
            return n;
    field->names =
        realloc(field->names, (size_t)(field->name_count + 1) * sizeof(double));
    field->names[field->name_count] = name;
    return field->name_count++;
}

double value_data(const value_scene *scene, const int64_t at[3]) {
    const snow_volume_info *info = &scene->base.info;
    double native = reference_native(&scene->base, at[0], at[1], at[2]);
    double value = info->slope * native + info->intercept;
    if (!scene->base.log || scene->base.settings.mode != SNOW_MODE_OVER)
        return value;
    return value > 0 ? log10(value) : (double)NAN;
}

void value_field_make(const value_plan *plan, value_field *field) {
    const int64_t *n = plan->dims;
    size_t count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2], to = 0;
    *field = (value_field){.plan = plan, .member = -1};
    field->codes = calloc(count, sizeof *field->codes);
    for (int64_t p = 0; p < n[2]; p++)
        for (int64_t v = 0; v < n[1]; v++)
            for (int64_t u = 0; u < n[0]; u++, to++) {
                int64_t at[3];
                at[plan->axis[0]] = u;
                at[plan->axis[1]] = v;
                at[plan->axis[2]] = p;
                double value = value_data(plan->scene, at);
                field->codes[to] = plan->scene->labels ? number_of(field, value)
                                                       : code_of(plan, value);
            }
}

void value_field_free(value_field *field) {
    free(field->codes);
    free(field->names);
}

/* Slices below and above a sheet; they are one where the sheet is a slice. */
static void slices_of(const value_plan *plan, int sheet, int64_t slices[2]) {
    double p = value_sheet_at(plan, sheet);
    slices[0] = (int64_t)floor(p);
    slices[1] = (int64_t)ceil(p);
    if (plan->dims[2] == 1)
        slices[0] = slices[1] = 0;
}

static size_t offset(const value_plan *plan, int64_t i, int64_t j, int64_t k) {
    return (size_t)((k * plan->dims[1] + j) * plan->dims[0] + i);
}

int value_code(const value_field *field, const int64_t at[3]) {
    return field->codes[offset(field->plan, at[0], at[1], at[2])];
}

static value_part slice_voxel(const value_field *field, int64_t i, int64_t j,
                              int64_t k) {
    int code = field->codes[offset(field->plan, i, j, k)];
    if (code == VALUE_HOLE)
        return (value_part){0};
    if (field->member >= 0)
        code = code == field->member ? VALUE_MOST : 0;
    return (value_part){code, VALUE_FULL};
}

/* A voxel of a whole slice by the cubic kernel along P: 1, 4, 1 sixths. */
static value_part smooth_voxel(const value_field *field, int64_t i, int64_t j,
                               int64_t k) {
    int64_t last = field->plan->dims[2] - 1;
    value_part here = slice_voxel(field, i, j, k);
    if (!here.weight || last == 0)
        return here;
    value_part side[2];
    for (int n = 0; n < 2; n++) {
        int64_t to = n ? k + 1 : k - 1, from = n ? k - 1 : k + 1;
        side[n] = slice_voxel(field, i, j, to < 0 || to > last ? from : to);
        if (!side[n].weight)
            side[n].value = here.value;
        else if (to < 0 || to > last)
            side[n].value = 2 * here.value - side[n].value;
    }
    here.value =
        divide_down(side[0].value + 4 * here.value + side[1].value + 3, 6);
    return here;
}

/* A voxel of a slice, whether in the box or beyond. */
static value_part any_voxel(const value_field *field, int64_t i, int64_t j,
                            int64_t k) {
    const int64_t *n = field->plan->dims;
    value_part (*voxel)(const value_field *, int64_t, int64_t, int64_t) =
        field->plan->scene->cubic ? smooth_voxel : slice_voxel;
    int64_t u = i < 0 ? 0 : i >= n[0] ? n[0] - 1 : i;
    int64_t v = j < 0 ? 0 : j >= n[1] ? n[1] - 1 : j;
    value_part border = voxel(field, u, v, k);
    if ((u == i && v == j) || border.weight < VALUE_FULL)
        return border;
    /* Beyond two sides the odd reflection is along u alone. */
    int64_t next[2] = {u, v};
    if (u != i)
        next[0] = n[0] == 1 ? u : i < 0 ? 1 : n[0] - 2;
    else
        next[1] = n[1] == 1 ? v : j < 0 ? 1 : n[1] - 2;
    value_part inside = voxel(field, next[0], next[1], k);
    if (inside.weight == VALUE_FULL)
        border.value = 2 * border.value - inside.value;
    return border;
}

/* Of a slice; half way between two, or from there toward the nearer one. */
value_part value_voxel(const value_field *field, int sheet, int64_t i,
                       int64_t j) {
    int64_t k[2];
    value_part part[2];
    slices_of(field->plan, sheet, k);
    for (int n = 0; n < 2; n++)
        part[n] = any_voxel(field, i, j, k[n]);
    double p = value_sheet_at(field->plan, sheet), t = p - floor(p);
    if (k[0] == k[1])
        return part[0];
    value_part *to = &part[t > 0.5], half;
    half.value = divide_down(part[0].value + part[1].value + 1, 2);
    half.weight = (part[0].weight + part[1].weight) / 2;
    double w = 32768 * fabs(2 * t - 1); /* a whole number */
    half.value = value_between((int)half.value, (int)to->value, (int)w);
    half.weight = value_between((int)half.weight, (int)to->weight, (int)w);
    return half;
}

/* --- sheets --------------------------------------------------------------- */

/* A mean that has its weights: no value where less than half is there. */
static int weighed(int64_t value, int64_t weight) {
    if (weight >= VALUE_FULL)
        return (int)value;
    if (weight < VALUE_FULL / 2)
        return VALUE_HOLE;
    return (int)floor((double)value * VALUE_FULL / (double)weight + 0.5);
}

static void cubic_weights(double t, double w[4]) {
    double s = 1 - t;
    w[0] = s * s * s / 6;
    w[1] = (4 - 6 * t * t + 3 * t * t * t) / 6;
    w[2] = (4 - 6 * s * s + 3 * s * s * s) / 6;
    w[3] = t * t * t / 6;
}

static int cubic_sheet(const value_field *field, int sheet, double u,
                       double v) {
    int64_t i = (int64_t)floor(u), j = (int64_t)floor(v);
    double wu[4], wv[4], value = 0, weight = 0;
    cubic_weights(u - (double)i, wu);
    cubic_weights(v - (double)j, wv);
    for (int y = 0; y < 4; y++)
        for (int x = 0; x < 4; x++) {
            value_part part = value_voxel(field, sheet, i - 1 + x, j - 1 + y);
            value += wu[x] * wv[y] * (double)part.value;
            weight += wu[x] * wv[y] * (double)part.weight;
        }
    return weighed((int64_t)floor(value + 0.5), (int64_t)floor(weight + 0.5));
}

int value_sheet(const value_field *field, int sheet, double u, double v) {
    if (field->plan->scene->cubic)
        return cubic_sheet(field, sheet, u, v);
    int64_t i = (int64_t)floor(u), j = (int64_t)floor(v);
    int wu = value_weight(u - (double)i), wv = value_weight(v - (double)j);
    int row[2], weight[2];
    for (int y = 0; y < 2; y++) {
        value_part a = value_voxel(field, sheet, i, j + y);
        value_part b = value_voxel(field, sheet, i + 1, j + y);
        row[y] = value_between((int)a.value, (int)b.value, wu);
        weight[y] = value_between((int)a.weight, (int)b.weight, wu);
    }
    return weighed(value_between(row[0], row[1], wv),
                   value_between(weight[0], weight[1], wv));
}

int value_sheet_label(const value_field *field, int sheet, double u, double v) {
    const int64_t *n = field->plan->dims;
    int64_t i = (int64_t)floor(u + 0.5), j = (int64_t)floor(v + 0.5), k[2];
    slices_of(field->plan, sheet, k);
    i = i < 0 ? 0 : i >= n[0] ? n[0] - 1 : i;
    j = j < 0 ? 0 : j >= n[1] ? n[1] - 1 : j;
    return field->codes[offset(field->plan, i, j, k[0])];
}
