/* composite/bytes.tmpl.h - see bytes.h.  Loops that the compiler vectorizes;
 * include simd/select.h first. */

/* Levels of channel c of some pixels; that behind the last is of alpha. */
TARGET static inline __attribute__((always_inline)) void
NAME(levels)(const float *row, int count, int channels, int c,
             const double *background, int *levels) {
    for (int x = 0; x < count; x++) {
        const float *pixel = row + x * channels;
        const bool missing = snow_has_nan(pixel, channels);
        const double color = missing ? 0 : (double)pixel[c];
        double alpha =
            missing ? 0 : snow_clamp_unit((double)pixel[channels - 1]);
        if (c < channels - 1 && !background)
            alpha = alpha > 0 ? snow_clamp_unit(color / alpha) : 0;
        if (background)
            alpha = snow_clamp_unit(color + (1 - alpha) * *background);
        levels[x] = (int)(alpha * 255 + 0.5);
    }
}

TARGET static inline __attribute__((always_inline)) void
NAME(some)(const float *row, int count, int channels, const double *background,
           unsigned char *rgba) {
    int levels[4][SOME];
    const bool grey =
        channels == 2 && (!background || (background[0] == background[1] &&
                                          background[1] == background[2]));
    for (int c = 0; c < (grey ? 1 : 3); c++)
        if (background)
            NAME(levels)
    (row, count, channels, channels == 2 ? 0 : c, background + c, levels[c]);
    else NAME(levels)(row, count, channels, channels == 2 ? 0 : c, NULL,
                      levels[c]);
    if (!background)
        NAME(levels)(row, count, channels, channels - 1, NULL, levels[3]);
    for (int x = 0; x < count; x++) {
        rgba[4 * x] = (unsigned char)levels[0][x];
        rgba[4 * x + 1] = (unsigned char)levels[grey ? 0 : 1][x];
        rgba[4 * x + 2] = (unsigned char)levels[grey ? 0 : 2][x];
        rgba[4 * x + 3] = background ? 255 : (unsigned char)levels[3][x];
    }
}

#if LANES > 4
typedef int32_t NAME(ints) __attribute__((vector_size(4 * LANES)));

/* Levels of single channels, where none is NaN: else false.  The sum may be
 * rounded up to the next level; the sign of the fused difference is exact. */
TARGET static inline __attribute__((always_inline)) bool
NAME(floats)(const float *row, int count, uint32_t *levels) {
    const V(vec) zero = V(set1)(0), one = V(set1)(1), half = V(set1)(0.5F);
    const V(vec) most = V(set1)(255);
    NAME(ints) missing = {0};
    int any = 0;
    for (int n = 0; n < count; n += LANES) {
        V(vec) v = V(load)(row + n);
        missing |= v != v;
        v = V(min)(V(max)(v, zero), one);
        NAME(ints)
        level = __builtin_convertvector(V(fma)(v, most, half), NAME(ints));
        V(vec) above = __builtin_convertvector(level, V(vec));
        level += V(fma)(v, most, V(sub)(half, above)) < zero;
        memcpy(levels + n, &level, sizeof level);
    }
    for (int n = 0; n < LANES; n++)
        any |= missing[n];
    return !any;
}

/* On black, where nothing is added: pixels are whole words. */
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
#endif

TARGET static void NAME(bytes)(const float *row, int width, int channels,
                               const double *background, unsigned char *rgba) {
    for (int x = 0; x < width; x += SOME) {
        int count = width - x < SOME ? width - x : SOME;
#if LANES > 4
        const bool black = background && background[0] == 0 &&
                           background[1] == 0 && background[2] == 0;
        if (black && count == SOME &&
            (channels == 2 ? NAME(black)(row + 2 * x, 2, rgba + 4 * x)
                           : NAME(black)(row + 4 * x, 4, rgba + 4 * x)))
            continue;
#endif
        if (channels == 2)
            NAME(some)(row + 2 * x, count, 2, background, rgba + 4 * x);
        else
            NAME(some)(row + 4 * x, count, 4, background, rgba + 4 * x);
    }
}
