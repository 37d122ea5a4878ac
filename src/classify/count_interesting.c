/* classify/count_interesting.c - see count_interesting.h. The classifier that
 * encodes voxels counts them too, so that both agree which are interesting. */
#include "classify/count_interesting.h"
#include "base/thread_pool.h"
#include "volume/stream.h"

/* Entries first .. end - 1 of a row block, without those of neighbours. */
static void trim_row(const snow_extent *part, const snow_row_block *row_block,
                     size_t first, size_t end, snow_interesting_row *row) {
    const int64_t from = part->first[0] - part->stored[0];
    const uint32_t *columns = row_block->columns;
    while (first < end && columns[first] < from)
        first++;
    while (end > first && columns[end - 1] >= from + part->count[0])
        end--;
    row->count = end - first;
    row->columns = columns + first;
    row->opacities = row_block->samples + (first + 1) * row->stride - 1;
}

typedef struct visiting {
    snow_extent part;
    snow_classifier classifier;
    snow_placement placement;
    snow_row_block *row_blocks; /* of the workers */
    snow_interesting_fn *visit;
    void *user;
} visiting;

static void visit_slice(void *of, int64_t item, int worker) {
    const visiting *v = of;
    const snow_extent *part = &v->part;
    const int64_t end = part->first[1] + part->count[1];
    snow_row_block *row_block = &v->row_blocks[worker];
    snow_interesting_row row = {.z = part->first[2] + item,
                                .stored = part->stored[0],
                                .worker = worker,
                                .stride = (size_t)v->classifier.channels};
    for (int64_t y = part->first[1]; y < end; y += row_block->room_rows) {
        int64_t rows = end - y;
        if (rows > row_block->room_rows)
            rows = row_block->room_rows;
        snow_classify_row_block(&v->classifier, &v->placement,
                                row.z - part->stored[2], y - part->stored[1],
                                rows, row_block);
        for (int64_t n = 0; n < rows; n++) {
            row.y = y + n;
            trim_row(part, row_block, n ? row_block->row_end[n - 1] : 0,
                     row_block->row_end[n], &row);
            if (row.count)
                v->visit(v->user, &row);
        }
    }
}

static snow_status visit_slices(snow_context *context, int threads,
                                visiting *v) {
    snow_status status = SNOW_STATUS_OK;
    const uint64_t bytes = (uint64_t)threads * sizeof *v->row_blocks;
    v->row_blocks = snow_allocate_clear(context, (size_t)bytes);
    if (!v->row_blocks)
        return SNOW_STATUS_NO_MEMORY;
    for (int n = 0; n < threads && status == SNOW_STATUS_OK; n++)
        status = snow_row_block_make(context, &v->placement,
                                     v->classifier.channels, &v->row_blocks[n]);
    if (status == SNOW_STATUS_OK)
        status =
            snow_parallel(context, threads, v->part.count[2], visit_slice, v);
    for (int n = 0; n < threads; n++)
        snow_row_block_free(context, &v->row_blocks[n]);
    snow_release(context, v->row_blocks);
    return status;
}

snow_status snow_visit_interesting(const snow_interesting_walk *walk,
                                   snow_interesting_fn *visit, void *user) {
    const snow_volume *volume = walk->volume;
    const int64_t *dims = volume->info.dims;
    /* Slices in memory order; there is no camera. */
    visiting v = {.placement = {.slice_axis = 2,
                                .u_axis = 0,
                                .v_axis = 1,
                                .columns = dims[0],
                                .rows = dims[1],
                                .slices = dims[2]},
                  .visit = visit,
                  .user = user};
    const snow_classify_options options = {.threshold = walk->threshold,
                                           .opacity_exponent = walk->exponent,
                                           .isa = walk->isa};
    SNOW_TRY(snow_volume_need_voxels(volume));
    snow_volume_find_extent(volume, &v.part);
    if (!v.part.count[0] || !v.part.count[1] || !v.part.count[2])
        return SNOW_STATUS_OK;
    snow_status status = snow_classifier_make(
        volume->context, volume, walk->transfer, &options, &v.classifier);
    if (status == SNOW_STATUS_OK)
        status = visit_slices(volume->context,
                              walk->threads > 1 ? walk->threads : 1, &v);
    snow_classifier_fini(volume->context, &v.classifier);
    return status;
}

/* --- counts --------------------------------------------------------------- */

typedef struct counting {
    snow_block_counts *block_counts;
    int64_t *columns; /* of the whole: their blocks */
} counting;

static void count_row(void *of, const snow_interesting_row *row) {
    const counting *c = of;
    const int64_t *blocks = c->block_counts->blocks;
    const int64_t *columns = c->columns + row->stored;
    int64_t *counts =
        c->block_counts->counts +
        (snow_block_counts_find(c->block_counts, 2, row->z) * blocks[1] +
         snow_block_counts_find(c->block_counts, 1, row->y)) *
            blocks[0];
    for (size_t n = 0; n < row->count; n++)
        counts[columns[row->columns[n]]]++;
}

snow_status snow_count_interesting_blocks(const snow_volume *volume,
                                          const snow_transfer *transfer,
                                          double threshold, snow_isa isa,
                                          snow_block_counts *block_counts) {
    counting c = {.block_counts = block_counts};
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    SNOW_TRY(SNOW_RESERVE(volume->context, c.columns, 0, part.dims[0]));
    for (int64_t x = 0; x < part.dims[0]; x++)
        c.columns[x] = snow_block_counts_find(block_counts, 0, x);
    const snow_interesting_walk walk = {.volume = volume,
                                        .transfer = transfer,
                                        .threshold = threshold,
                                        .exponent = 1,
                                        .isa = isa};
    snow_status status = snow_visit_interesting(&walk, count_row, &c);
    snow_release(volume->context, c.columns);
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
    snow_block_counts block_counts = {.blocks = {1, 1, 1}, .counts = &count};
    for (int axis = 0; axis < 3; axis++)
        block_counts.grid.dims[axis] = block_counts.block[axis] =
            part.dims[axis];
    SNOW_TRY(snow_count_interesting_blocks(volume, transfer, threshold, isa,
                                           &block_counts));
    *out = count;
    return SNOW_STATUS_OK;
}

/* Table 1 of the paper: the share of voxels that are not interesting. */
snow_status snow_transfer_sparse_ratio(const snow_transfer *transfer,
                                       const snow_volume *volume,
                                       double threshold, double *ratio) {
    int64_t interesting;
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    SNOW_TRY(snow_count_interesting(volume, transfer, threshold, SNOW_ISA_AUTO,
                                    &interesting));
    double voxels =
        (double)part.count[0] * (double)part.count[1] * (double)part.count[2];
    *ratio = voxels > 0 ? 1 - (double)interesting / voxels : 1;
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
