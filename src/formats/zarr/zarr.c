/* formats/zarr/zarr.c - reads arrays and images of Zarr, versions 2 and 3, as
 * volumes.
 *
 * An array is a folder of files, so a path is read, not a source; the metadata
 * files stand for their folder. */
#define _XOPEN_SOURCE 700 /* realpath */

#include "formats/zarr/zarr.h"
#include "io/folder.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const marks[] = {".zarray", ".zgroup", ".zattrs",
                                    "zarr.json"};

/* The most groups above a path that are searched. */
#define MOST_ABOVE 8

/* --- which folder --------------------------------------------------------- */

/* The length of a path without slashes at its end. */
static size_t path_letters(const char *path) {
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/')
        length--;
    return length;
}

static bool has_marks(snow_context *context, const char *path, size_t length) {
    char mark[ZARR_PATH_BYTES + 16];
    for (size_t i = 0; i < sizeof marks / sizeof *marks; i++) {
        int size =
            snprintf(mark, sizeof mark, "%.*s/%s", (int)length, path, marks[i]);
        if (size > 0 && (size_t)size < sizeof mark &&
            snow_is_there(context, mark, (size_t)size))
            return true;
    }
    return false;
}

bool snow_zarr_is(snow_context *context, const char *path) {
    size_t length = path_letters(path);
    return length < ZARR_PATH_BYTES && snow_is_folder(context, path) &&
           (has_marks(context, path, length) ||
            (length > 5 && !strncmp(path + length - 5, ".zarr", 5)));
}

/* The offset of the last part of a path. */
static size_t last_part(const char *path, size_t length) {
    while (length && path[length - 1] != '/')
        length--;
    return length;
}

/* Returns whether a path such as "2" or "a/.." does not show the folder
 * above. */
static bool hides_above(const char *path, size_t length) {
    size_t last = last_part(path, length), letters = length - last;
    return !last || (letters <= 2 && !strncmp(path + last, "..", letters));
}

/* The length of a path up to the highest group above it; the full length if
 * there is none. */
static size_t find_root(snow_context *context, const char *path,
                        size_t length) {
    for (int i = 0; i < MOST_ABOVE && !hides_above(path, length); i++) {
        size_t above = last_part(path, length) - 1;
        if (!above || !has_marks(context, path, above))
            break;
        length = above;
    }
    return length;
}

/* The highest group above a path is the store, and the rest of the path and the
 * data set are a path in it: an image's metadata are above its arrays. */
static snow_status open_store(snow_context *context, const char *path,
                              const char *dataset, zarr_store *store,
                              char inside[ZARR_PATH_BYTES]) {
    char whole[PATH_MAX];
    size_t length = path_letters(path);
    if (hides_above(path, length) && realpath(path, whole)) {
        size_t real = path_letters(whole);
        if (find_root(context, whole, real) < real) {
            path = whole;
            length = real;
        }
    }
    size_t root =
        length < ZARR_PATH_BYTES ? find_root(context, path, length) : length;
    size_t skip = root == length ? length : root + 1;
    while (dataset && *dataset == '/')
        dataset++;
    int size =
        snprintf(inside, ZARR_PATH_BYTES, "%.*s%s%s", (int)(length - skip),
                 path + skip, length > skip && dataset && *dataset ? "/" : "",
                 dataset ? dataset : "");
    if (length >= ZARR_PATH_BYTES || size >= ZARR_PATH_BYTES)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "the path is longer than %d letters; move the folder "
                         "up",
                         ZARR_PATH_BYTES);
    inside[path_letters(inside)] = 0;
    *store = (zarr_store){.context = context};
    memcpy(store->folder, path, root);
    return SNOW_STATUS_OK;
}

/* --- a volume ------------------------------------------------------------- */

/* Sizes by meaning, and the requested channel or component and time. */
static snow_status pick(snow_context *context,
                        const snow_volume_options *options, zarr_box *box,
                        snow_volume_info *info) {
    const zarr_array *array = box->array;
    const snow_axes *roles = &box->roles;
    int64_t channel;
    SNOW_TRY(snow_volume_pick_axes(context, options, roles, array->sizes, info,
                                   &channel));
    for (int i = 0; i < array->axes; i++) {
        int64_t at = i == roles->channel ? channel
                     : i == roles->time  ? info->time
                                         : 0;
        box->first[i] = at;
        box->end[i] = at + 1;
    }
    return SNOW_STATUS_OK;
}

static void crop(const snow_region *region, zarr_box *box) {
    for (int role = 0; role < 3; role++) {
        int axis = box->roles.space[role];
        if (axis >= 0) {
            box->first[axis] = region->first[role];
            box->end[axis] = region->first[role] + region->count[role];
        }
    }
}

/* Chunks are unpacked as a whole. */
static void note_chunks(const zarr_box *box, const snow_region *region) {
    int64_t size[3];
    for (int role = 0; role < 3; role++) {
        const int axis = box->roles.space[role];
        size[role] = axis < 0 ? 1 : box->array->chunk[axis];
    }
    snow_region_in_blocks(box->store->context, region, size);
}

/* "zarr 2, level 1 of 3 (1), axes z y x, chunks 64x64x64, blosc lz4": as much
 * as fits. */
