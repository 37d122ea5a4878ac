/* encode/values/value_rows.tmpl.h - loops over lines of numbers, 32 at a time.
 * Include simd/select.h first. */

/* A bit for each of 32 * words numbers that is outside of first .. last. */
TARGET static void NAME(outside)(const int16_t *line, size_t words,
                                 snow_value_run run, uint32_t *out) {
    const V(row) first = V(row_set1)(run.first), last = V(row_set1)(run.last);
    for (size_t w = 0; w < words; w++) {
        V(row) here = V(row_load)(line + 32 * w);
        out[w] = V(row_gt)(first, here) | V(row_gt)(here, last);
    }
}

/* The numbers whose bits are set; may write 32 beyond the last.  Returns their
 * end. */
TARGET static int16_t *NAME(pack)(const int16_t *line, const uint32_t *bits,
                                  size_t words, int16_t *out) {
    for (size_t w = 0; w < words; w++) {
        V(row_compress)(out, V(row_load)(line + 32 * w), bits[w]);
        out += __builtin_popcount(bits[w]);
    }
    return out;
}
