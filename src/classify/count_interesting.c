/* classify/count_interesting.c - see count_interesting.h. The classifier that
 * encodes voxels counts them too, so that both agree which are interesting. */
#include "classify/count_interesting.h"
#include "base/thread_pool.h"
#include "decompose/ray_grid.h"

#include <string.h>

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
    int64_t step;
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
    if (v->step > 1 && (part->first[2] + item) % v->step)
        return;
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
                  .step = walk->step,
                  .visit = visit,
                  .user = user};
    const snow_classify_options options = {.threshold = walk->threshold,
                                           .opacity_exponent = walk->exponent,
                                           .only_counts = walk->only_counts,
                                           .no_colors = true,
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

/* Spans of the rows that are drawn at once: along x, or along y where the
 * slices lie along x.  A cell between voxels is drawn if any of them is
 * interesting: so a span costs if it, or that of the row before, has one. Those
 * of the slice before are not looked at, since they may be another slab's. */
typedef struct span_rows {
    bool along_y;
    int64_t rows, spans; /* of a slice of the file; spans of a row */
    int64_t slice;       /* that `seen` is of; -1: none */
    unsigned char *seen; /* whether they have interesting voxels */
} span_rows;

/* What a worker counts, who has slices of its own. */
typedef struct counting {
    const snow_block_counts *block_counts;
    int64_t *counts;        /* the first worker's are those of all at last */
    const int64_t *columns; /* of the whole: their blocks */
    span_rows spans;
    int64_t *rays; /* sums of the cells of rays, as the counts; or NULL */
    const int64_t *cells; /* of the columns of the whole */
} counting;

static int64_t *block_at(const counting *c, int64_t x, int64_t y, int64_t z) {
    const int64_t *blocks = c->block_counts->blocks;
    return c->counts +
           (snow_block_counts_find(c->block_counts, 2, z) * blocks[1] +
            snow_block_counts_find(c->block_counts, 1, y)) *
               blocks[0] +
           c->columns[x];
}

/* Adds the costs of the spans of a slice, and begins another. */
static void count_spans(counting *c, int64_t next) {
    span_rows *s = &c->spans;
    const int64_t *dims = c->block_counts->grid.dims;
    const int64_t most = dims[s->along_y] - 1;
    const int64_t all = s->rows * s->spans;
    for (int64_t n = 0; n < all && s->slice >= 0; n++) {
        const int64_t row = n / s->spans, above = row ? n - s->spans : n;
        int64_t middle = n % s->spans * SNOW_COST_SPAN + SNOW_COST_SPAN / 2;
        middle = middle < most ? middle : most;
        *block_at(c, s->along_y ? row : middle, s->along_y ? middle : row,
                  s->slice) +=
            s->seen[n] | s->seen[above] ? c->block_counts->span : 0;
    }
    memset(s->seen, 0, (size_t)all);
    s->slice = next;
}

static void see_spans(counting *c, const snow_interesting_row *row) {
    span_rows *s = &c->spans;
    if (row->z != s->slice)
        count_spans(c, row->z);
    for (size_t n = 0; n < row->count; n++) {
        int64_t x = row->stored + row->columns[n];
        int64_t at = s->along_y ? x * s->spans + row->y / SNOW_COST_SPAN
                                : row->y * s->spans + x / SNOW_COST_SPAN;
        s->seen[at] = 1;
    }
}

static void count_rays(counting *c, const snow_interesting_row *row) {
    const snow_ray_grid *grid = c->block_counts->rays;
    const int64_t *cells = c->cells + row->stored;
    int64_t *sums = c->rays + snow_ray_grid_place(grid, 1, row->y) +
                    snow_ray_grid_place(grid, 2, row->z);
    for (size_t n = 0; n < row->count; n++)
        sums[cells[row->columns[n]]] +=
            snow_ray_grid_word(grid, row->opacities[n * row->stride]);
}

static void count_row(void *of, const snow_interesting_row *row) {
    counting *c = (counting *)of + row->worker;
    const int64_t *columns = c->columns + row->stored;
    int64_t *counts = block_at(c, 0, row->y, row->z);
    for (size_t n = 0; n < row->count; n++)
        counts[columns[row->columns[n]]]++;
    if (c->block_counts->span)
        see_spans(c, row);
    if (c->rays)
        count_rays(c, row);
}

/* Blocks of the columns of the whole, and behind them their cells. */
static snow_status find_columns(snow_context *context,
                                const snow_block_counts *block_counts,
                                int64_t **out) {
    const int64_t count = block_counts->grid.dims[0];
    const snow_ray_grid *rays = block_counts->rays;
    SNOW_TRY(SNOW_RESERVE(context, *out, 0, 2 * count));
    for (int64_t x = 0; x < count; x++) {
        (*out)[x] = snow_block_counts_find(block_counts, 0, x);
        (*out)[count + x] = rays ? snow_ray_grid_place(rays, 0, x) : 0;
    }
    return SNOW_STATUS_OK;
}

/* Zeros for a worker's own counts; the first one's are those of all. */
static snow_status make_counts(snow_context *context, bool first, size_t count,
                               int64_t *of_all, int64_t **out) {
    if (first) {
        *out = of_all;
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(SNOW_RESERVE(context, *out, 0, count));
    memset(*out, 0, count * sizeof **out);
    return SNOW_STATUS_OK;
}

static snow_status prepare_worker(snow_context *context,
                                  snow_block_counts *block_counts,
                                  const int64_t *columns, bool first,
                                  counting *c) {
    const int64_t *dims = block_counts->grid.dims;
    const snow_ray_grid *rays = block_counts->rays;
    span_rows *s = &c->spans;
    c->block_counts = block_counts;
    c->columns = columns;
    c->cells = columns + dims[0];
    SNOW_TRY(make_counts(context, first, snow_block_counts_blocks(block_counts),
                         block_counts->counts, &c->counts));
    if (rays)
        SNOW_TRY(make_counts(context, first, snow_ray_grid_cells(rays),
                             rays->sums, &c->rays));
    if (!block_counts->span)
        return SNOW_STATUS_OK;
    const bool along_y = block_counts->grid.axis == 0;
    *s = (span_rows){.along_y = along_y,
                     .rows = dims[!along_y],
                     .spans = (dims[along_y] - 1) / SNOW_COST_SPAN + 1,
                     .slice = -1};
    const int64_t all = s->rows * s->spans;
    SNOW_TRY(SNOW_RESERVE(context, s->seen, 0, all));
    memset(s->seen, 0, (size_t)all);
    return SNOW_STATUS_OK;
}

/* What a worker has counted goes to the counts of all. */
static void add_worker(counting *c) {
    const snow_block_counts *all = c->block_counts;
    const size_t blocks = snow_block_counts_blocks(all);
    if (all->span)
        count_spans(c, -1);
    for (size_t n = 0; n < blocks && c->counts != all->counts; n++)
        all->counts[n] += c->counts[n];
    for (size_t n = 0; c->rays && c->rays != all->rays->sums &&
                       n < snow_ray_grid_cells(all->rays);
         n++)
        all->rays->sums[n] += c->rays[n];
}

static snow_status count_blocks(const snow_interesting_walk *walk,
                                snow_block_counts *block_counts,
                                const int64_t *columns, counting *workers) {
    snow_context *context = walk->volume->context;
    for (int n = 0; n < walk->threads; n++)
        SNOW_TRY(prepare_worker(context, block_counts, columns, n == 0,
                                &workers[n]));
    SNOW_TRY(snow_visit_interesting(walk, count_row, workers));
    for (int n = 0; n < walk->threads; n++)
        add_worker(&workers[n]);
    return SNOW_STATUS_OK;
}

snow_status snow_count_interesting_blocks(const snow_volume *volume,
                                          const snow_transfer *transfer,
                                          double threshold, snow_isa isa,
                                          int threads,
                                          snow_block_counts *block_counts) {
    snow_context *context = volume->context;
    int64_t *columns = NULL;
    const snow_interesting_walk walk = {.volume = volume,
                                        .transfer = transfer,
                                        .threshold = threshold,
                                        .exponent = 1,
                                        .isa = isa,
                                        .only_counts = !block_counts->rays,
                                        .threads = threads,
                                        .step = block_counts->step};
    counting *workers =
        snow_allocate_clear(context, (size_t)threads * sizeof *workers);
    if (!workers)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = find_columns(context, block_counts, &columns);
    if (status == SNOW_STATUS_OK)
        status = count_blocks(&walk, block_counts, columns, workers);
    for (int n = 0; n < threads; n++) {
        snow_release(context, workers[n].spans.seen);
        if (n > 0) {
            snow_release(context, workers[n].counts);
            snow_release(context, workers[n].rays);
        }
    }
    snow_release(context, workers);
    snow_release(context, columns);
    return status;
}

/* Voxels for which a thread is worth the memory of its rows. */
#define THREAD_VOXELS (INT64_C(1) << 22)

/* A single block holds the whole grid. */
snow_status snow_count_interesting(const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   double threshold, snow_isa isa, int threads,
                                   int64_t *out) {
    int64_t count = 0;
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    snow_block_counts block_counts = {.blocks = {1, 1, 1}, .counts = &count};
    for (int axis = 0; axis < 3; axis++)
        block_counts.grid.dims[axis] = block_counts.block[axis] =
            part.dims[axis];
    const int64_t useful =
        1 + part.count[0] * part.count[1] * part.count[2] / THREAD_VOXELS;
    SNOW_TRY(snow_count_interesting_blocks(
        volume, transfer, threshold, isa,
        useful < threads ? (int)useful : threads, &block_counts));
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
                                    1, &interesting));
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
