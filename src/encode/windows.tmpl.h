/* encode/windows.tmpl.h - counting bits, for one level: simd/select.h's words
 * are in force.  The levels differ in how they count only. */

TARGET static uint64_t NAME(windows)(const snow_mask_rows *rows, int64_t column,
                                     int count, uint64_t *bits,
                                     uint32_t *before) {
    size_t at = (size_t)(column + SNOW_WINDOW_PAD), word = at / 64;
    unsigned shift = at % 64;
    uint64_t below = (UINT64_C(1) << shift) - 1;
    uint64_t within = (UINT64_C(1) << count) - 1, found = 0;
    for (uint64_t left = rows->held; left; left &= left - 1) {
        int row = __builtin_ctzll(left);
        const uint64_t *words = rows->bits + (size_t)row * rows->words + word;
        /* In two steps, since a shift by 64 is none. */
        uint64_t window = words[0] >> shift | words[1] << 1 << (63 - shift);
        bits[row] = window & within;
        before[row] = rows->rank[(size_t)row * rows->words + word] +
                      (uint32_t)V(popcount)(words[0] & below);
        found |= (uint64_t)(bits[row] != 0) << row;
    }
    return found;
}

TARGET static void NAME(rank)(snow_mask_rows *rows) {
    for (uint64_t left = rows->held; left; left &= left - 1) {
        size_t row = (size_t)__builtin_ctzll(left) * rows->words;
        uint32_t rank = 0;
        for (size_t word = 0; word < rows->words; word++) {
            rows->rank[row + word] = rank;
            rank += (uint32_t)V(popcount)(rows->bits[row + word]);
        }
    }
}
