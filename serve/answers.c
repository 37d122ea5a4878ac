/* answers.c - implements answers.h. */
#include "answers.h"
#include "message.h"

#include "commands/commands.h"
#include "pack.h"
#include "run/log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HISTOGRAM_BINS 256
#define STRIP_COLORS 64
#define POINTS_MOST 256 /* of a recipe */
#define THUMBNAIL_SIDE 96

/* Sends a tree, which it frees. */
static void put(outbox *box, uint64_t client, parcel_topic about,
                json_t *tree) {
    char *text = json_dumps(tree, JSON_COMPACT | JSON_REAL_PRECISION(17));
    outbox_put_text(box, client, about, text);
    free(text);
    json_decref(tree);
}

void answer_said(outbox *box, uint64_t client, const char *line) {
    put(box, client, PARCEL_PLAIN,
        json_pack("{s:s, s:s}", "t", "said", "text", line));
}

/* --- the volume --------------------------------------------------------------
 */

static json_t *names_of(const char *(*name)(size_t)) {
    json_t *list = json_array();
    for (size_t i = 0; name(i); i++)
        json_array_append_new(list, json_string(name(i)));
    return list;
}

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

void answer_info(drawing *d, outbox *box) {
    const snow_volume_info *info = &d->state.whole;
    snow_volume_statistics of = {.size = sizeof of};
    double middle[3], radius;
    drawing_middle(d, middle, &radius);
    if (snow_volume_get_statistics(d->state.volume, &of) != SNOW_STATUS_OK)
        of.min = of.max = NAN;
    json_t *tree = json_pack(
        "{s:s, s:s, s:o, s:o, s:s, s:s, s:b, s:I, s:o, s:o, s:o, s:f}", "t",
        "info", "name", base_of(d->first.operands[0]), "dims",
        json_sizes(info->dims, 3), "spacing", json_vector(info->spacing, 3),
        "unit", info->unit, "type", snow_type_name(info->type), "medical",
        (int)info->medical, "times", (json_int_t)info->times, "min",
        json_number(of.min), "max", json_number(of.max), "middle",
        json_vector(middle, 3), "radius", radius);
    json_t *matrix = json_array();
    for (int i = 0; i < 3; i++)
        json_array_append_new(matrix, json_vector(info->matrix[i], 4));
    json_object_set_new(tree, "matrix", matrix);
    json_object_set_new(tree, "view",
                        json_string(snow_view_name_for(info, NULL)));
    json_object_set_new(tree, "views", views(d));
    json_object_set_new(tree, "presets", presets());
    json_object_set_new(tree, "colormaps", names_of(snow_colormap_name));
    json_object_set_new(tree, "tf", json_boolean(d->first.tf != NULL));
    json_object_set_new(tree, "fov", json_real(SNOW_FOV_DEFAULT));
    put(box, 0, PARCEL_INFO, tree);
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

/* Colours at even steps of the range, "#rrggbb". */
static json_t *strip_of(const snow_transfer *transfer, double low,
                        double high) {
    json_t *list = json_array();
    for (int i = 0; i < STRIP_COLORS; i++) {
        double rgba[4], at = low + (high - low) * i / (STRIP_COLORS - 1);
        char text[8];
        snow_transfer_evaluate(transfer, at, rgba);
        snprintf(text, sizeof text, "#%02x%02x%02x",
                 (unsigned)lround(255 * fmin(fmax(rgba[0], 0), 1)),
                 (unsigned)lround(255 * fmin(fmax(rgba[1], 0), 1)),
                 (unsigned)lround(255 * fmin(fmax(rgba[2], 0), 1)));
        json_array_append_new(list, json_string(text));
    }
    return list;
}

void answer_look(drawing *d, outbox *box) {
    const snow_transfer *transfer = d->state.transfer;
    snow_look look = {.size = sizeof look};
    double low, high;
    if (snow_transfer_get_look(transfer, &look) != SNOW_STATUS_OK)
        return;
    snow_transfer_domain(transfer, &low, &high);
    put(box, 0, PARCEL_LOOK,
        json_pack(
            "{s:s, s:f, s:f, s:I, s:o, s:o, s:o, s:s, s:b}", "t", "look", "low",
            low, "high", high, "count", (json_int_t)look.opacity_count,
            "opacity", points_of(look.opacities, look.opacity_count),
            "gradient",
            points_of(look.gradient_opacities, look.gradient_opacity_count),
            "strip", strip_of(transfer, low, high), "text",
            snow_transfer_description(transfer), "shaded",
            d->state.settings.shade == SNOW_SHADE_PHONG));
}

void answer_figures(drawing *d, outbox *box) {
    const snow_stats *stats = &d->state.stats;
    put(box, 0, PARCEL_FIGURES,
        json_pack("{s:s, s:f, s:I, s:s}", "t", "figures", "sparse",
                  stats->sparse_ratio, "interesting",
                  (json_int_t)stats->interesting, "method",
                  snow_method_name(stats->method)));
}

/* --- what is asked
 * --------------------------------------------------------------- */

static void answer_histogram(drawing *d, outbox *box, uint64_t client,
                             const json_t *tree) {
    uint64_t counts[HISTOGRAM_BINS];
    snow_volume_statistics of = {.size = sizeof of};
    const json_t *lo = json_object_get(tree, "lo"),
                 *hi = json_object_get(tree, "hi");
    if (snow_volume_get_statistics(d->state.volume, &of) != SNOW_STATUS_OK)
        return;
    double low = json_is_number(lo) ? json_number_value(lo) : of.min;
    double high = json_is_number(hi) ? json_number_value(hi) : of.max;
    if (!(low < high) ||
        snow_volume_histogram(d->state.volume, low, high, HISTOGRAM_BINS,
                              counts) != SNOW_STATUS_OK)
        return;
    json_t *list = json_array();
    for (int i = 0; i < HISTOGRAM_BINS; i++)
        json_array_append_new(list, json_integer((json_int_t)counts[i]));
    put(box, client, PARCEL_PLAIN,
        json_pack("{s:s, s:f, s:f, s:o}", "t", "histogram", "lo", low, "hi",
                  high, "counts", list));
}

/* Of the newest state, which may not be drawn yet. */
static void answer_command(drawing *d, viewer_state *s, outbox *box,
                           uint64_t client) {
    json_t *recipe = state_recipe(s);
    int done = drawing_apply(d, recipe);
    char *command = done == CONTINUE ? drawing_command(d) : NULL;
    if (command)
        put(box, client, PARCEL_PLAIN,
            json_pack("{s:s, s:s}", "t", "command", "text", command));
    free(command);
    json_decref(recipe);
}

/* As a text, which keeps the order and the digits of its keys. */
static void answer_recipe(drawing *d, viewer_state *s, outbox *box,
                          uint64_t client) {
    json_t *newest = state_recipe(s);
    json_t *tree =
        drawing_apply(d, newest) == CONTINUE ? drawing_recipe(d) : NULL;
    char *text = tree ? json_dumps(tree, JSON_INDENT(2) | JSON_FORM) : NULL;
    if (text)
        put(box, client, PARCEL_PLAIN,
            json_pack("{s:s, s:s}", "t", "recipe", "text", text));
    free(text);
    json_decref(tree);
    json_decref(newest);
}

static void answer_fit(drawing *d, viewer_state *s, outbox *box,
                       uint64_t client) {
    uint32_t revision;
    json_t *recipe = state_recipe(s);
    json_t *keys = drawing_apply(d, recipe) == CONTINUE ? drawing_fit(d) : NULL;
    if (json_object_size(keys))
        free(state_set(s, keys, &revision));
    else if (keys)
        answer_said(box, client,
                    d->state.view.has_position
                        ? "The camera stands at a position that was given: "
                          "choose a view to frame all."
                        : "Nothing is visible that could be framed.");
    outbox_put(box, state_parcel(s, 0, 0));
    json_decref(keys);
    json_decref(recipe);
}

/* The state that was the newest when a picture was begun. */
typedef struct begun {
    const viewer_state *state;
    uint32_t revision;
} begun;

static bool has_changed(void *user) {
    const begun *b = user;
    return state_is_stale(b->state, b->revision);
}

/* {"what": "thumbnail", "preset": "ct-bone", "pane": 4}: is asked again where a
 * page changes something meanwhile. */
static void answer_thumbnail(drawing *d, viewer_state *s, outbox *box,
                             uint64_t client, json_t *tree) {
    begun now = {s, state_revision(s)};
    const char *preset = json_string_value(json_object_get(tree, "preset"));
    json_int_t pane = json_integer_value(json_object_get(tree, "pane"));
    snow_image *image = NULL;
    if (!preset || pane < 4 || pane > 255 ||
        (*preset && snow_preset_from_name(preset) < 0))
        return;
    int done =
        drawing_thumbnail(d, preset, THUMBNAIL_SIDE, has_changed, &now, &image);
    if (done == EXIT_INTERRUPTED)
        state_ask(s, client, json_incref(tree));
    if (done != CONTINUE)
        return;
    snow_image_options form = picture_form(&d->opts);
    parcel *made = pack_small(image, &form, (int)pane);
    if (made)
        made->client = client;
    outbox_put(box, made);
    snow_image_free(image);
}

void answer_question(drawing *d, viewer_state *s, outbox *box,
                     viewer_question *question) {
    const char *what =
        json_string_value(json_object_get(question->tree, "what"));
    uint64_t client = question->client;
    if (!d->state.volume || !d->state.transfer)
        what = "";
    if (strcmp(what, "histogram") == 0)
        answer_histogram(d, box, client, question->tree);
    else if (strcmp(what, "command") == 0)
        answer_command(d, s, box, client);
    else if (strcmp(what, "recipe") == 0)
        answer_recipe(d, s, box, client);
    else if (strcmp(what, "fit") == 0)
        answer_fit(d, s, box, client);
    else if (strcmp(what, "thumbnail") == 0)
        answer_thumbnail(d, s, box, client, question->tree);
    else
        answer_said(box, client, "ask: nothing is known of what is asked");
    json_decref(question->tree);
}
