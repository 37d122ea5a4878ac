/* formats/read.c - what readers share: voxels that lie in a file as they do in
 * memory, the choice of a time step, another spacing, a box. */
#include "formats/array.h"
#include "io/lookup.h"

#include <snowglass/extend.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A header of 400 bytes must not cost gigabytes. */
snow_status snow_volume_read(snow_source *source,
                             const snow_volume_options *options,
                             bool big_endian, uint64_t skip,
                             snow_volume_info *info, snow_volume **out) {
    snow_array array = {.big_endian = big_endian};
    snow_array_of_volumes(info, skip, &array);
    return snow_array_read(source, options, &array, info, out);
}

void snow_volume_order_bytes(snow_volume *volume, bool big_endian) {
    const int64_t *dims = volume->info.dims;
    if (big_endian != snow_machine_big_endian())
        snow_swap_bytes(volume->owned, (uint64_t)(dims[0] * dims[1] * dims[2]),
                        snow_type_size(volume->info.type));
}

/* Warns of the step that is taken unasked: the user must know that this is one
 * of many, unless all steps are opened in turn. */
snow_status snow_volume_pick_time(snow_context *context, const char *what,
                                  const snow_volume_options *options,
                                  snow_volume_info *info) {
    const int64_t time = options->time, all = info->times;
    if (time < -all || time >= all)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "there is no %s %lld; the file has %lld, counted from "
                         "0, or from -1 at its end",
                         what, (long long)time, (long long)all);
    info->time = time < 0 ? all + time : time;
    if (all > 1 && !time && !options->each_time && !options->time_given)
        snow_notify(context,
                    "%s %lld of %lld (counted from 0) is taken; --time N takes "
                    "another",
                    what, (long long)info->time, (long long)all);
    return SNOW_STATUS_OK;
}

snow_status snow_volume_replace_spacing(snow_context *context,
                                        const snow_volume_options *options,
                                        snow_volume_info *info) {
    snow_volume_info changed = *info;
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3 && options->spacing[j] > 0; i++)
            changed.matrix[i][j] *= options->spacing[j] / info->spacing[j];
    /* The file's own matrix was checked, so only the option can be wrong. */
    if (snow_volume_info_check(context, &changed) != SNOW_STATUS_OK)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--spacing %gx%gx%g makes voxels too small, too large "
                         "or too flat to compute with; give lengths in "
                         "another unit",
                         options->spacing[0], options->spacing[1],
                         options->spacing[2]);
    snow_volume_info_measure(&changed);
    *info = changed;
    return SNOW_STATUS_OK;
}

snow_status snow_volume_crop(const snow_volume_options *options,
                             snow_volume **volume) {
    snow_context *context = (*volume)->context;
    snow_volume_info info = (*volume)->info;
    int64_t time = info.time, times = info.times;
    snow_region region;
    snow_volume *box;
    info.time = 0;
    info.times = 1;
    SNOW_TRY(snow_region_lay_out(context, options, &info, &region));
    const snow_file_part all = {&region, 0, region.all};
    if (snow_file_part_is_all(&all))
        return SNOW_STATUS_OK;
    info.time = time;
    info.times = times;
    SNOW_TRY(snow_volume_new(context, &info, &box));
    snow_file_part_copy(&all, (*volume)->voxels, box->owned);
    snow_volume_close(*volume);
    *volume = box;
    return SNOW_STATUS_OK;
}

snow_status snow_volume_give(snow_status status, snow_volume *volume,
                             snow_volume **out) {
    if (status == SNOW_STATUS_OK && out)
        *out = volume;
    else
        snow_volume_close(volume);
    return status;
}

snow_status snow_volume_finish(snow_context *context, snow_status status,
                               snow_volume *volume, snow_volume **out) {
    return snow_volume_give(snow_lookup_end(context, status), volume, out);
}

void snow_append(char *text, size_t capacity, const char *format, ...) {
    const size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    snow_text_vprint(text + used, capacity - used, format, arguments);
    va_end(arguments);
}

void snow_list_add(char *list, size_t capacity, const char *format, ...) {
    char text[1024];
    const size_t used = strlen(list);
    va_list arguments;
    va_start(arguments, format);
    snow_text_vprint(text, sizeof text, format, arguments);
    va_end(arguments);
    if (used + strlen(text) + 8 < capacity)
        snprintf(list + used, capacity - used, "%s%s", used ? ", " : "", text);
    else if (used > 3 && strcmp(list + used - 3, "...") != 0)
        memcpy(list + used, " ...", 5);
}

snow_type snow_type_of_code(const snow_coded_type *table, int code) {
    while (table->type && table->code != code)
        table++;
    return table->type;
}

snow_type snow_type_of_kind(char kind, size_t bytes) {
    for (int type = SNOW_TYPE_NONE + 1; type <= SNOW_TYPE_FLOAT64; type++)
        if (*snow_type_name((snow_type)type) == kind &&
            snow_type_size((snow_type)type) == bytes)
            return (snow_type)type;
    return SNOW_TYPE_NONE;
}

snow_type snow_numpy_type(char kind, size_t bytes, snow_coding *coding) {
    const bool is_bool = kind == 'b' && bytes == 1;
    const bool half = kind == 'f' && bytes == 2;
    *coding = is_bool ? SNOW_CODING_BOOL
              : half  ? SNOW_CODING_HALF
                      : SNOW_CODING_PLAIN;
    return is_bool ? SNOW_TYPE_UINT8
                   : snow_type_of_kind(kind, half ? 4 : bytes);
}

bool snow_format_has_name(const snow_format *format, const char *name) {
    for (const char *const *suffix = format->suffixes; *suffix; suffix++)
        if (snow_has_suffix(name, *suffix))
            return true;
    return false;
}
