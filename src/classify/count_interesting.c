/* classify/count_interesting.c - see count_interesting.h. The classifier that
 * encodes voxels counts them too, so that both agree on which are interesting.
 */
#include "classify/count_interesting.h"
#include "volume/stream.h"

#include <string.h>

typedef struct pass {
    const snow_volume *volume;
    snow_extent part;
    snow_block_counts *tally;
    int64_t *columns; /* per stored column: its block; -1: a neighbour's */
} pass;

/* Counts rows of one slice of the whole volume, beginning with row y. */
static void add_row_block(const pass *p, const snow_row_block *row_block,
                          int64_t y, int64_t z) {
    const int64_t *blocks = p->tally->blocks;
    int64_t slice = snow_block_counts_find(p->tally, 2, z) * blocks[1];
    size_t at = 0;
    for (int64_t row = 0; row < row_block->rows; row++) {
        int64_t *counts =
            p->tally->counts +
            (slice + snow_block_counts_find(p->tally, 1, y + row)) * blocks[0];
        for (; at < row_block->row_end[row]; at++) {
            int64_t block = p->columns[row_block->columns[at]];
            if (block >= 0)
                counts[block]++;
        }
    }
}

static void add_slices(const pass *p, const snow_classifier *classifier,
                       const snow_placement *placement,
                       snow_row_block *row_block) {
    const snow_extent *part = &p->part;
    int64_t end = part->first[1] + part->count[1];
    for (int64_t i = 0; i < part->count[2]; i++) {
        int64_t z = part->first[2] + i;
        if (snow_monitor_look(p->volume->context->monitor, 0))
            return;
        for (int64_t y = part->first[1]; y < end; y += row_block->room_rows) {
            int64_t rows = end - y;
            if (rows > row_block->room_rows)
                rows = row_block->room_rows;
            snow_classify_row_block(classifier, placement, z - part->stored[2],
                                    y - part->stored[1], rows, row_block);
            add_row_block(p, row_block, y, z);
        }
    }
}

static snow_status find_columns(snow_context *context, pass *p) {
    int64_t columns = p->volume->info.dims[0];
    p->columns =
        snow_allocate_array(context, (uint64_t)columns, sizeof *p->columns);
    if (!p->columns)
        return SNOW_STATUS_NO_MEMORY;
    for (int64_t i = 0; i < columns; i++) {
        int64_t x = p->part.stored[0] + i, own = x - p->part.first[0];
        p->columns[i] = own >= 0 && own < p->part.count[0]
                            ? snow_block_counts_find(p->tally, 0, x)
                            : -1;
    }
    return SNOW_STATUS_OK;
}

snow_status snow_count_interesting_blocks(const snow_volume *volume,
                                          const snow_transfer *transfer,
                                          double threshold, snow_isa isa,
                                          snow_block_counts *tally) {
    const int64_t *dims = volume->info.dims;
    snow_context *context = volume->context;
    /* Slices in memory order; counting needs no camera. */
    snow_placement placement = {.slice_axis = 2,
                                .u_axis = 0,
                                .v_axis = 1,
                                .columns = dims[0],
                                .rows = dims[1],
                                .slices = dims[2]};
    snow_classify_options options = {
        .threshold = threshold, .opacity_exponent = 1, .isa = isa};
    snow_classifier classifier = {0};
    snow_row_block row_block = {0};
    pass p = {.volume = volume, .tally = tally};
    SNOW_TRY(snow_volume_need_voxels(volume));
    snow_volume_find_extent(volume, &p.part);
    if (!p.part.count[0] || !p.part.count[1] || !p.part.count[2])
        return SNOW_STATUS_OK;
    snow_status status = find_columns(context, &p);
    if (status == SNOW_STATUS_OK)
        status = snow_classifier_make(context, volume, transfer, &options,
                                      &classifier);
    if (status == SNOW_STATUS_OK)
        status = snow_row_block_make(context, &placement, classifier.channels,
                                     &row_block);
    if (status == SNOW_STATUS_OK)
        add_slices(&p, &classifier, &placement, &row_block);
    if (status == SNOW_STATUS_OK)
        status = snow_monitor_status(context->monitor);
    snow_row_block_free(context, &row_block);
    snow_classifier_fini(context, &classifier);
    snow_release(context, p.columns);
    return status;
}

/* A single block holds the whole grid. */
snow_status snow_count_interesting(const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   double threshold, snow_isa isa,
                                   int64_t *out) {
    int64_t count = 0;
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    snow_block_counts tally = {.blocks = {1, 1, 1}, .counts = &count};
    for (int axis = 0; axis < 3; axis++)
        tally.grid.dims[axis] = tally.block[axis] = part.dims[axis];
    SNOW_TRY(snow_count_interesting_blocks(volume, transfer, threshold, isa,
                                           &tally));
    *out = count;
    return SNOW_STATUS_OK;
}

int snow_interesting_ranges(const snow_volume_info *info,
                            const snow_transfer *transfer, double threshold,
                            int32_t first, int32_t last, snow_native_range *out,
                            int most) {
    bool before = false;
    int count = 0;
    for (int32_t native = first; native <= last; native++) {
        double value = info->slope * native + info->intercept;
        double opacity = snow_transfer_opacity(transfer, value);
        bool here = opacity > 0 && snow_is_interesting(opacity, threshold);
        if (here && !before && count == most)
            return -1;
        if (here && !before)
            out[count++].first = native;
        if (here)
            out[count - 1].last = native;
        before = here;
    }
    return count;
}
