/* tests/values/picture.c - the value model's lattice and its warp.
 *
 * docs/model.md, the value model, points 5, 6 and 8. */
#include "values/value_model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- lattice samples ------------------------------------------------------ */

/* The ends of the kept part of a slab as integers. */
static bool slab_values(const value_model *model, const value_ray *ray,
                        int slab, const int part[2], int ends[2]) {
    const value_field *field = &model->field;
    int value[2];
    for (int end = 0; end < 2; end++) {
        double at[3];
        value_ray_at(&model->plan, ray, slab + end, at);
        value[end] = value_sheet(field, slab + end, at[0], at[1]);
        if (value[end] == VALUE_HOLE)
            return false;
    }
    for (int end = 0; end < 2; end++) {
        ends[end] = value_between(value[0], value[1], part[end]);
        ends[end] = ends[end] < 0            ? 0
                    : ends[end] > VALUE_MOST ? VALUE_MOST
                                             : ends[end];
    }
    return true;
}

/* Experiments: the values where a cut is, from both slices. */
static void values_at_cut(const value_model *model, const value_ray *ray,
                          int slab, const int part[2], int ends[2]) {
    for (int end = 0; end < 2; end++) {
        double at[3], t = part[end] / 32768.0;
        value_ray_at(&model->plan, ray, slab + t, at);
        int f = value_sheet(&model->field, slab, at[0], at[1]);
        int b = value_sheet(&model->field, slab + 1, at[0], at[1]);
        if (f != VALUE_HOLE && b != VALUE_HOLE)
            ends[end] = (int)fmin(fmax(rint(f + t * (b - f)), 0), VALUE_MOST);
    }
}

/* A slab's colours before light, and the place of its opacity. */
static bool look_up(value_model *model, const value_ray *ray, int slab,
                    const int part[2], double rgba[4], int *place) {
    const value_table *table = &model->table;
    int ends[2], length = part[1] - part[0];
    if (!slab_values(model, ray, slab, part, ends))
        return false;
    if (model->plan.exact_cut && length < 32768)
        values_at_cut(model, ray, slab, part, ends);
    const value_entry *entry =
        &table->entries[table->index[ends[0]] * table->nodes +
                        table->index[ends[1]]];
    for (int c = 0; c < 3; c++)
        rgba[c] = entry->color[c] * table->unit;
    rgba[3] = entry->alpha * table->unit;
    *place = part[0] + (((2 * entry->place + 1) * length + 16) >> 5);
    return entry->alpha > 0;
}

/* V at `place` of 32768 of a whole slab. */
static double value_at_place(const value_model *model, const value_ray *ray,
                             int slab, int place) {
    int part[2] = {place, place}, ends[2] = {0, 0};
    slab_values(model, ray, slab, part, ends);
    return ends[0];
}

static bool draw_slab(value_model *model, const value_ray *ray, int slab,
                      double rgba[4]) {
    const value_plan *plan = &model->plan;
    const reference_scene *scene = &plan->scene->base;
    bool shaded = scene->settings.shade == SNOW_SHADE_PHONG;
    double gradient[3];
    int part[2], place;
    if (!value_cut(plan, ray, slab, part))
        return false;
    bool labels = plan->scene->labels;
    if (labels ? !value_label_slab(&model->field, ray, slab, part, rgba, &place)
               : !look_up(model, ray, slab, part, rgba, &place))
        return false;
    if (shaded || scene->gradient_count)
        value_gradient(&model->field, ray, slab, place, gradient);
    value_fade(plan, gradient, value_at_place(model, ray, slab, place), rgba);
    if (!labels)
        value_lengthen(rgba,
                       (part[1] - part[0]) / 32768.0 * ray->path / plan->path);
    if (shaded) {
        value_add_border(&model->field, ray, slab, place, gradient);
        value_shade(plan, ray, gradient, rgba);
    }
    return true;
}

static void compute_sample(value_model *model, int64_t a, int64_t b,
                           double out[4]) {
    const value_plan *plan = &model->plan;
    double front[2];
    value_lattice_front(plan, (double)a, (double)b, front);
    value_ray ray = value_ray_of(plan, front[0], front[1]);
    memset(out, 0, 4 * sizeof *out);
    if (plan->scene->base.settings.mode != SNOW_MODE_OVER) {
        value_mode_sample(&model->field, &ray, out);
        return;
    }
    for (int slab = 0; slab + 1 < plan->sheets; slab++) {
        double mixed[4] = {0, 0, 0, 0}, through = 1 - out[3];
        for (value_model *m = model->front ? model->front : model; m;
             m = m == model ? NULL : model) {
            double rgba[4];
            if (!draw_slab(m, &ray, slab, rgba))
                continue;
            for (int c = 0; c < 4; c++)
                if (!plan->scene->mixes)
                    out[c] += (c ? through : (through = 1 - out[3])) * rgba[c];
                else
                    mixed[c] =
                        c < 3 ? mixed[c] + rgba[c] : fmax(mixed[c], rgba[c]);
            if (out[3] >= model->close_at)
                return;
        }
        for (int c = 0; c < 4; c++)
            out[c] += through * mixed[c];
        if (out[3] >= model->close_at)
            return;
    }
}

