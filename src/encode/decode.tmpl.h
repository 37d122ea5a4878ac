/* encode/decode.tmpl.h - counts bits for decoding, for one instruction set.
 * Include simd/select.h first. The variants differ only in how they count. */

TARGET static uint64_t NAME(windows)(const snow_mask_rows *rows,
                                     uint64_t wanted, int64_t column, int count,
                                     uint64_t *bits, uint32_t *before) {
    size_t at = (size_t)(column + SNOW_DECODE_PAD);
    size_t word = at / 64 * SNOW_DECODE_ROWS;
    unsigned shift = at % 64;
    uint64_t below = (UINT64_C(1) << shift) - 1;
    uint64_t within = (UINT64_C(1) << count) - 1, found = 0;
    const uint64_t *low = rows->bits + word, *high = low + SNOW_DECODE_ROWS;
    wanted &= rows->held;
    for (int row = 0; row < SNOW_DECODE_ROWS && wanted >> row; row += 8)
        if (wanted >> row & 255)
            found |= (uint64_t)V(windows)(low + row, high + row, shift, within,
                                          bits + row)
                     << row;
    found &= wanted;
    for (uint64_t left = found; left; left &= left - 1) {
        int row = __builtin_ctzll(left);
        before[row] = rows->rank[word + (size_t)row] +
                      (uint32_t)V(popcount)(low[row] & below);
    }
    return found;
}

/* Computes the ranks of a row's words and adds the words to `any`; returns the
 * row's number of voxels. */
TARGET static size_t NAME(rank)(const uint64_t *bits, size_t words,
                                uint32_t *rank, uint64_t *any) {
    uint32_t sum = 0;
    for (size_t word = 0; word < words; word++) {
        rank[word * SNOW_DECODE_ROWS] = sum;
        any[word] |= bits[word * SNOW_DECODE_ROWS];
        sum += (uint32_t)V(popcount)(bits[word * SNOW_DECODE_ROWS]);
    }
    return sum;
}

/* Prefetches voxels `from` to `to` - 1 of a band, which are contiguous: the
 * windows that read them are too far apart for the hardware prefetcher. Always
 * inlined: gcc removes calls of a function whose only effect is a prefetch. */
TARGET static inline __attribute__((always_inline)) void
NAME(fetch)(const snow_bands *bands, const snow_sparse *band, size_t from,
            size_t to) {
    const unsigned char *end = snow_bands_codes(band, to);
    for (const unsigned char *at = snow_bands_codes(band, from); at < end;
         at += LINE)
        __builtin_prefetch(at);
    const uint16_t *arrays[] = {
        bands->with_normals ? band->normals : NULL,
        bands->with_gradient_factors ? band->gradient_factors : NULL};
    for (size_t n = 0; n < sizeof arrays / sizeof *arrays; n++)
        for (size_t voxel = from; arrays[n] && voxel < to;
             voxel += LINE / sizeof *arrays[n])
            __builtin_prefetch(arrays[n] + voxel);
}

/* Decodes rows begin .. end - 1, which belong to one band, to positions n and
 * after. */
TARGET static void NAME(read_band)(const snow_bands *bands, int64_t slice,
                                   int64_t begin, int64_t end, int n,
                                   snow_span *spans, snow_mask_rows *rows) {
    const snow_sparse *band = &bands->bands[begin / SNOW_BAND_ROWS];
    snow_walk walk;
    snow_walk_begin(&walk, band, slice);
    if (begin % SNOW_BAND_ROWS)
        snow_walk_skip(&walk, begin % SNOW_BAND_ROWS);
    size_t from = walk.voxel;
    for (int64_t row = begin; row < end; row++, n++) {
        next_mask(&walk, spans, rows->bits + n, rows->words);
        rows->codes[n] = snow_bands_codes(band, walk.voxel);
        rows->normals[n] =
            bands->with_normals ? snow_bands_normals(band, walk.voxel) : NULL;
        rows->gradient_factors[n] =
            bands->with_gradient_factors
                ? snow_bands_gradient_factors(band, walk.voxel)
                : NULL;
        size_t voxels =
            NAME(rank)(rows->bits + n, rows->words, rows->rank + n, rows->any);
        walk.voxel += voxels;
        walk.row++;
        rows->held |= (uint64_t)(voxels != 0) << n;
    }
    if (rows->fetch)
        NAME(fetch)(bands, band, from, walk.voxel);
}

TARGET static void NAME(read)(const snow_bands *bands, int64_t slice,
                              int64_t first, uint64_t wanted, snow_span *spans,
                              snow_mask_rows *rows) {
    rows->held = 0;
    memset(rows->any, 0, rows->words * sizeof *rows->any);
    if (!wanted)
        return;
    int64_t row = first + __builtin_ctzll(wanted);
    int64_t last = first + 64 - __builtin_clzll(wanted);
    if (row < 0)
        row = 0;
    if (last > bands->rows)
        last = bands->rows;
    while (row < last) {
        int64_t band = row / SNOW_BAND_ROWS, end = (band + 1) * SNOW_BAND_ROWS;
        const snow_slice_pointer *pa = bands->bands[band].pa + slice;
        if (end > last)
            end = last;
        if (pa[1].ia > pa[0].ia)
            NAME(read_band)
        (bands, slice, row, end, (int)(row - first), spans, rows);
        row = end;
    }
}

static const snow_decode_fns NAME(decode_fns) = {NAME(windows), NAME(read)};
