/* formats/read.c - what readers share: voxels that lie in a file as they do in
 * memory, and the choice of a time step. */
#include "formats/format.h"

/* The bytes are compared with the source before the voxels get their memory: a
 * header of 400 bytes must not cost gigabytes. */
snow_status snow_volume_read(snow_source *source,
                             const snow_volume_options *options,
                             bool big_endian, uint64_t skip,
                             snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    snow_region window;
    uint64_t all;
    SNOW_TRY(snow_region_lay_out(context, options, info, &window));
    /* More than 64 bits can count: expect refuses it with its usual words. */
    if (!snow_add_u64(skip, window.all, &all))
        all = UINT64_MAX;
    SNOW_TRY(snow_source_expect(source, all, "the voxels"));
    if (!out)
        return SNOW_STATUS_OK;
    const snow_file_part part = {&window, 0, window.all};
    snow_volume *volume;
    SNOW_TRY(snow_volume_new(context, info, &volume));
    snow_status status = snow_source_skip(source, skip, "the voxels");
    if (status == SNOW_STATUS_OK)
        status = snow_file_part_read(source, &part, volume->owned);
    if (status == SNOW_STATUS_OK)
        status = snow_source_finish(source);
    if (status != SNOW_STATUS_OK) {
        snow_volume_close(volume);
        return status;
    }
    snow_volume_order_bytes(volume, big_endian);
    *out = volume;
    return SNOW_STATUS_OK;
}

void snow_volume_order_bytes(snow_volume *volume, bool big_endian) {
    const int64_t *dims = volume->info.dims;
    if (big_endian != snow_machine_big_endian())
        snow_swap_bytes(volume->owned, (uint64_t)(dims[0] * dims[1] * dims[2]),
                        snow_type_size(volume->info.type));
}

/* Warns even for step 0: the user must know that this is one step of many,
 * unless all steps are opened in turn. */
snow_status snow_volume_pick_time(snow_context *context, const char *what,
                                  const snow_volume_options *options,
                                  snow_volume_info *info) {
    if (options->time < 0 || options->time >= info->times)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "there is no %s %lld; the file has %lld, counted from "
                         "0",
                         what, (long long)options->time,
                         (long long)info->times);
    info->time = options->time;
    if (info->times > 1 && !options->each_time)
        snow_notify(context,
                    "%s %lld of %lld (counted from 0) is taken; --time N takes "
                    "another",
                    what, (long long)info->time, (long long)info->times);
    return SNOW_STATUS_OK;
}

bool snow_format_has_name(const snow_format *format, const char *name) {
    for (const char *const *suffix = format->suffixes; *suffix; suffix++)
        if (snow_has_suffix(name, *suffix))
            return true;
    return false;
}