void value_model_sample(value_model *model, int64_t a, int64_t b,
                        double out[4]) {
    int64_t x = a - model->first[0], y = b - model->first[1];
    memset(out, 0, 4 * sizeof *out);
    if (x < 0 || y < 0 || x >= model->size[0] || y >= model->size[1])
        return;
    size_t at = (size_t)(y * model->size[0] + x);
    if (!model->known[at]) {
        compute_sample(model, a, b, model->samples[at]);
        model->known[at] = true;
    }
    memcpy(out, model->samples[at], 4 * sizeof *out);
}

/* --- the lattice's extent ------------------------------------------------- */

/* The lattice position of the ray through an index position. */
static void shadow(const value_plan *plan, const double at[3], double ab[2]) {
    double front[2], p = at[2] - plan->first;
    double m = plan->perspective
                   ? (at[2] - plan->eye[2]) / (plan->first - plan->eye[2])
                   : 1;
    for (int n = 0; n < 2; n++)
        front[n] = plan->perspective ? plan->eye[n] + (at[n] - plan->eye[n]) / m
                                     : at[n] - p * plan->slope[n];
    value_lattice_of(plan, front, ab);
}

static void enclose_volume(const value_plan *plan, double low[2],
                           double high[2]) {
    for (int n = 0; n < 2; n++) {
        low[n] = INFINITY;
        high[n] = -INFINITY;
    }
    for (int corner = 0; corner < 8; corner++) {
        double at[3], ab[2];
        for (int n = 0; n < 3; n++)
            at[n] = corner >> n & 1 ? (double)plan->dims[n] : -1;
        at[2] =
            corner & 4 ? value_sheet_at(plan, plan->sheets - 1) : plan->first;
        shadow(plan, at, ab);
        for (int n = 0; n < 2; n++) {
            low[n] = fmin(low[n], ab[n]);
            high[n] = fmax(high[n], ab[n]);
        }
    }
}

/* What the picture's corners see of the lattice, where they see it. */
static void enclose_picture(const value_plan *plan, double low[2],
                            double high[2]) {
    const snow_view *view = &plan->scene->base.view;
    double around = 4 << plan->halvings, seen[2][2];
    for (int corner = 0; corner < 4; corner++) {
        double ab[2];
        if (!value_lattice_at(plan, corner & 1 ? view->width : 0,
                              corner & 2 ? view->height : 0, ab))
            return;
        for (int n = 0; n < 2; n++) {
            seen[n][0] = corner ? fmin(seen[n][0], ab[n]) : ab[n];
            seen[n][1] = corner ? fmax(seen[n][1], ab[n]) : ab[n];
        }
    }
    for (int n = 0; n < 2; n++) {
        low[n] = fmax(low[n], seen[n][0] - around);
        high[n] = fmin(high[n], seen[n][1] + around);
    }
}

value_model *value_model_new(const value_plan *plan) {
    value_model *model = calloc(1, sizeof *model);
    double low[2], high[2];
    model->plan = *plan;
    model->close_at = 2;
    value_field_make(&model->plan, &model->field);
    if (plan->scene->base.settings.mode == SNOW_MODE_OVER &&
        !plan->scene->labels)
        value_table_make(&model->plan, &model->table);
    enclose_volume(plan, low, high);
    enclose_picture(plan, low, high);
    for (int n = 0; n < 2; n++) {
        model->first[n] = (int64_t)floor(low[n]) - 1;
        model->size[n] = (int64_t)fmax(ceil(high[n]) + 2 - floor(low[n]), 1);
    }
    size_t count = (size_t)model->size[0] * (size_t)model->size[1];
    model->samples = calloc(count, sizeof *model->samples);
    model->known = calloc(count, sizeof *model->known);
    if (!model->samples || !model->known)
        abort();
    return model;
}

void value_model_free(value_model *model) {
    value_field_free(&model->field);
    value_table_free(&model->table);
    free(model->samples);
    free(model->known);
    free(model);
}

