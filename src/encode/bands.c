/* encode/bands.c - a slab into the bands of the sheared method: lines 04 to 06
 * of figure 8, with codes instead of samples.
 *
 * A band is one item of work: its slices one after another, and of each the
 * rows: native voxels (fetch.h) to masks and codes (rows.h), of which a
 * gradient opacity strikes out some, masks to EA (the schemes), and for shading
 * the normals of the interesting voxels.  The result does not depend on the
 * number of threads, nor on the level of instructions.
 */
#include "encode/bands.h"

#include "base/parallel.h"
#include "encode/fetch.h"
#include "encode/rows.h"

#include <stdatomic.h>
#include <string.h>

/* Where a band's slices come from and go to, for all threads. */
typedef struct encode_job {
    snow_bands *bands;
    const snow_bands_order *order;
    snow_bands_piece piece; /* of the bands that the order is for */
    bool anew;              /* they begin with it */
    const snow_scheme *scheme;
    snow_row_encoder rows;
    unsigned char *scratch;
    size_t scratch_bytes; /* of one thread */
    atomic_int failed;    /* the last failure's snow_status */
} encode_job;

/* The scratch of a thread: masks of a slice of a band, columns of a row, and
 * what snow_fetch wants. */
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

/* --- room -----------------------------------------------------------------
 */

/* A buffer of `bytes` bytes in the place of another, of which `keep` stay. */
static snow_status exchange(snow_context *context, void *block_pointer,
                            size_t *capacity, size_t keep, size_t bytes) {
    void *old, *copy = snow_allocate(context, bytes);
    if (!copy)
        return SNOW_NO_MEMORY;
    memcpy(&old, block_pointer, sizeof old);
    if (keep)
        memcpy(copy, old, keep);
    snow_release(context, old);
    memcpy(block_pointer, &copy, sizeof copy);
    *capacity = bytes;
    return SNOW_OK;
}

/* As snow_reserve.  Bands that are encoded piece by piece grow side by side, by
 * an eighth, so that together they have little to spare. */
static snow_status reserve(snow_context *context, bool piecewise,
                           void *block_pointer, size_t *capacity, size_t keep,
                           size_t bytes) {
    if (!piecewise)
        return snow_reserve(context, block_pointer, capacity, keep, bytes);
    if (bytes <= *capacity)
        return SNOW_OK;
    size_t wanted = *capacity + *capacity / 8;
    return exchange(context, block_pointer, capacity, keep,
                    wanted > bytes ? wanted : bytes);
}

/* Room in IA for a slice of a band in which every voxel is interesting. */
static snow_status reserve_ia(snow_sparse *band, bool piecewise,
                              bool with_normals, bool with_fades) {
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
    if (with_fades)
        SNOW_TRY(reserve(context, piecewise, &band->fades,
                         &band->fades_capacity, begin * word,
                         end * word + SNOW_ROW_MARGIN));
    return SNOW_OK;
}

/* Makes a buffer as short as the `bytes` that it holds, where it is longer by
 * more than an eighth; where there is no memory for a copy it stays. */
static void trim(snow_context *context, void *block_pointer, size_t *capacity,
                 size_t bytes) {
    if (bytes<*capacity && * capacity - bytes> * capacity / 8)
        (void)exchange(context, block_pointer, capacity, bytes, bytes);
}

/* A band that is full gives back what its buffers have to spare. */
static void trim_band(snow_sparse *band) {
    snow_context *context = band->context;
    size_t voxels = band->ia_voxels, words = voxels * sizeof(uint16_t);
    trim(context, &band->ea, &band->ea_capacity,
         band->ea_bytes + SNOW_EA_MARGIN);
    trim(context, &band->codes, &band->codes_capacity,
         voxels * (size_t)band->code_bytes + SNOW_ROW_MARGIN);
    trim(context, &band->normals, &band->normals_capacity,
         words + SNOW_ROW_MARGIN);
    trim(context, &band->fades, &band->fades_capacity, words + SNOW_ROW_MARGIN);
}

/* --- a slice of a band ----------------------------------------------------
 */