static void spell(const zarr_found *found, char *out, size_t capacity) {
    const zarr_array *array = &found->array;
    char text[1024];
    int used = snprintf(text, sizeof text, "version %d", array->version);
    if (found->image)
        used +=
            snprintf(text + used, sizeof text - (size_t)used,
                     ", level %d of %d (%.60s)", found->index, found->levels,
                     snow_zarr_level_path(found->image, (size_t)found->index));
    used += snprintf(text + used, sizeof text - (size_t)used, ", axes");
    for (int i = 0; i < array->axes; i++)
        used += snprintf(text + used, sizeof text - (size_t)used, " %s",
                         *array->names[i] ? array->names[i] : "?");
    const struct {
        const char *what;
        const int64_t *sizes;
    } lists[] = {{", chunks ", array->chunk}, {", shards ", array->file}};
    for (int k = 0; k < (array->sharded ? 2 : 1); k++)
        for (int i = 0; i < array->axes; i++)
            used +=
                snprintf(text + used, sizeof text - (size_t)used, "%s%lld",
                         i ? "x" : lists[k].what, (long long)lists[k].sizes[i]);
    snprintf(text + used, sizeof text - (size_t)used, ", %s",
             *array->coding.text ? array->coding.text : "not compressed");
    snprintf(out, capacity, "%.*s", (int)capacity - 1, text);
}

/* An array on the way to be read. */
typedef struct zarr_job {
    zarr_box box;
    zarr_cf cf;
    snow_uneven grid;
} zarr_job;

/* Reads a box of the array's own voxels as they are stored. */
static snow_status read_stored(void *user, const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    zarr_job *job = user;
    snow_context *context = job->box.store->context;
    snow_region region;
    snow_volume *volume;
    int64_t voxels;
    uint64_t bytes;
    SNOW_TRY(snow_region_lay_out(context, options, info, &region));
    crop(&region, &job->box);
    if (!snow_uneven_any(&job->grid))
        note_chunks(&job->box, &region);
    if (!snow_volume_count(info->dims, info->type, &voxels, &bytes))
        bytes = UINT64_MAX; /* refused by the check of the region before */
    SNOW_TRY(snow_zarr_check_box(&job->box, bytes));
    if (!out)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_volume_new(context, info, &volume));
    snow_status status = snow_zarr_fill(&job->box, volume->owned);
    return snow_volume_give(status, volume, out);
}

/* What arrays of data sets have: coordinates, time, names. */
static void describe_array(zarr_job *job, const snow_volume_options *options,
                           snow_volume_info *info) {
    const snow_axes *roles = &job->box.roles;
    const char *path = job->box.array->path, *slash = strrchr(path, '/');
    cf_axis space[3] = {{0}};
    for (int i = 0; i < 3; i++)
        if (roles->space[i] >= 0)
            space[i] = job->cf.axes[roles->space[i]];
    if (job->cf.named)
        snow_cf_name(slash ? slash + 1 : path, &job->cf.says, info);
    if (roles->time >= 0)
        snow_cf_time(&job->cf.axes[roles->time], info);
    snow_cf_place(job->box.store->context, space, options, info, &job->grid);
}

static snow_status read_job(zarr_job *job, zarr_found *found,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    const zarr_store *store = job->box.store;
    zarr_box *box = &job->box;
    SNOW_TRY(snow_zarr_read_cf(found, &job->cf));
    SNOW_TRY(snow_zarr_assign(found, &job->cf, &box->roles));
    const int axis = box->roles.channel;
    info->type = job->cf.values.type;
    if (!box->roles.interleaved)
        snow_zarr_describe_channels(
            found, axis < 0 ? 1 : found->array.sizes[axis], info);
    SNOW_TRY(pick(store->context, options, box, info));
    spell(found, info->storage, sizeof info->storage);
    SNOW_TRY(snow_zarr_place(found, &box->roles, info));
    describe_array(job, options, info);
    return snow_cf_read(store->context, NULL, &job->grid, &job->cf.values,
                        read_stored, job, options, info, out);
}

static snow_status read_found(const zarr_store *store, zarr_found *found,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    zarr_job job = {.box = {.store = store, .array = &found->array}};
    *info = snow_volume_info_default("zarr");
    snow_status status = read_job(&job, found, options, info, out);
    snow_zarr_release_cf(store, &job.cf);
    return status;
}

snow_status snow_zarr_read_store(const zarr_store *store, const char *path,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out) {
    zarr_found *found = snow_allocate(store->context, sizeof *found);
    if (!found)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = snow_zarr_find(store, path, found);
    if (status == SNOW_STATUS_OK)
        status = read_found(store, found, options, info, out);
    snow_zarr_found_forget(found);
    snow_release(store->context, found);
    return status;
}

snow_status snow_zarr_read_folder(snow_context *context, const char *path,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out) {
    zarr_store store;
    char inside[ZARR_PATH_BYTES];
    SNOW_TRY(open_store(context, path, options->dataset, &store, inside));
    return snow_zarr_read_store(&store, inside, options, info, out);
}

/* --- a file that describes a folder --------------------------------------- */

static snow_status read_zarr(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    const char *name = snow_source_name(source);
    const char *slash = strrchr(name, '/');
    size_t length = slash ? (size_t)(slash - name) : 1;
    char folder[ZARR_PATH_BYTES];
    if (!snow_source_has_siblings(source) || length >= sizeof folder)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "describes a Zarr array, whose voxels are in the "
                         "files beside it; open its folder");
    memcpy(folder, slash ? name : ".", length);
    folder[length] = 0;
    return snow_zarr_read_folder(context, folder, options, info, out);
}

const snow_format snow_format_zarr = {
    .name = "zarr",
    .text = "Zarr and OME-Zarr (a folder with .zarray or zarr.json)",
    .suffixes = {".zarray", ".zgroup", ".zattrs", "zarr.json"},
    .crops = true,
    .sets = true,
    .channels = true,
    .read = read_zarr,
};
