/* warp/linear.tmpl.h - bilinear mixtures of a group of pixels.  Define before
 * including, with simd/select.h's words in force:
 *
 *   WARP_CHANNELS  floats of a pixel: 2 or 4
 *   WARP_TWINS, WARP_REPEAT
 *                  V(twins2), V(repeat2) or V(twins4), V(repeat4), as
 *                  WARP_CHANNELS
 *   WARP_NAME      names of the functions: (_mix)
 *
 * WARP_TWINS and WARP_REPEAT are undefined at the end.  A vector holds the same
 * of four neighbours of several pixels.  No product is fused with its sum, so
 * that all levels make the same bits. */

/* (1 - part) a + part b */
TARGET static inline __attribute__((always_inline)) V(vec)
    WARP_NAME(_mixed)(V(vec) a, V(vec) b, V(vec) part) {
    return V(add)(a, V(mul)(part, V(sub)(b, a)));
}

TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_mix)(const snow_plane *plane, const warp_group *group,
                float *pixels) {
    const V(places) repeat = WARP_REPEAT();
    for (int n = 0; n < GROUP; n += LANES / WARP_CHANNELS) {
        V(vec) left, right, above, below;
        V(vec) across = V(pick)(group->across + n, repeat);
        V(vec) down = V(pick)(group->down + n, repeat);
        WARP_TWINS(plane->pixels, group->at + n, &left, &right);
        above = WARP_NAME(_mixed)(left, right, across);
        WARP_TWINS(plane->pixels + plane->stride, group->at + n, &left, &right);
        below = WARP_NAME(_mixed)(left, right, across);
        V(store)
        (pixels + n * WARP_CHANNELS, WARP_NAME(_mixed)(above, below, down));
    }
}

#undef WARP_TWINS
#undef WARP_REPEAT
