/* splat/across.tmpl.h - one row of a sheared slice through the kernel along u,
 * onto the intermediate image's columns.  In gather form: each pixel sums the
 * voxels in its reach, with one set of weights per phase for the whole slice.
 * Define before including, with simd/select.h's words in force:
 *
 *   ACROSS_CHANNELS  floats of a sample and of a pixel: 2 or 4
 *   ACROSS_WEAVE     V(weave2) or V(weave4)
 *   ACROSS_NAME      name of the function
 *
 * All are undefined at the end.  A chunk is SNOW_CHUNK pixels; only chunks of
 * the mask are computed. */

/* One pixel a voxel: pixel n is the sum of weights[m] * voxels[n + m]. */
TARGET static inline __attribute__((always_inline)) void
ACROSS_NAME(_single)(const float *voxels, const V(vec) *weights, int taps,
                     float *pixels) {
    for (int at = 0; at < SNOW_CHUNK * ACROSS_CHANNELS; at += LANES) {
        V(vec) sum = V(mul)(weights[0], V(load)(voxels + at));
        for (int m = 1; m < taps; m++)
            sum = V(fma)(weights[m],
                         V(load)(voxels + at + m * ACROSS_CHANNELS), sum);
        V(store)(pixels + at, sum);
    }
}

/* Two pixels a voxel, each phase with its own voxels and weights. */
TARGET static inline __attribute__((always_inline)) void
ACROSS_NAME(_double)(const float *even, const float *odd, const V(vec) *weights,
                     int taps, float *pixels) {
    for (int at = 0; at < SNOW_CHUNK / 2 * ACROSS_CHANNELS; at += LANES) {
        V(vec) a = V(mul)(weights[0], V(load)(even + at));
        V(vec) b = V(mul)(weights[taps], V(load)(odd + at));
        for (int m = 1; m < taps; m++) {
            int next = at + m * ACROSS_CHANNELS;
            a = V(fma)(weights[m], V(load)(even + next), a);
            b = V(fma)(weights[taps + m], V(load)(odd + next), b);
        }
        ACROSS_WEAVE(a, b, pixels + 2 * at);
    }
}

/* Several voxels a pixel: the same sum, at every stride-th voxel. */
TARGET static inline void ACROSS_NAME(_strided)(const snow_across *across,
                                                const float *voxels,
                                                float *pixels) {
    for (int n = 0; n < SNOW_CHUNK; n++)
        for (int c = 0; c < ACROSS_CHANNELS; c++) {
            const float *voxel =
                voxels + n * across->stride * ACROSS_CHANNELS + c;
            float sum = across->weights[0] * *voxel;
            for (int m = 1; m < across->taps; m++)
                sum += across->weights[m] * voxel[m * ACROSS_CHANNELS];
            pixels[n * ACROSS_CHANNELS + c] = sum;
        }
}

TARGET static inline __attribute__((always_inline)) void
ACROSS_NAME(_chunk)(const snow_across *a, const V(vec) *weights, int taps,
                    const float *row, int64_t chunk, float *line) {
    float *pixels = line + chunk * SNOW_CHUNK * ACROSS_CHANNELS;
    if (a->phases == 2) {
        int64_t voxel = a->first / 2 + chunk * (SNOW_CHUNK / 2);
        ACROSS_NAME(_double)
        (row + (voxel + a->offset[0]) * ACROSS_CHANNELS,
         row + (voxel + a->offset[1]) * ACROSS_CHANNELS, weights, taps, pixels);
        return;
    }
    int64_t voxel = (a->first + chunk * SNOW_CHUNK) * a->stride + a->offset[0];
    if (a->stride == 1)
        ACROSS_NAME(_single)
        (row + voxel * ACROSS_CHANNELS, weights, taps, pixels);
    else
        ACROSS_NAME(_strided)(a, row + voxel * ACROSS_CHANNELS, pixels);
}

/* With `taps` a constant the weights stay in registers. */
TARGET static inline __attribute__((always_inline)) void
ACROSS_NAME(_taps)(const snow_across *across, const int taps, const float *row,
                   const uint64_t *mask, size_t words, float *line) {
    const snow_across a = *across;
    V(vec) weights[2 * SNOW_TAPS_MOST];
    for (int m = 0; m < a.phases * taps; m++)
        weights[m] = V(set1)(a.weights[m]);
    for (size_t word = 0; word < words; word++)
        for (uint64_t bits = mask[word]; bits; bits &= bits - 1) {
            int64_t chunk = (int64_t)(word * 64) + __builtin_ctzll(bits);
            ACROSS_NAME(_chunk)(&a, weights, taps, row, chunk, line);
        }
}

TARGET static void ACROSS_NAME()(const snow_across *across, const float *row,
                                 const uint64_t *mask, size_t words,
                                 float *line) {
    if (across->taps == 4)
        ACROSS_NAME(_taps)(across, 4, row, mask, words, line);
    else if (across->taps == 2)
        ACROSS_NAME(_taps)(across, 2, row, mask, words, line);
    else
        ACROSS_NAME(_taps)(across, across->taps, row, mask, words, line);
}

#undef ACROSS_CHANNELS
#undef ACROSS_WEAVE
#undef ACROSS_NAME
