/* measures.c - implements measures.h. */
#include "measure/measures.h"
#include "commands/commands.h"
#include "run/log.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Part of a slice's thickness that a point may be off it. */
#define THICKNESS 0.500001

static const char *const kinds[] = {"", "line", "angle", "ellipse"};

/* --- what is asked -------------------------------------------------------- */

static int refuse_outside(const measures *m, int n) {
    const snow_measure *one = &m->each[n];
    const int point = one->outside - 1;
    double low[3], high[3];
    for (int i = 0; i < 3; i++) {
        const double scale = m->whole.axis_scale[i];
        double middle = m->whole.matrix[i][3], reach = 0;
        for (int k = 0; k < 3; k++) {
            const double step = m->whole.matrix[i][k];
            middle += step * ((double)m->whole.dims[k] - 1) / 2;
            reach += fabs(step) * (double)m->whole.dims[k] / 2;
        }
        const double unit = fabs(scale) > 0 ? scale : 1;
        low[i] = fmin((middle - reach) / unit, (middle + reach) / unit);
        high[i] = fmax((middle - reach) / unit, (middle + reach) / unit);
    }
    if (one->kind == SNOW_MEASURE_ELLIPSE &&
        (one->index < 0 || one->index >= m->whole.dims[one->axis]))
        return fail_usage("--measure: measure %d: no slice is at its position: "
                          "the volume has x from %.6g to %.6g, y %.6g to %.6g, "
                          "z %.6g to %.6g; correct the position",
                          n + 1, low[0], high[0], low[1], high[1], low[2],
                          high[2]);
    return fail_usage("--measure: measure %d: %.6g,%.6g,%.6g is outside the "
                      "volume, which has x from %.6g to %.6g, y %.6g to %.6g, "
                      "z %.6g to %.6g; correct the point",
                      n + 1, one->points[point][0], one->points[point][1],
                      one->points[point][2], low[0], high[0], low[1], high[1],
                      low[2], high[2]);
}

static int read_all(const char *text, snow_context *context, bool everywhere,
                    measures *m) {
    for (m->count = 0; m->count <= SNOW_MEASURES_MAX; m->count++) {
        snow_measure one = {.size = sizeof one};
        snow_status status =
            snow_measure_read(context, text, m->count, &m->whole, &one);
        if (status != SNOW_STATUS_OK)
            return fail_usage("--measure: %s", snow_context_message(context));
        if (one.kind == SNOW_MEASURE_NONE)
            break;
        m->each[m->count] = one;
        if (one.outside && !everywhere)
            return refuse_outside(m, m->count);
    }
    return CONTINUE;
}

/* --- values --------------------------------------------------------------- */

static bool has_clip(const options *opts) {
    for (int i = 0; i < SNOW_CLIPS_MAX; i++)
        for (int k = 0; k < 3; k++)
            if (fabs(opts->clip[i][k]) > 0)
                return true;
    return false;
}

/* The slice of an ellipse alone, of the file.  Clip planes leave out what is
 * drawn, not what is measured. */
static int measure_in_file(const options *opts, snow_context *context,
                           const char *path, snow_measure *one) {
    static options alone; /* large */
    snow_volume *slice = NULL;
    if (strcmp(path, "-") == 0)
        return fail_usage("--measure: the slice of an ellipse cannot be read "
                          "of standard input again; save that to a file, and "
                          "name it");
    alone = *opts;
    alone.mixes = true; /* nothing is said of the others */
    if (opts->channels.count)
        alone.channel = opts->channels.picks[0].index;
    memset(alone.clip, 0, sizeof alone.clip);
    int64_t *crop = alone.crop[one->axis];
    crop[0] += one->index;
    crop[1] = crop[0] + 1;
    int done = open_input(context, &alone, path, &slice);
    if (done == CONTINUE)
        done = check_status(context, snow_measure_values(slice, one));
    snow_volume_close(slice);
    return done;
}

/* Whether a volume has all of the slice of an ellipse, if it has that. */
static bool has_slices(const measures *m, const snow_volume *volume, int axis) {
    const int64_t *dims = volume ? snow_volume_get_info(volume)->dims : NULL;
    for (int i = 0; i < 3 && dims; i++)
        if (i != axis && dims[i] != m->whole.dims[i])
            return false;
    return dims && snow_volume_voxels(volume);
}

static int measure_ellipse(const options *opts, snow_context *context,
                           const char *path, const snow_volume *volume,
                           measures *m, snow_measure *one) {
    snow_status status = SNOW_STATUS_OK;
    one->count = -1;
    if (one->index < 0 || one->index >= m->whole.dims[one->axis])
        one->count = 0;
    else if (has_slices(m, volume, one->axis) && !has_clip(opts))
        status = snow_measure_values(volume, one);
    if (status != SNOW_STATUS_OK)
        return fail_status(context, status);
    return one->count < 0 ? measure_in_file(opts, context, path, one)
                          : CONTINUE;
}

static void find_unit(measures *m) {
    const snow_volume_info *info = &m->whole;
    snprintf(m->unit, sizeof m->unit, "%s",
             info->hounsfield ? "HU" : info->value_unit);
}

