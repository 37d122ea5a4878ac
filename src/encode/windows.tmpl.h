/* encode/windows.tmpl.h - counting bits, for one level: simd/select.h's words
 * are in force.  The levels differ in how they count only. */

TARGET static uint64_t NAME(windows)(const snow_mask_rows *rows,
                                     uint64_t wanted, int64_t column, int count,
                                     uint64_t *bits, uint32_t *before) {
    size_t at = (size_t)(column + SNOW_WINDOW_PAD);
    size_t word = at / 64 * SNOW_WINDOW_ROWS;
    unsigned shift = at % 64;
    uint64_t below = (UINT64_C(1) << shift) - 1;
    uint64_t within = (UINT64_C(1) << count) - 1, found = 0;
    const uint64_t *low = rows->bits + word, *high = low + SNOW_WINDOW_ROWS;
    wanted &= rows->held;
    for (int row = 0; row < SNOW_WINDOW_ROWS && wanted >> row; row += 8)
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

/* The ranks of a row's words; returns its voxels. */
TARGET static size_t NAME(rank)(const uint64_t *bits, size_t words,
                                uint32_t *rank) {
    uint32_t sum = 0;
    for (size_t word = 0; word < words; word++) {
        rank[word * SNOW_WINDOW_ROWS] = sum;
        sum += (uint32_t)V(popcount)(bits[word * SNOW_WINDOW_ROWS]);
    }
    return sum;
}

/* Rows begin .. end - 1, which lie in one band, into the places from n on. */
TARGET static void NAME(read_band)(const snow_bands *bands, int64_t slice,
                                   int64_t begin, int64_t end, int n,
                                   snow_span *spans, snow_mask_rows *rows) {
    const snow_sparse *band = &bands->bands[begin / SNOW_BAND_ROWS];
    snow_walk walk;
    snow_walk_begin(&walk, band, slice);
    if (begin % SNOW_BAND_ROWS)
        snow_walk_skip(&walk, begin % SNOW_BAND_ROWS);
    for (int64_t row = begin; row < end; row++, n++) {
        next_mask(&walk, spans, rows->bits + n, rows->words);
        rows->codes[n] = snow_bands_codes(band, walk.voxel);
        rows->normals[n] =
            bands->with_normals ? snow_bands_normals(band, walk.voxel) : NULL;
        rows->fades[n] =
            bands->with_fades ? snow_bands_fades(band, walk.voxel) : NULL;
        size_t voxels = NAME(rank)(rows->bits + n, rows->words, rows->rank + n);
        walk.voxel += voxels;
        walk.row++;
        rows->held |= (uint64_t)(voxels != 0) << n;
    }
}

TARGET static void NAME(read)(const snow_bands *bands, int64_t slice,
                              int64_t first, int count, snow_span *spans,
                              snow_mask_rows *rows) {
    int64_t row = first < 0 ? 0 : first, last = first + count;
    if (last > bands->rows)
        last = bands->rows;
    rows->held = 0;
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
