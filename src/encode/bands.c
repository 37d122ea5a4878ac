/* encode/bands.c - encodes a slab into the bands of the shear-warp method:
 * lines 04 to 06 of figure 8, with codes instead of samples.
 *
 * A band is one work item. Its slices are encoded one after another: rows of
 * native voxels (fetch.h) become masks and codes (rows.h); a gradient opacity
 * removes some of them; the schemes write the masks to EA; and for shading the
 * normals of the interesting voxels are added. The result does not depend on
 * the number of threads or on the instruction set. */
#include "encode/bands.h"

#include "base/thread_pool.h"
#include "encode/fetch.h"
#include "encode/rows.h"

#include <stdatomic.h>
#include <string.h>

/* Source and destination of a band's slices, for all threads. */
typedef struct encode_job {
    snow_bands *bands;
    const snow_bands_params *params;
    snow_bands_piece piece; /* the part of the bands that the params are for */
    bool anew;              /* the bands begin with it */
    const snow_scheme *scheme;
    snow_row_encoder rows;
    unsigned char *scratch;
    size_t scratch_bytes; /* of one thread */
    atomic_int failed;    /* the last failure's snow_status */
} encode_job;

/* The scratch memory of a thread: masks of a slice of a band, columns of a row,
 * and the scratch of snow_fetch. */
typedef struct row_buffers {
    uint64_t *masks;
    uint32_t *columns;
    unsigned char *fetch;
} row_buffers;

static size_t aligned(size_t bytes) {
    return (bytes + 63) / 64 * 64;
}

static size_t mask_bytes(const snow_bands *bands) {
    size_t words = ((size_t)bands->columns + 63) / 64;
    return aligned(SNOW_BAND_ROWS * words * sizeof(uint64_t));
}

static size_t column_bytes(const snow_bands *bands) {
    return aligned((size_t)bands->columns * sizeof(uint32_t) + 64);
}

static row_buffers buffers_of(const encode_job *job, int worker) {
    unsigned char *at = job->scratch + (size_t)worker * job->scratch_bytes;
    unsigned char *columns = at + mask_bytes(job->bands);
    return (row_buffers){(uint64_t *)(void *)at, (uint32_t *)(void *)columns,
                         columns + column_bytes(job->bands)};
}

/* --- memory --------------------------------------------------------------- */

/* Replaces a buffer by one of `bytes` bytes; the first `keep` are copied. */
static snow_status exchange(snow_context *context, void *block_pointer,
                            size_t *capacity, size_t keep, size_t bytes) {
    void *old, *copy = snow_allocate(context, bytes);
    if (!copy)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(&old, block_pointer, sizeof old);
    if (keep)
        memcpy(copy, old, keep);
    snow_release(context, old);
    memcpy(block_pointer, &copy, sizeof copy);
    *capacity = bytes;
    return SNOW_STATUS_OK;
}

/* As snow_reserve. Bands that are encoded piecewise grow together, by an eighth
 * each, so that they have little unused memory in sum. */
static snow_status reserve(snow_context *context, bool piecewise,
                           void *block_pointer, size_t *capacity, size_t keep,
                           size_t bytes) {
    if (!piecewise)
        return snow_reserve(context, block_pointer, capacity, keep, bytes);
    if (bytes <= *capacity)
        return SNOW_STATUS_OK;
    size_t wanted = *capacity + *capacity / 8;
    return exchange(context, block_pointer, capacity, keep,
                    wanted > bytes ? wanted : bytes);
}

/* Reserves IA for a slice of a band in which every voxel is interesting. */
static snow_status reserve_ia(snow_sparse *band, bool piecewise,
                              bool with_normals, bool with_gradient_factors) {
    snow_context *context = band->context;
    size_t voxels = (size_t)band->columns * (size_t)band->rows;
    size_t size = (size_t)band->code_bytes, word = sizeof(uint16_t);
    size_t begin = band->ia_voxels, end = band->ia_voxels + voxels;
    SNOW_TRY(reserve(context, piecewise, &band->codes, &band->codes_capacity,
                     begin * size, end * size + SNOW_ROW_MARGIN));
    if (with_normals)
        SNOW_TRY(reserve(context, piecewise, &band->normals,
                         &band->normals_capacity, begin * word,
                         end * word + SNOW_ROW_MARGIN));
    if (with_gradient_factors)
        SNOW_TRY(reserve(context, piecewise, &band->gradient_factors,
                         &band->gradient_factors_capacity, begin * word,
                         end * word + SNOW_ROW_MARGIN));
    return SNOW_STATUS_OK;
}

