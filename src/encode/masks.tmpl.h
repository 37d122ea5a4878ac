/* encode/masks.tmpl.h - counts the bits of bytes, for one instruction set.
 * Include simd/select.h first. */
TARGET static size_t NAME(count_bits)(const unsigned char *bytes,
                                      size_t count) {
    size_t set = 0;
    for (; count >= 8; count -= 8, bytes += 8) {
        uint64_t word;
        memcpy(&word, bytes, sizeof word);
        set += (size_t)V(popcount)(word);
    }
    for (; count; count--, bytes++)
        set += (size_t)V(popcount)(*bytes);
    return set;
}