/* --- the warp ------------------------------------------------------------- */

static void catmull_rom(double t, double w[4]) {
    w[0] = (-t + 2 * t * t - t * t * t) / 2;
    w[1] = (2 - 5 * t * t + 3 * t * t * t) / 2;
    w[2] = (t + 4 * t * t - 3 * t * t * t) / 2;
    w[3] = (-t * t + t * t * t) / 2;
}

static void linear(double t, double w[4]) {
    w[0] = w[3] = 0;
    w[1] = 1 - t;
    w[2] = t;
}

/* A sample of the lattice image, halved as often as the plan says. */
static void halved_sample(value_model *model, int64_t a, int64_t b,
                          double out[4]) {
    int64_t side = (int64_t)1 << model->plan.halvings;
    memset(out, 0, 4 * sizeof *out);
    for (int64_t y = 0; y < side; y++)
        for (int64_t x = 0; x < side; x++) {
            double sample[4];
            value_model_sample(model, a * side + x, b * side + y, sample);
            for (int c = 0; c < 4; c++)
                out[c] += sample[c] / (double)(side * side);
        }
}

/* Adds the lattice image at a position; of projections the value times its
 * weight, and the weight. */
static void add_image(value_model *model, const double ab[2], double share,
                      double sum[4]) {
    double side = (double)((int64_t)1 << model->plan.halvings), w[2][4];
    double at[2];
    snow_mode mode = model->plan.scene->base.settings.mode;
    bool colors = mode == SNOW_MODE_OVER || mode == SNOW_MODE_ISO;
    for (int n = 0; n < 2; n++) {
        at[n] = (ab[n] + 0.5) / side - 0.5;
        if (model->plan.warp == VALUE_WARP_CATMULL_ROM && colors)
            catmull_rom(at[n] - floor(at[n]), w[n]);
        else
            linear(at[n] - floor(at[n]), w[n]);
    }
    for (int y = 0; y < 4; y++)
        for (int x = 0; x < 4; x++) {
            double sample[4], weight = share * w[0][x] * w[1][y];
            if (weight == 0)
                continue;
            halved_sample(model, (int64_t)floor(at[0]) - 1 + x,
                          (int64_t)floor(at[1]) - 1 + y, sample);
            for (int c = 0; c < 4; c++)
                sum[c] += weight * sample[c];
        }
}

/* What the sums of a pixel come to. */
static void finish(const value_plan *plan, double sum[4], double out[4]) {
    const reference_scene *scene = &plan->scene->base;
    snow_mode mode = scene->settings.mode;
    memset(out, 0, 4 * sizeof *out);
    if (mode == SNOW_MODE_OVER || mode == SNOW_MODE_ISO) {
        out[3] = fmin(fmax(sum[3], 0), 1);
        for (int c = 0; c < 3; c++)
            out[c] = fmin(fmax(sum[c], 0), out[3]);
        return;
    }
    bool values = mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM;
    out[0] = values ? (double)NAN : 0;
    if (!(sum[1] >= 0.499))
        return;
    double value = sum[0] / sum[1];
    if (values) {
        out[0] = value;
        return;
    }
    reference_classify(scene, value, out);
    out[3] = 1;
}

void value_model_pixel(value_model *model, int x, int y, double out[4]) {
    const value_plan *plan = &model->plan;
    int side = plan->warp == VALUE_WARP_MEAN ? plan->mean : 1;
    double sum[4] = {0}, ab[2], share = 1.0 / (side * side);
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++)
            if (value_lattice_at(plan, x + (i + 0.5) / side,
                                 y + (j + 0.5) / side, ab))
                add_image(model, ab, share, sum);
    finish(plan, sum, out);
}

double *value_model_render(const value_scene *scene) {
    value_plan plan;
    if (!value_plan_of(scene, &plan))
        return NULL;
    value_model *model = value_model_new(&plan);
    int width = scene->base.view.width, height = scene->base.view.height;
    snow_mode mode = scene->base.settings.mode;
    int channels = mode == SNOW_MODE_MEAN || mode == SNOW_MODE_SUM ? 1 : 4;
    double *picture = calloc((size_t)width * (size_t)height * (size_t)channels,
                             sizeof *picture);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            double pixel[4];
            value_model_pixel(model, x, y, pixel);
            memcpy(picture + ((size_t)y * (size_t)width + (size_t)x) *
                                 (size_t)channels,
                   pixel, (size_t)channels * sizeof *pixel);
        }
    value_model_free(model);
    return picture;
}
