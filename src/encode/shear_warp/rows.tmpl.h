/* encode/shear_warp/rows.tmpl.h - loops over lines of quantized values, 32 at a
 * time. Include simd/select.h first. */

/* A bit for each of 32 * words quantized values that is outside of first ..
 * last. */
TARGET static void NAME(outside)(const int16_t *line, size_t words,
                                 snow_transparent_interval interval,
                                 uint32_t *out) {
    const V(row) first = V(row_set1)(interval.first),
                 last = V(row_set1)(interval.last);
    for (size_t w = 0; w < words; w++) {
        V(row) here = V(row_load)(line + 32 * w);
        out[w] = V(row_gt)(first, here) | V(row_gt)(here, last);
    }
}

/* The quantized values whose bits are set; may write 32 beyond the last.
 * Returns their end. */
TARGET static int16_t *NAME(pack)(const int16_t *line, const uint32_t *bits,
                                  size_t words, int16_t *out) {
    for (size_t w = 0; w < words; w++) {
        V(row_compress)(out, V(row_load)(line + 32 * w), bits[w]);
        out += __builtin_popcount(bits[w]);
    }
    return out;
}

/* A bit for each of `count` stored values of 8 or 16 bits that is outside of a
 * range, in whole words; others are 0. */
TARGET static void NAME(outside_bytes)(const unsigned char *stored,
                                       size_t count,
                                       snow_value_stored_range range,
                                       uint64_t *out) {
    const uint8_t first = (uint8_t)range.first, width = (uint8_t)range.width;
    size_t n = 0;
    for (; n + 64 <= count; n += 64)
        *out++ = V(bytes_outside)(stored + n, first, width);
    if (n < count) {
        unsigned char rest[64] = {0};
        memcpy(rest, stored + n, count - n);
        *out = V(bytes_outside)(rest, first, width) &
               (~UINT64_C(0) >> (64 - (count - n)));
    }
}

TARGET static inline uint32_t NAME(outside32)(const unsigned char *stored,
                                              V(row) first, V(row) width) {
    V(row) here = V(row_load)((const int16_t *)(const void *)stored);
    return V(row_gt)(V(row_add)(here, first), width);
}

TARGET static void NAME(outside_words)(const unsigned char *stored,
                                       size_t count,
                                       snow_value_stored_range range,
                                       uint64_t *out) {
    /* Comparisons are of signed numbers. */
    const V(row) first = V(row_set1)((int16_t)(0x8000 - range.first));
    const V(row) width = V(row_set1)((int16_t)(range.width - 0x8000));
    size_t n = 0;
    for (; n + 64 <= count; n += 64)
        *out++ = NAME(outside32)(stored + 2 * n, first, width) |
                 (uint64_t)NAME(outside32)(stored + 2 * n + 64, first, width)
                     << 32;
    if (n < count) {
        unsigned char rest[128] = {0};
        memcpy(rest, stored + 2 * n, 2 * (count - n));
        *out = (NAME(outside32)(rest, first, width) |
                (uint64_t)NAME(outside32)(rest + 64, first, width) << 32) &
               (~UINT64_C(0) >> (64 - (count - n)));
    }
}

static const snow_value_loops NAME(loops) = {
    NAME(outside), NAME(pack), NAME(outside_bytes), NAME(outside_words)};
