/* recipe_file.c - implements recipe_file.h. */
#include "recipe_file.h"
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
