/* encode/bands/bands.c - encodes a slab into the bands of the shear-warp
 * method: lines 04 to 06 of figure 8, with codes instead of samples.
 *
 * A band is one work item. Its slices are encoded one after another (slice.c).
 * The result does not depend on the number of threads or on the instruction
 * set. */
#include "encode/bands/internal.h"

#include "base/thread_pool.h"

#include <string.h>

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

snow_row_buffers snow_row_buffers_of(const snow_encode_job *job, int worker) {
    unsigned char *at = job->scratch + (size_t)worker * job->scratch_bytes;
    unsigned char *columns = at + mask_bytes(job->bands);
    return (snow_row_buffers){(uint64_t *)(void *)at,
                              (uint32_t *)(void *)columns,
                              columns + column_bytes(job->bands)};
}

snow_fetch_params snow_band_fetch_params(const snow_bands_params *params,
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

static snow_status encode_band(const snow_encode_job *job, int64_t number,
                               int worker) {
    const snow_bands *bands = job->bands;
    const snow_bands_params *params = job->params;
    snow_sparse *band = &bands->bands[job->piece.first_band + number];
    int64_t first = job->piece.first_row + number * SNOW_BAND_ROWS;
    int64_t rows = band_rows(bands, job->piece.first_band + number);
    snow_row_buffers buffers = snow_row_buffers_of(job, worker);
    snow_fetch_params from = snow_band_fetch_params(
        params, params->first_slice, params->slice_count, first, rows);
    snow_fetch fetch;
    snow_fetch_begin(&fetch, &from, buffers.fetch);
    if (job->anew)
        SNOW_TRY(begin_band(bands, job->piece.first_band + number, job->scheme,
                            params->isa));
    for (int64_t slice = 0; slice < job->piece.slices; slice++) {
        if (snow_monitor_look(bands->context->monitor, worker))
            return SNOW_STATUS_OK; /* snow_parallel fails */
        SNOW_TRY(
            snow_band_encode_slice(job, &buffers, &fetch, band, first, slice));
    }
    if (!job->anew && band->filled == bands->slices)
        snow_band_trim(band);
    return SNOW_STATUS_OK;
}

static void encode_item(void *arguments, int64_t item, int worker) {
    snow_encode_job *job = arguments;
    if (atomic_load(&job->failed))
        return;
    snow_status status = encode_band(job, item, worker);
    if (status != SNOW_STATUS_OK)
        atomic_store(&job->failed, (int)status);
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
static snow_status prepare(snow_encode_job *job, int threads) {
    snow_bands *bands = job->bands;
    const snow_bands_params *params = job->params;
    int64_t rows = bands->rows < SNOW_BAND_ROWS ? bands->rows : SNOW_BAND_ROWS;
    snow_fetch_params from =
        snow_band_fetch_params(params, 0, params->slice_count, 0, rows);
    job->scratch_bytes = mask_bytes(bands) + column_bytes(bands) +
                         aligned(snow_fetch_bytes(&from));
    SNOW_TRY(snow_reserve(bands->context, &bands->scratch,
                          &bands->scratch_capacity, 0,
                          (size_t)threads * job->scratch_bytes));
    job->scratch = bands->scratch;
    snow_row_encoder_init(params->quantizer, params->isa, &job->rows);
    if (bands->encoding == SNOW_ENCODING_AUTO)
        SNOW_TRY(snow_bands_choose_encoding(job));
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
    snow_encode_job job = {
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
