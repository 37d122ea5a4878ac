/* config.c - converts between recipe files and options.
 *
 * A recipe is validated first and then turned into the texts that would stand
 * on the command line.  So each option has one reader, and the record of an
 * interrupted movie covers the options of a recipe too. */
#include "options/config.h"
#include "commands/commands.h"
#include "picture/outputs.h"
#include "run/log.h"
#include "run/start.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <snowglass/recipe.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- reading -------------------------------------------------------------- */

/* Appends to the texts of the configuration; returns false if they are full. */
static bool add_text(options *out, const char *text) {
    size_t length = strlen(text);
    if (length >= CONFIG_TEXTS_BYTES - out->text_bytes)
        return false;
    memcpy(out->texts + out->text_bytes, text, length + 1);
    out->text_bytes += length;
    return true;
}

static bool add_value(options *out, const char *key, const json_t *value);

/* Writes a list as text: "640x480", "0,1", "10:0,20:0.5".  A colon separates
 * the numbers of a list within a list, except for clip planes.  An empty end of
 * a crop axis is an empty text. */
static bool add_list(options *out, const char *key, const json_t *list) {
    bool crop = strcmp(key, "crop") == 0, inner = strcmp(key, "clip") != 0;
    const char *between =
        strcmp(key, ":") == 0                                     ? ":"
        : strcmp(key, "size") == 0                                ? "x"
        : strcmp(key, "dims") == 0 || strcmp(key, "spacing") == 0 ? "x"
                                                                  : ",";
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        if (i > 0 && !add_text(out, between))
            return false;
        if (crop && json_integer_value(json_array_get(item, 1)) == 0) {
            if (!add_value(out, ":", json_array_get(item, 0)) ||
                !add_text(out, ":"))
                return false;
        } else if (!add_value(out, inner && json_is_array(item) ? ":" : key,
                              item))
            return false;
    }
    return true;
}

static bool add_value(options *out, const char *key, const json_t *value) {
    char number[40];
    if (json_is_array(value))
        return add_list(out, key, value);
    if (json_is_string(value))
        return add_text(out, json_string_value(value));
    if (json_is_integer(value))
        snprintf(number, sizeof number, "%" JSON_INTEGER_FORMAT,
                 json_integer_value(value));
    else
        snprintf(number, sizeof number, "%.17g", json_real_value(value));
    return add_text(out, number);
}

/* The text of a value; NULL if there is no more room. */
static char *text_of(options *out, const char *key, const json_t *value) {
    char *text = out->texts + out->text_bytes;
    if (!add_value(out, key, value))
        return NULL;
    out->text_bytes++; /* the terminating zero */
    return text;
}

/* Whether a key gives way to another option on the command line that means the
 * same. */
static bool gives_way(const options *out, const char *key) {
    bool window = options_given(out, "window") || options_given(out, "level");
    if (strcmp(key, "range") == 0)
        return window;
    if (strcmp(key, "tf") == 0)
        return options_given(out, "preset");
    if (strcmp(key, "preset") == 0)
        return options_given(out, "tf");
    if (strcmp(key, "view") == 0)
        return options_given(out, "position");
    if (strcmp(key, "level") == 0 && !isnan(out->level)) /* --window W,L */
        return true;
    if (strcmp(key, "position") == 0)
        return options_given(out, "view");
    return (strcmp(key, "window") == 0 || strcmp(key, "level") == 0) &&
           options_given(out, "range");
}

static int take_key(options *out, const verb_row *verb, const char *key,
                    const json_t *value) {
    bool nothing = json_is_false(value) || (strcmp(key, "perspective") == 0 &&
                                            json_number_value(value) == 0);
    if (nothing || gives_way(out, key))
        return CONTINUE;
    if (json_is_true(value))
        return options_take(out, verb, key, NULL);
    char *text = text_of(out, key, value);
    if (!text)
        return fail_usage("--config: %s is too long; use fewer points",
                          out->config);
    if (strcmp(key, "input") != 0)
        return options_take(out, verb, key, text);
    out->config_input = text;
    if (out->operand_count == 0) {
        out->operands = &out->config_input;
        out->operand_count = 1;
    }
    return CONTINUE;
}