/* Rows that lie end to end, and fill their masks, are one long row. */
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
    const snow_bands_order *order = job->order;
    size_t words = snow_mask_words(band);
    bool is_between = order->between && slice % 2;
    int64_t here = order->first_slice + (order->between ? slice / 2 : slice);
    for (int64_t row = 0; row < band->rows; row++) {
        size_t count = snow_columns_of_masks(
            buffers->masks + (size_t)row * words, words, buffers->columns);
        uint16_t *normals = band->normals + voxel;
        if (count && is_between)
            snow_normals_between(order->maker, order->placement, here,
                                 first_row + row, buffers->columns, count,
                                 normals);
        else if (count)
            snow_normals_of_row(order->maker, order->placement, here,
                                first_row + row, buffers->columns, count,
                                normals);
        voxel += count;
    }
}

/* Moves the codes and factors that stay from `from` on to `to` on, and strikes
 * the bits of the others out of a row's mask.  Returns how many stay. */
static size_t strike_out(snow_sparse *band, const uint32_t *columns,
                         size_t count, size_t from, size_t to, uint64_t *mask) {
    size_t size = (size_t)band->code_bytes, stay = 0;
    for (size_t n = 0; n < count; n++) {
        uint16_t fade = band->fades[to + n];
        if (fade == SNOW_NO_FADE)
            mask[columns[n] / 64] &= ~(UINT64_C(1) << columns[n] % 64);
        band->fades[to + stay] = fade;
        if (size == 1)
            band->codes[to + stay] = band->codes[from + n];
        else
            memcpy(band->codes + (to + stay) * 2, band->codes + (from + n) * 2,
                   2);
        stay += fade != SNOW_NO_FADE;
    }
    return stay;
}

/* Lets a gradient opacity judge voxels that are interesting by their values:
 * `rows` of a slice, in bands from `voxel` on.  Returns how many stay. */
static size_t fade_rows(const snow_bands_order *order, const snow_rows *rows,
                        const row_buffers *buffers, snow_sparse *band,
                        snow_fade_row row, size_t voxel) {
    size_t words = (rows->columns + 63) / 64, from = voxel, to = voxel;
    row.placement = order->placement;
    for (size_t n = 0; n < rows->rows; n++, row.row++) {
        uint64_t *mask = buffers->masks + n * words;
        size_t count = snow_columns_of_masks(mask, words, buffers->columns);
        snow_fade_codes(order->fader, &row, rows->voxels + n * rows->stride,
                        buffers->columns, count, band->fades + to);
        to += strike_out(band, buffers->columns, count, from, to, mask);
        from += count;
    }
    return to - voxel;
}

static snow_status encode_slice(const encode_job *job,
                                const row_buffers *buffers, snow_fetch *fetch,
                                snow_sparse *band, int64_t first_row,
                                int64_t slice) {
    const snow_bands_order *order = job->order;
    size_t begin = band->ia_voxels;
    snow_rows rows, apart;
    SNOW_TRY(reserve_ia(band, !job->anew, order->maker != NULL,
                        order->fader != NULL));
    snow_fetch_slice(fetch, slice, &apart);
    rows = apart;
    join_rows(&rows, fetch->size);
    size_t count =
        job->rows.encode_rows(&job->rows, &rows, buffers->masks,
                              band->codes + begin * (size_t)band->code_bytes);
    if (order->fader && count)
        count = fade_rows(order, &apart, buffers, band,
                          (snow_fade_row){
                              .slice = order->first_slice +
                                       (order->between ? slice / 2 : slice),
                              .row = first_row,
                              .between = order->between && slice % 2,
                          },
                          begin);
    band->ia_voxels += count;
    if (order->maker && count)
        make_normals(job, buffers, band, first_row, slice, begin);
    return snow_sparse_add_masks(band, buffers->masks, count);
}

