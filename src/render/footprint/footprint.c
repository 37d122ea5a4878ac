/* render/footprint/footprint.c - the footprint methods, from voxels to the
 * local image: lines 02 to 13 of figure 8 of the paper, whose numbers stand in
 * the comments.
 *
 *   original, tested   a voxel row is classified and splatted, slice by slice
 *   footprint          the slab is encoded, and its interesting voxels scatter
 *
 * In perspective footprints differ from voxel to voxel
 * (splat/footprint/perspective.h), and are thrown by one thread.
 *
 * Threads take groups of slices to encode, and bands of image rows to splat
 * and composite: each walks all slices front to back for its band, so that no
 * two write one pixel.  Every pixel is made by the same operations in the same
 * order however bands are cut: the number of threads cannot change a bit. */
#include "base/minmax.h"
#include "render/modes/depth.h"
#include "render/picture.h"
#include "render/tested.h"
#include "splat/footprint/perspective.h"

#include <string.h>

#define GROUP_SLICES 8 /* of one sparse matrix */
#define BANDS_PER_THREAD 4

typedef enum stage { CLASSIFY, SHADE, ENCODE, SPLAT, COMPOSITE, STAGES } stage;

/* What one thread works with. */
typedef struct worker {
    snow_row_block row_block;
    snow_span *spans; /* of one row */
    snow_sheet sheet; /* of a band */
    snow_splatter splatter;
    snow_perspective_splatter eye; /* in perspective: instead */
    int64_t kept;                  /* voxels splatted of row blocks */
    snow_status status;
    double seconds[STAGES];
} worker;

struct snow_footprint_buffers {
    snow_context *context;
    snow_classifier classifier;
    snow_shader shader;
    snow_encoding encoding;
    snow_sparse *groups; /* EA, IA, PA of GROUP_SLICES slices each */
    worker *workers;
    int64_t group_count, worker_count; /* that were ever made */
    int64_t groups_used;               /* by this picture */
    int threads, bands;
};

/* A part of a picture's work that threads share. */
typedef struct pass {
    snow_footprint_buffers *buffers;
    const snow_job *job;
    snow_encoding encoding;
} pass;

/* The frame's buffers are made when a picture needs them. */
static snow_status new_buffers(snow_frame *frame) {
    if (frame->footprint)
        return SNOW_STATUS_OK;
    frame->footprint =
        snow_allocate_clear(frame->context, sizeof *frame->footprint);
    if (!frame->footprint)
        return SNOW_STATUS_NO_MEMORY;
    frame->footprint->context = frame->context;
    return SNOW_STATUS_OK;
}

void snow_footprint_buffers_free(snow_footprint_buffers *buffers) {
    if (!buffers)
        return;
    snow_context *context = buffers->context;
    for (int64_t n = 0; n < buffers->group_count; n++)
        snow_sparse_fini(&buffers->groups[n]);
    for (int64_t n = 0; n < buffers->worker_count; n++) {
        worker *w = &buffers->workers[n];
        snow_row_block_free(context, &w->row_block);
        snow_release(context, w->spans);
        snow_release(context, w->sheet.pixels);
        snow_splatter_fini(context, &w->splatter);
        snow_perspective_splatter_fini(context, &w->eye);
    }
    snow_release(context, buffers->groups);
    snow_release(context, buffers->workers);
    snow_classifier_fini(context, &buffers->classifier);
    snow_release(context, buffers);
}

/* --- preparation ---------------------------------------------------------- */

/* Makes an array hold `wanted` records, new ones as zeros. */
static snow_status more_records(snow_context *context, void *array_pointer,
                                int64_t *made, int64_t wanted, size_t size) {
    if (wanted <= *made)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_reserve(context, array_pointer, (uint64_t)*made,
                          (uint64_t)wanted, size));
    char *array;
    memcpy(&array, array_pointer, sizeof array);
    memset(array + (size_t)*made * size, 0, (size_t)(wanted - *made) * size);
    *made = wanted;
    return SNOW_STATUS_OK;
}

