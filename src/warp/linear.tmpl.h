/* warp/linear.tmpl.h - bilinear interpolation of a group of pixels. Include
 * simd/select.h first, and define:
 *
 *   WARP_CHANNELS  floats of a pixel: 2 or 4
 *   WARP_NAME      names of the functions: (_mix)
 *
 * A vector holds the same one of the four neighbours of several pixels. No
 * product is fused with its sum, so all instruction sets give the same bits. */

/* (1 - part) a + part b */
TARGET static inline __attribute__((always_inline)) V(vec)
WARP_NAME(_mixed)(V(vec) a, V(vec) b, V(vec) part) {
    return V(add)(a, V(mul)(part, V(sub)(b, a)));
}

TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_mix)(const snow_intermediate_view *plane, const warp_group *group,
                float *pixels) {
    for (int n = 0; n < GROUP; n += LANES / WARP_CHANNELS) {
        V(vec) left, right, above, below;
        V(vec) across = VC(fractions, WARP_CHANNELS)(group->x + n);
        V(vec) down = VC(fractions, WARP_CHANNELS)(group->y + n);
        VC(load_pairs, WARP_CHANNELS)
        (plane->pixels, group->at + n, &left, &right);
        above = WARP_NAME(_mixed)(left, right, across);
        VC(load_pairs, WARP_CHANNELS)
        (plane->pixels + plane->stride, group->at + n, &left, &right);
        below = WARP_NAME(_mixed)(left, right, across);
        V(store)(pixels + n * WARP_CHANNELS,
                 WARP_NAME(_mixed)(above, below, down));
    }
}
