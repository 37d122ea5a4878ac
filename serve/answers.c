/* answers.c - implements answers.h. */
#include "answers.h"
#include "message.h"

#include "commands/commands.h"
#include "draw/mixed.h"
#include "draw/pick.h"
#include "draw/slices.h"
#include "draw/small.h"
#include "draw/values.h"
#include "pack.h"
#include "recipe_file.h"
#include "run/log.h"

#include <snowglass/recipe.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STRIP_COLORS 64
#define POINTS_MOST 256 /* of a recipe */
#define THUMBNAIL_SIDE 96
#define LISTED_MOST 64 /* channels; more than can be mixed */

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

/* A name that is not UTF-8 is none. */
static json_t *channel_name(const snow_volume_info *info, int64_t index) {
    json_t *name = index < SNOW_CHANNELS_MAX
                       ? json_string(info->channel[index].name)
                       : NULL;
    return name ? name : json_string("");
}

static json_t *channel_names(const snow_volume_info *info) {
    json_t *list = json_array();
    for (int n = 0; n < info->channels && n < LISTED_MOST; n++)
        json_array_append_new(list, channel_name(info, n));
    return list;
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
        hear_warnings(&d->opts, d->state.context, false);
        (void)snow_volume_inspect(d->state.context, d->opts.operands[0], &data,
                                  &info);
        hear_warnings(&d->opts, d->state.context, true);
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
        json_sizes(info->dims, 3), "spacing", json_vector(info->spacing, 3),
        "unit", info->unit, "type", stored_type(d), "medical",
        (int)info->medical, "times", (json_int_t)info->times, "min",
        json_number(ends[0]), "max", json_number(ends[1]), "middle",
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
    json_object_set_new(tree, "channels", channel_names(info));
    json_object_set_new(tree, "tf", json_boolean(d->first.tf != NULL));
    json_object_set_new(tree, "keys", names_of(message_key));
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
    json_object_set_new(tree, "live", json_boolean(d->live));
    json_object_set_new(tree, "window",
                        json_pack("[f,f]", window[0], window[1]));
    json_object_set_new(
        tree, "hounsfield",
        json_boolean(info->hounsfield ||
                     (info->medical && ends[0] < ends[1] &&
                      snow_are_hounsfield(info, ends[0], ends[1]))));
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

void answer_look(drawing *d, outbox *box) {
    const snow_transfer *transfer = d->state.transfer;
    snow_look look = {.size = sizeof look};
    double low, high;
    if (snow_transfer_get_look(transfer, &look) != SNOW_STATUS_OK)
        return;
    snow_transfer_domain(transfer, &low, &high);
    put(box, 0, PARCEL_LOOK,
        json_pack(
            "{s:s, s:f, s:f, s:I, s:o, s:o, s:o, s:s, s:b, s:o, s:o, s:o}", "t",
            "look", "low", low, "high", high, "count",
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
    put(box, 0, PARCEL_FIGURES,
        json_pack("{s:s, s:o, s:I, s:s}", "t", "figures", "sparse",
                  isnan(hidden) ? json_null() : json_real(hidden),
                  "interesting", (json_int_t)stats->interesting, "method",
                  snow_method_name(stats->method)));
}

void answer_step(outbox *box, int64_t step) {
    put(box, 0, PARCEL_FIGURES,
        json_pack("{s:s, s:I}", "t", "step", "step", (json_int_t)step));
}

/* --- what is asked
 * --------------------------------------------------------------- */

static int answer_histogram(drawing *d, outbox *box, uint64_t client,
                            const json_t *tree) {
    uint64_t counts[VALUES_BINS];
    double ends[2];
    const json_t *lo = json_object_get(tree, "lo"),
                 *hi = json_object_get(tree, "hi");
    if (!json_is_number(lo) || !json_is_number(hi))
        values_ends(d, ends);
    double low = json_is_number(lo) ? json_number_value(lo) : ends[0];
    double high = json_is_number(hi) ? json_number_value(hi) : ends[1];
    if (!(low < high) || !isfinite(high - low) ||
        values_count(d, low, high, counts) != CONTINUE)
        return CONTINUE;
    json_t *list = json_array();
    for (int i = 0; i < VALUES_BINS; i++)
        json_array_append_new(list, json_integer((json_int_t)counts[i]));
    put(box, client, PARCEL_PLAIN,
        json_pack("{s:s, s:f, s:f, s:o}", "t", "histogram", "lo", low, "hi",
                  high, "counts", list));
    return CONTINUE;
}

static void answer_command(drawing *d, viewer_state *s, outbox *box,
                           uint64_t client, unsigned verb) {
    json_t *recipe = state_recipe(s);
    int done = drawing_apply(d, recipe);
    char *command = done == CONTINUE ? drawing_command(d, verb) : NULL;
    if (command)
        put(box, client, PARCEL_PLAIN,
            json_pack("{s:s, s:s}", "t", "command", "text", command));
    free(command);
    json_decref(recipe);
}

/* As a text, which keeps the order and the digits of its keys. */
void answer_recipe_text(outbox *box, uint64_t client, const json_t *tree) {
    char *text = tree ? json_dumps(tree, JSON_INDENT(2) | JSON_FORM) : NULL;
    if (text)
        put(box, client, PARCEL_PLAIN,
            json_pack("{s:s, s:s}", "t", "recipe", "text", text));
    free(text);
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

/* {"what": "thumbnail", "preset": "ct-bone", "pane": 4}: is
 * asked again where a page changes something meanwhile. */
static void answer_thumbnail(drawing *d, viewer_state *s, outbox *box,
                             uint64_t client, json_t *tree) {
    begun now = {s, state_revision(s)};
    const char *preset = json_string_value(json_object_get(tree, "preset"));
    json_int_t pane = json_integer_value(json_object_get(tree, "pane"));
    snow_image *image = NULL;
    if (!d->state.volume || !preset || pane < 4 || pane > 255 ||
        (*preset && snow_preset_from_name(preset) < 0))
        return;
    int done =
        small_thumbnail(d, preset, THUMBNAIL_SIDE, has_changed, &now, &image);
    if (done == EXIT_INTERRUPTED) {
        json_object_set_new(tree, "again", json_true());
        state_ask(s, client, json_incref(tree));
    }
    if (done != CONTINUE)
        return;
    snow_image_options form = picture_form(&d->opts);
    parcel *made = pack_small(image, &form, false, (int)pane, 0);
    if (made)
        made->client = client;
    outbox_put(box, made);
    snow_image_free(image);
}

static void put_no_slice(outbox *box, uint64_t client, json_int_t pane) {
    if (pane >= 1 && pane <= 3)
        put(box, client, PARCEL_PLAIN,
            json_pack("{s:s, s:I}", "t", "slice", "pane", pane));
}

static bool read_slice(const json_t *tree, slice_asked *out) {
    const json_t *range = json_object_get(tree, "range");
    out->axis = json_string_value(json_object_get(tree, "axis"));
    out->index = json_integer_value(json_object_get(tree, "index"));
    out->low = json_number_value(json_array_get(range, 0));
    out->high = json_number_value(json_array_get(range, 1));
    out->colored = json_is_true(json_object_get(tree, "colored"));
    return out->axis && out->low < out->high;
}

/* {"what": "slice", "axis": "axial", "index": 57, "range": [0, 80], "pane": 1,
 * "n": 8, "exact": true}: {"t": "slice", "pane": 1} where there is none, as the
 * page waits for it. */
static int answer_slice(drawing *d, outbox *box, uint64_t client,
                        const json_t *tree) {
    slice_asked asked;
    snow_image_options form;
    snow_image *image = NULL;
    json_int_t pane = json_integer_value(json_object_get(tree, "pane"));
    json_int_t n = json_integer_value(json_object_get(tree, "n"));
    bool exact = json_is_true(json_object_get(tree, "exact"));
    int done = CONTINUE;
    if (pane < 1 || pane > 3)
        return CONTINUE;
    if (read_slice(tree, &asked))
        done = slices_draw(d, &asked, &image, &form);
    parcel *made =
        image ? pack_small(image, &form, exact, (int)pane, (uint32_t)n) : NULL;
    if (made)
        made->client = client;
    else if (done != SNOW_STATUS_NO_MEMORY)
        put_no_slice(box, client, pane);
    outbox_put(box, made);
    snow_image_free(image);
    return done;
}

static int answer_slice_command(drawing *d, outbox *box, uint64_t client,
                                const json_t *tree) {
    slice_asked asked;
    char *command = read_slice(tree, &asked) ? slices_command(d, &asked) : NULL;
    if (command)
        put(box, client, PARCEL_PLAIN,
            json_pack("{s:s, s:s}", "t", "command", "text", command));
    free(command);
    return CONTINUE;
}

static void read_at(const json_t *tree, int64_t index[3]) {
    const json_t *at = json_object_get(tree, "at");
    for (size_t i = 0; i < 3; i++)
        index[i] = json_integer_value(json_array_get(at, i));
}

static void put_value(outbox *box, uint64_t client, const int64_t at[3],
                      double value) {
    put(box, client, PARCEL_PLAIN,
        json_pack("{s:s, s:o, s:o}", "t", "value", "at", json_sizes(at, 3),
                  "value", json_number(value)));
}

/* {"what": "value", "at": [12, 30, 57]} */
static int answer_value(drawing *d, outbox *box, uint64_t client,
                        const json_t *tree) {
    int64_t at[3];
    read_at(tree, at);
    put_value(box, client, at, slices_value(d, at));
    return CONTINUE;
}

void answer_none(outbox *box, uint64_t client, const json_t *tree) {
    const char *what = json_string_value(json_object_get(tree, "what"));
    int64_t at[3];
    if (what && strcmp(what, "slice") == 0)
        put_no_slice(box, client,
                     json_integer_value(json_object_get(tree, "pane")));
    if (!what || strcmp(what, "value") != 0)
        return;
    read_at(tree, at);
    put_value(box, client, at, NAN);
}

/* {"what": "depth", "x": 0.5, "y": 0.25}: of the picture as it was drawn last.
 * The page knows the camera. */
static int answer_depth(drawing *d, outbox *box, uint64_t client,
                        const json_t *tree) {
    double depth;
    double x = json_number_value(json_object_get(tree, "x"));
    double y = json_number_value(json_object_get(tree, "y"));
    if (x < 0 || x > 1 || y < 0 || y > 1 ||
        pick_depth(d, x, y, &depth) != CONTINUE)
        return CONTINUE;
    put(box, client, PARCEL_PLAIN,
        json_pack("{s:s, s:f, s:f, s:o}", "t", "depth", "x", x, "y", y, "depth",
                  json_number(depth)));
    return CONTINUE;
}

/* What needs the newest state, which may not be drawn yet. */
static bool answer_state(drawing *d, viewer_state *s, outbox *box,
                         const viewer_question *question, const char *what) {
    if (strcmp(what, "command") == 0)
        answer_command(d, s, box, question->client, VERB_RENDER);
    else if (strcmp(what, "movie-command") == 0)
        answer_command(d, s, box, question->client, VERB_TURNTABLE);
    else if (strcmp(what, "recipe") == 0) {
        json_t *newest = state_recipe(s);
        json_t *tree =
            drawing_apply(d, newest) == CONTINUE ? recipe_file_tree(d) : NULL;
        answer_recipe_text(box, question->client, tree);
        json_decref(tree);
        json_decref(newest);
    } else if (strcmp(what, "fit") == 0)
        answer_fit(d, s, box, question->client);
    else if (strcmp(what, "thumbnail") == 0)
        answer_thumbnail(d, s, box, question->client, question->tree);
    else
        return false;
    return true;
}

/* Makes what the newest state needs, once for each state; why it cannot be made
 * is said then, and a second try is only for one that was short of memory. */
static int follow(drawing *d, viewer_state *s) {
    uint32_t revision = state_revision(s); /* the recipe may be newer */
    if (d->followed == revision)
        return d->followed_done == CONTINUE ? CONTINUE : SNOW_STATUS_FAILED;
    json_t *recipe = state_recipe(s);
    d->followed_done = drawing_apply(d, recipe);
    d->followed = revision;
    json_decref(recipe);
    return d->followed_done;
}

/* What is answered of the volume: `newest` where that is the one of the newest
 * state, not of the last picture. */
typedef struct answer_row {
    const char *what;
    int (*answer)(drawing *, outbox *, uint64_t, const json_t *);
    bool newest;
} answer_row;

/* Why a state has no volume is said when it is made. */
static int answer_by(const answer_row *row, drawing *d, viewer_state *s,
                     outbox *box, const viewer_question *question) {
    int made = row->newest ? follow(d, s) : CONTINUE;
    if (made == CONTINUE && d->state.volume && d->state.transfer)
        return row->answer(d, box, question->client, question->tree);
    if (made == SNOW_STATUS_NO_MEMORY)
        return made;
    answer_none(box, question->client, question->tree);
    if (made == CONTINUE)
        answer_said(
            box, question->client,
            "There is no volume: undo, or choose another time or crop.");
    return CONTINUE;
}

int answer_question(drawing *d, viewer_state *s, outbox *box,
                    const viewer_question *question) {
    static const answer_row rows[] = {
        {"histogram", answer_histogram, false},
        {"slice", answer_slice, true},
        {"slice-command", answer_slice_command, true},
        {"value", answer_value, true},
        {"depth", answer_depth, false}};
    const char *what =
        json_string_value(json_object_get(question->tree, "what"));
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strcmp(what, rows[i].what) == 0)
            return answer_by(&rows[i], d, s, box, question);
    if (!answer_state(d, s, box, question, what))
        answer_said(box, question->client,
                    "ask: nothing is known of what is asked");
    return CONTINUE;
}