int measures_find(const options *opts, snow_context *context, const char *path,
                  const snow_volume_info *whole, const snow_volume *volume,
                  bool everywhere, measures **out) {
    measures *m = NULL;
    free(*out);
    *out = NULL;
    if (!opts->measure)
        return CONTINUE;
    m = calloc(1, sizeof *m);
    if (!m)
        return fail_memory("out of memory for measures; close other programs");
    m->whole = *whole;
    find_unit(m);
    int done = read_all(opts->measure, context,
                        everywhere || options_given(opts, "crop"), m);
    for (int n = 0; n < m->count && done == CONTINUE; n++)
        if (m->each[n].kind == SNOW_MEASURE_ELLIPSE)
            done = measure_ellipse(opts, context, path, volume, m, &m->each[n]);
    if (done == CONTINUE)
        *out = m;
    else
        free(m);
    return done;
}

/* --- in a picture --------------------------------------------------------- */

/* Which slice across an axis a point is in, of a grid whose slices are planes.
 */
static double slice_of(const snow_volume_info *info, int axis,
                       const double point[3]) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double normal[3], far = 0, thick = 0;
    for (int i = 0; i < 3; i++) {
        const double(*m)[4] = info->matrix;
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double scale = info->axis_scale[i];
        normal[i] = m[j][u] * m[k][v] - m[k][u] * m[j][v];
        far += normal[i] * (point[i] * (fabs(scale) > 0 ? scale : 1) - m[i][3]);
        thick += normal[i] * m[i][axis];
    }
    return far / thick;
}

static bool lies_in(const measures *m, const snow_measure *one, int axis,
                    int64_t index) {
    const int count = one->kind == SNOW_MEASURE_LINE ? 2 : 3;
    if (one->kind == SNOW_MEASURE_ELLIPSE)
        return one->axis == axis && one->index == index;
    for (int n = 0; n < count; n++)
        if (!(fabs(slice_of(&m->whole, axis, one->points[n]) - (double)index) <=
              THICKNESS))
            return false;
    return true;
}

snow_status measures_draw(const measures *m, const snow_volume_info *info,
                          const snow_view *view, double x, double y, int axis,
                          int64_t index, snow_overlay *overlay) {
    snow_status status = SNOW_STATUS_OK;
    for (int n = 0; m && n < m->count && status == SNOW_STATUS_OK; n++)
        if (index < 0 || lies_in(m, &m->each[n], axis, index))
            status = snow_overlay_measure(overlay, info, view, x, y, m->unit,
                                          &m->each[n]);
    return status;
}

/* --- in words ------------------------------------------------------------- */

static json_t *points_json(const snow_measure *one) {
    json_t *points = json_array();
    for (int n = 0; n < (one->kind == SNOW_MEASURE_LINE ? 2 : 3); n++)
        json_array_append_new(points, json_vector(one->points[n], 3));
    return points;
}

static void add_ellipse(const measures *m, const snow_measure *one,
                        json_t *tree) {
    const struct {
        const char *key;
        double value;
    } rows[] = {{"area", one->result},
                {"mean", one->mean},
                {"deviation", one->deviation},
                {"min", one->min},
                {"max", one->max}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        json_object_set_new(tree, rows[i].key, json_number(rows[i].value));
    json_object_set_new(tree, "count", json_integer((json_int_t)one->count));
    json_object_set_new(tree, "value_unit", json_string(m->unit));
    json_object_set_new(tree, "axis",
                        json_string((char[]){"xyz"[one->axis], '\0'}));
    json_object_set_new(tree, "index", json_integer((json_int_t)one->index));
}

json_t *measures_json(const measures *m) {
    json_t *list = json_array();
    for (int n = 0; m && n < m->count; n++) {
        const snow_measure *one = &m->each[n];
        json_t *tree = json_pack("{s:s, s:o}", "kind", kinds[one->kind],
                                 "points", points_json(one));
        if (one->kind == SNOW_MEASURE_LINE)
            json_object_set_new(tree, "length", json_number(one->result));
        else if (one->kind == SNOW_MEASURE_ANGLE)
            json_object_set_new(tree, "degrees", json_number(one->result));
        else
            add_ellipse(m, one, tree);
        if (one->kind != SNOW_MEASURE_ANGLE)
            json_object_set_new(tree, "unit", json_string(one->unit));
        json_array_append_new(list, tree);
    }
    return list;
}

static void report_ellipse(const measures *m, int n) {
    const snow_measure *one = &m->each[n];
    const char *space = *m->unit ? " " : "";
    char values[160] = "";
    if (one->count > 0)
        snprintf(values, sizeof values,
                 "mean %.6g%s%s, deviation %.6g, %.6g to %.6g, ", one->mean,
                 space, m->unit, one->deviation, one->min, one->max);
    say("measure %d: ellipse on slice %lld across %c: %s%lld voxels, area "
        "%.6g%s%s%s",
        n + 1, (long long)one->index, "xyz"[one->axis], values,
        (long long)one -> count, one -> result, *one -> unit ? " " : "",
        one->unit, *one->unit ? "2" : "");
}

void measures_report(const measures *m) {
    for (int n = 0; m && n < m->count; n++) {
        const snow_measure *one = &m->each[n];
        if (one->kind == SNOW_MEASURE_ELLIPSE)
            report_ellipse(m, n);
        else
            say("measure %d: %s, %.6g%s%s", n + 1, kinds[one->kind],
                one->result, *one->unit ? " " : "",
                one->kind == SNOW_MEASURE_ANGLE ? "degrees" : one->unit);
    }
}
