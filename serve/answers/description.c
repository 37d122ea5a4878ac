/* description.c - the volume, its look and the last picture's figures, as JSON
 * for all pages; see answers.h. */
#include "answers/answers.h"
#include "message.h"

#include "commands/commands.h"
#include "commands/world.h"
#include "draw/mixed.h"
#include "draw/slices.h"
#include "draw/values.h"
#include "run/log.h"
#include "run/start.h"

#include <snowglass/recipe.h>

#include <math.h>
#include <string.h>

#define STRIP_COLORS 64
#define POINTS_MOST 256 /* of a recipe */
#define LISTED_MOST 64  /* channels; more than can be mixed */

/* --- the volume --------------------------------------------------------------
 */

static json_t *presets(void) {
    json_t *list = json_array();
    for (size_t i = 0; snow_preset_name(i); i++)
        json_array_append_new(list, json_pack("[s,s]", snow_preset_name(i),
                                              snow_preset_description(i)));
    return list;
}

/* {"left": [[back], [up]], ...}: where the camera of each view is. */
static json_t *views(drawing *d) {
    const snow_volume_info *info = &d->state.whole;
    json_t *all = json_object();
    for (size_t i = 0; snow_view_name(i); i++) {
        const char *name = snow_view_name(i);
        snow_view view = {.size = sizeof view};
        if (snow_view_from_name(d->state.context,
                                snow_view_name_for(info, name),
                                &view) == SNOW_STATUS_OK)
            json_object_set_new(all, name,
                                json_pack("[o,o]", json_vector(view.back, 3),
                                          json_vector(view.up, 3)));
    }
    return all;
}

/* The name without its folder: what else a path says is nobody's business. */
static const char *base_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* A name that is not UTF-8 is none. */
static json_t *channel_name(const snow_volume_info *info, int64_t index) {
    json_t *name = index < SNOW_CHANNELS_MAX
                       ? json_string(info->channel[index].name)
                       : NULL;
    return name ? name : json_string("");
}

/* As the file has it: a mask and clip planes make voxels NaN, so of floats. */
static const char *stored_type(const drawing *d) {
    snow_volume_info info;
    snow_volume_info_init(&info);
    info.type = d->state.whole.type;
    if (!d->live && (d->opts.mask || drawing_is_clipped(d))) {
        snow_volume_options data = data_options(&d->opts);
        memset(data.clip, 0, sizeof data.clip);
        data.mask = NULL;
        /* What is said of the file was said when it was opened. */
        show_warnings(&d->opts, d->state.context, false);
        (void)snow_volume_inspect(d->state.context, d->opts.operands[0], &data,
                                  &info);
        show_warnings(&d->opts, d->state.context, true);
    }
    return snow_type_name(info.type);
}

void answer_info(drawing *d, outbox *box) {
    const snow_volume_info *info = &d->state.whole;
    double middle[3], radius, ends[2], window[2];
    drawing_middle(d, middle, &radius);
    values_ends(d, ends);
    values_window(d, window);
    json_t *tree = json_pack(
        "{s:s, s:s, s:o, s:o, s:s, s:s, s:b, s:I, s:o, s:o, s:o, s:f}", "t",
        "info", "name", base_of(d->first.operands[0]), "dims",
        json_sizes(info->dims, 3), "spacing",
        json_vector(world_in_units(info).spacing, 3), "unit", info->unit,
        "type", stored_type(d), "medical", (int)info->medical, "times",
        (json_int_t)info->times, "min", json_number(ends[0]), "max",
        json_number(ends[1]), "middle", json_vector(middle, 3), "radius",
        radius);
    json_t *matrix = json_array(), *axes = json_array();
    for (int i = 0; i < 3; i++) {
        json_array_append_new(matrix, json_vector(info->matrix[i], 4));
        json_array_append_new(axes, json_pack("[s, f]", world_unit(info, i),
                                              world_length(info, i)));
    }
    json_object_set_new(tree, "axes", axes);
    json_object_set_new(tree, "matrix", matrix);
    json_object_set_new(tree, "view",
                        json_string(snow_view_name_for(info, NULL)));
    json_object_set_new(tree, "views", views(d));
    json_object_set_new(tree, "presets", presets());
    json_object_set_new(tree, "colormaps", json_names(snow_colormap_name));
    json_t *list = json_array();
    for (int n = 0; n < info->channels && n < LISTED_MOST; n++)
        json_array_append_new(list, channel_name(info, n));
    json_object_set_new(tree, "channels", list);
    json_object_set_new(tree, "tf", json_boolean(d->first.tf != NULL));
    json_object_set_new(tree, "keys", json_names(message_key));
    json_object_set_new(tree, "mask", json_boolean(d->first.mask != NULL));
    json_object_set_new(tree, "overlay",
                        d->first.overlay
                            ? json_string(base_of(d->first.overlay))
                            : json_null());
    json_object_set_new(tree, "labels",
                        d->first.labels ? json_string(d->first.labels)
                                        : json_null());
    json_object_set_new(tree, "fov", json_real(SNOW_FOV_DEFAULT));
    json_object_set_new(tree, "slices", d->live ? json_null() : slices_info(d));
    json_object_set_new(tree, "movies",
                        d->offer ? json_incref(d->offer) : json_null());
    json_object_set_new(tree, "live", json_boolean(d->live));
    json_object_set_new(tree, "instance", json_string(identity_of_program()));
    json_object_set_new(tree, "file", json_string(d->identity));
    json_object_set_new(tree, "opened", json_integer(d->opened));
    json_object_set_new(tree, "series",
                        json_string(d->first.series ? d->first.series : ""));
    json_object_set_new(tree, "value_unit", json_string(info->value_unit));
    json_object_set_new(tree, "modality", json_string(info->modality));
    json_object_set_new(tree, "window",
                        json_pack("[f,f]", window[0], window[1]));
    json_object_set_new(
        tree, "hounsfield",
        json_boolean(info->hounsfield ||
                     (info->medical && ends[0] < ends[1] &&
                      snow_are_hounsfield(info, ends[0], ends[1]))));
    answer_put(box, 0, MESSAGE_INFO, tree);
}

