/* describe.c - says of files what they are, by their headers; see folder.h. */
#include "folder/inside.h"
#include "folder/own.h"
#include "options/config_paths.h"

#include <snowglass/recipe.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* No recipe is longer. */
#define RECIPE_BYTES (1 << 20)

/* Of a folder whose largest series cannot be read, so that it does not say how
 * many there are. */
#define SERIES_MOST 1024

snow_status describe(folder *f, const char *path, const char *series,
                     snow_volume_info *info) {
    snow_volume_options data = {.size = sizeof data,
                                .series = series,
                                .each_time = true,
                                .each_channel = true,
                                .allow_gaps = f->base->allow_gaps};
    snow_volume_info_init(info);
    return snow_volume_inspect(f->context, path, &data, info);
}

void describe_add(folder *f, const char *name, const char *series,
                  const char *day, const snow_volume_info *info) {
    char path[PATH_MAX];
    struct stat what;
    folder_entry made = {.kind = ENTRY_VOLUME,
                         .name = strdup(name),
                         .info = malloc(sizeof *info)};
    if (made.info)
        *made.info = *info;
    snprintf(made.series, sizeof made.series, "%s", series);
    snprintf(made.day, sizeof made.day, "%s", day);
    if (list_path(f, name, path) && stat(path, &what) == 0) {
        made.bytes = S_ISREG(what.st_mode) ? (uint64_t)what.st_size : 0;
        made.changed = what.st_mtim.tv_sec;
    }
    list_add(f, &made);
}

/* Whether a file is none of a volume, by what is said of it: there are notes
 * and tables beside volumes, and data whose header is another file. */
static bool is_other(const char *why) {
    static const char *const words[] = {"unknown format", ": is raw data",
                                        "not a volume", "is empty"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strstr(why, words[i]))
            return true;
    return false;
}

/* A picture of its own is none, unless it has several slices. */
static bool is_picture(const snow_volume_info *info) {
    return strcmp(info->format, "png") == 0 ||
           strcmp(info->format, "jpeg") == 0 ||
           (strcmp(info->format, "tiff") == 0 && info->dims[2] == 1);
}

bool describe_file(folder *f, const char *name) {
    char path[PATH_MAX];
    snow_volume_info info;
    if (!list_path(f, name, path))
        return false;
    const snow_status status = describe(f, path, NULL, &info);
    const char *why = snow_context_message(f->context);
    if (status == SNOW_STATUS_OK && strcmp(info.format, "dicom") == 0)
        return true;
    if (status == SNOW_STATUS_STOPPED)
        return false;
    if (status == SNOW_STATUS_OK ? is_picture(&info) : is_other(why))
        list_count_out(f);
    else if (status == SNOW_STATUS_OK)
        describe_add(f, name, "", "", &info);
    else
        list_add_fault(f, name, why);
    return false;
}

/* --- DICOM ---------------------------------------------------------------- */

/* The reader says how many there are where nobody has chosen one. */
static void hear_count(void *user, const char *text) {
    static const char words[] = " series of images";
    const char *at = strstr(text, words);
    int64_t count = 0, digit = 1;
    for (; at && at > text && at[-1] >= '0' && at[-1] <= '9'; at--, digit *= 10)
        count += digit * (at[-1] - '0');
    if (count > 1)
        *(int64_t *)user = count;
}

int64_t describe_count(snow_context *context, const char *path,
                       const snow_volume_options *data, snow_volume_info *info,
                       snow_status *status) {
    int64_t count = 1;
    snow_context_set_warning(context, hear_count, &count);
    *status = snow_volume_inspect(context, path, data, info);
    snow_context_set_warning(context, NULL, NULL);
    return *status == SNOW_STATUS_OK && strcmp(info->format, "dicom") == 0
               ? count
               : 0;
}

/* A UID stays when files come; a number is that of the list. */
static void add_series(folder *f, const char *name, const snow_volume_info *all,
                       const bool *good, size_t count) {
    days_of_folder days;
    days_read(f, name, &days);
    for (size_t i = 0; i < count; i++) {
        const day_of_series *day = days_find(&days, i, count);
        char number[24];
        snprintf(number, sizeof number, "%zu", i);
        if (good[i])
            describe_add(f, name, day ? day->uid : number, day ? day->day : "",
                         &all[i]);
    }
    days_free(&days);
}