static int64_t parts_of(int64_t whole, int64_t part) {
    return (whole + part - 1) / part;
}

/* How the picture is cut for threads. */
static void cut(snow_footprint_buffers *buffers, const snow_job *job) {
    const snow_placement *p = &job->stored;
    int64_t threads = p->perspective ? 1 : job->settings.threads;
    buffers->groups_used = parts_of(job->stored_slab.count, GROUP_SLICES);
    buffers->bands = 1;
    if (threads > 1)
        buffers->bands = (int)SNOW_MIN(BANDS_PER_THREAD * threads, p->height);
    int64_t most = buffers->bands > buffers->groups_used ? buffers->bands
                                                         : buffers->groups_used;
    buffers->threads = (int)SNOW_MIN(threads, most);
}

static snow_status prepare_splatter(snow_context *context, const snow_job *job,
                                    worker *w) {
    const snow_placement *p = &job->stored;
    const snow_settings *s = &job->settings;
    if (!p->perspective)
        return snow_splatter_make(context, p, s->kernel, s->footprint,
                                  job->channels, &w->splatter);
    snow_perspective_splatter_fini(context, &w->eye);
    return snow_perspective_splatter_init(context, p, s->kernel, s->footprint,
                                          job->channels, &w->eye);
}

static snow_status prepare_worker(snow_footprint_buffers *buffers,
                                  const snow_job *job, worker *w) {
    snow_context *context = buffers->context;
    const snow_placement *p = &job->stored;
    w->kept = 0;
    w->status = SNOW_STATUS_OK;
    memset(w->seconds, 0, sizeof w->seconds);
    SNOW_TRY(snow_row_block_make(context, p, job->channels, &w->row_block));
    SNOW_TRY(SNOW_RESERVE(context, w->spans, 0, (size_t)p->columns / 2 + 1));
    /* Here and not where a thread needs it, so that what is taken does not
     * depend on which thread does what. */
    size_t row = (size_t)p->width * (size_t)job->channels;
    size_t rows = (size_t)parts_of(p->height, buffers->bands);
    SNOW_TRY(SNOW_RESERVE(context, w->sheet.pixels, 0, rows * row));
    return prepare_splatter(context, job, w);
}

/* Makes room and tables for a job. */
static snow_status prepare_tables(snow_picture *picture, snow_job *job) {
    SNOW_TRY(new_buffers(picture->frame));
    snow_footprint_buffers *buffers = picture->frame->footprint;
    snow_context *context = buffers->context;
    const snow_settings *settings = &job->settings;
    const snow_placement *p = &job->stored;
    snow_classify_options options = {
        .threshold = settings->threshold,
        /* In perspective each voxel's own length comes after. */
        .opacity_exponent =
            p->perspective ? 1 : p->path / settings->opacity_length,
        .keep_all = settings->method == SNOW_METHOD_ORIGINAL,
        .premultiply = settings->shade == SNOW_SHADE_NONE,
        .isa = settings->method == SNOW_METHOD_FOOTPRINT ? settings->isa
                                                         : SNOW_ISA_SCALAR,
    };
    SNOW_TRY(snow_classifier_make(context, job->volume, job->transfer, &options,
                                  &buffers->classifier));
    /* Normals are made for the voxels that are kept. */
    SNOW_TRY(
        snow_shader_init(context, job->volume, p, settings, &buffers->shader));
    cut(buffers, job);
    SNOW_TRY(more_records(context, &buffers->groups, &buffers->group_count,
                          buffers->groups_used, sizeof *buffers->groups));
    for (int64_t n = 0; n < buffers->groups_used; n++)
        buffers->groups[n].context = context;
    SNOW_TRY(more_records(context, &buffers->workers, &buffers->worker_count,
                          buffers->threads, sizeof *buffers->workers));
    for (int n = 0; n < buffers->threads; n++)
        SNOW_TRY(prepare_worker(buffers, job, &buffers->workers[n]));
    return SNOW_STATUS_OK;
}

