/* encode/windows.c - rows of a band as bit masks. */
#include "encode/windows.h"

#include <string.h>

#define SELECT_SCALAR
#include "simd/select.h"

#include "encode/windows.tmpl.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "encode/windows.tmpl.h"
#endif

const snow_window_fns *snow_window_fns_of(snow_isa isa) {
    static const snow_window_fns scalar = {windows_scalar, rank_scalar};
#if SNOW_HAS_AVX
    static const snow_window_fns avx2 = {windows_avx2, rank_avx2};
    if (isa == SNOW_ISA_AVX2 || isa == SNOW_ISA_AVX512)
        return &avx2;
#endif
    (void)isa;
    return &scalar;
}

/* Sets bits [from, to) of a row. */
static void set_bits(uint64_t *bits, size_t from, size_t to) {
    for (size_t word = from / 64; word * 64 < to; word++) {
        uint64_t mask = ~UINT64_C(0);
        if (word * 64 < from)
            mask <<= from % 64;
        if (to - word * 64 < 64)
            mask &= (UINT64_C(1) << (to - word * 64)) - 1;
        bits[word] |= mask;
    }
}

static void set_spans(uint64_t *bits, const snow_span *spans, size_t count) {
    for (size_t i = 0; i < count; i++) {
        size_t from = SNOW_WINDOW_PAD + (size_t)spans[i].column;
        set_bits(bits, from, from + spans[i].length);
    }
}

/* Rows begin .. end - 1, which lie in one band, into the places from n on. */
static void read_band(const snow_bands *bands, int64_t slice, int64_t begin,
                      int64_t end, int n, snow_span *spans,
                      snow_mask_rows *rows) {
    const snow_sparse *band = &bands->bands[begin / SNOW_BAND_ROWS];
    if (band->pa[slice + 1].ia == band->pa[slice].ia)
        return;
    snow_walk walk;
    snow_walk_begin(&walk, band, slice);
    if (begin % SNOW_BAND_ROWS)
        snow_walk_skip(&walk, begin % SNOW_BAND_ROWS);
    for (int64_t row = begin; row < end; row++, n++) {
        size_t voxel, count = snow_walk_row(&walk, spans, &voxel);
        if (!count)
            continue;
        uint64_t *bits = rows->bits + (size_t)n * rows->words;
        memset(bits, 0, rows->words * sizeof *bits);
        set_spans(bits, spans, count);
        rows->codes[n] = snow_bands_codes(band, voxel);
        rows->normals[n] =
            bands->with_normals ? snow_bands_normals(band, voxel) : NULL;
        rows->held |= UINT64_C(1) << n;
    }
}

void snow_mask_rows_read(const snow_bands *bands, int64_t slice, int64_t first,
                         int count, snow_span *spans, snow_mask_rows *rows) {
    int64_t row = first < 0 ? 0 : first, last = first + count;
    if (last > bands->rows)
        last = bands->rows;
    rows->held = 0;
    while (row < last) {
        int64_t end = (row / SNOW_BAND_ROWS + 1) * SNOW_BAND_ROWS;
        if (end > last)
            end = last;
        read_band(bands, slice, row, end, (int)(row - first), spans, rows);
        row = end;
    }
}
