/* recipe/recipe.c - reads, writes and applies recipes.
 *
 * Texts of a record that was read belong to its JSON tree, which is kept with
 * it.  jansson allocates with malloc: setting another allocator would change it
 * for the whole process. */
#include "recipe/keys.h"

#include <snowglass/extend.h>

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

void snow_recipe_init_sized(snow_recipe *recipe, size_t size) {
    snow_recipe defaults = {.width = 512, .height = 512, .zoom = 1, .fps = 25};
    for (int i = 0; i < 3; i++)
        defaults.position[i] = defaults.target[i] = defaults.up[i] = NAN;
    snow_volume_options_init(&defaults.data);
    snow_settings_init(&defaults.settings);
    snow_image_options_init(&defaults.image);
    snow_record_init(recipe, size, &defaults, sizeof defaults);
}

void snow_recipe_clear(snow_recipe *recipe) {
    json_decref(recipe->owned);
    snow_recipe_init_sized(recipe, recipe->size);
}

/* --- reading -------------------------------------------------------------- */

static snow_status take_key(snow_context *context, const char *source,
                            const char *name, const json_t *value,
                            snow_recipe *out) {
    char wrong[WRONG_BYTES];
    const recipe_key *key = recipe_keys;
    while (key->name && strcmp(key->name, name) != 0)
        key++;
    const char *now = key->name ? NULL : recipe_renamed(name);
    if (now)
        return snow_context_fail(context, SNOW_STATUS_BAD_INPUT,
                                 "%s: \"%s\" is now %s", source, name, now);
    if (!key->name)
        return snow_context_fail(context, SNOW_STATUS_BAD_INPUT,
                                 "%s: \"%.64s\" is not a key of a recipe; use "
                                 "the tool's long options without dashes",
                                 source, name);
    if (key->kind->read(key, value, (char *)out + key->field, wrong))
        return SNOW_STATUS_OK;
    return snow_context_fail(context, SNOW_STATUS_BAD_INPUT, "%s: \"%s\" %s",
                             source, name, wrong);
}

/* A window is another way to give a range. */
static snow_status take_window(snow_context *context, const char *source,
                               json_t *tree, snow_recipe *out) {
    const json_t *window = json_object_get(tree, "window");
    const json_t *width = json_array_get(window, 0),
                 *centre = json_array_get(window, 1);
    if (!window)
        return SNOW_STATUS_OK;
    double half = json_number_value(width) / 2;
    double low = json_number_value(centre) - half;
    double high = json_number_value(centre) + half;
    if (json_array_size(window) != 2 || !json_is_number(width) ||
        !json_is_number(centre) || !(low < high) || !isfinite(low) ||
        !isfinite(high) || out->range != SNOW_RANGE_AUTO)
        return snow_context_fail(context, SNOW_STATUS_BAD_INPUT,
                                 "%s: \"window\" must be [width, centre], the "
                                 "width above 0, without \"range\"",
                                 source);
    out->range = SNOW_RANGE_VALUES;
    out->low = low;
    out->high = high;
    return SNOW_STATUS_OK;
}

static snow_status take_tree(snow_context *context, const char *source,
                             json_t *tree, snow_recipe *out) {
    const char *name;
    json_t *value;
    if (!json_is_object(tree))
        return snow_context_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "%s: a recipe must be one JSON object; begin it with {", source);
    json_object_foreach(tree, name, value) {
        snow_status status = SNOW_STATUS_OK;
        if (strcmp(name, "window") != 0)
            status = take_key(context, source, name, value, out);
        if (status != SNOW_STATUS_OK)
            return status;
    }
    return take_window(context, source, tree, out);
}

/* Takes over the tree. */
static snow_status finish_recipe(snow_context *context, const char *source,
                                 json_t *tree, const json_error_t *error,
                                 snow_recipe *out) {
    snow_recipe recipe;
    if (!tree)
        return snow_context_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "%s: line %d is not valid JSON: %s; correct it", source,
            error->line, error->text);
    snow_recipe_init(&recipe);
    snow_status status = take_tree(context, source, tree, &recipe);
    if (status != SNOW_STATUS_OK) {
        json_decref(tree);
        return status;
    }
    recipe.owned = tree;
    status = SNOW_RECORD_FILL(context, snow_recipe, &recipe, out);
    if (status != SNOW_STATUS_OK)
        json_decref(tree);
    return status;
}

snow_status snow_recipe_parse(snow_context *context, const char *name,
                              const char *text, size_t bytes,
                              snow_recipe *out) {
    json_error_t error;
    json_t *tree = json_loadb(text, bytes, JSON_REJECT_DUPLICATES, &error);
    return finish_recipe(context, name, tree, &error, out);
}