/* --- work and time -------------------------------------------------------- */

/* Deals a pass' wall time out to the stages as its threads spent theirs. */
static void deal_out(snow_footprint_buffers *buffers, double wall,
                     snow_stats *stats) {
    double *totals[STAGES] = {
        [CLASSIFY] = &stats->seconds_classify,
        [SHADE] = &stats->seconds_shade,
        [ENCODE] = &stats->seconds_encode,
        [SPLAT] = &stats->seconds_splat,
        [COMPOSITE] = &stats->seconds_composite,
    };
    double spent[STAGES] = {0}, all = 0;
    for (int n = 0; n < buffers->threads; n++)
        for (int s = 0; s < STAGES; s++) {
            spent[s] += buffers->workers[n].seconds[s];
            all += buffers->workers[n].seconds[s];
            buffers->workers[n].seconds[s] = 0;
        }
    for (int s = 0; s < STAGES && all > 0; s++)
        *totals[s] += wall * spent[s] / all;
}

/* Does the items of a pass on the threads. */
static snow_status run(pass *work, int64_t items, snow_work_fn *one) {
    snow_footprint_buffers *buffers = work->buffers;
    double start = snow_seconds();
    snow_status status =
        snow_parallel(buffers->context, buffers->threads, items, one, work);
    deal_out(buffers, snow_seconds() - start, work->job->stats);
    SNOW_TRY(status);
    for (int n = 0; n < buffers->threads; n++)
        if (buffers->workers[n].status != SNOW_STATUS_OK)
            return buffers->workers[n].status;
    return SNOW_STATUS_OK;
}

/* Returns whether the picture is to end: the rest may be left out. */
static bool stops(const pass *work, const worker *w) {
    return snow_monitor_look(work->buffers->context->monitor,
                             (int)(w - work->buffers->workers));
}

/* The slab's n-th slice from the viewer. */
static int64_t nth_slice(const snow_job *job, int64_t n) {
    snow_slab slab = job->stored_slab;
    if (job->stored.perspective)
        return snow_perspective_nth_slice(&job->stored.eye, slab.first,
                                          slab.count, n);
    return slab.first + (job->stored.nearest_first ? n : slab.count - 1 - n);
}

/* In perspective: for the length of each voxel's own ray. */
static void correct_lengths(const snow_job *job, snow_row_block *row_block) {
    const snow_settings *s = &job->settings;
    if (s->mode == SNOW_MODE_OVER)
        snow_correct_opacity(&job->stored, s->opacity_length, job->channels,
                             row_block);
    else if (s->mode == SNOW_MODE_SUM)
        snow_scale_by_path_length(&job->stored, s->opacity_length,
                                  job->channels, row_block);
}

/* Classifies and shades `rows` rows of a slice, or as many as a row block
 * holds, from `row` on into the worker's. */
static void classify_and_shade(const pass *work, worker *w, int64_t slice,
                               int64_t row, int64_t rows) {
    const snow_footprint_buffers *buffers = work->buffers;
    double mark = snow_seconds();
    snow_classify_row_block(&buffers->classifier, &work->job->stored, slice,
                            row, SNOW_MIN(rows, w->row_block.room_rows),
                            &w->row_block);
    snow_lap(&mark, &w->seconds[CLASSIFY]);
    if (work->job->settings.shade == SNOW_SHADE_PHONG)
        snow_shade_row_block(&buffers->shader, work->job->channels,
                             &w->row_block);
    snow_lap(&mark, &w->seconds[SHADE]);
    if (work->job->stored.perspective)
        correct_lengths(work->job, &w->row_block);
    snow_lap(&mark, &w->seconds[CLASSIFY]);
}

/* --- encoding ------------------------------------------------------------- */

/* The encoding that takes least, by density and runs on every 8th row of every
 * 8th slice. */
