/* config_paths.c - implements config_paths.h.
 *
 * A path that begins with /, a phantom, an address and "-" stay as they are. */
#define _XOPEN_SOURCE 700
#include "options/config_paths.h"

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Converts a path for a configuration in a folder; false: it stays. */
typedef bool convert(const char *folder, const char *path, char out[PATH_MAX]);

static bool is_relative(const char *path) {
    return *path && *path != '/' && strcmp(path, "-") != 0 &&
           strncmp(path, "phantom:", 8) != 0 && !strstr(path, "://");
}

/* The folder part of a path, with its slash; "" for none. */
static void folder_of(const char *path, char out[PATH_MAX]) {
    const char *slash = strrchr(path, '/');
    snprintf(out, PATH_MAX, "%.*s", slash ? (int)(slash - path + 1) : 0, path);
}

static bool convert_read(const char *folder, const char *path,
                         char out[PATH_MAX]) {
    return is_relative(path) &&
           snprintf(out, PATH_MAX, "%s%s", folder, path) < PATH_MAX;
}

/* The path without links, of a file that need not be there. */
static bool resolve(const char *path, char out[PATH_MAX]) {
    char folder[PATH_MAX], real[PATH_MAX];
    folder_of(path, folder);
    const char *name = path + strlen(folder);
    return realpath(*folder ? folder : ".", real) &&
           snprintf(out, PATH_MAX, "%s/%s", strcmp(real, "/") ? real : "",
                    name) < PATH_MAX;
}

/* Bytes of the folders that both paths begin with. */
static size_t common_folders(const char *a, const char *b) {
    size_t common = 0;
    for (size_t i = 0; a[i] && a[i] == b[i]; i++)
        if (a[i] == '/')
            common = i + 1;
    return common;
}

/* A path that has nothing but the root in common with the folder is given
 * whole. */
static bool convert_write(const char *folder, const char *path,
                          char out[PATH_MAX]) {
    char from[PATH_MAX], real[PATH_MAX], to[PATH_MAX];
    if (!is_relative(path) || !realpath(folder, real) || !resolve(path, to) ||
        snprintf(from, sizeof from, "%s/", strcmp(real, "/") ? real : "") >=
            PATH_MAX)
        return false;
    size_t common = common_folders(from, to), used = 0;
    for (const char *at = from + common; common > 1 && *at; at++)
        if (*at == '/' && used + 4 < PATH_MAX)
            used += (size_t)snprintf(out + used, PATH_MAX - used, "../");
    return snprintf(out + used, PATH_MAX - used, "%s",
                    to + (common > 1 ? common : 0)) < (int)(PATH_MAX - used);
}

/* The path of a file, without that of a dataset in it (run.h5:/density). */
static void convert_text(json_t *text, const char *folder, convert *how) {
    char path[PATH_MAX];
    const char *given = json_string_value(text);
    const char *within = given ? strstr(given, ":/") : NULL;
    char file[PATH_MAX], whole[2 * PATH_MAX];
    if (!given)
        return;
    snprintf(file, sizeof file, "%.*s",
             (int)(within ? within - given : (ptrdiff_t)strlen(given)), given);
    if (!how(folder, file, path))
        return;
    snprintf(whole, sizeof whole, "%s%s", path, within ? within : "");
    json_string_set(text, whole);
}

static void convert_tree(json_t *tree, const char *config, convert *how) {
    static const char *const keys[] = {"input", "output",      "depth",  "tf",
                                       "mask",  "label-table", "overlay"};
    char folder[PATH_MAX];
    folder_of(config, folder);
    if (!*folder) /* the working folder */
        return;
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        json_t *value = json_object_get(tree, keys[i]);
        convert_text(value, folder, how);
        for (size_t n = 0; n < json_array_size(value); n++)
            convert_text(json_array_get(value, n), folder, how);
    }
}

void config_paths_read(json_t *tree, const char *config) {
    convert_tree(tree, config, convert_read);
}

void config_paths_write(json_t *tree, const char *config) {
    convert_tree(tree, config, convert_write);
}