/* --- the look
 * ----------------------------------------------------------------- */

static json_t *points_of(const snow_opacity_point *points, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count && i < POINTS_MOST; i++)
        json_array_append_new(
            list, json_pack("[f,f]", points[i].value, points[i].opacity));
    return list;
}

/* Colours as "#rrggbb". */
static void write_color(const double rgba[4], char text[8]) {
    snprintf(text, 8, "#%02x%02x%02x",
             (unsigned)lround(255 * fmin(fmax(rgba[0], 0), 1)),
             (unsigned)lround(255 * fmin(fmax(rgba[1], 0), 1)),
             (unsigned)lround(255 * fmin(fmax(rgba[2], 0), 1)));
}

/* Colours at even steps of the range, "#rrggbb". */
static json_t *strip_of(const snow_transfer *transfer, double low,
                        double high) {
    json_t *list = json_array();
    for (int i = 0; i < STRIP_COLORS; i++) {
        double rgba[4], at = low + (high - low) * i / (STRIP_COLORS - 1);
        char text[8];
        snow_transfer_evaluate(transfer, at, rgba);
        write_color(rgba, text);
        json_array_append_new(list, json_string(text));
    }
    return list;
}

/* [[3, "liver", "#b25a00", 1], ...] with their opacity, but not the background.
 * A name that is not UTF-8 is none.  None of more than a recipe has opacities
 * for: those of the rest would be lost. */
static json_t *labels_of(const snow_transfer *transfer) {
    json_t *list = json_array();
    const snow_label *label;
    if (snow_transfer_label(transfer, SNOW_RECIPE_POINTS_MAX))
        return list;
    for (size_t i = 0; (label = snow_transfer_label(transfer, i)); i++) {
        double rgba[4];
        char color[8];
        json_t *name = json_string(label->name);
        if (!name)
            name = json_string("");
        snow_transfer_evaluate(transfer, label->value, rgba);
        write_color(rgba, color);
        if (label->value < 0 || label->value > 0 || *label->name)
            json_array_append_new(list, json_pack("[f,O,s,f]", label->value,
                                                  name, color, rgba[3]));
        json_decref(name);
    }
    return list;
}

/* Of the overlay that is drawn; else null. */
static json_t *overlay_look(const drawing *d) {
    const snow_transfer *transfer = d->state.layers.transfer;
    double low, high;
    if (!d->opts.overlay || !transfer)
        return json_null();
    snow_transfer_domain(transfer, &low, &high);
    return json_pack("{s:f, s:f, s:o}", "low", low, "high", high, "labels",
                     labels_of(transfer));
}

/* [[0, "DAPI", "blue", "#0000ff", 10, 200, 1], ...]: those that are drawn, with
 * colour, range and opacity where they are mixed. */
static json_t *channels_of(const drawing *d) {
    const channel_set *c = &d->state.channels;
    json_t *list = json_array();
    for (int n = 0; n < mixed_count(d); n++) {
        const channel_pick *pick = &c->list.picks[n];
        const snow_transfer *look = n ? c->looks[n] : d->state.transfer;
        const int64_t index = n ? pick->index : mixed_first(d);
        double low, high, rgba[4];
        char color[8];
        snow_transfer_domain(look, &low, &high);
        snow_transfer_evaluate(look, high, rgba);
        write_color(rgba, color);
        json_array_append_new(
            list, json_pack("[I,o,s,s,f,f,f]", (json_int_t)index,
                            channel_name(&d->state.whole, index),
                            c->list.count ? pick->color : "", color, low, high,
                            c->list.count ? pick->opacity : 1));
    }
    return list;
}

