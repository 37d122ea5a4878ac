/* splat/rake.c - weights of scaled slices.
 *
 * The two kernels that pictures are mostly made with, the cubic B-spline and
 * the tent, are short formulas, which loops over pixels carry to vectors; the
 * others go through the definition. */
#include "splat/rake.h"

#include <math.h>

/* Pixels of a chunk: their sums stay in the first-level cache. */
#define CHUNK 128

/* The voxel below pixel n: as floor(), which is a call without SSE4.1, for
 * places far within 2^51. */
static inline int64_t below(double place) {
    int64_t whole = (int64_t)place;
    return whole - ((double)whole > place);
}

static double place_of(const snow_rake *rake, int64_t n) {
    return rake->start + (double)n * rake->step;
}

int64_t snow_rake_first(const snow_rake *rake, int64_t n) {
    return below(place_of(rake, n)) - (rake->taps / 2 - 1);
}

/* Six times the cubic B-spline, |t| from 0, 0 from 2 on: the difference of two
 * truncated powers. */
static inline float cubic(float t) {
    float a = t < 2 ? 2 - t : 0, b = t < 1 ? 1 - t : 0;
    return a * a * a - 4 * b * b * b;
}

static inline float tent(float t) {
    return t < 1 ? 1 - t : 0;
}

/* Weights of up to CHUNK pixels, whose places within their voxels are known,
 * by VALUE of the distance over `wide`. */
#define SPREAD(name, value)                                                 \
    static void name(const float *within, int count, int taps, float scale, \
                     size_t stride, float *weights) {                       \
        float sums[CHUNK] = {0};                                            \
        for (int m = 0; m < taps; m++) {                                    \
            float *row = weights + (size_t)m * stride;                      \
            float voxel = (float)(m - taps / 2 + 1);                        \
            for (int n = 0; n < count; n++) {                               \
                float t = (within[n] - voxel) * scale;                      \
                row[n] = value(t < 0 ? -t : t);                             \
                sums[n] += row[n];                                          \
            }                                                               \
        }                                                                   \
        for (int n = 0; n < count; n++)                                     \
            sums[n] = 1 / sums[n];                                          \
        for (int m = 0; m < taps; m++)                                      \
            for (int n = 0; n < count; n++)                                 \
                weights[(size_t)m * stride + (size_t)n] *= sums[n];         \
    }

SPREAD(spread_cubic, cubic)
SPREAD(spread_tent, tent)

/* Any kernel, by its definition in double. */
static void spread_any(const snow_rake *rake, int from, int count,
                       size_t stride, float *weights) {
    float taps[SNOW_TAPS_MOST];
    for (int n = 0; n < count; n++) {
        double place = place_of(rake, from + n);
        snow_taper_spread(&rake->taper, place - (double)below(place),
                          1 - rake->taps / 2, rake->taps, taps);
        for (int m = 0; m < rake->taps; m++)
            weights[(size_t)m * stride + (size_t)n] = taps[m];
    }
}

static void fill_chunk(const snow_rake *rake, int from, int count,
                       size_t stride, int32_t *first, float *weights) {
    const snow_taper *taper = &rake->taper;
    float within[CHUNK];
    for (int n = 0; n < count; n++) {
        double place = place_of(rake, from + n);
        int64_t voxel = below(place);
        within[n] = (float)(place - (double)voxel);
        first[n] = (int32_t)(voxel - (rake->taps / 2 - 1));
    }
    if (taper->kernel == SNOW_KERNEL_BSPLINE && taper->support == 4)
        spread_cubic(within, count, rake->taps, (float)(1 / taper->wide),
                     stride, weights);
    else if (taper->kernel == SNOW_KERNEL_TENT)
        spread_tent(within, count, rake->taps, (float)(1 / taper->half), stride,
                    weights);
    else
        spread_any(rake, from, count, stride, weights);
}

void snow_rake_fill(const snow_rake *rake, int from, int to, size_t stride,
                    int32_t *first, float *weights) {
    for (int n = from; n < to; n += CHUNK)
        fill_chunk(rake, n, to - n < CHUNK ? to - n : CHUNK, stride, first + n,
                   weights + n);
}
