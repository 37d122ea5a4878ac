/* warp/warp.tmpl.h - one line of the picture out of the intermediate image.
 * Define before including, with simd/select.h's words in force:
 *
 *   WARP_CHANNELS  floats of a pixel: 2 or 4
 *   WARP_TAPS      pixels in reach on either axis: 2 (bilinear) or 4
 *                  (Catmull-Rom); WARP_CHANNELS * WARP_TAPS is a multiple of
 *                  LANES
 *   WARP_FOLD      V(fold2) or V(fold4), as WARP_CHANNELS
 *   WARP_NAME      names of the functions: of a line whose places are a
 *                  number of steps apart, and (_places) of any places
 *
 * All are undefined at the end.  The taps along x are neighbours in memory, so
 * a line of them is one run of WARP_CHANNELS * WARP_TAPS floats: lines are
 * added up with their weights along y first, then the pixels of the run with
 * theirs along x.  Sums are by halves, so that they do not depend on LANES. */

#define WARP_VECTORS (WARP_CHANNELS * WARP_TAPS / LANES)

TARGET static inline __attribute__((always_inline)) snow_scalar_vec
WARP_NAME(_pixel)(const float *run, size_t stride, const float *along_y,
                  V(vec) part[WARP_VECTORS]) {
    for (int n = 0; n < WARP_VECTORS; n++) {
        V(vec) sum = V(mul)(V(set1)(along_y[0]), V(load)(run + n * LANES));
        for (int m = 1; m < WARP_TAPS; m++)
            sum = V(fma)(V(set1)(along_y[m]),
                         V(load)(run + (size_t)m * stride + n * LANES), sum);
        part[n] = V(mul)(part[n], sum);
    }
    for (int half = WARP_VECTORS / 2; half; half /= 2)
        for (int n = 0; n < half; n++)
            part[n] = V(add)(part[n], part[n + half]);
    return WARP_FOLD(part[0]);
}

/* Weights along x in all lanes, as cubic polynomials of the fraction. */
TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_along_x)(float fraction, V(vec) part[WARP_VECTORS]) {
    V(vec) f = V(set1)(fraction);
    for (int n = 0; n < WARP_VECTORS; n++) {
        float lanes[4][LANES];
        for (int i = 0; i < LANES; i++)
            for (int power = 0; power < 4; power++)
                lanes[power][i] =
                    WARP_CUBIC[power][(n * LANES + i) / WARP_CHANNELS];
        V(vec) w = V(load)(lanes[3]);
        for (int power = 2; power >= 0; power--)
            w = V(fma)(w, f, V(load)(lanes[power]));
        part[n] = w;
    }
}

/* The pixel at place (x, y) of the plane, in 2^-32 pixels. */
TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_place)(const snow_plane *plane, int64_t x, int64_t y, float *pixel) {
    const float *run = plane->pixels +
                       (size_t)((y >> 32) + 1 - WARP_TAPS / 2) * plane->stride +
                       (size_t)((x >> 32) + 1 - WARP_TAPS / 2) * WARP_CHANNELS;
    float along_y[4];
    V(vec) part[WARP_VECTORS];
    snow_scalar_store(along_y, cubic_weights(WARP_CUBIC, fraction_of(y)));
    WARP_NAME(_along_x)(fraction_of(x), part);
    store_pixel(WARP_NAME(_pixel)(run, plane->stride, along_y, part),
                WARP_CHANNELS, pixel);
}

TARGET static void WARP_NAME()(const snow_plane *plane,
                               const snow_warp_line *line, int first, int count,
                               float *pixels) {
    for (int n = 0; n < count; n++)
        WARP_NAME(_place)
        (plane, line->start[0] + (first + n) * line->step[0],
         line->start[1] + (first + n) * line->step[1],
         pixels + n * WARP_CHANNELS);
}

TARGET static void WARP_NAME(_places)(const snow_plane *plane,
                                      const int64_t (*places)[2], int count,
                                      float *pixels) {
    for (int n = 0; n < count; n++)
        WARP_NAME(_place)
        (plane, places[n][0], places[n][1], pixels + n * WARP_CHANNELS);
}

#undef WARP_VECTORS
#undef WARP_CHANNELS
#undef WARP_TAPS
#undef WARP_FOLD
#undef WARP_CUBIC
#undef WARP_NAME
