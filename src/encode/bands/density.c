/* encode/bands/density.c - chooses the encoding by the density of interesting
 * voxels and the length of their runs, which a sample of rows shows. */
#include "encode/bands/internal.h"

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

snow_status snow_bands_choose_encoding(snow_encode_job *job) {
    snow_bands *bands = job->bands;
    const snow_bands_params *params = job->params;
    size_t words = ((size_t)bands->columns + 63) / 64;
    int64_t rows = bands->rows * params->slice_count;
    int64_t step = sample_step(bands, rows);
    uint64_t voxels = 0, interesting = 0, runs = 0;
    snow_row_buffers buffers = snow_row_buffers_of(job, 0);
    snow_sparse *codes = &bands->bands[0]; /* for its buffers */
    SNOW_TRY(snow_sparse_begin_band(codes, &snow_scheme_bitmap, bands->columns,
                                    1, bands->slices, bands->code_bytes,
                                    params->isa));
    SNOW_TRY(snow_band_reserve(codes, false, false,
                               params->gradient_opacity != NULL));
    for (int64_t n = 0; n < rows; n += step) {
        snow_fetch_params from = snow_band_fetch_params(
            params, params->first_slice + n / bands->rows, 1, n % bands->rows,
            1);
        snow_fetch fetch;
        snow_rows row;
        from.between = false;
        snow_fetch_begin(&fetch, &from, buffers.fetch);
        snow_fetch_slice(&fetch, 0, &row);
        size_t count = job->rows.encode_rows(&job->rows, &row, buffers.masks,
                                             codes->codes);
        if (params->gradient_opacity && count)
            count = snow_band_apply_gradient_opacity(
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
