/* config_save.c - converts options to a recipe file, and to the command that
 * makes the same picture.
 *
 * What was chosen automatically is written as if it had been given, so that a
 * configuration gives the same look for the next volume, and in later
 * versions. */
#include "commands/commands.h"
#include "options/config.h"
#include "options/config_paths.h"
#include "picture/outputs.h"
#include "run/log.h"
#include "run/start.h"

#include <inttypes.h>
#include <limits.h>
#include <snowglass/recipe.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fill_data(const options *opts, snow_recipe *out) {
    static char text[1024], steps[64];
    out->data = data_options(opts);
    out->data.suv = opts->suv;
    out->data.vertical = opts->vertical;
    if (opts->channels.count) {
        channels_text(&opts->channels, text, sizeof text);
        out->channels = text;
        out->data.channel = 0;
        out->data.channel_given = false;
    }
    out->data.labels = opts->labels;
    out->data.label_table = opts->label_table;
    if (opts->time_range) {
        char end[24] = "";
        if (opts->time_end != INT64_MAX)
            snprintf(end, sizeof end, "%" PRId64, opts->time_end);
        snprintf(steps, sizeof steps, "%" PRId64 ":%s", opts->time, end);
        out->steps = steps;
    }
    if (!opts->component && !opts->channel && out->data.channel_given)
        out->data.component = "0"; /* a recipe has no channel 0 */
}

