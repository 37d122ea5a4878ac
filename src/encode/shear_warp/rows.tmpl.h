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

static inline void NAME(store64)(uint64_t bits, uint32_t *out) {
    out[0] = (uint32_t)bits;
    out[1] = (uint32_t)(bits >> 32);
}

/* A bit for each of 64 stored values of 1 or 2 bytes that is outside of a
 * range. */
TARGET static inline uint64_t NAME(outside64)(const unsigned char *stored,
                                              snow_value_stored_range range,
                                              const size_t size) {
    if (size == 1)
        return V(bytes_outside)(stored, (uint8_t)range.first,
                                (uint8_t)range.width);
    /* Comparisons are of signed numbers. */
    const V(row) first = V(row_set1)((int16_t)(0x8000 - range.first));
    const V(row) width = V(row_set1)((int16_t)(range.width - 0x8000));
    const int16_t *values = (const int16_t *)(const void *)stored;
    V(row) low = V(row_add)(V(row_load)(values), first);
    V(row) high = V(row_add)(V(row_load)(values + 32), first);
    return V(row_gt)(low, width) | (uint64_t)V(row_gt)(high, width) << 32;
}

/* The same of `count` of them, from bit `by` (0 to 31) of the words on; other
 * bits of these are 0. */
TARGET static inline void NAME(outside_stored)(const unsigned char *stored,
                                               size_t count, int by,
                                               snow_value_stored_range range,
                                               uint32_t *out,
                                               const size_t size) {
    unsigned char few[128] = {0};
    uint64_t bits;
    size_t n = 64 - (size_t)by;
    if (count < 64) {
        memcpy(few, stored, count * size);
        bits = NAME(outside64)(few, range, size) & ((UINT64_C(1) << count) - 1);
    } else
        bits = NAME(outside64)(stored, range, size);
    NAME(store64)(bits << by, out);
    for (; n + 64 <= count; n += 64)
        NAME(store64)(NAME(outside64)(stored + n * size, range, size),
                      out += 2);
    if (n >= count)
        return;
    if (count >= 64)
        bits = NAME(outside64)(stored + (count - 64) * size, range, size) >>
               (64 - (count - n));
    else
        bits >>= n;
    NAME(store64)(bits, out + 2);
}

TARGET static void NAME(outside_bytes)(const unsigned char *stored,
                                       size_t count, int by,
                                       snow_value_stored_range range,
                                       uint32_t *out) {
    NAME(outside_stored)(stored, count, by, range, out, 1);
}

TARGET static void NAME(outside_words)(const unsigned char *stored,
                                       size_t count, int by,
                                       snow_value_stored_range range,
                                       uint32_t *out) {
    NAME(outside_stored)(stored, count, by, range, out, 2);
}

/* What follows are plain loops, of which compilers make vectors. */
TARGET static int64_t NAME(count)(const uint32_t *bits, size_t words) {
    int64_t count = 0;
    for (size_t w = 0; w < words; w++)
        count += V(popcount)(bits[w]);
    return count;
}

TARGET static void NAME(cells)(const uint32_t *above, const uint32_t *below,
                               size_t words, uint32_t *out) {
    uint32_t last = above[words - 1] | below[words - 1];
    for (size_t w = 0; w + 1 < words; w++) {
        uint32_t here = above[w] | below[w], next = above[w + 1] | below[w + 1];
        out[w] = here | here >> 1 | next << 31;
    }
    out[words - 1] = last | last >> 1;
}

static const snow_value_loops NAME(loops) = {
    NAME(outside),       NAME(pack),  NAME(outside_bytes),
    NAME(outside_words), NAME(count), NAME(cells)};
