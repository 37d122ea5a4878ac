/* splat/separable/rake.c - weights of scaled slices.
 *
 * The two most common kernels, the cubic B-spline and the tent, are short
 * formulas that the compiler vectorizes over pixels; the others use the
 * definition. */
#include "splat/separable/rake.h"
#include "simd/isa.h"

#include <math.h>

/* Pixels of a chunk: their sums stay in the first-level cache. */
#define CHUNK 128

/* The voxel below pixel n: floor(), which without SSE4.1 is a call, for
 * positions far within 2^51. */
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

/* Six times the cubic B-spline of |t|, 0 from 2 on: the difference of two
 * truncated powers. */
static inline float cubic(float t) {
    float a = t < 2 ? 2 - t : 0, b = t < 1 ? 1 - t : 0;
    return a * a * a - 4 * b * b * b;
}

static inline float tent(float t) {
    return t < 1 ? 1 - t : 0;
}

/* The loops of one instruction set, in splat/separable/rake.tmpl.h. */
typedef void spread_fn(const float *within, int count, int taps, float scale,
                       size_t stride, float *weights);
typedef struct rake_loops {
    void (*locate)(double start, double step, int from, int count, int before,
                   int32_t *first, float *within);
    spread_fn *cubic, *tent;
} rake_loops;

#define TEMPLATE "splat/separable/rake.tmpl.h"
#include "simd/each_isa.h"

static const rake_loops *best_loops(void) {
    return SNOW_OF_ISA(snow_isa_resolve(SNOW_ISA_AUTO), &loops);
}

/* Any kernel, by its definition in double precision. */
static void spread_any(const snow_rake *rake, int from, int count,
                       size_t stride, float *weights) {
    float taps[SNOW_TAPS_MOST];
    for (int n = 0; n < count; n++) {
        double place = place_of(rake, from + n);
        snow_scaled_kernel_spread(&rake->scaled_kernel,
                                  place - (double)below(place),
                                  1 - rake->taps / 2, rake->taps, taps);
        for (int m = 0; m < rake->taps; m++)
            weights[(size_t)m * stride + (size_t)n] = taps[m];
    }
}

static void fill_chunk(const snow_rake *rake, const rake_loops *loops, int from,
                       int count, size_t stride, int32_t *first,
                       float *weights) {
    const snow_scaled_kernel *scaled_kernel = &rake->scaled_kernel;
    float within[CHUNK];
    loops->locate(rake->start, rake->step, from, count, rake->taps / 2 - 1,
                  first, within);
    if (scaled_kernel->kernel == SNOW_KERNEL_BSPLINE &&
        scaled_kernel->support == 4)
        loops->cubic(within, count, rake->taps,
                     (float)(1 / scaled_kernel->wide), stride, weights);
    else if (scaled_kernel->kernel == SNOW_KERNEL_TENT)
        loops->tent(within, count, rake->taps, (float)(1 / scaled_kernel->half),
                    stride, weights);
    else
        spread_any(rake, from, count, stride, weights);
}

void snow_rake_fill(const snow_rake *rake, int from, int to, size_t stride,
                    int32_t *first, float *weights) {
    const rake_loops *loops = best_loops();
    for (int n = from; n < to; n += CHUNK)
        fill_chunk(rake, loops, n, to - n < CHUNK ? to - n : CHUNK, stride,
                   first + n, weights + n);
}