snow_status recipe_read_file(snow_context *context, const char *path,
                             char **text, size_t *bytes) {
    struct stat about; /* to open a pipe could take for ever */
    FILE *file = NULL;
    if (stat(path, &about) == 0 && S_ISREG(about.st_mode))
        file = fopen(path, "rb");
    if (!file)
        return snow_context_fail(context, SNOW_STATUS_BAD_INPUT,
                                 "%s: cannot be opened; name a readable recipe",
                                 path);
    size_t capacity = (size_t)about.st_size + 1;
    *text = snow_context_allocate(context, capacity);
    *bytes = *text ? fread(*text, 1, capacity, file) : 0;
    const bool broken = ferror(file) != 0;
    fclose(file);
    if (!*text || !broken)
        return *text ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    snow_context_release(context, *text);
    *text = NULL;
    *bytes = 0;
    return snow_context_fail(context, SNOW_STATUS_BAD_INPUT,
                             "%s: cannot be read to its end; check the disk",
                             path);
}

snow_status snow_recipe_load(snow_context *context, const char *path,
                             snow_recipe *out) {
    char *text = NULL;
    size_t bytes = 0;
    snow_status status = recipe_read_file(context, path, &text, &bytes);
    if (status == SNOW_STATUS_OK)
        status = snow_recipe_parse(context, path, text, bytes, out);
    snow_context_release(context, text);
    return status;
}

/* --- writing -------------------------------------------------------------- */

snow_status snow_recipe_write(snow_context *context, const snow_recipe *given,
                              char *text, size_t capacity, size_t *length) {
    snow_recipe recipe;
    snow_status status = SNOW_RECORD_READ(context, snow_recipe, given, &recipe);
    if (status != SNOW_STATUS_OK)
        return status;
    json_t *tree = json_object();
    int failed = tree == NULL;
    for (const recipe_key *key = recipe_keys; key->name && !failed; key++) {
        json_t *value =
            key->kind->write(key, (const char *)&recipe + key->field);
        if (value)
            failed = json_object_set_new(tree, key->name, value);
    }
    size_t flags = JSON_INDENT(2) | JSON_REAL_PRECISION(17);
    size_t bytes = failed ? 0 : json_dumpb(tree, text, capacity, flags);
    json_decref(tree);
    if (!bytes)
        return snow_context_fail(
            context, SNOW_STATUS_NO_MEMORY,
            "out of memory for the text of a recipe; close other programs");
    if (capacity)
        text[bytes < capacity ? bytes : 0] = 0;
    *length = bytes;
    return SNOW_STATUS_OK;
}

/* --- applying ------------------------------------------------------------- */

snow_status snow_recipe_get_look(snow_context *context,
                                 const snow_recipe *recipe, snow_look *out) {
    snow_look look = {.size = sizeof look,
                      .preset = recipe->preset,
                      .colormap = recipe->colormap,
                      .range = recipe->range,
                      .low = recipe->low,
                      .high = recipe->high,
                      .log = recipe->log,
                      .symlog = recipe->symlog};
    if (recipe->opacity_count) {
        look.opacities = recipe->opacities;
        look.opacity_count = recipe->opacity_count;
    }
    if (recipe->gradient_opacity_count) {
        look.gradient_opacities = recipe->gradient_opacities;
        look.gradient_opacity_count = recipe->gradient_opacity_count;
    }
    return SNOW_RECORD_FILL(context, snow_look, &look, out);
}

static bool take_place(const double given[3], double out[3]) {
    if (isnan(given[0]))
        return false;
    memcpy(out, given, 3 * sizeof *out);
    return true;
}

snow_status snow_recipe_get_view(snow_context *context,
                                 const snow_recipe *recipe,
                                 const snow_view *usual, snow_view *out) {
    snow_view view;
    snow_status status = SNOW_RECORD_READ(context, snow_view, usual, &view);
    if (status == SNOW_STATUS_OK && recipe->view)
        status = snow_view_from_name(context, recipe->view, &view);
    if (status != SNOW_STATUS_OK)
        return status;
    view.width = recipe->width;
    view.height = recipe->height;
    view.azimuth = recipe->azimuth;
    view.elevation = recipe->elevation;
    view.roll = recipe->roll;
    view.zoom = recipe->zoom;
    view.fov = recipe->fov;
    view.has_position = take_place(recipe->position, view.position);
    view.has_target = take_place(recipe->target, view.target);
    view.has_view_up = take_place(recipe->up, view.view_up);
    if (view.has_position && recipe->view)
        return snow_context_fail(context, SNOW_STATUS_BAD_USAGE,
                                 "\"position\" and \"view\" both place the "
                                 "camera; give only one of them");
    return SNOW_RECORD_FILL(context, snow_view, &view, out);
}

snow_status snow_recipe_get_settings(snow_context *context,
                                     const snow_recipe *recipe,
                                     const char *unit, snow_settings *out) {
    snow_settings settings = recipe->settings;
    if (recipe->opacity_per_mm) {
        const double length = snow_unit_length(*unit ? unit : "mm", NULL);
        if (!(length > 0))
            return snow_context_fail(context, SNOW_STATUS_BAD_USAGE,
                                     "the volume's unit '%s' is not a length; "
                                     "use opacities per voxel",
                                     unit);
        settings.opacity_length = snow_unit_length("mm", NULL) / length;
    }
    return SNOW_RECORD_FILL(context, snow_settings, &settings, out);
}
