/* recipe_file.c - implements recipe_file.h. */
#include "recipe_file.h"
#include "answers/answers.h"
#include "options/config.h"
#include "options/config_paths.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

/* The folder of a volume with its slash, "" for none: of /data/run.h5:/density
 * and of the DICOM folder /data/head/ it is /data/. */
static void folder_of(const char *path, char out[PATH_MAX]) {
    const char *within = strstr(path, ":/");
    size_t length = within ? (size_t)(within - path) : strlen(path);
    while (length > 0 && path[length - 1] == '/')
        length--;
    while (length > 0 && path[length - 1] != '/')
        length--;
    snprintf(out, PATH_MAX, "%.*s", (int)length, path);
}

/* Of a path that begins with / what is below the folder. */
static void shorten(json_t *path, const char *folder) {
    const char *text = json_string_value(path);
    size_t length = strlen(folder);
    if (*folder != '/' || !text || strncmp(text, folder, length) != 0)
        return;
    json_t *rest = json_string(text + length); /* the old text goes */
    json_string_set(path, json_string_value(rest));
    json_decref(rest);
}

json_t *recipe_file_tree(const drawing *d) {
    static const char *const keys[] = {"input", "tf", "mask", "overlay"};
    static options opts; /* large; one thread draws */
    char beside[PATH_MAX + 8], folder[PATH_MAX];
    drawing_options(d, &opts);
    opts.output = NULL;
    json_t *tree = config_tree(&opts, verb_of(VERB_RENDER));
    if (!tree || strstr(opts.operands[0], "://"))
        return tree;
    folder_of(opts.operands[0], folder);
    snprintf(beside, sizeof beside, "%sx.json", folder);
    config_paths_write(tree, beside);
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        shorten(json_object_get(tree, keys[i]), folder);
    return tree;
}

json_t *recipe_first(const options *opts) {
    json_t *tree = config_tree(opts, verb_of(VERB_RENDER));
    static const char *const unwanted[] = {"input",     "output",  "depth",
                                           "verb",      "version", "quality",
                                           "overwrite", "bits"};
    for (size_t i = 0; i < sizeof unwanted / sizeof *unwanted; i++)
        json_object_del(tree, unwanted[i]);
    return tree;
}

static bool has_one(const json_t *tree, const char *const *keys) {
    for (; *keys; keys++)
        if (json_object_get(tree, *keys))
            return true;
    return false;
}

/* Of a projection colours and their ends, which are all that it has. */
static json_t *projected(const drawing *d) {
    snow_look look = {.size = sizeof look};
    double low, high;
    if (!mode_is_projection(d->opts.mode) ||
        snow_transfer_get_look(d->state.transfer, &look) != SNOW_STATUS_OK)
        return NULL;
    snow_transfer_domain(d->state.transfer, &low, &high);
    return json_pack("{s:[f,f], s:o*}", "range", low, high, "colormap",
                     answer_colormap(&look));
}

/* What was chosen from the values becomes numbers, so that another volume gets
 * the same look; a preset stays one, since it says how it is spread. */
static void add_chosen(const drawing *d, json_t *tree) {
    static const char *const whole[] = {"preset", "tf", "channel", NULL},
                             *const ends[] = {"window", NULL};
    if (has_one(tree, whole))
        return;
    json_t *chosen = answer_look_keys(d);
    if (!chosen && snow_transfer_label(d->state.transfer, 0))
        chosen = json_pack("{s:s}", "preset", "labels");
    if (!chosen)
        chosen = projected(d);
    if (has_one(tree, ends))
        json_object_del(chosen, "range");
    if (json_object_get(tree, "colormap"))
        json_object_del(chosen, "preset");
    json_object_update_missing(tree, chosen);
    json_decref(chosen);
}

json_t *look_file_tree(const drawing *d) {
    static const char *const names[] = {
        "version", "preset",           "colormap", "tf",     "scale",
        "opacity", "gradient-opacity", "range",    "window", "opacity-unit",
        "shade",   "material"};
    const channel_list *mixed = &d->state.channels.list;
    json_t *all = recipe_file_tree(d), *tree = json_object();
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (json_object_get(all, names[i]))
            json_object_set(tree, names[i], json_object_get(all, names[i]));
    if (mixed->count) {
        char text[1024];
        channels_text(mixed, text, sizeof text);
        json_object_set_new(tree, "channel", json_string(text));
    }
    add_chosen(d, tree);
    json_decref(all);
    return tree;
}
