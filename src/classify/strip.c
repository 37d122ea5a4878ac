/* classify/strip.c - the buffers that a strip of a slice passes through. */
#include "classify/classify.h"

/* Voxels of a strip: with 4 bytes of column and 16 of sample each, 320 KB, a
 * part of today's second-level caches. */
#define STRIP_VOXELS 16384

snow_status snow_strip_make(snow_context *context,
                            const snow_placement *placement, int channels,
                            snow_strip *strip) {
    if (placement->columns > UINT32_MAX)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "rows of %lld voxels are too long to render; take a "
                         "part of the volume",
                         (long long)placement->columns);
    int64_t rows = STRIP_VOXELS / placement->columns;
    if (rows > placement->rows)
        rows = placement->rows;
    if (rows < 1)
        rows = 1;
    uint64_t voxels = (uint64_t)rows * (uint64_t)placement->columns;
    strip->room_rows = rows;
    SNOW_TRY(snow_reserve(context, &strip->row_end, &strip->row_end_capacity, 0,
                          (size_t)rows * sizeof *strip->row_end));
    SNOW_TRY(snow_reserve(context, &strip->columns, &strip->columns_capacity, 0,
                          (size_t)voxels * sizeof *strip->columns));
    return snow_reserve(context, &strip->samples, &strip->samples_capacity, 0,
                        (size_t)voxels * (size_t)channels *
                            sizeof *strip->samples);
}

void snow_strip_free(snow_context *context, snow_strip *strip) {
    snow_release(context, strip->row_end);
    snow_release(context, strip->columns);
    snow_release(context, strip->samples);
    *strip = (snow_strip){0};
}
