/* info_list.c - implements info_list.h.
 *
 * Headers alone are read, so that a folder of large files is listed at once. */
#define _XOPEN_SOURCE 700
#include "commands/info_list.h"
#include "commands/commands.h"
#include "commands/info_volume.h"
#include "run/log.h"
#include "run/paths.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static int is_shown(const struct dirent *entry) {
    return entry->d_name[0] != '.';
}

/* Whether a volume can be described by its header; nothing is printed. */
static bool probe(const options *opts, const char *path,
                  snow_volume_info *out) {
    snow_context *context = NULL;
    snow_volume_options data = data_options(opts);
    data.allow_gaps = true;
    snow_status status = snow_context_new(NULL, &context);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_inspect(context, path, &data, out);
    snow_context_free(context);
    return status == SNOW_STATUS_OK;
}

/* Whether a file has the mark of DICOM (PS3.10, 7.1).  Files of old programs
 * may lack it; they are recognised when they are opened. */
static bool has_dicom_mark(const char *path) {
    char head[132];
    FILE *file = is_file(path) ? fopen(path, "rb") : NULL;
    bool marked = file && fread(head, 1, sizeof head, file) == sizeof head &&
                  memcmp(head + 128, "DICM", 4) == 0;
    if (file)
        fclose(file);
    return marked;
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

/* False for a pipe or a device, which may keep who opens it waiting.  What
 * cannot be looked at is opened, which says why. */
static bool path_in(const char *folder, const char *name, char out[PATH_MAX]) {
    size_t length = strlen(folder);
    bool slash = length && folder[length - 1] == '/';
    struct stat what;
    return snprintf(out, PATH_MAX, "%s%s%s", folder, slash ? "" : "/", name) <
               PATH_MAX &&
           (stat(out, &what) != 0 || S_ISREG(what.st_mode) ||
            S_ISDIR(what.st_mode));
}

/* Whether files of the format may be the slices of one volume. */
static bool are_images(const snow_volume_info *info) {
    return strcmp(info->format, "png") == 0 ||
           strcmp(info->format, "jpeg") == 0 ||
           strcmp(info->format, "tiff") == 0;
}

/* Whether what a folder holds is a volume by itself, and no part of one that
 * the folder should be: a slice, or an array of a Zarr group. */
static bool stands_alone(const char *path, const snow_volume_info *info) {
    if (strcmp(info->format, "dicom") == 0)
        return is_folder(path);
    if (strcmp(info->format, "zarr") == 0)
        return ends_with(path, ".zarr");
    return !are_images(info) ||
           (strcmp(info->format, "tiff") == 0 && info->dims[2] > 1);
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
        /* The suffix of a name; "" also for numbers, as in slice.001. */
        const char *dot = strrchr(entries[i]->d_name, '.');
        const char *suffix =
            dot && dot[1 + strspn(dot + 1, "0123456789")] ? dot : "";
        if (!path_in(folder, entries[i]->d_name, path) ||
            (slices && strcmp(slices, suffix) == 0 && !is_folder(path)) ||
            has_dicom_mark(path) || !probe(opts, path, &info))
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
    /* Slices among volumes of their own are no reason to hide these; files that
     * lead to one another are one volume. */
    if (probe(opts, path, &info) &&
        ((strcmp(info.format, "dicom") != 0 && !are_images(&info)) ||
         strncmp(info.storage, "set of", 6) == 0))
        return false;
    return holds_volumes(opts, path);
}

/* --- the list ------------------------------------------------------------- */

typedef struct row {
    const char *path;
    snow_volume_info info;
    char patient[256]; /* "": not requested, or not in the file */
} row;

static void print_row(const row *r) {
    char text[256];
    describe_volume(&r->info, text, sizeof text);
    printf("%s: %s", r->path, text);
    if (r->info.components > 1)
        printf(", %" PRId64 " components", r->info.components);
    if (r->info.times > 1)
        printf(", %" PRId64 " time steps", r->info.times);
    if (*r->patient)
        printf(", patient %s", r->patient);
    printf("\n");
}

/* The name is known to a volume only, of which one voxel is read; of the
 * formats DICOM alone has names. */
static void find_patient(snow_context *context, const options *opts,
                         const char *path, row *r) {
    snow_volume *volume = NULL;
    options one = *opts;
    if (!opts->patient || strcmp(r->info.format, "dicom") != 0)
        return;
    for (int i = 0; i < 3; i++) {
        one.crop[i][0] = 0;
        one.crop[i][1] = 1;
    }
    show_warnings(opts, context, false);
    snow_volume_options data = data_options(&one);
    data.allow_gaps = true;
    if (snow_volume_open(context, path, &data, &volume) == SNOW_STATUS_OK)
        snprintf(r->patient, sizeof r->patient, "%s",
                 snow_volume_patient(volume));
    snow_volume_close(volume);
}

/* Lists one volume; a fault is printed, and the list goes on. */
static int list_file(const options *opts, const char *path, json_t *list) {
    snow_context *context = NULL;
    row r = {name_of_input(path), {.size = sizeof r.info}, ""};
    int done = open_context(opts, &context);
    if (done == CONTINUE)
        done = info_open(context, opts, path, &r.info, NULL);
    if (done == CONTINUE)
        find_patient(context, opts, path, &r);
    if (done == CONTINUE && list) {
        json_t *object = json_object();
        json_object_set_new(object, "path", json_string(r.path));
        info_set_geometry(object, &r.info);
        if (*r.patient)
            json_object_set_new(object, "patient", json_string(r.patient));
        json_array_append_new(list, object);
    } else if (done == CONTINUE) {
        print_row(&r);
    }
    snow_context_free(context);
    return done;
}

/* The DICOM files of a folder are listed once, as the folder: a slice stands
 * for its whole series, so that each would cost the headers of all. */
static int list_folder(const options *opts, const char *folder, json_t *list) {
    struct dirent **entries = NULL;
    char path[PATH_MAX];
    bool series = false;
    int count = entries_of(folder, &entries);
    if (count < 0) {
        say("%s: cannot be listed: %s; check the name and the permissions",
            folder, strerror(errno));
        return SNOW_STATUS_BAD_INPUT;
    }
    for (int i = 0; i < count; i++) {
        if (!path_in(folder, entries[i]->d_name, path))
            continue;
        bool slice = has_dicom_mark(path);
        if (!slice || !series)
            list_file(opts, slice ? folder : path, list);
        series |= slice;
    }
    free_entries(entries, count);
    return CONTINUE;
}

int info_list(const options *opts) {
    json_t *list = opts->json ? json_array() : NULL;
    int fault = SNOW_STATUS_OK;
    for (int i = 0; i < opts->operand_count; i++) {
        options one = *opts;
        int done = CONTINUE;
        one.operands += i;
        one.operand_count = 1;
        if (info_is_list(&one))
            list_folder(opts, *one.operands, list);
        else
            done = list_file(opts, *one.operands, list);
        if (done != CONTINUE && fault == SNOW_STATUS_OK)
            fault = done;
    }
    int printed = list ? print_json(list) : finish_stdout();
    return fault == SNOW_STATUS_OK ? printed : fault;
}
