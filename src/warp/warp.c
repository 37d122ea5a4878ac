/* warp/warp.c - lines of the picture, and the resampling for each level.
 *
 * Catmull-Rom's cubic (Keys 1981, a = -1/2) keeps what a bilinear warp blurs;
 * it may swing beyond its data beside an edge, so that results are held to 0
 * <= colour <= alpha <= 1, which premultiplied pictures obey. */
#include "warp/warp.h"

#include <math.h>
#include <string.h>

/* Coefficients of 1, f, f^2 and f^3 for the weight of each tap. */
static const float catmull_rom[4][4] = {
    {0, 1, 0, 0},
    {-0.5f, 0, 0.5f, 0},
    {1, -2.5f, 2, -0.5f},
    {-0.5f, 1.5f, -1.5f, 0.5f},
};
static const float linear[4][4] = {
    {1, 0, 0, 0},
    {-1, 1, 0, 0},
    {0, 0, 0, 0},
    {0, 0, 0, 0},
};

#include "simd/vec_scalar.h"

static inline float fraction_of(int64_t place) {
    return (float)(uint32_t)place * 0x1p-32f;
}

static inline snow_scalar_vec cubic_weights(const float cubic[4][4], float f) {
    snow_scalar_vec at = snow_scalar_set1(f);
    snow_scalar_vec w = snow_scalar_load(cubic[3]);
    for (int power = 2; power >= 0; power--)
        w = snow_scalar_fma(w, at, snow_scalar_load(cubic[power]));
    return w;
}

/* Holds a pixel to the laws of premultiplied ones, and stores it. */
static inline void store_pixel(snow_scalar_vec pixel, int channels,
                               float *out) {
    const snow_scalar_vec zero = {0, 0, 0, 0}, one = {1, 1, 1, 1};
    pixel = snow_scalar_min(snow_scalar_max(pixel, zero), one);
    snow_scalar_vec alpha =
        channels == 4 ? snow_scalar_alpha4(pixel) : snow_scalar_alpha2(pixel);
    pixel = snow_scalar_min(pixel, alpha);
    memcpy(out, &pixel, (size_t)channels * sizeof *out);
}

#define SELECT_SCALAR
#include "simd/select.h"

#include "warp/levels.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "warp/levels.h"
#define SELECT_AVX512
#include "simd/select.h"

#include "warp/levels.h"
#endif

snow_warp_fn *snow_warp_of(snow_isa isa, snow_filter filter, int channels) {
    bool cubic = filter == SNOW_CATMULL_ROM, grey = channels == 2;
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512 && cubic && !grey)
        return cubic4_avx512;
    if (isa == SNOW_ISA_AVX512 || isa == SNOW_ISA_AVX2) {
        if (cubic)
            return grey ? cubic2_avx2 : cubic4_avx2;
        if (!grey)
            return linear4_avx2;
    }
#endif
    (void)isa;
    if (cubic)
        return grey ? cubic2_scalar : cubic4_scalar;
    return grey ? linear2_scalar : linear4_scalar;
}

/* Cuts [*low, *high] to the numbers x for which place + x * step is within
 * [least, most]. */
static void cut_range(double place, double step, double least, double most,
                      double *low, double *high) {
    if (step == 0) {
        if (!(place >= least && place <= most))
            *high = *low - 1;
        return;
    }
    double a = (least - place) / step, b = (most - place) / step;
    *low = fmax(*low, fmin(a, b));
    *high = fmin(*high, fmax(a, b));
}

static int64_t fixed(double x) {
    return (int64_t)floor(x * 0x1p32 + 0.5);
}

void snow_warp_row(const snow_plane *plane, const snow_shear *shear,
                   snow_filter filter, snow_warp_fn *warp, int y, int width,
                   float *pixels) {
    int before = filter == SNOW_CATMULL_ROM ? 1 : 0, after = before + 1;
    const int sides[2] = {plane->width, plane->height};
    double low = 0, high = width - 1;
    snow_warp_line line;
    for (int axis = 0; axis < 2; axis++) {
        double start = shear->start[axis] + y * shear->along_y[axis];
        /* Half a pixel inside, for rounding; the plane's border is wider. */
        cut_range(start, shear->along_x[axis], before + 0.5,
                  sides[axis] - 1.5 - after, &low, &high);
        line.step[axis] = fixed(shear->along_x[axis]);
        line.start[axis] = low <= high ? fixed(start) : 0;
    }
    size_t pixel = (size_t)plane->channels;
    int first = (int)ceil(fmin(low, width));
    int last = low <= high ? (int)floor(high) : first - 1;
    if (last < first)
        first = width, last = width - 1;
    memset(pixels, 0, (size_t)first * pixel * sizeof *pixels);
    warp(plane, &line, first, last - first + 1, pixels + (size_t)first * pixel);
    memset(pixels + (size_t)(last + 1) * pixel, 0,
           (size_t)(width - 1 - last) * pixel * sizeof *pixels);
}
