/* warp/warp.c - lines of the picture, and the resampling for each instruction
 * set.
 *
 * Catmull-Rom's cubic (Keys 1981, a = -1/2) preserves detail that a bilinear
 * warp blurs. It may overshoot beside an edge, so results are clamped to 0 <=
 * colour <= alpha <= 1, which valid premultiplied pixels satisfy. */
#include "warp/empty.h"

#include <math.h>
#include <string.h>

/* Coefficients of 1, f, f^2 and f^3 for the weight of each tap. */
#define TAPS(a, b, c, d) \
    { FLOATS(a), FLOATS(b), FLOATS(c), FLOATS(d) }
#define POLYNOMIALS                                                          \
    {                                                                        \
        TAPS(0, 1, 0, 0), TAPS(-0.5f, 0, 0.5f, 0), TAPS(1, -2.5f, 2, -0.5f), \
            TAPS(-0.5f, 1.5f, -1.5f, 0.5f),                                  \
    }
#define FLOATS(a) a
static const float catmull_rom[4][4] = POLYNOMIALS;
#undef FLOATS

/* The same for each float of four pixels of 2 and 4 channels, which compilers
 * load as they stand. */
#define FLOATS(a) a, a
static const float catmull_rom2[4][8] = POLYNOMIALS;
#undef FLOATS
#define FLOATS(a) a, a, a, a
static const float catmull_rom4[4][16] = POLYNOMIALS;

#include "simd/vec_scalar.h"

#define GROUP 16

/* The pixels of a group. */
typedef struct warp_group {
    uint64_t x[GROUP], y[GROUP]; /* places in 2^-32 pixels */
    int64_t at[GROUP];           /* offset of the first float read */
} __attribute__((aligned(64))) warp_group;

#define TEMPLATE "warp/warp_isa.h"
#include "simd/each_isa.h"

/* Both functions of an instruction set. */
typedef struct warp_pair {
    snow_warp_fn *line;
    snow_warp_places_fn *places;
} warp_pair;

#define PAIR(name, level) ((warp_pair){name##_##level, name##_places_##level})

static warp_pair pair_of(snow_isa isa, snow_filter filter, int channels) {
    bool cubic = filter == SNOW_CATMULL_ROM, grey = channels == 2;
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512 && cubic && !grey)
        return PAIR(cubic4, avx512);
    if (isa == SNOW_ISA_AVX512 || isa == SNOW_ISA_AVX2) {
        if (cubic)
            return grey ? PAIR(cubic2, avx2) : PAIR(cubic4, avx2);
        return grey ? PAIR(linear2, avx2) : PAIR(linear4, avx2);
    }
#endif
    (void)isa;
    if (cubic)
        return grey ? PAIR(cubic2, scalar) : PAIR(cubic4, scalar);
    return grey ? PAIR(linear2, scalar) : PAIR(linear4, scalar);
}

snow_warp_fn *snow_warp_of(snow_isa isa, snow_filter filter, int channels) {
    return pair_of(isa, filter, channels).line;
}

snow_warp_places_fn *snow_warp_places_of(snow_isa isa, snow_filter filter,
                                         int channels) {
    return pair_of(isa, filter, channels).places;
}

/* Narrows [*low, *high] to the numbers x with place + x * step within [least,
 * most]. */
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

/* Pixels of the picture that are warped or skipped together. */
#define RUN GROUP

static void place_of(const snow_warp_line *line, int x, int64_t place[2]) {
    place[0] = line->start[0] + x * line->step[0];
    place[1] = line->start[1] + x * line->step[1];
}

/* Pixels first .. last of a line, one at least, in the intermediate image. */
static void warp_runs(const snow_intermediate_view *plane,
                      const snow_warp_line *line, snow_warp_fn *warp, int first,
                      int last, float *pixels) {
    size_t pixel = (size_t)plane->channels;
    const snow_blocks blocks = snow_blocks_of(plane);
    int64_t ends[2][2];
    int begun = first; /* first pixel not yet warped */
    for (int x = first; x <= last; x += RUN) {
        int end = x + RUN <= last ? x + RUN : last + 1;
        place_of(line, x, ends[0]);
        place_of(line, end - 1, ends[1]);
        if (snow_blocks_drawn(&blocks, ends[0], ends[1]))
            continue;
        if (begun < x)
            warp(plane, line, begun, x - begun, pixels + (size_t)begun * pixel);
        memset(pixels + (size_t)x * pixel, 0,
               (size_t)(end - x) * pixel * sizeof *pixels);
        begun = end;
    }
    if (begun <= last)
        warp(plane, line, begun, last + 1 - begun,
             pixels + (size_t)begun * pixel);
}

void snow_warp_row(const snow_intermediate_view *plane, const snow_shear *shear,
                   snow_filter filter, snow_warp_fn *warp, int y, int from,
                   int to, float *pixels) {
    int before = filter == SNOW_CATMULL_ROM ? 1 : 0, after = before + 1;
    const int sides[2] = {plane->width, plane->height};
    double low = from, high = to - 1;
    snow_warp_line line;
    for (int axis = 0; axis < 2; axis++) {
        double start = shear->start[axis] + y * shear->along_y[axis];
        /* Half a pixel inside, for rounding; the image's border is wider. */
        cut_range(start, shear->along_x[axis], before + 0.5,
                  sides[axis] - 1.5 - after, &low, &high);
        line.step[axis] = fixed(shear->along_x[axis]);
        line.start[axis] = low <= high ? fixed(start) : 0;
    }
    int first, last;
    if (snow_clear_outside(from, to, low, high, plane->channels, pixels, &first,
                           &last))
        warp_runs(plane, &line, warp, first, last, pixels);
}
