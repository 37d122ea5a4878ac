/* info_list.c - implements info_list.h.
 *
 * Headers alone are read, so that a folder of large files is listed at once. */
#define _XOPEN_SOURCE 700
#include "commands/info_list.h"
#include "commands/commands.h"
#include "run/log.h"
#include "run/paths.h"

#include <dirent.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int is_shown(const struct dirent *entry) {
    return entry->d_name[0] != '.';
}

/* Reads a header in a context of its own, whose messages are dropped if
 * `quiet`. */
static int inspect(const options *opts, const char *path, bool quiet,
                   snow_volume_info *out) {
    snow_context *context = NULL;
    options listed = *opts;
    if (quiet)
        listed.verbosity = -1;
    listed.allow_gaps = true;
    int done = open_context(&listed, &context);
    if (done != CONTINUE)
        return done;
    snow_volume_options data = data_options(&listed);
    snow_status status = snow_volume_inspect(context, path, &data, out);
    if (status != SNOW_STATUS_OK)
        done = quiet ? (int)status : fail_status(context, status);
    snow_context_free(context);
    return done;
}

/* The entries of a folder by name; -1 if it cannot be read. */
static int entries_of(const char *folder, struct dirent ***out) {
    return scandir(folder, out, is_shown, alphasort);
}

static void free_entries(struct dirent **entries, int count) {
    for (int i = 0; i < count; i++)
        free(entries[i]);
    free(entries);
}

static bool path_in(const char *folder, const char *name, char out[PATH_MAX]) {
    size_t length = strlen(folder);
    bool slash = length && folder[length - 1] == '/';
    return snprintf(out, PATH_MAX, "%s%s%s", folder, slash ? "" : "/", name) <
           PATH_MAX;
}

/* Whether what a folder holds is a volume by itself, and no part of one that
 * the folder should be: a slice, or an array of a Zarr group. */
static bool stands_alone(const char *path, const snow_volume_info *info) {
    if (strcmp(info->format, "dicom") == 0)
        return is_folder(path);
    if (strcmp(info->format, "zarr") == 0)
        return ends_with(path, ".zarr");
    return strcmp(info->format, "png") != 0 &&
           (strcmp(info->format, "tiff") != 0 || info->dims[2] > 1);
}

/* The suffix of a name; "" also for numbers, as in slice.001. */
static const char *suffix_of(const char *name) {
    const char *dot = strrchr(name, '.');
    return dot && dot[1 + strspn(dot + 1, "0123456789")] ? dot : "";
}

/* Of names with one suffix no more are read than up to the first slice: each
 * slice of a series reads the headers of all others. */
static bool holds_volumes(const options *opts, const char *folder) {
    struct dirent **entries = NULL;
    snow_volume_info info = {.size = sizeof info};
    char path[PATH_MAX];
    const char *slices = NULL;
    bool found = false;
    int count = entries_of(folder, &entries);
    for (int i = 0; i < count && !found; i++) {
        const char *suffix = suffix_of(entries[i]->d_name);
        if (!path_in(folder, entries[i]->d_name, path) ||
            (slices && strcmp(slices, suffix) == 0 && !is_folder(path)) ||
            inspect(opts, path, true, &info) != CONTINUE)
            continue;
        found = stands_alone(path, &info);
        if (!found)
            slices = suffix;
    }
    free_entries(entries, count);
    return found;
}

bool info_is_list(const options *opts) {
    snow_volume_info info = {.size = sizeof info};
    if (opts->operand_count != 1)
        return opts->operand_count > 1;
    const char *path = opts->operands[0];
    if (opts->series || opts->dataset || !is_folder(path))
        return false;
    /* Slices among volumes of their own are no reason to hide these. */
    if (inspect(opts, path, true, &info) == CONTINUE &&
        strcmp(info.format, "dicom") != 0 && strcmp(info.format, "png") != 0 &&
        strcmp(info.format, "tiff") != 0)
        return false;
    return holds_volumes(opts, path);
}

/* --- the list ------------------------------------------------------------- */

static void print_row(const char *path, const snow_volume_info *info,
                      json_t *list) {
    char text[256];
    if (list) {
        json_t *row = json_object();
        json_object_set_new(row, "path", json_string(path));
        info_set_geometry(row, info);
        json_array_append_new(list, row);
        return;
    }
    describe_volume(info, text, sizeof text);
    printf("%s: %s", path, text);
    if (info->times > 1)
        printf(", %" PRId64 " time steps", info->times);
    printf("\n");
}

/* Lists one volume; a fault is printed, and the list goes on. */
static int list_file(const options *opts, const char *path, json_t *list) {
    snow_volume_info info = {.size = sizeof info};
    int done = inspect(opts, path, false, &info);
    if (done == CONTINUE)
        print_row(name_of_input(path), &info, list);
    return done;
}

static void list_folder(const options *opts, const char *folder, json_t *list) {
    struct dirent **entries = NULL;
    char path[PATH_MAX];
    int count = entries_of(folder, &entries);
    for (int i = 0; i < count; i++)
        if (path_in(folder, entries[i]->d_name, path))
            list_file(opts, path, list);
    free_entries(entries, count);
}

static int list_operand(const options *opts, const char *path, json_t *list) {
    options one = *opts;
    one.operands = (char *[]){(char *)path};
    one.operand_count = 1;
    if (!info_is_list(&one))
        return list_file(opts, path, list);
    list_folder(opts, path, list);
    return CONTINUE;
}

int info_list(const options *opts) {
    json_t *list = opts->json ? json_array() : NULL;
    int fault = SNOW_STATUS_OK;
    for (int i = 0; i < opts->operand_count; i++) {
        int done = list_operand(opts, opts->operands[i], list);
        if (done != CONTINUE && fault == SNOW_STATUS_OK)
            fault = done;
    }
    int printed = list ? print_json(list) : finish_stdout();
    return fault == SNOW_STATUS_OK ? printed : fault;
}
