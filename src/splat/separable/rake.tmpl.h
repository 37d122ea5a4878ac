/* splat/separable/rake.tmpl.h - weights of a chunk of pixels, in loops that the
 * compiler vectorizes, for one instruction set. Include simd/select.h first.
 * All instruction sets give the same bits. */

/* Weights of up to CHUNK pixels, whose places within their voxels are known,
 * by VALUE of the distance times `scale`. */
#define SPREAD(name, value)                                                \
    TARGET static void NAME(name)(const float *restrict within, int count, \
                                  int taps, float scale, size_t stride,    \
                                  float *restrict weights) {               \
        float sums[CHUNK] = {0};                                           \
        for (int m = 0; m < taps; m++) {                                   \
            float *restrict row = weights + (size_t)m * stride;            \
            float voxel = (float)(m - taps / 2 + 1);                       \
            for (int n = 0; n < count; n++) {                              \
                float t = (within[n] - voxel) * scale;                     \
                float weight = value(t < 0 ? -t : t);                      \
                row[n] = weight;                                           \
                sums[n] += weight;                                         \
            }                                                              \
        }                                                                  \
        for (int n = 0; n < count; n++)                                    \
            sums[n] = 1 / sums[n];                                         \
        for (int m = 0; m < taps; m++)                                     \
            for (int n = 0; n < count; n++)                                \
                weights[(size_t)m * stride + (size_t)n] *= sums[n];        \
    }

SPREAD(spread_cubic, cubic)
SPREAD(spread_tent, tent)
#undef SPREAD

/* First voxels, and positions within the voxels before them. Adding 1.5 * 2^52
 * rounds to an integer, in the last bits of the sum; a result that was rounded
 * up is one too many. */
TARGET static void NAME(locate)(double start, double step, int from, int count,
                                int before, int32_t *restrict first,
                                float *restrict within) {
    for (int n = 0; n < count; n++) {
        double place = start + (double)(from + n) * step;
        double whole = (place + 0x1.8p52) - 0x1.8p52;
        whole -= whole > place ? 1 : 0;
        within[n] = (float)(place - whole);
        first[n] = (int32_t)whole - before;
    }
}

static const rake_loops NAME(loops) = {NAME(locate), NAME(spread_cubic),
                                       NAME(spread_tent)};
