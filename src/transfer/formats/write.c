/* transfer/formats/write.c - writes points as JSON and as CSV.  Numbers have 17
 * digits, which restore the same double. */
#include "transfer/formats/tf.h"

#include <snowglass/extend.h>

#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static json_t *numbers(const double *from, size_t count) {
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(array, json_real(from[i]));
    return array;
}

static json_t *color_list(const snow_look *points) {
    json_t *list = json_array();
    for (size_t i = 0; i < points->color_count; i++) {
        const snow_color_point *p = points->colors + i;
        const double four[4] = {p->value, p->red, p->green, p->blue};
        json_array_append_new(list, numbers(four, 4));
    }
    return list;
}

static json_t *pair_list(const snow_opacity_point *points, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++) {
        const double pair[2] = {points[i].value, points[i].opacity};
        json_array_append_new(list, numbers(pair, 2));
    }
    return list;
}

static json_t *tree_of(const snow_look *points) {
    static const char *const values[] = {"data", "range", "object",
                                         "symmetric"};
    json_t *tree = json_object();
    json_object_set_new(tree, "snowglass-tf", json_integer(1));
    json_object_set_new(tree, "name",
                        json_string(points->name ? points->name : ""));
    json_object_set_new(tree, "values", json_string(values[points->domain]));
    json_object_set_new(tree, "interpolation",
                        json_string(points->log ? "log" : "linear"));
    json_object_set_new(tree, "color-space", json_string("rgb"));
    json_object_set_new(tree, "opacity-unit",
                        json_string(points->per_mm ? "mm" : "voxel"));
    if (points->color_count)
        json_object_set_new(tree, "colors", color_list(points));
    if (points->opacity_count)
        json_object_set_new(
            tree, "opacities",
            pair_list(points->opacities, points->opacity_count));
    if (points->gradient_opacity_count)
        json_object_set_new(tree, "gradient-opacities",
                            pair_list(points->gradient_opacities,
                                      points->gradient_opacity_count));
    return tree;
}

snow_status snow_look_write_json(snow_context *context, const snow_look *given,
                                 char *text, size_t capacity, size_t *length) {
    snow_look look;
    TF_TRY(SNOW_RECORD_READ(context, snow_look, given, &look));
    json_t *tree = tree_of(&look);
    size_t flags = JSON_INDENT(1) | JSON_REAL_PRECISION(17);
    size_t bytes = tree ? json_dumpb(tree, text, capacity, flags) : 0;
    json_decref(tree);
    if (!bytes)
        return snow_context_fail(context, SNOW_STATUS_NO_MEMORY,
                                 "out of memory for the text of a transfer "
                                 "function; close other programs");
    if (capacity)
        text[bytes < capacity ? bytes : 0] = 0;
    *length = bytes;
    return SNOW_STATUS_OK;
}

/* --- CSV ------------------------------------------------------------------ */

typedef struct sheet {
    char *text;
    size_t room, used; /* used keeps counting if the text does not fit */
} sheet;

SNOW_PRINTF(2, 3)
static void put_text(sheet *out, const char *format, ...) {
    char line[256];
    va_list arguments;
    va_start(arguments, format);
    int count = snow_text_vprint(line, sizeof line, format, arguments);
    va_end(arguments);
    if (count < 0)
        return;
    if (out->used + (size_t)count < out->room)
        memcpy(out->text + out->used, line, (size_t)count);
    out->used += (size_t)count;
}

static double mix(double a, double b, double from, double to, double at) {
    return from < to ? a + (b - a) * ((at - from) / (to - from)) : b;
}

/* The colour at a value; `next` is the index of the first point beyond it. */
static snow_color_point color_at(const snow_look *points, size_t next,
                                 double at) {
    const snow_color_point *p = points->colors;
    size_t count = points->color_count;
    snow_color_point out = p[next ? next - 1 : 0];
    if (next && next < count) {
        const snow_color_point *a = p + next - 1, *b = p + next;
        out.red = mix(a->red, b->red, a->value, b->value, at);
        out.green = mix(a->green, b->green, a->value, b->value, at);
        out.blue = mix(a->blue, b->blue, a->value, b->value, at);
    }
    out.value = at;
    return out;
}

static double opacity_at(const snow_look *points, size_t next, double at) {
    const snow_opacity_point *p = points->opacities;
    if (!next || next == points->opacity_count)
        return p[next ? next - 1 : 0].opacity;
    return mix(p[next - 1].opacity, p[next].opacity, p[next - 1].value,
               p[next].value, at);
}

/* Walks along both kinds of points: one row per point; a value that repeats
 * gets as many rows as the kind that has more of it. */
static void put_rows(sheet *out, const snow_look *points) {
    size_t color = 0, opacity = 0;
    while (color < points->color_count || opacity < points->opacity_count) {
        bool more_colors = color < points->color_count;
        bool more = opacity < points->opacity_count;
        double c = more_colors ? points->colors[color].value : 0;
        double o = more ? points->opacities[opacity].value : 0;
        double at = more_colors && (!more || c <= o) ? c : o;
        color += more_colors && c == at;
        opacity += more && o == at;
        const snow_color_point rgb = color_at(points, color, at);
        put_text(out, "%.17g,%.17g,%.17g,%.17g,%.17g\n", at, rgb.red, rgb.green,
                 rgb.blue, opacity_at(points, opacity, at));
    }
}

snow_status snow_look_write_csv(snow_context *context, const snow_look *given,
                                char *text, size_t capacity, size_t *length) {
    snow_look look;
    TF_TRY(SNOW_RECORD_READ(context, snow_look, given, &look));
    sheet out = {text, capacity, 0};
    if (!look.color_count || !look.opacity_count)
        return snow_context_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "a table needs colours and opacities, but this has %s; write .json",
            look.color_count ? "no opacities" : "no colours");
    put_text(&out, "value,red,green,blue,opacity\n");
    put_rows(&out, &look);
    if (capacity)
        text[out.used < capacity ? out.used : 0] = 0;
    *length = out.used;
    return SNOW_STATUS_OK;
}
