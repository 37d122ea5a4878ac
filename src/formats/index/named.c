/* formats/index/named.c - volumes that a file names. */
#include "formats/index/index.h"

#include <string.h>

/* Files that lead to a volume, each named by the one before: a series, a file
 * of pieces, a piece. */
#define MOST_DEPTH 4

/* The whole of a named volume, without the warnings that reading makes too. */
static snow_status look_at_named(snow_source *source, const char *path,
                                 const snow_volume_options *options, bool quiet,
                                 snow_volume_info *info) {
    snow_context *context = snow_source_context(source);
    snow_volume_options whole = *options;
    snow_warning_fn *warning = context->warning;
    memset(whole.crop, 0, sizeof whole.crop);
    if (quiet)
        context->warning = NULL;
    snow_status status =
        snow_source_open_named(source, path, &whole, info, NULL);
    context->warning = warning;
    return status;
}

static snow_status open_named(snow_source *source, const char *path,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    snow_volume_info box;
    snow_region region;
    snow_volume *volume;
    SNOW_TRY(look_at_named(source, path, options, out != NULL, info));
    if (!out)
        return snow_region_lay_out(snow_source_context(source), options, info,
                                   &region);
    SNOW_TRY(snow_source_open_named(source, path, options, &box, &volume));
    memcpy(info->dims, box.dims, sizeof info->dims);
    *out = volume;
    return SNOW_STATUS_OK;
}

/* The letters of a name that are the file's: all before the data set in
 * "run.h5:/rho", but not before that in "C:/run.vti". */
static size_t file_length(const char *name) {
    const char *set = *name && name[1] ? strstr(name + 2, ":/") : NULL;
    return set ? (size_t)(set - name) : strlen(name);
}

snow_status snow_volume_open_named(snow_source *source, const char *name,
                                   const snow_volume_options *options,
                                   snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    snow_volume_options own = *options;
    char *path;
    memset(own.spacing, 0, sizeof own.spacing);
    own.z_scale = 0;
    if (snow_source_depth(source) >= MOST_DEPTH)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "names a file that names others, %d times in a row; "
                         "open one of them",
                         MOST_DEPTH);
    SNOW_TRY(snow_source_find_named(source, name, file_length(name), &path));
    snow_status status = open_named(source, path, &own, info, out);
    snow_release(context, path);
    return status;
}