/* Shrinks a buffer to the `bytes` that it holds if it is more than an eighth
 * longer. Without memory for the copy it stays as it is. */
static void trim(snow_context *context, void *block_pointer, size_t *capacity,
                 size_t bytes) {
    if (bytes<*capacity && * capacity - bytes> * capacity / 8)
        (void)exchange(context, block_pointer, capacity, bytes, bytes);
}

/* Frees the unused memory of a full band. */
static void trim_band(snow_sparse *band) {
    snow_context *context = band->context;
    size_t voxels = band->ia_voxels, words = voxels * sizeof(uint16_t);
    trim(context, &band->ea, &band->ea_capacity,
         band->ea_bytes + SNOW_EA_MARGIN);
    trim(context, &band->codes, &band->codes_capacity,
         voxels * (size_t)band->code_bytes + SNOW_ROW_MARGIN);
    trim(context, &band->normals, &band->normals_capacity,
         words + SNOW_ROW_MARGIN);
    trim(context, &band->gradient_factors, &band->gradient_factors_capacity,
         words + SNOW_ROW_MARGIN);
}

/* --- a slice of a band ----------------------------------------------------
 */

/* Contiguous rows that fill their masks become one long row. */
static void join_rows(snow_rows *rows, size_t size) {
    if (rows->columns % 64 == 0 && rows->stride == rows->columns * size) {
        rows->columns *= rows->rows;
        rows->rows = 1;
    }
}

/* Normals of a slice whose masks are known and whose voxels begin at `voxel` in
 * IA. */
static void make_normals(const encode_job *job, const row_buffers *buffers,
                         snow_sparse *band, int64_t first_row, int64_t slice,
                         size_t voxel) {
    const snow_bands_params *params = job->params;
    size_t words = snow_mask_words(band);
    bool is_between = params->between && slice % 2;
    int64_t here = params->first_slice + (params->between ? slice / 2 : slice);
    for (int64_t row = 0; row < band->rows; row++) {
        size_t count = snow_columns_of_masks(
            buffers->masks + (size_t)row * words, words, buffers->columns);
        uint16_t *normals = band->normals + voxel;
        if (count && is_between)
            snow_normals_between(params->maker, params->placement, here,
                                 first_row + row, buffers->columns, count,
                                 normals);
        else if (count)
            snow_normals_of_row(params->maker, params->placement, here,
                                first_row + row, buffers->columns, count,
                                normals);
        voxel += count;
    }
}

/* Moves the codes and factors that remain from `from` on to `to` on, and clears
 * the bits of the others in a row's mask. Returns the number that remain. */
static size_t strike_out(snow_sparse *band, const uint32_t *columns,
                         size_t count, size_t from, size_t to, uint64_t *mask) {
    size_t size = (size_t)band->code_bytes, stay = 0;
    for (size_t n = 0; n < count; n++) {
        uint16_t fade = band->gradient_factors[to + n];
        if (fade == SNOW_NO_GRADIENT_OPACITY)
            mask[columns[n] / 64] &= ~(UINT64_C(1) << columns[n] % 64);
        band->gradient_factors[to + stay] = fade;
        if (size == 1)
            band->codes[to + stay] = band->codes[from + n];
        else
            memcpy(band->codes + (to + stay) * 2, band->codes + (from + n) * 2,
                   2);
        stay += fade != SNOW_NO_GRADIENT_OPACITY;
    }
    return stay;
}

/* Applies a gradient opacity to voxels that are interesting by value: `rows` of
 * a slice, in bands from `voxel` on. Returns the number that remain
 * interesting. */
static size_t apply_gradient_opacity_rows(const snow_bands_params *params,
                                          const snow_rows *rows,
                                          const row_buffers *buffers,
                                          snow_sparse *band,
                                          snow_gradient_opacity_row row,
                                          size_t voxel) {
    size_t words = (rows->columns + 63) / 64, from = voxel, to = voxel;
    row.placement = params->placement;
    for (size_t n = 0; n < rows->rows; n++, row.row++) {
        uint64_t *mask = buffers->masks + n * words;
        size_t count = snow_columns_of_masks(mask, words, buffers->columns);
        snow_gradient_opacity_codes(
            params->gradient_opacity, &row, rows->voxels + n * rows->stride,
            buffers->columns, count, band->gradient_factors + to);
        to += strike_out(band, buffers->columns, count, from, to, mask);
        from += count;
    }
    return to - voxel;
}

