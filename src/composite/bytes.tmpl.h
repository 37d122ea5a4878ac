/* composite/bytes.tmpl.h - see bytes.h.  Include simd/select.h first. */

/* By the loops of PNG files (image/samples.h). */
TARGET static inline __attribute__((always_inline)) void
NAME(some)(const float *row, int count, int channels, const double *background,
           unsigned char *rgba) {
    double samples[4 * SOME];
    unsigned char levels[4 * SOME];
    const int kept = background ? 3 : channels, green = kept > 2 ? 1 : 0;
    if (background)
        snow_flatten_row(row, count, channels, background, 3, samples);
    else
        snow_straighten_row(row, count, channels, samples);
    snow_quantise_8(samples, (size_t)(count * kept), levels);
    for (int x = 0; x < count; x++) {
        const unsigned char *of = levels + x * kept;
        rgba[4 * x] = of[0];
        rgba[4 * x + 1] = of[green];
        rgba[4 * x + 2] = of[2 * green];
        rgba[4 * x + 3] = background ? 255 : of[kept - 1];
    }
}

typedef int32_t NAME(ints) __attribute__((vector_size(4 * LANES)));

/* Levels of single channels, where none is NaN: else false.  The sum may be
 * rounded up to the next level l.  Whether 255 v + 0.5 is below l is exact:
 * 256 v + 0.5 - l is not rounded where it is near v. */
TARGET static inline __attribute__((always_inline)) bool
NAME(floats)(const float *row, int count, uint32_t *levels) {
    const V(vec) zero = V(set1)(0), one = V(set1)(1), half = V(set1)(0.5F);
    const V(vec) most = V(set1)(255), more = V(set1)(256);
    NAME(ints) missing = {0};
    int any = 0;
    for (int n = 0; n < count; n += LANES) {
        V(vec) v = V(load)(row + n);
        missing |= v != v;
        v = V(min)(V(max)(v, zero), one);
        NAME(ints) level =
            __builtin_convertvector(V(fma)(v, most, half), NAME(ints));
        V(vec) above = __builtin_convertvector(level, V(vec));
        level += V(add)(V(mul)(v, more), V(sub)(half, above)) < v;
        memcpy(levels + n, &level, sizeof level);
    }
    for (int n = 0; n < LANES; n++)
        any |= missing[n];
    return !any;
}

/* On black, where nothing is added: pixels are whole words, of machines whose
 * least byte comes first. */
TARGET static inline __attribute__((always_inline)) bool
NAME(black)(const float *row, int channels, unsigned char *rgba) {
    uint32_t levels[4 * SOME], words[SOME];
    if (!NAME(floats)(row, SOME * channels, levels))
        return false;
    for (int x = 0; x < SOME; x++) {
        const uint32_t *of = levels + x * channels;
        words[x] =
            0xFF000000 | (channels == 2 ? of[0] * 0x10101
                                        : of[0] | of[1] << 8 | of[2] << 16);
    }
    memcpy(rgba, words, sizeof words);
    return true;
}

TARGET static void NAME(bytes)(const float *row, int width, int channels,
                               const double *background, unsigned char *rgba) {
    for (int x = 0; x < width; x += SOME) {
        int count = width - x < SOME ? width - x : SOME;
        const bool black = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ &&
                           background && background[0] == 0 &&
                           background[1] == 0 && background[2] == 0;
        if (black && count == SOME &&
            (channels == 2 ? NAME(black)(row + 2 * x, 2, rgba + 4 * x)
                           : NAME(black)(row + 4 * x, 4, rgba + 4 * x)))
            continue;
        if (channels == 2)
            NAME(some)(row + 2 * x, count, 2, background, rgba + 4 * x);
        else
            NAME(some)(row + 4 * x, count, 4, background, rgba + 4 * x);
    }
}