static void describe_each(folder *f, const char *name, const char *path,
                          size_t most) {
    snow_volume_info *all = calloc(most, sizeof *all);
    bool *good = calloc(most, sizeof *good);
    size_t count = 0;
    while (all && good && count < most && cover_serve(f)) {
        char number[24], label[PATH_MAX + 32];
        snprintf(number, sizeof number, "%zu", count);
        const snow_status status = describe(f, path, number, &all[count]);
        good[count] = status == SNOW_STATUS_OK;
        if (status == SNOW_STATUS_BAD_USAGE || status == SNOW_STATUS_STOPPED)
            break; /* there is no such series */
        snprintf(label, sizeof label, "%s, series %zu", name, count);
        if (!good[count])
            list_add_fault(f, label, snow_context_message(f->context));
        count++;
    }
    if (all && good)
        add_series(f, name, all, good, count);
    free(all);
    free(good);
}

/* One series alone may be joined of several (formats/dicom/groups.c). */
static void add_alone(folder *f, const char *name,
                      const snow_volume_info *info) {
    days_of_folder days;
    days_read(f, name, &days);
    describe_add(f, name, "", days.count ? days.series[0].day : "", info);
    days_free(&days);
}

void describe_series(folder *f, const char *name) {
    char path[PATH_MAX], where[NAME_MAX + 1], why[NAME_MAX + 200];
    snow_volume_options data = {.size = sizeof data,
                                .each_time = true,
                                .each_channel = true,
                                .allow_gaps = f->base->allow_gaps};
    snow_volume_info info;
    snow_status status;
    if (!list_path(f, name, path))
        return;
    if (!inside_root(f->real, path, where)) {
        snprintf(why, sizeof why,
                 "%s: leads out of the folder that was given, or cannot be "
                 "looked at; name the folder of the slices alone",
                 where);
        list_add_fault(f, name, why);
        return;
    }
    snow_volume_info_init(&info);
    const int64_t count =
        describe_count(f->context, path, &data, &info, &status);
    if (count == 1)
        add_alone(f, name, &info);
    else if (status != SNOW_STATUS_STOPPED)
        describe_each(f, name, path, count ? (size_t)count : SERIES_MOST);
}

/* --- recipes -------------------------------------------------------------- */

/* Many tables beside volumes are JSON too; a recipe names its volume. */
json_t *describe_recipe_tree(const char *path) {
    struct stat what;
    snow_context *context = NULL;
    snow_recipe read = {.size = sizeof read};
    json_t *tree = NULL;
    if (stat(path, &what) == 0 && S_ISREG(what.st_mode) &&
        what.st_size <= RECIPE_BYTES)
        tree = json_load_file(path, JSON_REJECT_DUPLICATES, NULL);
    bool good = json_is_string(json_object_get(tree, "input")) &&
                snow_context_new(NULL, &context) == SNOW_STATUS_OK &&
                snow_recipe_load(context, path, &read) == SNOW_STATUS_OK;
    if (good)
        snow_recipe_clear(&read);
    snow_context_free(context);
    if (!good) {
        json_decref(tree);
        return NULL;
    }
    config_paths_read(tree, path);
    return tree;
}

/* Of what it names only the file's name is shown. */
void describe_recipe(folder *f, const char *name) {
    char path[PATH_MAX];
    struct stat what;
    json_t *tree = list_path(f, name, path) ? describe_recipe_tree(path) : NULL;
    const char *input = json_string_value(json_object_get(tree, "input"));
    if (!input || stat(path, &what) != 0) {
        json_decref(tree);
        list_count_out(f);
        return;
    }
    const char *slash = strrchr(input, '/');
    const folder_entry made = {.kind = ENTRY_RECIPE,
                               .name = strdup(name),
                               .text = strdup(slash ? slash + 1 : input),
                               .bytes = (uint64_t)what.st_size,
                               .changed = what.st_mtim.tv_sec};
    list_add(f, &made);
    json_decref(tree);
}