static snow_status encode_slice(const encode_job *job,
                                const row_buffers *buffers, snow_fetch *fetch,
                                snow_sparse *band, int64_t first_row,
                                int64_t slice) {
    const snow_bands_params *params = job->params;
    size_t begin = band->ia_voxels;
    snow_rows rows, apart;
    SNOW_TRY(reserve_ia(band, !job->anew, params->maker != NULL,
                        params->gradient_opacity != NULL));
    snow_fetch_slice(fetch, slice, &apart);
    rows = apart;
    join_rows(&rows, fetch->size);
    size_t count =
        job->rows.encode_rows(&job->rows, &rows, buffers->masks,
                              band->codes + begin * (size_t)band->code_bytes);
    if (params->gradient_opacity && count)
        count = apply_gradient_opacity_rows(
            params, &apart, buffers, band,
            (snow_gradient_opacity_row){
                .slice =
                    params->first_slice + (params->between ? slice / 2 : slice),
                .row = first_row,
                .between = params->between && slice % 2,
            },
            begin);
    band->ia_voxels += count;
    if (params->maker && count)
        make_normals(job, buffers, band, first_row, slice, begin);
    return snow_sparse_add_masks(band, buffers->masks, count);
}

/* Rows first_row .. first_row + rows - 1 of slices of the volume. */
static snow_fetch_params fetch_params(const snow_bands_params *params,
                                      int64_t first_slice, int64_t slices,
                                      int64_t first_row, int64_t rows) {
    return (snow_fetch_params){.volume = params->volume,
                               .placement = params->placement,
                               .first_slice = first_slice,
                               .slices = slices,
                               .first_row = first_row,
                               .rows = rows,
                               .between = params->between,
                               .isa = params->isa};
}

static int64_t band_rows(const snow_bands *bands, int64_t number) {
    int64_t left = bands->rows - number * SNOW_BAND_ROWS;
    return left < SNOW_BAND_ROWS ? left : SNOW_BAND_ROWS;
}

static snow_status begin_band(const snow_bands *bands, int64_t number,
                              const snow_scheme *scheme, snow_isa isa) {
    return snow_sparse_begin_band(&bands->bands[number], scheme, bands->columns,
                                  band_rows(bands, number), bands->slices,
                                  bands->code_bytes, isa);
}

static snow_status encode_band(const encode_job *job, int64_t number,
                               int worker) {
    const snow_bands *bands = job->bands;
    const snow_bands_params *params = job->params;
    snow_sparse *band = &bands->bands[job->piece.first_band + number];
    int64_t first = job->piece.first_row + number * SNOW_BAND_ROWS;
    int64_t rows = band_rows(bands, job->piece.first_band + number);
    row_buffers buffers = buffers_of(job, worker);
    snow_fetch_params from = fetch_params(params, params->first_slice,
                                          params->slice_count, first, rows);
    snow_fetch fetch;
    snow_fetch_begin(&fetch, &from, buffers.fetch);
    if (job->anew)
        SNOW_TRY(begin_band(bands, job->piece.first_band + number, job->scheme,
                            params->isa));
    for (int64_t slice = 0; slice < job->piece.slices; slice++) {
        if (snow_monitor_look(bands->context->monitor, worker))
            return SNOW_STATUS_OK; /* snow_parallel fails */
        SNOW_TRY(encode_slice(job, &buffers, &fetch, band, first, slice));
    }
    if (!job->anew && band->filled == bands->slices)
        trim_band(band);
    return SNOW_STATUS_OK;
}

static void encode_item(void *arguments, int64_t item, int worker) {
    encode_job *job = arguments;
    if (atomic_load(&job->failed))
        return;
    snow_status status = encode_band(job, item, worker);
    if (status != SNOW_STATUS_OK)
        atomic_store(&job->failed, (int)status);
}

/* --- density and runs ----------------------------------------------------- */

/* One row in SAMPLE_STEP is sampled, spread evenly over the slab; at least
 * ROWS_LEAST and at most what fits into VOXELS_MOST: a row along y costs a
 * cache line for each voxel. */
#define SAMPLE_STEP 199
#define ROWS_LEAST 64
#define VOXELS_MOST 65536

