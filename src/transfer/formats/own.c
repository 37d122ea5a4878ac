/* transfer/formats/own.c - reads Snowglass's own JSON:
 *
 *   {"snowglass-tf": 1, "name": "bone", "values": "data",
 *    "interpolation": "linear", "color-space": "rgb", "opacity-unit": "voxel",
 *    "colors": [[150, 0.6, 0.38, 0.28], ...], "opacities": [[150, 0], ...],
 *    "gradient-opacities": [[0, 0.2], [60, 1]]}
 *
 * "values" are data values, or shares of the "range", of the "object", or of
 * one that is "symmetric" around 0; the interpolation may be "log", the colour
 * space "hsv", "lab", "diverging" or "step", the opacity unit "mm".  Only
 * "snowglass-tf" and one kind of points are required. */
#include "transfer/formats/json.h"

#include <string.h>

/* The index of a text among some words; 0 if the key is missing, -1 if the text
 * is not among them. */
static int word_of(const json_t *map, const char *key, const char *const *words,
                   int count) {
    const json_t *given = json_object_get(map, key);
    const char *text = json_string_value(given);
    if (!given)
        return 0;
    for (int i = 0; i < count && text; i++)
        if (strcmp(text, words[i]) == 0)
            return i;
    return -1;
}

/* Reads the numbers of one point; returns false if their number is wrong. */
static bool take_point(const json_t *point, size_t count, double *numbers) {
    if (json_array_size(point) != count)
        return false;
    for (size_t i = 0; i < count; i++)
        if (!tf_json_number(point, i, &numbers[i]))
            return false;
    return true;
}

static snow_status take_colors(const tf_input *in, snow_look_file *tf,
                               const json_t *list, tf_space space) {
    double last[4], point[4];
    for (size_t n = 0; n < json_array_size(list); n++) {
        if (!take_point(json_array_get(list, n), 4, point))
            return tf_fail(
                in, "colour %zu is not [value, red, green, blue]; correct it",
                n + 1);
        TF_TRY(tf_join_color(in, tf, space, n ? last[0] : 0,
                             n ? last + 1 : NULL, point[0], point + 1));
        memcpy(last, point, sizeof last);
    }
    return SNOW_STATUS_OK;
}

static snow_status take_pairs(const tf_input *in, snow_look_file *tf,
                              tf_list *to, const char *what,
                              const json_t *list) {
    double pair[2];
    for (size_t n = 0; n < json_array_size(list); n++) {
        if (!take_point(json_array_get(list, n), 2, pair))
            return tf_fail(in, "%s %zu is not [value, opacity]; correct it",
                           what, n + 1);
        TF_TRY(tf_add_opacity(in, tf, to, what, pair[0], pair[1]));
    }
    return SNOW_STATUS_OK;
}

static snow_status take_words(const tf_input *in, snow_look_file *tf,
                              const json_t *map, tf_space *space) {
    static const char *const values[] = {"data", "range", "object",
                                         "symmetric"};
    static const char *const scales[] = {"linear", "log"};
    static const char *const units[] = {"voxel", "mm"};
    static const char *const spaces[TF_SPACES] = {
        "rgb", "hsv", "hsv-wrap", "lab", "diverging", "step"};
    int value = word_of(map, "values", values, 4);
    int scale = word_of(map, "interpolation", scales, 2);
    int unit = word_of(map, "opacity-unit", units, 2);
    int found = word_of(map, "color-space", spaces, TF_SPACES);
    if (value < 0 || scale < 0 || unit < 0 || found < 0)
        return tf_fail(in,
                       "\"%s\" has an unknown word; `snowglass tf convert` "
                       "writes files with valid ones",
                       value < 0   ? "values"
                       : scale < 0 ? "interpolation"
                       : unit < 0  ? "opacity-unit"
                                   : "color-space");
    tf->look.domain = (snow_domain)value;
    tf->look.log = scale == 1;
    tf->look.per_mm = unit == 1;
    *space = (tf_space)found;
    return SNOW_STATUS_OK;
}

snow_status tf_take_own(const tf_input *in, snow_look_file *tf,
                        const json_t *map) {
    const json_t *version = json_object_get(map, "snowglass-tf");
    const char *name = json_string_value(json_object_get(map, "name"));
    tf_space space = TF_RGB;
    if (!json_is_integer(version) || json_integer_value(version) != 1)
        return tf_fail(
            in,
            "\"snowglass-tf\" is not 1; a newer Snowglass may read this file");
    TF_TRY(take_words(in, tf, map, &space));
    TF_TRY(take_colors(in, tf, json_object_get(map, "colors"), space));
    TF_TRY(take_pairs(in, tf, &tf->opacities, "opacity",
                      json_object_get(map, "opacities")));
    TF_TRY(take_pairs(in, tf, &tf->gradients, "gradient opacity",
                      json_object_get(map, "gradient-opacities")));
    tf->format = "snowglass";
    if (name)
        tf_set_name(tf, name);
    return SNOW_STATUS_OK;
}
