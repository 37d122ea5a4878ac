/* volume/save.c - snow_volume_save: which format a name asks for.
 *
 * The format's `write` makes the bytes, the writer packs them where the name
 * ends in .gz and sees to it that the file is whole or absent. */
#include "volume/stream.h"
#include "volume/write.h"

#include <stdio.h>
#include <string.h>

/* Voxels turned around at a time on machines of the other byte order. */
#define CHUNK_BYTES 4096

static const struct {
    const char *suffix;
    const snow_format *format;
    bool packed;
} endings[] = {
    {".nrrd", &snow_format_nrrd, false},
    {".nii", &snow_format_nifti, false},
    {".nii.gz", &snow_format_nifti, true},
    {".mha", &snow_format_metaimage, false},
    {".npy", &snow_format_npy, false},
    {".raw", &snow_format_raw, false},
    {".raw.gz", &snow_format_raw, true},
};
#define ENDING_COUNT (sizeof endings / sizeof *endings)

/* Straight from the volume on little-endian machines: no copy of what may be
 * gigabytes. */
snow_status snow_write_voxels(const snow_volume *volume, snow_writer *writer) {
    int64_t voxels;
    uint64_t bytes;
    size_t size = snow_type_size(volume->info.type);
    snow_volume_count(volume->info.dims, volume->info.type, &voxels, &bytes);
    if (!snow_machine_big_endian())
        return snow_writer_write(writer, volume->voxels, (size_t)bytes);
    const unsigned char *at = volume->voxels;
    while (bytes) {
        unsigned char chunk[CHUNK_BYTES];
        size_t some = bytes < CHUNK_BYTES ? (size_t)bytes : CHUNK_BYTES;
        memcpy(chunk, at, some);
        snow_swap_bytes(chunk, some / size, size);
        SNOW_TRY(snow_writer_write(writer, chunk, some));
        at += some;
        bytes -= some;
    }
    return SNOW_OK;
}

/* printf goes by the locale of the program around the library; files do not. */
int snow_print_numbers(char *text, size_t room, const double *values, int count,
                       const char *between) {
    int used = 0;
    for (int i = 0; i < count; i++) {
        if (i)
            used += snprintf(text + used, room - (size_t)used, "%s", between);
        char *number = text + used;
        /* Adding 0 makes -0, of which files need not tell, 0. */
        used += snprintf(number, room - (size_t)used, "%.17g", values[i] + 0.0);
        char *comma = strchr(number, ',');
        if (comma)
            *comma = '.';
    }
    return used;
}

/* A name alone cannot bring the voxels back: the remark gives the options that
 * do.  A scaling is refused, since dropped it would change every value. */
snow_status snow_raw_write(const snow_volume *volume, const char *path,
                           snow_writer *writer) {
    const snow_volume_info *info = &volume->info;
    if (info->slope != 1 || info->intercept != 0)
        return snow_fail(volume->context, SNOW_BAD_USAGE,
                         "%s: raw data cannot say slope %g and intercept %g; "
                         "write .nii or .mha",
                         path, info->slope, info->intercept);
    SNOW_TRY(snow_write_voxels(volume, writer));
    snow_notify(volume->context,
                "%s: raw data keep no sizes; open it with --dims "
                "%lldx%lldx%lld --type %s --spacing %gx%gx%g",
                path, (long long)info->dims[0], (long long)info->dims[1],
                (long long)info->dims[2], snow_type_name(info->type),
                info->spacing[0], info->spacing[1], info->spacing[2]);
    return SNOW_OK;
}

/* Fills an open writer. */
static snow_status fill(const snow_volume *volume, const char *path,
                        const snow_format *format, bool packed,
                        snow_writer *writer) {
    if (packed)
        SNOW_TRY(snow_writer_pack(writer));
    return format->write(volume, path, writer);
}

const char *snow_volume_suffix(size_t index) {
    return index < ENDING_COUNT ? endings[index].suffix : NULL;
}

static snow_status refuse_name(snow_context *context, const char *path) {
    char names[128] = "";
    size_t used = 0;
    for (size_t i = 0; i < ENDING_COUNT && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, " %s",
                                 endings[i].suffix);
    return snow_fail(context, SNOW_BAD_USAGE,
                     "%s: volumes are written as%s; choose one of these "
                     "endings",
                     path, names);
}

/* The name is checked first, so that a wrong one never creates a file; a file
 * that fails half-way is given up, never committed. */
snow_status snow_volume_save(const snow_volume *volume, const char *path,
                             bool overwrite) {
    size_t i = 0;
    SNOW_TRY(snow_volume_need_voxels(volume));
    while (i < ENDING_COUNT && !snow_has_suffix(path, endings[i].suffix))
        i++;
    if (i == ENDING_COUNT)
        return refuse_name(volume->context, path);
    snow_writer *writer;
    SNOW_TRY(snow_writer_open(volume->context, path, overwrite, &writer));
    snow_status status =
        fill(volume, path, endings[i].format, endings[i].packed, writer);
    if (status != SNOW_OK) {
        snow_writer_abandon(writer);
        return status;
    }
    return snow_writer_commit(writer);
}