static int64_t sample_step(const snow_bands *bands, int64_t rows) {
    int64_t step = SAMPLE_STEP;
    int64_t most = VOXELS_MOST / bands->columns + ROWS_LEAST;
    if (rows / step > most)
        step = rows / most;
    if (rows / step < ROWS_LEAST)
        step = rows / ROWS_LEAST;
    return step < 1 ? 1 : step;
}

/* The number of runs that begin in a row. */
static size_t count_runs(const uint64_t *masks, size_t words) {
    uint64_t before = 0;
    size_t runs = 0;
    for (size_t w = 0; w < words; w++) {
        runs +=
            (size_t)__builtin_popcountll(masks[w] & ~(masks[w] << 1 | before));
        before = masks[w] >> 63;
    }
    return runs;
}

/* Measures rows of the slab (without intermediate slices) and chooses. */
static snow_status choose(encode_job *job) {
    snow_bands *bands = job->bands;
    const snow_bands_params *params = job->params;
    size_t words = ((size_t)bands->columns + 63) / 64;
    int64_t rows = bands->rows * params->slice_count;
    int64_t step = sample_step(bands, rows);
    uint64_t voxels = 0, interesting = 0, runs = 0;
    row_buffers buffers = buffers_of(job, 0);
    snow_sparse *codes = &bands->bands[0]; /* for its buffers */
    SNOW_TRY(snow_sparse_begin_band(codes, &snow_scheme_bitmap, bands->columns,
                                    1, bands->slices, bands->code_bytes,
                                    params->isa));
    SNOW_TRY(reserve_ia(codes, false, false, params->gradient_opacity != NULL));
    for (int64_t n = 0; n < rows; n += step) {
        snow_fetch_params from =
            fetch_params(params, params->first_slice + n / bands->rows, 1,
                         n % bands->rows, 1);
        snow_fetch fetch;
        snow_rows row;
        from.between = false;
        snow_fetch_begin(&fetch, &from, buffers.fetch);
        snow_fetch_slice(&fetch, 0, &row);
        size_t count = job->rows.encode_rows(&job->rows, &row, buffers.masks,
                                             codes->codes);
        if (params->gradient_opacity && count)
            count = apply_gradient_opacity_rows(
                params, &row, &buffers, codes,
                (snow_gradient_opacity_row){.slice = from.first_slice,
                                            .row = from.first_row},
                0);
        interesting += count;
        runs += count_runs(buffers.masks, words);
        voxels += (uint64_t)bands->columns;
    }
    bands->encoding = snow_encoding_choose(voxels, interesting, runs);
    return SNOW_STATUS_OK;
}

/* --- setting up ----------------------------------------------------------- */

/* Reserves records for `count` bands; new ones are empty. */
static snow_status reserve_bands(snow_bands *bands, int64_t count) {
    size_t before = bands->capacity;
    SNOW_TRY(snow_reserve(bands->context, &bands->bands, &bands->capacity,
                          before, (size_t)count * sizeof *bands->bands));
    size_t n = before / sizeof *bands->bands;
    for (; n < bands->capacity / sizeof *bands->bands; n++)
        bands->bands[n] = (snow_sparse){.context = bands->context};
    bands->band_count = count;
    return SNOW_STATUS_OK;
}

static snow_status measure_bands(snow_bands *bands,
                                 const snow_bands_params *params) {
    const snow_placement *p = params->placement;
    uint64_t voxels;
    if (!snow_mul_u64((uint64_t)p->columns, (uint64_t)p->rows, &voxels) ||
        voxels > UINT32_MAX)
        return snow_fail(
            bands->context, SNOW_STATUS_BAD_USAGE,
            "slices of %lldx%lld voxels are too large to encode: the limit is "
            "4294967295 voxels; render a part of the volume",
            (long long)p->columns, (long long)p->rows);
    bands->columns = p->columns;
    bands->rows = p->rows;
    bands->slices = params->slice_count;
    if (params->between && params->slice_count)
        bands->slices = 2 * params->slice_count - 1;
    bands->code_bytes = params->quantizer->bytes;
    bands->with_normals = params->maker != NULL;
    bands->with_gradient_factors = params->gradient_opacity != NULL;
    bands->encoding = params->encoding;
    return SNOW_STATUS_OK;
}

static int64_t count_bands(const snow_bands *bands) {
    return (bands->rows + SNOW_BAND_ROWS - 1) / SNOW_BAND_ROWS;
}

