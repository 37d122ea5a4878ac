/* config.c - converts recipe files to options.
 *
 * A recipe is validated first and then turned into the texts that would stand
 * on the command line.  So each option has one reader, and the record of an
 * interrupted movie covers the options of a recipe too. */
#include "options/config.h"
#include "options/config_paths.h"
#include "run/log.h"
#include "run/start.h"

#include <jansson.h>
#include <snowglass/recipe.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

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

/* With as few digits as bring the number back, but no "4e+01". */
void config_real(double value, char text[40]) {
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, 40, "%.*g", digits, value);
        double again = strtod(text, NULL);
        if (again <= value && again >= value)
            return;
    }
}

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
        config_real(json_real_value(value), number);
    return add_text(out, number);
}

char *config_text(options *out, const char *key, const json_t *value) {
    char *text = out->texts + out->text_bytes;
    if (!add_value(out, key, value))
        return NULL;
    out->text_bytes++; /* the terminating zero */
    return text;
}

/* Whether a key gives way to another option on the command line that means the
 * same. */
static bool gives_way(const options *out, const char *key) {
    if (strcmp(key, "range") == 0)
        return options_given(out, "window");
    if (strcmp(key, "tf") == 0)
        return options_given(out, "preset");
    if (strcmp(key, "preset") == 0)
        return options_given(out, "tf");
    if (strcmp(key, "view") == 0)
        return options_given(out, "position");
    if (strcmp(key, "position") == 0)
        return options_given(out, "view");
    return strcmp(key, "window") == 0 && options_given(out, "range");
}

/* The inputs of a movie, unless some stand on the command line.  They stay
 * until the process ends, as argv does. */
static int take_inputs(options *out, const json_t *list) {
    static char **inputs;
    size_t count = json_array_size(list);
    if (out->operand_count > 0 || inputs || count == 0)
        return CONTINUE;
    inputs = calloc(count, sizeof *inputs);
    bool good = inputs != NULL;
    for (size_t i = 0; good && i < count; i++) {
        inputs[i] = strdup(json_string_value(json_array_get(list, i)));
        good = inputs[i] != NULL;
    }
    if (!good)
        return fail_memory("out of memory for the names of %zu inputs; close "
                           "other programs",
                           count);
    out->operands = inputs;
    out->operand_count = (int)count;
    return CONTINUE;
}

static int take_key(options *out, const verb_row *verb, const char *key,
                    const json_t *value) {
    bool nothing =
        json_is_false(value) || strcmp(key, "version") == 0 ||
        strcmp(key, "reread") == 0 || /* of simulations */
        strcmp(key, "verb") == 0 ||
        (strcmp(key, "perspective") == 0 && json_number_value(value) == 0);
    if (nothing || gives_way(out, key))
        return CONTINUE;
    if (strcmp(key, "opacity-unit") == 0) { /* which is no option */
        out->opacity_unit =
            strcmp(json_string_value(value), "mm") == 0 ? "mm" : "voxel";
        return CONTINUE;
    }
    if (json_is_true(value))
        return options_take(out, verb, key, NULL);
    if (json_is_array(value) && strcmp(key, "input") == 0)
        return take_inputs(out, value);
    char *text = config_text(out, key, value);
    if (!text)
        return fail_usage("%s: \"%s\" is too long; shorten it",
                          out->config ? out->config : "the recipe", key);
    if (strcmp(key, "input") != 0)
        return options_take(out, verb, key, text);
    out->config_input = text;
    if (out->operand_count == 0) {
        out->operands = &out->config_input;
        out->operand_count = 1;
    }
    return CONTINUE;
}

/* Whether it is no file but a text, {"KEY": VALUE}. */
static bool is_recipe_text(const char *config) {
    return *config == '{';
}

/* Whether the file, or the text, is a recipe. */
static int check_recipe(const char *config) {
    snow_context *context = NULL;
    snow_recipe recipe = {.size = sizeof recipe};
    snow_status status = snow_context_new(NULL, &context);
    if (status != SNOW_STATUS_OK)
        return fail_status(NULL, status);
    status = is_recipe_text(config)
                 ? snow_recipe_parse(context, "--config", config,
                                     strlen(config), &recipe)
                 : snow_recipe_load(context, config, &recipe);
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
             (options_given(out, "mode") && mode_is_projection(out->mode)))
        json_object_del(tree, "depth");
}

/* Takes the keys in their order. */
int config_take_tree(options *out, const verb_row *verb, const json_t *tree) {
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)tree, key, value) {
        int done = take_key(out, verb, key, value);
        if (done != CONTINUE)
            return done;
    }
    return CONTINUE;
}

/* The recipe could not be read when its verb was wanted. */
static bool verb_unknown;

static int take_file(options *out, const verb_row *verb) {
    json_error_t error;
    int done = check_recipe(out->config);
    if (done != CONTINUE)
        return done;
    json_t *tree = is_recipe_text(out->config)
                       ? json_loads(out->config, 0, &error)
                       : json_load_file(out->config, 0, &error);
    if (!tree || verb_unknown) {
        json_decref(tree);
        say("%s: could be read once only; check the disk", out->config);
        return SNOW_STATUS_BAD_INPUT;
    }
    if (!is_recipe_text(out->config))
        config_paths_read(tree, out->config);
    fit_depth(out, verb, tree);
    done = config_take_tree(out, verb, tree);
    const json_t *overlay = json_object_get(tree, "overlay");
    if (overlay && !out->overlay)
        out->overlay_hidden = config_text(out, "overlay", overlay);
    json_decref(tree);
    return done;
}

/* All ranks read the file; if one of them cannot, all return an error. */
int config_take(options *out, const verb_row *verb) {
    return out->config ? process_agree(take_file(out, verb)) : CONTINUE;
}

/* The value of --config among the words, NULL if it is not there. */
static const char *config_among(int argc, char **argv) {
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strncmp(argv[i], "--config=", 9) == 0)
            return argv[i] + 9;
        if (strcmp(argv[i], "--config") == 0)
            return argv[i + 1];
    }
    return NULL;
}

/* A file that cannot be read is refused later, with the reason; also where it
 * could not be read this time, so that its verb is not known.  A pipe is read
 * once. */
const verb_row *config_verb(int argc, char **argv) {
    const char *path = config_among(argc, argv);
    const verb_row *verb = NULL;
    struct stat what;
    if (!path || is_recipe_text(path))
        return verb_of(VERB_RENDER);
    verb_unknown = stat(path, &what) != 0;
    if (!verb_unknown && S_ISREG(what.st_mode)) {
        json_t *tree = json_load_file(path, 0, NULL);
        verb_unknown = !tree;
        const char *name = json_string_value(json_object_get(tree, "verb"));
        verb = name ? verb_named(name) : NULL;
        json_decref(tree);
    }
    return verb && verb->bit &
                       (VERB_RENDER | VERB_TURNTABLE | VERB_MOVIE | VERB_SLICE)
               ? verb
               : verb_of(VERB_RENDER);
}