/* Rows first_row .. first_row + rows - 1 of slices of the volume. */
static snow_fetch_order fetch_order(const snow_bands_order *order,
                                    int64_t first_slice, int64_t slices,
                                    int64_t first_row, int64_t rows) {
    return (snow_fetch_order){.volume = order->volume,
                              .placement = order->placement,
                              .first_slice = first_slice,
                              .slices = slices,
                              .first_row = first_row,
                              .rows = rows,
                              .between = order->between,
                              .isa = order->isa};
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
    const snow_bands_order *order = job->order;
    snow_sparse *band = &bands->bands[job->piece.first_band + number];
    int64_t first = job->piece.first_row + number * SNOW_BAND_ROWS;
    int64_t rows = band_rows(bands, job->piece.first_band + number);
    row_buffers buffers = buffers_of(job, worker);
    snow_fetch_order from =
        fetch_order(order, order->first_slice, order->slice_count, first, rows);
    snow_fetch fetch;
    snow_fetch_begin(&fetch, &from, buffers.fetch);
    if (job->anew)
        SNOW_TRY(begin_band(bands, job->piece.first_band + number, job->scheme,
                            order->isa));
    for (int64_t slice = 0; slice < job->piece.slices; slice++)
        SNOW_TRY(encode_slice(job, &buffers, &fetch, band, first, slice));
    if (!job->anew && band->filled == bands->slices)
        trim_band(band);
    return SNOW_OK;
}

static void work(void *arguments, int64_t item, int worker) {
    encode_job *job = arguments;
    if (atomic_load(&job->failed))
        return;
    snow_status status = encode_band(job, item, worker);
    if (status != SNOW_OK)
        atomic_store(&job->failed, (int)status);
}

/* --- density and runs ----------------------------------------------------- */

/* One row in so many is looked at, spread evenly over the slab; no fewer than
 * ROWS_LEAST and no more than fit into VOXELS_MOST: a row along y costs a cache
 * line for each voxel. */
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

/* Runs that begin in a row. */
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

/* Measures rows of the slab (without slices between) and chooses. */
static snow_status choose(encode_job *job) {
    snow_bands *bands = job->bands;
    const snow_bands_order *order = job->order;
    size_t words = ((size_t)bands->columns + 63) / 64;
    int64_t rows = bands->rows * order->slice_count;
    int64_t step = sample_step(bands, rows);
    uint64_t voxels = 0, interesting = 0, runs = 0;
    row_buffers buffers = buffers_of(job, 0);
    snow_sparse *codes = &bands->bands[0]; /* lends its buffers */
    SNOW_TRY(snow_sparse_begin_band(codes, &snow_scheme_bitmap, bands->columns,
                                    1, bands->slices, bands->code_bytes,
                                    order->isa));
    SNOW_TRY(reserve_ia(codes, false, false, order->fader != NULL));
    for (int64_t n = 0; n < rows; n += step) {
        snow_fetch_order from = fetch_order(
            order, order->first_slice + n / bands->rows, 1, n % bands->rows, 1);
        snow_fetch fetch;
        snow_rows row;
        from.between = false;
        snow_fetch_begin(&fetch, &from, buffers.fetch);
        snow_fetch_slice(&fetch, 0, &row);
        size_t count = job->rows.encode_rows(&job->rows, &row, buffers.masks,
                                             codes->codes);
        if (order->fader && count)
            count = fade_rows(order, &row, &buffers, codes,
                              (snow_fade_row){.slice = from.first_slice,
                                              .row = from.first_row},
                              0);
        interesting += count;
        runs += count_runs(buffers.masks, words);
        voxels += (uint64_t)bands->columns;
    }
    bands->encoding = snow_encoding_choose(voxels, interesting, runs);
    return SNOW_OK;
}

/* --- setting up ----------------------------------------------------------- */

/* Records for so many bands; new ones are empty. */
static snow_status reserve_bands(snow_bands *bands, int64_t count) {
    size_t before = bands->capacity;
    SNOW_TRY(snow_reserve(bands->context, &bands->bands, &bands->capacity,
                          before, (size_t)count * sizeof *bands->bands));
    size_t n = before / sizeof *bands->bands;
    for (; n < bands->capacity / sizeof *bands->bands; n++)
        bands->bands[n] = (snow_sparse){.context = bands->context};
    bands->band_count = count;
    return SNOW_OK;
}