/* Prepares what the threads need. */
static snow_status prepare(encode_job *job, int threads) {
    snow_bands *bands = job->bands;
    const snow_bands_params *params = job->params;
    int64_t rows = bands->rows < SNOW_BAND_ROWS ? bands->rows : SNOW_BAND_ROWS;
    snow_fetch_params from =
        fetch_params(params, 0, params->slice_count, 0, rows);
    job->scratch_bytes = mask_bytes(bands) + column_bytes(bands) +
                         aligned(snow_fetch_bytes(&from));
    SNOW_TRY(snow_reserve(bands->context, &bands->scratch,
                          &bands->scratch_capacity, 0,
                          (size_t)threads * job->scratch_bytes));
    job->scratch = bands->scratch;
    snow_row_encoder_init(params->quantizer, params->isa, &job->rows);
    if (bands->encoding == SNOW_ENCODING_AUTO)
        SNOW_TRY(choose(job));
    job->scheme = snow_scheme_of(bands->encoding);
    return SNOW_STATUS_OK;
}

static void add_up(snow_bands *bands) {
    uint64_t voxels = 0, ea = 0, slices = (uint64_t)bands->slices + 1;
    for (int64_t n = 0; n < bands->band_count; n++) {
        voxels += bands->bands[n].ia_voxels;
        ea += bands->bands[n].ea_bytes;
    }
    uint64_t size = (uint64_t)bands->code_bytes;
    if (bands->with_normals)
        size += sizeof(uint16_t);
    if (bands->with_gradient_factors)
        size += sizeof(uint16_t);
    bands->voxels = voxels;
    bands->ea_bytes = ea;
    bands->ia_bytes = voxels * size;
    bands->pa_bytes =
        (uint64_t)bands->band_count * slices * sizeof(snow_slice_pointer);
}

static snow_status encode_piece(snow_bands *bands,
                                const snow_bands_params *params,
                                const snow_bands_piece *piece, bool anew) {
    int64_t count = piece->band_count;
    int threads = params->threads < count ? params->threads : (int)count;
    encode_job job = {
        .bands = bands, .params = params, .piece = *piece, .anew = anew};
    atomic_init(&job.failed, SNOW_STATUS_OK);
    SNOW_TRY(prepare(&job, threads));
    snow_monitor_next(bands->context->monitor, SNOW_STAGE_ENCODE, 0, 1);
    SNOW_TRY(snow_parallel(bands->context, threads, count, encode_item, &job));
    return (snow_status)atomic_load(&job.failed);
}

snow_status snow_bands_encode(snow_bands *bands,
                              const snow_bands_params *params) {
    SNOW_TRY(measure_bands(bands, params));
    SNOW_TRY(reserve_bands(bands, count_bands(bands)));
    const snow_bands_piece all = {.band_count = bands->band_count,
                                  .slices = bands->slices};
    SNOW_TRY(encode_piece(bands, params, &all, true));
    add_up(bands);
    return SNOW_STATUS_OK;
}

/* --- piecewise ------------------------------------------------------------ */

snow_status snow_bands_begin(snow_bands *bands,
                             const snow_bands_params *params) {
    SNOW_TRY(measure_bands(bands, params));
    if (bands->encoding == SNOW_ENCODING_AUTO)
        bands->encoding = SNOW_ENCODING_BITMAP;
    SNOW_TRY(reserve_bands(bands, count_bands(bands)));
    for (int64_t n = 0; n < bands->band_count; n++)
        SNOW_TRY(
            begin_band(bands, n, snow_scheme_of(bands->encoding), params->isa));
    return SNOW_STATUS_OK;
}

snow_status snow_bands_append(snow_bands *bands,
                              const snow_bands_params *params,
                              const snow_bands_piece *piece) {
    return encode_piece(bands, params, piece, false);
}

void snow_bands_end(snow_bands *bands) {
    snow_release(bands->context, bands->scratch);
    bands->scratch = NULL;
    bands->scratch_capacity = 0;
    add_up(bands);
}

void snow_bands_fini(snow_bands *bands) {
    for (size_t n = 0; n < bands->capacity / sizeof *bands->bands; n++)
        snow_sparse_fini(&bands->bands[n]);
    snow_release(bands->context, bands->bands);
    snow_release(bands->context, bands->scratch);
    *bands = (snow_bands){.context = bands->context};
}
