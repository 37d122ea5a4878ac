/* levels.c - implements levels.h: a volume that is fetched takes time for each
 * byte, so that the finest level is not what a reader wants first. */
#include "levels.h"

#include "formats/zarr/zarr.h"

#include <stdio.h>
#include <string.h>

/* Of one time. */
static double bytes_of(zarr_found *found) {
    static const zarr_cf nothing;
    zarr_array *array = &found->array;
    snow_axes roles;
    double bytes = (double)snow_type_size(array->type);
    if (snow_zarr_assign(found, &nothing, &roles) != SNOW_STATUS_OK)
        return 0;
    for (int i = 0; i < array->axes; i++)
        if (i != roles.time)
            bytes *= (double)array->sizes[i];
    return bytes;
}

/* The path of a level beside the one that was found. */
static bool name_level(const zarr_found *found, int level, char *out,
                       size_t size) {
    const char *path = found->array.path;
    const char *own =
        snow_zarr_level_path(found->image, (size_t)found->index);
    const char *other = snow_zarr_level_path(found->image, (size_t)level);
    size_t group = own ? strlen(path) - strlen(own) : 0;
    int length = other && own ? snprintf(out, size, "%.*s%s", (int)group, path,
                                         other)
                              : -1;
    return length > 0 && (size_t)length < size;
}

/* Goes on from the finest level that was found. */
static void go_down(const zarr_store *store, const zarr_found *finest,
                    double most, level_choice *out) {
    zarr_found *found = snow_allocate(store->context, sizeof *found);
    for (int n = finest->index + 1;
         found && n < out->levels && out->left > most; n++) {
        char path[sizeof out->dataset];
        if (!name_level(finest, n, path, sizeof path))
            continue;
        if (snow_zarr_find(store, path, found) == SNOW_STATUS_OK) {
            out->left = bytes_of(found);
            out->level = n;
            memcpy(out->dataset, path, sizeof path);
        }
        snow_zarr_found_forget(found);
    }
    snow_release(store->context, found);
}

static void choose(snow_context *context, const char *path, double most,
                   level_choice *out) {
    zarr_store store = {.context = context};
    zarr_found *found = snow_allocate(context, sizeof *found);
    snprintf(store.folder, sizeof store.folder, "%s", path);
    if (found && strlen(path) < sizeof store.folder &&
        snow_zarr_find(&store, "", found) == SNOW_STATUS_OK && found->image) {
        out->level = found->index;
        out->levels = found->levels;
        out->bytes = out->left = bytes_of(found);
        go_down(&store, found, most, out);
    }
    if (found)
        snow_zarr_found_forget(found);
    snow_release(context, found);
}

level_choice level_choose(const char *path, double most) {
    level_choice out = {.levels = 0};
    snow_context *context;
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return out;
    if (snow_zarr_is(context, path))
        choose(context, path, most, &out);
    snow_context_free(context);
    return out;
}
