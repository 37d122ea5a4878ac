/* config_note.c - notes what was chosen automatically for a picture, until its
 * recipe is written. */
#include "options/config.h"
#include "run/log.h"

#include <inttypes.h>
#include <snowglass/recipe.h>
#include <stdio.h>
#include <string.h>

/* What a look of the histogram and the default view came to. */
static struct chosen {
    json_t *preset, *colormap, *range, *opacity, *scale, *shade, *view, *axis,
        *at, *channel;
} chosen;

/* Whether the transfer function has the colours of a map over its range. */
static bool has_colors_of(const snow_look *look, size_t map) {
    snow_color_point points[SNOW_COLORMAP_POINTS_MAX];
    size_t count = snow_colormap_points(map, points, SNOW_COLORMAP_POINTS_MAX);
    if (count != look->color_count)
        return false;
    for (size_t i = 0; i < count; i++)
        points[i].value = look->colors[i].value;
    return memcmp(points, look->colors, sizeof *points * count) == 0;
}

static const char *map_of(const options *opts, const snow_look *look) {
    if (opts->colormap)
        return opts->colormap;
    for (size_t i = 0; snow_colormap_name(i); i++)
        if (has_colors_of(look, i))
            return snow_colormap_name(i);
    return NULL;
}

static void note_range(const options *opts, const snow_transfer *transfer) {
    double ends[2];
    if (options_range(opts).kind != SNOW_RANGE_AUTO ||
        options_place_colors(opts))
        return;
    snow_transfer_domain(transfer, &ends[0], &ends[1]);
    chosen.range = json_vector(ends, 2);
}

/* From where it was chosen. */
static void note_scale(const snow_look *look) {
    char number[40];
    config_real(look->symlog, number);
    if (look->symlog > 0)
        chosen.scale = json_sprintf("symlog:%s", number);
}

/* Means and sums are painted over the values of the picture, and their range in
 * files of floats means nothing.  No option gives an empty range, or one from 0
 * on a logarithmic scale, or the points of a symmetric one: these are left to
 * be chosen again. */
static void note_projection(const options *opts, const snow_transfer *transfer,
                            const double painted[2]) {
    bool of_picture =
        strcmp(opts->mode, "mean") == 0 || strcmp(opts->mode, "sum") == 0;
    snow_look look = {.size = sizeof look};
    if (snow_transfer_get_look(transfer, &look) != SNOW_STATUS_OK)
        return;
    if (!of_picture) {
        note_scale(&look);
        note_range(opts, transfer);
    } else if (options_range(opts).kind == SNOW_RANGE_AUTO &&
               !options_place_colors(opts) && painted[0] < painted[1] &&
               !(look.symlog > 0) && !(look.log && painted[0] <= 0))
        chosen.range = json_vector(painted, 2);
}

/* Shapes of opacity and colour that no option can give are left to be chosen
 * again, from the same values in the same way. */
static void note_look(const options *opts, const snow_transfer *transfer) {
    snow_look look = {.size = sizeof look};
    if (snow_transfer_get_look(transfer, &look) != SNOW_STATUS_OK)
        return;
    note_scale(&look);
    if (look.name) {
        chosen.preset = json_string(look.name);
        if (strcmp(look.name, "signed") == 0)
            note_range(opts, transfer);
        return;
    }
    if (!map_of(opts, &look) || look.opacity_count > SNOW_RECIPE_POINTS_MAX)
        return;
    chosen.colormap = json_string(map_of(opts, &look));
    note_range(opts, transfer);
    chosen.opacity = json_array();
    for (size_t i = 0; i < look.opacity_count; i++) {
        const double point[2] = {look.opacities[i].value,
                                 look.opacities[i].opacity};
        json_array_append_new(chosen.opacity, json_vector(point, 2));
    }
}

void config_note(const options *opts, const snow_transfer *transfer,
                 snow_shade shade, const char *view, const double painted[2]) {
    bool asked = opts->preset || opts->tf;
    if (!asked && mode_is_projection(opts->mode))
        note_projection(opts, transfer, painted);
    else if (!asked)
        note_look(opts, transfer);
    if (chosen.opacity && !options_given(opts, "shade"))
        chosen.shade = json_string(shade == SNOW_SHADE_NONE ? "none" : "phong");
    if (!opts->position.given)
        chosen.view = json_string(view);
}

/* A list says all of the look. */
void config_note_channels(const options *opts, const channel_list *list,
                          snow_shade shade, const char *view) {
    char text[1024];
    channels_text(list, text, sizeof text);
    chosen.channel = json_string(text);
    if (view && !options_given(opts, "shade"))
        chosen.shade = json_string(shade == SNOW_SHADE_NONE ? "none" : "phong");
    if (view && !opts->position.given)
        chosen.view = json_string(view);
}

void config_note_slice(const options *opts, const snow_transfer *transfer,
                       const char *axis, int64_t index) {
    char at[24];
    snprintf(at, sizeof at, "%" PRId64, index);
    if (axis)
        chosen.axis = json_string(axis);
    if (opts->at || index >= 0)
        chosen.at = json_string(opts->at ? opts->at : at);
    if (transfer && !opts->preset && !opts->tf) {
        if (snow_transfer_label(transfer, 0))
            chosen.preset = json_string("labels");
        else
            note_range(opts, transfer);
    }
}

void config_set_noted(json_t *tree) {
    const struct {
        const char *key;
        json_t **value;
    } rows[] = {{"preset", &chosen.preset}, {"colormap", &chosen.colormap},
                {"range", &chosen.range},   {"opacity", &chosen.opacity},
                {"scale", &chosen.scale},   {"shade", &chosen.shade},
                {"view", &chosen.view},     {"axis", &chosen.axis},
                {"at", &chosen.at},         {"channel", &chosen.channel}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (*rows[i].value)
            json_object_set_new(tree, rows[i].key, *rows[i].value);
        *rows[i].value = NULL;
    }
}
