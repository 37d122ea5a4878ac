/* encode/bands/slice.c - a slice of a band: rows of native voxels (fetch.h)
 * become masks and codes (rows.h); a gradient opacity removes some of them; the
 * schemes write the masks to EA; and for shading the normals of the interesting
 * voxels are added. */
#include "encode/bands/internal.h"

#include <string.h>

/* Contiguous rows that fill their masks become one long row. */
static void join_rows(snow_rows *rows, size_t size) {
    if (rows->columns % 64 == 0 && rows->stride == rows->columns * size) {
        rows->columns *= rows->rows;
        rows->rows = 1;
    }
}

/* Normals of a slice whose masks are known and whose voxels begin at `voxel` in
 * IA. */
static void make_normals(const snow_encode_job *job,
                         const snow_row_buffers *buffers, snow_sparse *band,
                         int64_t first_row, int64_t slice, size_t voxel) {
    const snow_bands_params *params = job->params;
    size_t words = snow_mask_words(band);
    bool is_between = params->between && slice % 2;
    int64_t here = params->first_slice + (params->between ? slice / 2 : slice);
    for (int64_t row = 0; row < band->rows; row++) {
        size_t count = snow_columns_of_masks(
            buffers->masks + (size_t)row * words, words, buffers->columns);
        uint16_t *normals = band->normals + voxel;
        if (count)
            snow_normals_of_row(params->maker, params->placement, here,
                                first_row + row, is_between, buffers->columns,
                                count, normals);
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

size_t snow_band_apply_gradient_opacity(const snow_bands_params *params,
                                        const snow_rows *rows,
                                        const snow_row_buffers *buffers,
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

snow_status snow_band_encode_slice(const snow_encode_job *job,
                                   const snow_row_buffers *buffers,
                                   snow_fetch *fetch, snow_sparse *band,
                                   int64_t first_row, int64_t slice) {
    const snow_bands_params *params = job->params;
    size_t begin = band->ia_voxels;
    snow_rows rows, apart;
    SNOW_TRY(snow_band_reserve(band, !job->anew, params->maker != NULL,
                               params->gradient_opacity != NULL));
    snow_fetch_slice(fetch, slice, &apart);
    rows = apart;
    join_rows(&rows, fetch->size);
    size_t count =
        job->rows.encode_rows(&job->rows, &rows, buffers->masks,
                              band->codes + begin * (size_t)band->code_bytes);
    if (params->gradient_opacity && count)
        count = snow_band_apply_gradient_opacity(
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
