/* formats/write.c - what the formats' `write` members share. */
#include "formats/write.h"

#include "base/monitor.h"

#include <string.h>

/* Voxels turned around at a time on machines of the other byte order. */
#define CHUNK_BYTES 4096
/* Written at a time; packed they take some ten milliseconds. */
#define PART_BYTES ((size_t)1 << 18)

static snow_status write_swapped(const unsigned char *at, size_t bytes,
                                 size_t size, snow_writer *writer) {
    while (bytes) {
        unsigned char chunk[CHUNK_BYTES];
        size_t some = bytes < CHUNK_BYTES ? bytes : CHUNK_BYTES;
        memcpy(chunk, at, some);
        snow_swap_bytes(chunk, some / size, size);
        SNOW_TRY(snow_writer_write(writer, chunk, some));
        at += some;
        bytes -= some;
    }
    return SNOW_STATUS_OK;
}

snow_volume_info snow_write_in_units(const snow_volume_info *info,
                                     const char *const *units) {
    snow_volume_info out = *info;
    const double unit = snow_unit_length(info->unit, NULL);
    const double factor = unit / snow_unit_length("mm", NULL);
    for (; *units; units++)
        if (strcmp(info->unit, *units) == 0)
            return out;
    if (!(unit > 0))
        return out;
    for (int i = 0; i < 3; i++) {
        out.spacing[i] *= factor;
        for (int j = 0; j < 4; j++)
            out.matrix[i][j] *= factor;
    }
    memcpy(out.unit, "mm", 3);
    return out;
}

/* Straight from the volume on little-endian machines: no copy of what may be
 * gigabytes.  Part by part, so that a stop does not wait for all of it; row by
 * row where rows lie apart. */
snow_status snow_write_voxels(const snow_volume *volume, snow_writer *writer) {
    int64_t voxels;
    uint64_t bytes;
    size_t size = snow_type_size(volume->info.type);
    snow_volume_count(volume->info.dims, volume->info.type, &voxels, &bytes);
    snow_monitor *monitor = volume->context->monitor;
    for (uint64_t done = 0; done < bytes;) {
        uint64_t count =
            (bytes - done < PART_BYTES ? bytes - done : PART_BYTES) / size;
        const unsigned char *at =
            (unsigned char *)volume->voxels +
            (size_t)snow_volume_run(volume, (int64_t)(done / size), &count) *
                size;
        const size_t some = (size_t)count * size;
        SNOW_TRY(snow_machine_big_endian()
                     ? write_swapped(at, some, size, writer)
                     : snow_writer_write(writer, at, some));
        done += some;
        snow_monitor_report(monitor, SNOW_STAGE_WRITE, (double)done,
                            (double)bytes);
        SNOW_TRY(snow_monitor_status(monitor));
    }
    return SNOW_STATUS_OK;
}

void snow_append_numbers(char *text, size_t capacity, const double *values,
                         int count, const char *between) {
    for (int i = 0; i < count; i++) /* adding 0 turns -0 into 0 */
        snow_append(text, capacity, "%s%.17g", i ? between : "",
                    values[i] + 0.0);
}