static snow_encoding measure(const snow_classifier *classifier,
                             const snow_placement *p, snow_row_block *row_block,
                             snow_span *spans) {
    uint64_t voxels = 0, interesting = 0, runs = 0;
    for (int64_t slice = 0;
         slice < p->slices &&
         !snow_monitor_look(classifier->volume->context->monitor, 0);
         slice += 8)
        for (int64_t row = slice / 8 % 8; row < p->rows; row += 8) {
            snow_classify_row_block(classifier, p, slice, row, 1, row_block);
            voxels += (uint64_t)p->columns;
            interesting += row_block->count;
            runs += snow_spans_of_columns(row_block->columns, row_block->count,
                                          spans);
        }
    return snow_encoding_choose(voxels, interesting, runs);
}

/* Lines 04 to 06: one slice into the sparse matrix of its group. */
static snow_status encode_slice(const pass *work, worker *w,
                                snow_sparse *sparse, int64_t slice) {
    const snow_placement *p = &work->job->stored;
    snow_row_block *row_block = &w->row_block;
    float *samples = row_block->samples;
    snow_status status = snow_sparse_begin_slice(sparse);
    for (int64_t row = 0; row < p->rows && status == SNOW_STATUS_OK;
         row += row_block->room_rows) {
        if (stops(work, w))
            break;
        /* Classified straight into IA: most of what is encoded is samples. */
        status = snow_sparse_lend(sparse,
                                  (size_t)(row_block->room_rows * p->columns),
                                  &row_block->samples);
        if (status != SNOW_STATUS_OK)
            break;
        classify_and_shade(work, w, slice, row, p->rows - row);
        double mark = snow_seconds();
        status = snow_sparse_add_row_block(sparse, row_block);
        snow_lap(&mark, &w->seconds[ENCODE]);
    }
    row_block->samples = samples;
    return status == SNOW_STATUS_OK ? snow_sparse_end_slice(sparse) : status;
}

static snow_status encode_group(const pass *work, int64_t group, worker *w) {
    const snow_job *job = work->job;
    snow_sparse *sparse = &work->buffers->groups[group];
    SNOW_TRY(snow_sparse_begin(sparse, snow_scheme_of(work->encoding),
                               &job->stored, job->channels));
    int64_t first = group * GROUP_SLICES;
    int64_t end = SNOW_MIN(first + GROUP_SLICES, job->stored_slab.count);
    for (int64_t n = first; n < end; n++)
        SNOW_TRY(encode_slice(work, w, sparse, job->stored_slab.first + n));
    return SNOW_STATUS_OK;
}

static void encode_item(void *data, int64_t item, int number) {
    pass *work = data;
    worker *w = &work->buffers->workers[number];
    if (w->status == SNOW_STATUS_OK)
        w->status = encode_group(work, item, w);
}

/* --- scattering footprints ------------------------------------------------ */

static snow_status begin_slice(const pass *work, worker *w, int64_t slice,
                               bool *seen) {
    *seen = true;
    if (work->job->stored.perspective)
        return snow_perspective_splatter_begin_slice(work->buffers->context,
                                                     &w->eye, slice, seen);
    snow_splatter_begin_slice(&w->splatter, slice);
    return SNOW_STATUS_OK;
}

static void splat_row(const pass *work, worker *w, int64_t row, size_t spans,
                      const float *samples) {
    if (work->job->stored.perspective)
        snow_perspective_splat_row(&w->eye, &w->sheet, row, w->spans, spans,
                                   samples);
    else
        snow_splat_row(&w->splatter, &w->sheet, row, w->spans, spans, samples);
}

/* Lines 08 to 12: the interesting voxels of one slice, out of EA and IA. */
static void scatter_encoded(const pass *work, worker *w, int64_t slice,
                            int64_t first, int64_t end) {
    double mark = snow_seconds();
    snow_walk walk;
    const int64_t n = slice - work->job->stored_slab.first;
    snow_walk_begin(&walk, &work->buffers->groups[n / GROUP_SLICES],
                    n % GROUP_SLICES);
    for (int64_t row = 0; row < end && !stops(work, w); row++) {
        size_t voxel, spans = snow_walk_row(&walk, w->spans, &voxel);
        const float *samples =
            walk.sparse->ia + voxel * (size_t)work->job->channels;
        if (row >= first)
            splat_row(work, w, row, spans, samples);
    }
    snow_lap(&mark, &w->seconds[SPLAT]);
}

