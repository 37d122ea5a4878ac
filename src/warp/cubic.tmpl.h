/* warp/cubic.tmpl.h - Catmull-Rom interpolation of a group of pixels. Include
 * simd/select.h first, and define:
 *
 *   WARP_CHANNELS  floats of a pixel: 2 or 4; a multiple of LANES / 4
 *   WARP_NAME      names of the functions: (_mix)
 *
 * The taps along x are contiguous in memory: a line of four pixels is one run.
 * Lines are added up with their weights along y first, then the pixels of the
 * run with theirs along x. Sums are computed by halves, so that they do not
 * depend on LANES. */

#define WARP_VECTORS (4 * WARP_CHANNELS / LANES) /* of a run */
#define WARP_PIXELS (LANES / WARP_CHANNELS)      /* of a vector */

/* Coefficients of the weights along x in the lanes of a part of a run. */
TARGET static inline __attribute__((always_inline)) V(vec)
WARP_NAME(_taps)(int part, int power) {
    return V(load)(part * LANES + (WARP_CHANNELS == 2 ? catmull_rom2[power]
                                                      : catmull_rom4[power]));
}

TARGET static inline __attribute__((always_inline)) V(vec)
WARP_NAME(_along_x)(int part, V(vec) f) {
    V(vec) w = WARP_NAME(_taps)(part, 3);
    for (int power = 2; power >= 0; power--)
        w = V(fma)(w, f, WARP_NAME(_taps)(part, power));
    return w;
}

/* A pixel's weighted run, added up to one vector. */
TARGET static inline __attribute__((always_inline)) V(vec)
WARP_NAME(_run)(const float *run, size_t stride, const float *along_y,
                V(vec) across) {
    V(vec) part[WARP_VECTORS];
    for (int n = 0; n < WARP_VECTORS; n++) {
        V(vec) sum = V(mul)(V(set1)(along_y[0]), V(load)(run + n * LANES));
        for (int m = 1; m < 4; m++)
            sum = V(fma)(V(set1)(along_y[m * GROUP]),
                         V(load)(run + (size_t)m * stride + n * LANES), sum);
        part[n] = V(mul)(WARP_NAME(_along_x)(n, across), sum);
    }
    for (int half = WARP_VECTORS / 2; half; half /= 2)
        for (int n = 0; n < half; n++)
            part[n] = V(add)(part[n], part[n + half]);
    return part[0];
}

TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_mix)(const snow_intermediate_view *plane, const warp_group *group,
                float *pixels) {
    float along_y[4][GROUP], across[GROUP];
    for (int n = 0; n < GROUP; n += LANES) {
        V(vec) f = V(fractions1)(group->y + n);
        V(store)(across + n, V(fractions1)(group->x + n));
        for (int m = 0; m < 4; m++) {
            V(vec) w = V(set1)(catmull_rom[3][m]);
            for (int power = 2; power >= 0; power--)
                w = V(add)(V(mul)(w, f), V(set1)(catmull_rom[power][m]));
            V(store)(along_y[m] + n, w);
        }
    }
    for (int n = 0; n < GROUP; n += WARP_PIXELS) {
        V(vec) runs[WARP_PIXELS];
        for (int i = 0; i < WARP_PIXELS; i++)
            runs[i] =
                WARP_NAME(_run)(plane->pixels + group->at[n + i], plane->stride,
                                &along_y[0][n + i], V(set1)(across[n + i]));
        V(store)(pixels + n * WARP_CHANNELS, VC(sums, WARP_CHANNELS)(runs));
    }
}

#undef WARP_VECTORS
#undef WARP_PIXELS