static void fill_look(const options *opts, snow_recipe *out) {
    out->preset = opts->preset;
    out->colormap = opts->colormap;
    out->tf = opts->tf;
    out->log = opts->scale.log;
    out->symlog = opts->scale.symlog;
    const range_value range = options_range(opts);
    out->range = range.kind;
    out->low = range.low;
    out->high = range.high;
    out->opacity_count = opts->opacities.count;
    memcpy(out->opacities, opts->opacities.points,
           opts->opacities.count * sizeof *out->opacities);
    out->gradient_opacity_count = opts->gradient_opacities.count;
    memcpy(out->gradient_opacities, opts->gradient_opacities.points,
           opts->gradient_opacities.count * sizeof *out->gradient_opacities);
    out->opacity_per_mm =
        opts->opacity_unit && strcmp(opts->opacity_unit, "mm") == 0;
    out->opacity_per_voxel = !out->opacity_per_mm && opts->opacity_unit;
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

static void fill_recipe(const options *opts, const verb_row *verb,
                        snow_recipe *out) {
    snow_recipe_init(out);
    if (opts->operand_count >= 1 && strcmp(opts->operands[0], "-") != 0)
        out->input = opts->operands[0];
    out->verb = verb->name;
    out->version = snow_version();
    out->grid = opts->grid;
    out->slab = opts->thickness;
    out->ortho = opts->ortho;
    if (verb->bit == VERB_TURNTABLE ||
        (verb->bit == VERB_SLICE && options_given(opts, "frames")))
        out->frames = (int)opts->frames;
    out->fps = opts->fps;
    out->output =
        opts->show && strcmp(opts->output, "-") == 0 ? NULL : opts->output;
    out->depth = opts->depth;
    out->image.flatten = opts->background.given;
    memcpy(out->image.background, opts->background.rgb,
           sizeof out->image.background);
    out->image.bits = options_bits(opts);
    fill_data(opts, out);
    fill_look(opts, out);
    out->overlay = opts->overlay;
    out->overlay_look = opts->overlay_look.text;
    fill_view(opts, out);
    out->no_labels = opts->no_labels;
    out->legend = opts->legend.bar;
    out->scale_bar = opts->legend.scale && !opts->legend.bar;
    out->legend_title = opts->legend.title;
    out->title = opts->title;
    out->annotate = opts->annotate.text;
    out->box = opts->box;
    out->measure = opts->measure;
    fill_settings(opts, &out->settings);
}

static int check_place(const options *opts) {
    static const char *const names[] = {"output", "depth", "stats"};
    const char *const paths[] = {opts->output, opts->depth, opts->stats};
    int done = CONTINUE;
    for (size_t i = 0; i < sizeof paths / sizeof *paths && done == CONTINUE;
         i++) {
        char fault[80];
        snprintf(fault, sizeof fault,
                 "--save-config: is the same file as --%s; name two files",
                 names[i]);
        done = check_apart(opts->save_config, paths[i], fault);
    }
    if (done == CONTINUE)
        done = check_input_first(opts, &opts->save_config, 1);
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

/* --- the file and the command --------------------------------------------- */

/* A movie of several files. */
static void set_inputs(const options *opts, json_t *tree) {
    json_t *list = json_array();
    for (int i = 0; i < opts->operand_count; i++)
        json_array_append_new(list, json_string(opts->operands[i]));
    if (opts->operand_count > 1)
        json_object_set(tree, "input", list);
    json_decref(list);
}

/* A recipe has all keys; those of options that a slice lacks are removed, and
 * its own size. */
static void keep_slice(const options *opts, json_t *tree) {
    if (!options_given(opts, "size"))
        json_object_del(tree, "size");
    json_object_del(tree, "opacity-unit");
    for (const option_row *row = option_table; row->name; row++)
        if (!(row->verbs & VERB_SLICE))
            json_object_del(tree, row->name);
}

json_t *config_tree(const options *opts, const verb_row *verb) {
    snow_context *context = NULL;
    snow_recipe recipe = {.size = sizeof recipe};
    json_t *tree = NULL;
    fill_recipe(opts, verb, &recipe);
    if (snow_context_new(NULL, &context) == SNOW_STATUS_OK)
        tree = recipe_tree(context, &recipe);
    snow_context_free(context);
    if (!tree)
        return NULL;
    if (!options_given(opts, "shade")) /* otherwise the look decides */
        json_object_del(tree, "shade");
    if (!opts->background.given && !opts->background.automatic)
        json_object_set_new(tree, "background", json_string("none"));
    if (verb->bit == VERB_RENDER || !options_given(opts, "fps"))
        json_object_del(tree, "fps"); /* few time steps have their own */
    if (options_given(opts, "time") && !json_object_get(tree, "time"))
        json_object_set_new(tree, "time", json_integer(opts->time));
    if (verb->bit == VERB_SLICE)
        keep_slice(opts, tree);
    set_inputs(opts, tree);
    config_set_noted(tree);
    return tree;
}

/* Appends a word to a command as a shell reads it. */
static void add_word(FILE *out, const char *word) {
    bool plain = *word && !word[strspn(word, "abcdefghijklmnopqrstuvwxyz"
                                             "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                             "0123456789_./:,=+%@#-")];
    fputs(plain && *word != '#' ? " " : " '", out);
    for (const char *at = word; *at; at++)
        fputs(*at == '\'' && !plain ? "'\\''" : (char[]){*at, '\0'}, out);
    if (!plain || *word == '#')
        fputc('\'', out);
}

/* A key that is no option stands in a recipe's text. */
static void add_option(FILE *out, const char *key, const json_t *value) {
    static options scratch; /* for its texts */
    char name[64];
    if (strcmp(key, "opacity-unit") == 0) {
        fprintf(out, " --config '{\"%s\": \"%s\"}'", key,
                json_string_value(value));
        return;
    }
    scratch.text_bytes = 0;
    snprintf(name, sizeof name, "--%s", key);
    const char *text =
        json_is_true(value) ? NULL : config_text(&scratch, key, value);
    if (strcmp(key, "legend") == 0 && text) { /* a value that may be left out */
        char whole[256];
        snprintf(whole, sizeof whole, "%s=%s", name, text);
        add_word(out, whole);
        return;
    }
    add_word(out, name);
    if (!json_is_true(value))
        add_word(out, text ? text : "");
}

/* All options that differ from their defaults. */
static void write_command(FILE *out, const options *opts, const verb_row *verb,
                          const json_t *tree, json_t *usual) {
    const char *key;
    json_t *value;
    fprintf(out, "snowglass %s", verb->name);
    for (int i = 0; i < opts->operand_count; i++) {
        /* A file whose name begins with a dash is no option. */
        char text[PATH_MAX + 4];
        bool dashed = *opts->operands[i] == '-' && opts->operands[i][1];
        snprintf(text, sizeof text, "%s%s", dashed ? "./" : "",
                 opts->operands[i]);
        add_word(out, text);
    }
    json_object_foreach((json_t *)tree, key, value) {
        bool always = strcmp(key, "input") == 0 || strcmp(key, "verb") == 0 ||
                      strcmp(key, "version") == 0;
        const json_t *other = json_object_get(usual, key);
        if (!always && !(other && json_equal(value, other)))
            add_option(out, key, value);
    }
}

char *config_command(const options *opts, const verb_row *verb,
                     const json_t *tree) {
    snow_context *context = NULL;
    snow_recipe recipe = {.size = sizeof recipe};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    snow_recipe_init(&recipe);
    recipe.fit = 1;
    if (out && snow_context_new(NULL, &context) == SNOW_STATUS_OK) {
        json_t *usual = recipe_tree(context, &recipe);
        json_object_del(usual, "shade"); /* the default depends on the look */
        if (options_given(opts, "mode")) /* or on the file */
            json_object_del(usual, "mode");
        if (verb->bit == VERB_SLICE)
            json_object_del(usual, "size"); /* or on the slice */
        json_object_del(usual, "fps");      /* or on the number of steps */
        write_command(out, opts, verb, tree, usual);
        json_decref(usual);
    }
    snow_context_free(context);
    if (out)
        fclose(out);
    return text;
}

int config_save(const options *opts, const verb_row *verb) {
    bool rendered =
        (verb->bit & (VERB_RENDER | VERB_TURNTABLE | VERB_MOVIE | VERB_SLICE));
    bool prints = opts->verbosity > 0 && rendered;
    if ((!opts->save_config && !prints) || !process_talks())
        return SNOW_STATUS_OK;
    json_t *tree = config_tree(opts, verb);
    if (!tree)
        return fail_memory(
            "%s: out of memory for its text; close other programs",
            opts->save_config ? opts->save_config : "the command");
    if (prints) {
        char *text = config_command(opts, verb, tree);
        if (text)
            say("again: %s", text);
        free(text);
    }
    if (!opts->save_config) {
        json_decref(tree);
        return SNOW_STATUS_OK;
    }
    config_paths_write(tree, opts->save_config);
    return write_json(tree, opts->save_config, opts->overwrite);
}