json_t *answer_colormap(const snow_look *look) {
    snow_color_point points[SNOW_COLORMAP_POINTS_MAX];
    size_t same = 0, count, maps = 0;
    while (snow_colormap_name(maps))
        maps++; /* and as many that are reversed */
    for (size_t i = 0;
         (count = snow_colormap_points(i, points, SNOW_COLORMAP_POINTS_MAX));
         i++) {
        for (same = 0; count == look->color_count && same < count &&
                       memcmp(&points[same].red, &look->colors[same].red,
                              3 * sizeof(double)) == 0;
             same++)
            continue;
        if (count != look->color_count || same != count)
            continue;
        return i < maps ? json_string(snow_colormap_name(i))
                        : json_sprintf("%s_r", snow_colormap_name(i - maps));
    }
    return NULL;
}

json_t *answer_look_keys(const drawing *d) {
    const snow_transfer *transfer = d->state.transfer;
    snow_look look = {.size = sizeof look};
    double low, high;
    if (!transfer || d->state.channels.list.count ||
        mode_is_projection(d->opts.mode) || snow_transfer_label(transfer, 0) ||
        snow_transfer_get_look(transfer, &look) != SNOW_STATUS_OK ||
        look.opacity_count > POINTS_MOST)
        return NULL;
    snow_transfer_domain(transfer, &low, &high);
    json_t *keys = json_pack(
        "{s:[f,f], s:o, s:s}", "range", low, high, "opacity",
        points_of(look.opacities, look.opacity_count), "shade",
        d->state.settings.shade == SNOW_SHADE_PHONG ? "phong" : "none");
    json_t *map = look.name ? NULL : answer_colormap(&look);
    if (look.name)
        json_object_set_new(keys, "preset", json_string(look.name));
    else if (map)
        json_object_set_new(keys, "colormap", map);
    return keys;
}

void answer_kept(drawing *d, viewer_state *s, uint32_t revision) {
    state_note_look(s, revision, answer_look_keys(d));
}

void answer_look(drawing *d, outbox *box) {
    const snow_transfer *transfer = d->state.transfer;
    snow_look look = {.size = sizeof look};
    double low, high;
    if (snow_transfer_get_look(transfer, &look) != SNOW_STATUS_OK)
        return;
    snow_transfer_domain(transfer, &low, &high);
    answer_put(
        box, 0, MESSAGE_LOOK,
        json_pack(
            "{s:s, s:s*, s:o*, s:f, s:f, s:f, s:I, s:o, s:o, s:o, s:s, s:b, "
            "s:o, "
            "s:o, s:o}",
            "t", "look", "preset", look.name, "map", answer_colormap(&look),
            "legend", d->state.strip, "low", low, "high", high, "count",
            (json_int_t)look.opacity_count, "opacity",
            points_of(look.opacities, look.opacity_count), "gradient",
            points_of(look.gradient_opacities, look.gradient_opacity_count),
            "strip", strip_of(transfer, low, high), "text",
            snow_transfer_description(transfer), "shaded",
            d->state.settings.shade == SNOW_SHADE_PHONG, "labels",
            labels_of(transfer), "overlay", overlay_look(d), "channels",
            channels_of(d)));
}

void answer_figures(drawing *d, double hidden, outbox *box) {
    const snow_stats *stats = &d->state.stats;
    answer_put(box, 0, MESSAGE_FIGURES,
               json_pack("{s:s, s:o, s:I, s:s}", "t", "figures", "sparse",
                         isnan(hidden) ? json_null() : json_real(hidden),
                         "interesting", (json_int_t)stats->interesting,
                         "method", snow_method_name(stats->method)));
}

void answer_step(outbox *box, int64_t step) {
    answer_put(box, 0, MESSAGE_FIGURES,
               json_pack("{s:s, s:I}", "t", "step", "step", (json_int_t)step));
}

void answer_replaced(const drawing *d, char told[IDENTITY_BYTES], outbox *box) {
    char now[IDENTITY_BYTES];
    identity_of(d->opts.operands[0], now);
    if (strcmp(now, d->identity) == 0 || strcmp(now, told) == 0)
        return;
    memcpy(told, now, sizeof now);
    answer_put(box, 0, MESSAGE_PLAIN,
               json_pack("{s:s, s:b, s:b}", "t", "replaced", "gone", !*now,
                         "again", *now && process_ranks() == 1));
}
