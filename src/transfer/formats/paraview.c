/* transfer/formats/paraview.c - ParaView's JSON: "RGBPoints" [x, r, g, b, ...]
 * interpolated in "ColorSpace", and "Points" [x, opacity, midpoint, sharpness,
 * ...].  The older "NanColor" and annotations are ignored: NaN is
 * transparent. */
#include "transfer/formats/json.h"

#include <math.h>
#include <string.h>

/* Names of ParaView's colour spaces; CIEDE2000 differs little from L*a*b* and
 * is replaced by it. */
static const struct {
    const char *name;
    tf_space space;
} spaces[] = {{"RGB", TF_RGB},           {"HSV", TF_HSV},
              {"Lab", TF_LAB},           {"CIELAB", TF_LAB},
              {"Lab/CIEDE2000", TF_LAB}, {"Diverging", TF_DIVERGING},
              {"Step", TF_STEP}};

static snow_status find_space(const tf_input *in, const json_t *map,
                              tf_space *out) {
    const json_t *given = json_object_get(map, "ColorSpace");
    const char *name = json_string_value(given);
    if (!given) {
        *out = TF_RGB;
        return SNOW_STATUS_OK;
    }
    for (size_t i = 0; name && i < sizeof spaces / sizeof *spaces; i++)
        if (strcmp(name, spaces[i].name) == 0) {
            bool wrap = json_is_true(json_object_get(map, "HSVWrap")) ||
                        json_integer_value(json_object_get(map, "HSVWrap"));
            *out = spaces[i].space == TF_HSV && wrap ? TF_HSV_WRAP
                                                     : spaces[i].space;
            if (strcmp(name, "Lab/CIEDE2000") == 0)
                snow_context_warn(
                    in->context,
                    "%s: colours are interpolated in Lab instead of %s",
                    in->name, name);
            return SNOW_STATUS_OK;
        }
    return tf_fail(in,
                   "has the unknown ColorSpace '%.40s'; supported are RGB, "
                   "HSV, Lab, Diverging and Step",
                   name ? name : "(no text)");
}

/* Reads four numbers from index `n` of a list on. */
static bool take_four(const json_t *list, size_t n, double four[4]) {
    for (size_t i = 0; i < 4; i++)
        if (!tf_json_number(list, n + i, &four[i]))
            return false;
    return true;
}

static snow_status take_colors(const tf_input *in, snow_look_file *tf,
                               const json_t *list, tf_space space) {
    size_t size = json_array_size(list);
    double last[4], point[4];
    for (size_t n = 0; n < size; n += 4) {
        if (!take_four(list, n, point))
            return tf_fail(in, "\"RGBPoints\" is not a list of four numbers "
                               "per point: x, red, green, blue; correct it");
        TF_TRY(tf_join_color(in, tf, space, n ? last[0] : 0,
                             n ? last + 1 : NULL, point[0], point + 1));
        memcpy(last, point, sizeof last);
    }
    return SNOW_STATUS_OK;
}

static snow_status take_opacities(const tf_input *in, snow_look_file *tf,
                                  const json_t *list) {
    size_t size = json_array_size(list);
    double last[4], point[4];
    for (size_t n = 0; n < size; n += 4) {
        if (!take_four(list, n, point) || !(point[2] >= 0 && point[2] <= 1) ||
            !(point[3] >= 0 && point[3] <= 1))
            return tf_fail(in, "\"Points\" is not a list of four numbers per "
                               "point: x, opacity, midpoint, sharpness, the "
                               "last two from 0 to 1; correct it");
        if (n)
            TF_TRY(tf_join_opacity(in, tf, last, point));
        TF_TRY(tf_add_opacity(in, tf, &tf->opacities, "opacity", point[0],
                              point[1]));
        memcpy(last, point, sizeof last);
    }
    return SNOW_STATUS_OK;
}

snow_status tf_take_paraview(const tf_input *in, snow_look_file *tf,
                             const json_t *map) {
    const char *name = json_string_value(json_object_get(map, "Name"));
    tf_space space = TF_RGB;
    TF_TRY(find_space(in, map, &space));
    TF_TRY(take_colors(in, tf, json_object_get(map, "RGBPoints"), space));
    TF_TRY(take_opacities(in, tf, json_object_get(map, "Points")));
    if (json_array_size(json_object_get(map, "IndexedColors")))
        snow_context_warn(
            in->context, "%s: its colours of categories are ignored", in->name);
    const json_t *log = json_object_get(map, "UseLogScale");
    tf->look.log = json_is_true(log) || json_integer_value(log) == 1;
    tf->format = "paraview";
    if (name)
        tf_set_name(tf, name);
    return SNOW_STATUS_OK;
}
