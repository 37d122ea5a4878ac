/* classify/row_block.c - the buffers of a row block, the rows of a slice that
 * are classified together. */
#include "classify/classify.h"

/* Voxels of a row block: with 4 bytes of column and 16 of sample each it takes
 * 320 KB, a part of today's second-level caches. */
#define ROW_BLOCK_VOXELS 16384

snow_status snow_row_block_make(snow_context *context,
                                const snow_placement *placement, int channels,
                                snow_row_block *row_block) {
    if (placement->columns > UINT32_MAX)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "rows of %lld voxels are too long to render: the "
                         "limit is 4294967295; render a part of the volume",
                         (long long)placement->columns);
    int64_t rows = ROW_BLOCK_VOXELS / placement->columns;
    if (rows > placement->rows)
        rows = placement->rows;
    if (rows < 1)
        rows = 1;
    uint64_t voxels = (uint64_t)rows * (uint64_t)placement->columns;
    row_block->room_rows = rows;
    SNOW_TRY(SNOW_RESERVE(context, row_block->row_end, 0, rows));
    SNOW_TRY(SNOW_RESERVE(context, row_block->columns, 0, voxels));
    return SNOW_RESERVE(context, row_block->samples, 0,
                        (size_t)voxels * (size_t)channels);
}

void snow_row_block_free(snow_context *context, snow_row_block *row_block) {
    snow_release(context, row_block->row_end);
    snow_release(context, row_block->columns);
    snow_release(context, row_block->samples);
    *row_block = (snow_row_block){0};
}
