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

#define WARP_VECTORS (4 * WARP_CHANNELS / LANES)

TARGET static inline __attribute__((always_inline)) snow_scalar_vec
WARP_NAME(_pixel)(const float *run, size_t stride, const float *along_y,
                  V(vec) part[WARP_VECTORS]) {
    for (int n = 0; n < WARP_VECTORS; n++) {
        V(vec) sum = V(mul)(V(set1)(along_y[0]), V(load)(run + n * LANES));
        for (int m = 1; m < 4; m++)
            sum = V(fma)(V(set1)(along_y[m * GROUP]),
                         V(load)(run + (size_t)m * stride + n * LANES), sum);
        part[n] = V(mul)(part[n], sum);
    }
    for (int half = WARP_VECTORS / 2; half; half /= 2)
        for (int n = 0; n < half; n++)
            part[n] = V(add)(part[n], part[n + half]);
    return VC(hadd, WARP_CHANNELS)(part[0]);
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
                    catmull_rom[power][(n * LANES + i) / WARP_CHANNELS];
        V(vec) w = V(load)(lanes[3]);
        for (int power = 2; power >= 0; power--)
            w = V(fma)(w, f, V(load)(lanes[power]));
        part[n] = w;
    }
}

TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_mix)(const snow_intermediate_view *plane, const warp_group *group,
                float *pixels) {
    float along_y[4][GROUP];
    for (int m = 0; m < 4; m++)
        for (int n = 0; n < GROUP; n++) {
            float f = group->down[n], w = catmull_rom[3][m];
            for (int power = 2; power >= 0; power--)
                w = w * f + catmull_rom[power][m];
            along_y[m][n] = w;
        }
    for (int n = 0; n < GROUP; n++) {
        V(vec) part[WARP_VECTORS];
        WARP_NAME(_along_x)(group->across[n], part);
        snow_scalar_vec pixel = WARP_NAME(_pixel)(
            plane->pixels + group->at[n], plane->stride, &along_y[0][n], part);
        memcpy(pixels + n * WARP_CHANNELS, &pixel,
               WARP_CHANNELS * sizeof *pixels);
    }
}

#undef WARP_VECTORS