/* Whether the file is a recipe. */
static int check_recipe(const char *path) {
    snow_context *context = NULL;
    snow_recipe recipe = {.size = sizeof recipe};
    snow_status status = snow_context_new(NULL, &context);
    if (status != SNOW_STATUS_OK)
        return fail_usage("out of memory for a context; close other programs");
    status = snow_recipe_load(context, path, &recipe);
    int done = CONTINUE;
    if (status == SNOW_STATUS_OK)
        snow_recipe_clear(&recipe);
    else
        done = fail_status(context, status);
    snow_context_free(context);
    return done;
}

/* The depth of the recipe follows the options of the command line.  It moves to
 * the new picture file if that can hold depths.  It is dropped for modes
 * without depth, and for frames, which have no depth file. */
static void fit_depth(const options *out, const verb_row *verb, json_t *tree) {
    const char *depth = json_string_value(json_object_get(tree, "depth"));
    const char *output = json_string_value(json_object_get(tree, "output"));
    bool moves = options_given(out, "output") && depth && output &&
                 strcmp(depth, output) == 0;
    if (moves && snow_image_format_has_depth(out->output))
        json_object_set_new(tree, "depth", json_string(out->output));
    else if (moves ||
             (depth && verb->bit != VERB_RENDER &&
              (!output || strcmp(depth, output) != 0)) ||
             (options_given(out, "mode") && strcmp(out->mode, "over") &&
              strcmp(out->mode, "iso")))
        json_object_del(tree, "depth");
}

/* Takes the keys in the order of the file. */
static int take_file(options *out, const verb_row *verb) {
    json_error_t error;
    const char *key;
    json_t *value;
    int done = check_recipe(out->config);
    if (done != CONTINUE)
        return done;
    json_t *tree = json_load_file(out->config, 0, &error);
    fit_depth(out, verb, tree);
    json_object_foreach(tree, key, value) {
        done = take_key(out, verb, key, value);
        if (done != CONTINUE)
            break;
    }
    json_decref(tree);
    return done;
}

/* All ranks read the file; if one of them cannot, all return an error. */
int config_take(options *out, const verb_row *verb) {
    return out->config ? process_agree(take_file(out, verb)) : CONTINUE;
}

/* --- writing -------------------------------------------------------------- */

static void fill_data(const options *opts, snow_recipe *out) {
    snow_volume_options *data = &out->data;
    memcpy(data->dims, opts->dims, sizeof data->dims);
    memcpy(data->spacing, opts->spacing, sizeof data->spacing);
    memcpy(data->crop, opts->crop, sizeof data->crop);
    data->type = opts->type;
    data->offset = opts->offset;
    data->time = opts->time;
    data->channel = opts->channel;
    data->dataset = opts->dataset;
    data->series = opts->series;
    data->allow_gaps = opts->allow_gaps;
    data->mask = opts->mask;
    memcpy(data->clip, opts->clip, sizeof data->clip);
    data->labels = opts->labels;
    if (opts->endian)
        data->endian = strcmp(opts->endian, "big") == 0 ? SNOW_ENDIAN_BIG
                                                        : SNOW_ENDIAN_LITTLE;
}

static void fill_look(const options *opts, snow_recipe *out) {
    out->preset = opts->preset;
    out->colormap = opts->colormap;
    out->tf = opts->tf;
    out->log = opts->log;
    out->range = opts->range.kind;
    out->low = opts->range.low;
    out->high = opts->range.high;
    if (!isnan(opts->window)) {
        out->range = SNOW_RANGE_VALUES;
        out->low = opts->level - opts->window / 2;
        out->high = opts->level + opts->window / 2;
    }
    out->opacity_count = opts->opacities.count;
    memcpy(out->opacities, opts->opacities.points,
           opts->opacities.count * sizeof *out->opacities);
    out->gradient_opacity_count = opts->gradient_opacities.count;
    memcpy(out->gradient_opacities, opts->gradient_opacities.points,
           opts->gradient_opacities.count * sizeof *out->gradient_opacities);
    out->opacity_per_mm = strcmp(opts->opacity_unit, "mm") == 0;
    out->opacity_per_voxel =
        !out->opacity_per_mm && options_given(opts, "opacity-unit");
}