static snow_status measure(snow_bands *bands, const snow_bands_order *order) {
    const snow_placement *p = order->placement;
    uint64_t voxels;
    if (!snow_mul_u64((uint64_t)p->columns, (uint64_t)p->rows, &voxels) ||
        voxels > UINT32_MAX)
        return snow_fail(bands->context, SNOW_BAD_USAGE,
                         "slices of %lldx%lld voxels are too large to encode; "
                         "take a part of the volume",
                         (long long)p->columns, (long long)p->rows);
    bands->columns = p->columns;
    bands->rows = p->rows;
    bands->slices = order->slice_count;
    if (order->between && order->slice_count)
        bands->slices = 2 * order->slice_count - 1;
    bands->code_bytes = order->coder->bytes;
    bands->with_normals = order->maker != NULL;
    bands->with_fades = order->fader != NULL;
    bands->encoding = order->encoding;
    return SNOW_OK;
}

static int64_t count_bands(const snow_bands *bands) {
    return (bands->rows + SNOW_BAND_ROWS - 1) / SNOW_BAND_ROWS;
}

/* What the threads need. */
static snow_status prepare(encode_job *job, int threads) {
    snow_bands *bands = job->bands;
    const snow_bands_order *order = job->order;
    int64_t rows = bands->rows < SNOW_BAND_ROWS ? bands->rows : SNOW_BAND_ROWS;
    snow_fetch_order from = fetch_order(order, 0, order->slice_count, 0, rows);
    job->scratch_bytes = mask_bytes(bands) + column_bytes(bands) +
                         aligned(snow_fetch_bytes(&from));
    SNOW_TRY(snow_reserve(bands->context, &bands->scratch,
                          &bands->scratch_capacity, 0,
                          (size_t)threads * job->scratch_bytes));
    job->scratch = bands->scratch;
    snow_row_encoder_init(order->coder, order->isa, &job->rows);
    if (bands->encoding == SNOW_ENCODING_AUTO)
        SNOW_TRY(choose(job));
    job->scheme = snow_scheme_of(bands->encoding);
    return SNOW_OK;
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
    if (bands->with_fades)
        size += sizeof(uint16_t);
    bands->voxels = voxels;
    bands->ea_bytes = ea;
    bands->ia_bytes = voxels * size;
    bands->pa_bytes =
        (uint64_t)bands->band_count * slices * sizeof(snow_slice_pointer);
}

static snow_status encode_piece(snow_bands *bands,
                                const snow_bands_order *order,
                                const snow_bands_piece *piece, bool anew) {
    int64_t count = piece->band_count;
    int threads = order->threads < count ? order->threads : (int)count;
    encode_job job = {
        .bands = bands, .order = order, .piece = *piece, .anew = anew};
    atomic_init(&job.failed, SNOW_OK);
    SNOW_TRY(prepare(&job, threads));
    snow_parallel(bands->context, threads, count, work, &job);
    return (snow_status)atomic_load(&job.failed);
}

snow_status snow_bands_encode(snow_bands *bands,
                              const snow_bands_order *order) {
    SNOW_TRY(measure(bands, order));
    SNOW_TRY(reserve_bands(bands, count_bands(bands)));
    const snow_bands_piece all = {.band_count = bands->band_count,
                                  .slices = bands->slices};
    SNOW_TRY(encode_piece(bands, order, &all, true));
    add_up(bands);
    return SNOW_OK;
}

/* --- piece by piece ------------------------------------------------------- */

snow_status snow_bands_begin(snow_bands *bands, const snow_bands_order *order) {
    SNOW_TRY(measure(bands, order));
    if (bands->encoding == SNOW_ENCODING_AUTO)
        bands->encoding = SNOW_ENCODING_BITMAP;
    SNOW_TRY(reserve_bands(bands, count_bands(bands)));
    for (int64_t n = 0; n < bands->band_count; n++)
        SNOW_TRY(
            begin_band(bands, n, snow_scheme_of(bands->encoding), order->isa));
    return SNOW_OK;
}

snow_status snow_bands_append(snow_bands *bands, const snow_bands_order *order,
                              const snow_bands_piece *piece) {
    return encode_piece(bands, order, piece, false);
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
