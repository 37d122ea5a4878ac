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

/* With `taps` a constant the weights and the rows stay in registers: stores to
 * the line could otherwise change them, for all the compiler knows. */
TARGET static inline __attribute__((always_inline)) bool
DOWN_NAME(_taps)(float *line, const float *const *rows, const float *weights,
                 const int taps, const uint64_t *mask, size_t words,
                 uint64_t *alive) {
    const V(vec) one = V(set1)(1), enough = V(set1)(SNOW_OPAQUE_ENOUGH);
    V(vec) weight[SNOW_TAPS_MOST];
    const float *row[SNOW_TAPS_MOST];
    bool died = false;
    for (int m = 0; m < taps; m++) {
        weight[m] = V(set1)(weights[m]);
        row[m] = rows[m];
    }
    for (size_t word = 0; word < words; word++)
        for (uint64_t bits = mask[word]; bits; bits &= bits - 1) {
            size_t chunk = word * 64 + (size_t)__builtin_ctzll(bits);
            size_t at = chunk * SNOW_CHUNK * DOWN_CHANNELS;
            size_t end = at + SNOW_CHUNK * DOWN_CHANNELS;
            V(vec) most = V(set1)(0);
            for (; at < end; at += LANES) {
                V(vec) front = V(load)(line + at);
                V(vec) left = V(sub)(one, DOWN_ALPHA(front));
                V(vec) sum = V(mul)(weight[0], V(load)(row[0] + at));
                for (int m = 1; m < taps; m++)
                    sum = V(fma)(weight[m], V(load)(row[m] + at), sum);
                V(store)(line + at, V(fma)(left, sum, front));
                most = V(max)(most, left);
            }
            if (!V(any_less)(enough, most)) {
                alive[word] &= ~(bits & -bits);
                died = true;
            }
        }
    return died;
}

TARGET static bool DOWN_NAME()(float *line, const float *const *rows,
                               const float *weights, int taps,
                               const uint64_t *mask, size_t words,
                               uint64_t *alive) {
    if (taps == 4)
        return DOWN_NAME(_taps)(line, rows, weights, 4, mask, words, alive);
    if (taps == 2)
        return DOWN_NAME(_taps)(line, rows, weights, 2, mask, words, alive);
    return DOWN_NAME(_taps)(line, rows, weights, taps, mask, words, alive);
}

#undef DOWN_CHANNELS
#undef DOWN_ALPHA
#undef DOWN_NAME