static void fill_place(const place_value *place, double out[3]) {
    if (place->given)
        memcpy(out, place->at, sizeof place->at);
}

static void fill_view(const options *opts, snow_recipe *out) {
    out->view = opts->view;
    out->width = (int)opts->size[0];
    out->height = (int)opts->size[1];
    out->azimuth = opts->azimuth;
    out->elevation = opts->elevation;
    out->roll = opts->roll;
    out->zoom = opts->zoom;
    out->fov = opts->fov;
    out->fit = strcmp(opts->fit, "volume") ? 1 : 2;
    fill_place(&opts->position, out->position);
    fill_place(&opts->target, out->target);
    fill_place(&opts->up, out->up);
}

/* A movie of many files has no single input. */
static void fill_recipe(const options *opts, snow_recipe *out) {
    snow_recipe_init(out);
    if (opts->operand_count == 1 && strcmp(opts->operands[0], "-") != 0)
        out->input = opts->operands[0];
    out->output = opts->output;
    out->depth = opts->depth;
    out->image.flatten = opts->background.given;
    memcpy(out->image.background, opts->background.rgb,
           sizeof out->image.background);
    if (opts->bits)
        out->image.bits = opts->bits[0] == '8' ? 8 : 16;
    fill_data(opts, out);
    fill_look(opts, out);
    fill_view(opts, out);
    out->no_labels = opts->no_labels;
    out->legend = opts->legend;
    out->time_label = opts->time_label;
    fill_settings(opts, &out->settings);
}

static int check_place(const options *opts) {
    static const char *const names[] = {"output", "depth", "stats"};
    const char *const paths[] = {opts->output, opts->depth, opts->stats};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++)
        if (paths[i] && (strcmp(opts->save_config, paths[i]) == 0 ||
                         same_place(opts->save_config, paths[i])))
            return fail_usage(
                "--save-config: is the same file as --%s; name two files",
                names[i]);
    int done = check_input_first(opts, &opts->save_config, 1);
    return done == CONTINUE
               ? check_stats_path(opts->save_config, opts->overwrite)
               : done;
}

int config_check(const options *opts) {
    if (!opts->save_config)
        return CONTINUE;
    return process_agree(process_talks() ? check_place(opts) : CONTINUE);
}

/* The recipe as a JSON tree; the library writes it as text. */
static json_t *recipe_tree(snow_context *context, const snow_recipe *recipe) {
    size_t length = 0;
    json_error_t error;
    json_t *tree = NULL;
    if (snow_recipe_write(context, recipe, NULL, 0, &length) != SNOW_STATUS_OK)
        return NULL;
    char *text = malloc(length + 1);
    if (text && snow_recipe_write(context, recipe, text, length + 1, &length) ==
                    SNOW_STATUS_OK)
        tree = json_loadb(text, length, 0, &error);
    free(text);
    return tree;
}

int config_save(const options *opts) {
    snow_context *context = NULL;
    snow_recipe recipe = {.size = sizeof recipe};
    json_t *tree = NULL;
    if (!opts->save_config || !process_talks())
        return SNOW_STATUS_OK;
    fill_recipe(opts, &recipe);
    if (snow_context_new(NULL, &context) == SNOW_STATUS_OK)
        tree = recipe_tree(context, &recipe);
    snow_context_free(context);
    if (!tree)
        return fail_output(
            "%s: out of memory for its text; close other programs",
            opts->save_config);
    if (!options_given(opts, "shade")) /* otherwise the look decides */
        json_object_del(tree, "shade");
    return write_json(tree, opts->save_config, opts->overwrite);
}