/* The same without a sparse matrix, row by row out of the volume: original
 * splatting, where the classifier keeps every voxel, and tested splatting. */
static void scatter_classified(const pass *work, worker *w, int64_t slice,
                               int64_t first, int64_t end) {
    snow_row_block *row_block = &w->row_block;
    for (int64_t row = first; row < end && !stops(work, w);
         row += row_block->room_rows) {
        classify_and_shade(work, w, slice, row, end - row);
        double mark = snow_seconds();
        w->kept += (int64_t)row_block->count;
        size_t begin = 0;
        for (int64_t n = 0; n < row_block->rows; n++) {
            size_t stop = row_block->row_end[n];
            size_t spans = snow_spans_of_columns(row_block->columns + begin,
                                                 stop - begin, w->spans);
            splat_row(work, w, row + n, spans,
                      row_block->samples + begin * (size_t)work->job->channels);
            begin = stop;
        }
        snow_lap(&mark, &w->seconds[SPLAT]);
    }
}

/* Line 07, from front to back: the slab's slices onto the sheet, and each
 * sheet into the local image; for one band of its rows. */
static snow_status scatter_band(const pass *work, int64_t band, worker *w) {
    const snow_job *job = work->job;
    const snow_placement *p = &job->stored;
    int64_t bands = work->buffers->bands;
    int top = (int)(p->height * band / bands);
    int bottom = (int)(p->height * (band + 1) / bands);
    double mark = snow_seconds();
    SNOW_TRY(snow_sheet_begin(work->buffers->context, p, job->channels, top,
                              bottom, &w->sheet));
    snow_lap(&mark, &w->seconds[COMPOSITE]);
    for (int64_t n = 0; n < job->stored_slab.count; n++) {
        int64_t slice = nth_slice(job, n), first = 0, end = p->rows;
        bool seen;
        if (stops(work, w))
            break;
        if (bands == 1)
            snow_monitor_report(work->buffers->context->monitor,
                                SNOW_STAGE_RENDER, (double)n,
                                (double)job->stored_slab.count);
        SNOW_TRY(begin_slice(work, w, slice, &seen));
        if (!seen)
            continue;
        if (bands > 1) /* one band takes every row, as the paper does */
            snow_splatter_rows(&w->splatter, &w->sheet, &first, &end);
        if (job->settings.method == SNOW_METHOD_FOOTPRINT)
            scatter_encoded(work, w, slice, first, end);
        else
            scatter_classified(work, w, slice, first, end);
        mark = snow_seconds();
        snow_job_clip_sheet(job, slice, &w->sheet);
        snow_depth_note_sheet(job, slice, &w->sheet);
        snow_composite_sheet(job->pixels, &w->sheet, snow_job_composite(job));
        snow_lap(&mark, &w->seconds[COMPOSITE]);
    }
    return SNOW_STATUS_OK;
}

static void scatter_item(void *data, int64_t item, int number) {
    pass *work = data;
    worker *w = &work->buffers->workers[number];
    if (w->status == SNOW_STATUS_OK)
        w->status = scatter_band(work, item, w);
}

/* --- the whole ------------------------------------------------------------ */

static snow_status encode_slab(snow_picture *p, snow_job *job) {
    snow_footprint_buffers *buffers = p->frame->footprint;
    buffers->encoding = job->settings.encoding;
    if (job->settings.method != SNOW_METHOD_FOOTPRINT)
        return SNOW_STATUS_OK;
    if (buffers->encoding == SNOW_ENCODING_AUTO)
        buffers->encoding =
            measure(&buffers->classifier, &job->stored,
                    &buffers->workers[0].row_block, buffers->workers[0].spans);
    job->stats->encoding = buffers->encoding;
    snow_monitor_next(buffers->context->monitor, SNOW_STAGE_ENCODE, 0, 1);
    pass work = {buffers, job, buffers->encoding};
    return run(&work, buffers->groups_used, encode_item);
}

