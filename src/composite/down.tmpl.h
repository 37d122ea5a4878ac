/* composite/down.tmpl.h - a line of a sheet out of filtered rows, laid behind
 * the image's line.  Define before including, with simd/select.h's words in
 * force:
 *
 *   DOWN_CHANNELS  floats of a pixel: 2 or 4
 *   DOWN_ALPHA     V(alpha2) or V(alpha4)
 *   DOWN_NAME      name of the function
 *
 * All are undefined at the end.  The order of additions does not depend on the
 * level. */

/* One chunk; `rows` point to its first pixel.  False when nothing behind it can
 * be seen any more. */
TARGET static inline __attribute__((always_inline)) bool
DOWN_NAME(_chunk)(float *line, const float *const *rows, const float *weights,
                  int taps, size_t at) {
    const V(vec) one = V(set1)(1);
    V(vec) most = V(set1)(0);
    for (size_t end = at + SNOW_CHUNK * DOWN_CHANNELS; at < end; at += LANES) {
        V(vec) front = V(load)(line + at);
        V(vec) left = V(sub)(one, DOWN_ALPHA(front));
        V(vec) sum = V(mul)(V(set1)(weights[0]), V(load)(rows[0] + at));
        for (int m = 1; m < taps; m++)
            sum = V(fma)(V(set1)(weights[m]), V(load)(rows[m] + at), sum);
        V(store)(line + at, V(fma)(left, sum, front));
        most = V(max)(most, left);
    }
    return V(any_less)(V(set1)(SNOW_OPAQUE_ENOUGH), most);
}

TARGET static bool DOWN_NAME()(float *line, const float *const *rows,
                               const float *weights, int taps,
                               const uint64_t *mask, size_t words,
                               uint64_t *alive) {
    bool died = false;
    for (size_t word = 0; word < words; word++)
        for (uint64_t bits = mask[word]; bits; bits &= bits - 1) {
            size_t chunk = word * 64 + (size_t)__builtin_ctzll(bits);
            size_t at = chunk * SNOW_CHUNK * DOWN_CHANNELS;
            bool seen = taps == 4
                            ? DOWN_NAME(_chunk)(line, rows, weights, 4, at)
                        : taps == 2
                            ? DOWN_NAME(_chunk)(line, rows, weights, 2, at)
                            : DOWN_NAME(_chunk)(line, rows, weights, taps, at);
            if (seen)
                continue;
            alive[word] &= ~(bits & -bits);
            died = true;
        }
    return died;
}

#undef DOWN_CHANNELS
#undef DOWN_ALPHA
#undef DOWN_NAME
