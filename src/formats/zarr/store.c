/* formats/zarr/store.c - opens the files of a Zarr array by their names.
 *
 * A chunk that was never written has no file, so that nothing at a name is an
 * answer.  Names come from numbers and from checked paths: none leads out of
 * the store, but for links that the owner of the folder has made. */
#include "base/monitor.h"
#include "formats/zarr/zarr.h"
#include "io/folder.h"
#include "io/lookup.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* The most names in one folder: a plate has hundreds of wells. */
#define MOST_NAMES 10000

snow_status snow_zarr_join(const zarr_store *store, const char *path,
                           const char *name, char *out) {
    const char *slash = *path && *name ? "/" : "";
    int size = snprintf(out, ZARR_PATH_BYTES, "%s%s%s", path, slash, name);
    return size >= 0 && size < ZARR_PATH_BYTES
               ? SNOW_STATUS_OK
               : snow_zarr_fail(store, "",
                                "a path is longer than %d letters; move the "
                                "folder up",
                                ZARR_PATH_BYTES);
}

/* --- files ---------------------------------------------------------------- */

static snow_status fail_by_errno(const zarr_file *file, const char *done) {
    return snow_lookup_fail(file->store->context, file->name, done);
}

/* Checks the kind first, since opening a device can have side effects. */
snow_status snow_zarr_open(const zarr_store *store, const char *name,
                           zarr_file *out) {
    struct stat about;
    mode_t mode;
    *out = (zarr_file){.store = store, .descriptor = -1};
    snprintf(out->name, sizeof out->name, "%s%s%s", store->folder,
             *name ? "/" : "", name);
    SNOW_TRY(snow_look_for(store->context, out->name, &mode));
    if (!mode)
        return SNOW_STATUS_OK;
    if (!S_ISREG(mode))
        return snow_fail(store->context, SNOW_STATUS_BAD_INPUT,
                         "%s: is not a regular file, which is required here; "
                         "copy the array again",
                         out->name);
    out->descriptor =
        open(out->name, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (out->descriptor < 0 || fstat(out->descriptor, &about) ||
        !S_ISREG(about.st_mode)) {
        snow_status status = fail_by_errno(out, "opened");
        snow_zarr_close(out);
        return status;
    }
    out->is_there = true;
    out->size = (uint64_t)about.st_size;
    return SNOW_STATUS_OK;
}

void snow_zarr_close(zarr_file *file) {
    if (file->descriptor >= 0)
        close(file->descriptor);
    file->descriptor = -1;
}

snow_status snow_zarr_read(const zarr_file *file, uint64_t first,
                           unsigned char *bytes, size_t count) {
    for (size_t done = 0; done < count;) {
        ssize_t got =
            pread(file->descriptor, bytes + done,
                  snow_monitor_chunk(file->store->context, count - done),
                  (off_t)(first + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return fail_by_errno(file, "read");
        if (got == 0)
            return snow_fail(file->store->context, SNOW_STATUS_BAD_INPUT,
                             "%s: cannot be read to the end; check the disk",
                             file->name);
        done += (size_t)got;
        file->store->context->bytes_read += (uint64_t)got;
        SNOW_TRY(snow_monitor_read(file->store->context, (uint64_t)got));
    }
    return SNOW_STATUS_OK;
}

/* --- names in a folder ---------------------------------------------------- */

typedef struct name_list {
    char (*names)[256];
    size_t count;
} name_list;

static snow_status add_name(const zarr_store *store, name_list *list,
                            const char *name) {
    if (list->count == MOST_NAMES)
        return snow_fail(store->context, SNOW_STATUS_BAD_INPUT,
                         "has more than %d folders in one; name an array with "
                         "--dataset",
                         MOST_NAMES);
    SNOW_TRY(SNOW_RESERVE(store->context, list->names, list->count,
                          list->count + 1));
    snprintf(list->names[list->count++], sizeof *list->names, "%s", name);
    return SNOW_STATUS_OK;
}

static snow_status list_folder(const zarr_store *store, const char *path,
                               name_list *list) {
    char folder[2 * ZARR_PATH_BYTES + 1], whole[sizeof folder + NAME_MAX + 1];
    const int length =
        snprintf(folder, sizeof folder, "%s/%s", store->folder, path);
    DIR *stream = opendir(folder);
    if (!stream)
        return snow_lookup_fail(store->context, folder, "listed");
    const struct dirent *entry;
    snow_status status = SNOW_STATUS_OK;
    while (status == SNOW_STATUS_OK && (errno = 0, entry = readdir(stream))) {
        mode_t mode = 0;
        if (*entry->d_name == '.')
            continue;
        snprintf(whole, sizeof whole, "%s%s%s", folder,
                 folder[length - 1] == '/' ? "" : "/", entry->d_name);
        status = snow_look_at_given(store->context, whole, &mode);
        if (status == SNOW_STATUS_OK && S_ISDIR(mode))
            status = add_name(store, list, entry->d_name);
    }
    if (status == SNOW_STATUS_OK && errno)
        status = snow_lookup_fail(store->context, folder, "listed to its end");
    closedir(stream);
    return status;
}

static int compare_names(const void *a, const void *b) {
    return snow_name_compare(a, b);
}

snow_status snow_zarr_visit(const zarr_store *store, const char *path,
                            zarr_visit_fn *visit, void *user) {
    name_list list = {0};
    snow_status status = list_folder(store, path, &list);
    if (status == SNOW_STATUS_OK && list.count)
        qsort(list.names, list.count, sizeof *list.names, compare_names);
    for (size_t i = 0; i < list.count && status == SNOW_STATUS_OK; i++)
        status = visit(user, list.names[i]);
    snow_release(store->context, list.names);
    return status;
}