static snow_status splat_and_composite(snow_picture *p, snow_job *job) {
    snow_footprint_buffers *buffers = p->frame->footprint;
    pass work = {buffers, job, buffers->encoding};
    if (buffers->bands > 1) /* else slices are reported */
        snow_monitor_next(buffers->context->monitor, SNOW_STAGE_RENDER, 0, 1);
    return run(&work, buffers->bands, scatter_item);
}

/* --- counts --------------------------------------------------------------- */

static void count_item(void *data, int64_t item, int number) {
    const pass *work = data;
    const snow_footprint_buffers *buffers = work->buffers;
    const snow_placement *p = &work->job->stored;
    worker *w = &buffers->workers[number];
    for (int64_t row = 0; row < p->rows; row += w->row_block.room_rows) {
        snow_classify_row_block(
            &buffers->classifier, p, work->job->stored_slab.first + item, row,
            SNOW_MIN(p->rows - row, w->row_block.room_rows), &w->row_block);
        w->kept += (int64_t)w->row_block.count;
    }
}

/* Original splatting keeps every voxel, and bands keep some more than once, so
 * nothing holds the number of interesting voxels, and they are counted here:
 * outside of seconds_frame. */
static snow_status count_classified(snow_footprint_buffers *buffers,
                                    const snow_job *job, int64_t *count) {
    bool known =
        job->settings.method == SNOW_METHOD_TESTED && buffers->bands == 1;
    if (!known) {
        pass work = {.buffers = buffers, .job = job};
        for (int n = 0; n < buffers->threads; n++)
            buffers->workers[n].kept = 0;
        snow_classify_options options = {.threshold = job->settings.threshold,
                                         .opacity_exponent = 1};
        SNOW_TRY(snow_classifier_make(buffers->context, job->volume,
                                      job->transfer, &options,
                                      &buffers->classifier));
        SNOW_TRY(snow_parallel(buffers->context, buffers->threads,
                               job->stored_slab.count, count_item, &work));
    }
    for (int n = 0; n < buffers->threads; n++)
        *count += buffers->workers[n].kept;
    return SNOW_STATUS_OK;
}

static void count_encoded(const snow_footprint_buffers *buffers,
                          snow_stats *stats) {
    for (int64_t n = 0; n < buffers->groups_used; n++) {
        const snow_sparse *s = &buffers->groups[n];
        stats->interesting += (int64_t)s->ia_voxels;
        stats->ea_bytes += s->ea_bytes;
        stats->ia_bytes += s->ia_voxels * (size_t)s->channels * sizeof *s->ia;
        stats->pa_bytes += (uint64_t)(s->filled + 1) * sizeof *s->pa;
    }
}

snow_status snow_footprint_count(snow_footprint_buffers *buffers,
                                 const snow_job *job) {
    snow_stats *stats = job->stats;
    if (job->settings.method == SNOW_METHOD_FOOTPRINT)
        count_encoded(buffers, stats);
    else
        SNOW_TRY(count_classified(buffers, job, &stats->interesting));
    stats->sparse_ratio = 1; /* of no voxels; snow_job_finish has others' */
    return SNOW_STATUS_OK;
}

/* Slabs of a volume in its file have been counted one by one. */
static snow_status find_figures(snow_picture *p, snow_job *job) {
    if (!job->volume->stream)
        SNOW_TRY(snow_footprint_count(p->frame->footprint, job));
    return snow_job_finish(p->frame, job);
}

const snow_render_method snow_method_footprint = {
    .classify_and_shade = prepare_tables,
    .encode = encode_slab,
    .splat_and_composite = splat_and_composite,
    .figures = find_figures,
};
