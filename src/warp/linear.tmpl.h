/* warp/linear.tmpl.h - bilinear mixtures of a group of pixels, for one level:
 * simd/select.h's words are in force.  Each pixel is a mixture of four
 * neighbours, of which a vector holds one pixel of four floats, or two of two.
 * No product is fused with its sum, so that all levels make the same bits. */

TARGET static inline __attribute__((always_inline)) void
NAME(linear4_mix)(const snow_plane *plane, const warp_group *group,
                  float *pixels) {
    for (int n = 0; n < GROUP; n++) {
        const float *at = plane->pixels + group->at[n];
        const float *below = at + plane->stride;
        snow_scalar_vec across = snow_scalar_set1(group->across[2 * n]);
        snow_scalar_vec down = snow_scalar_set1(group->down[2 * n]);
        snow_scalar_vec a =
            mixed(snow_scalar_load(at), snow_scalar_load(at + 4), across);
        snow_scalar_vec b =
            mixed(snow_scalar_load(below), snow_scalar_load(below + 4), across);
        snow_scalar_store(pixels + 4 * n, mixed(a, b, down));
    }
}

TARGET static inline __attribute__((always_inline)) void
NAME(linear2_mix)(const snow_plane *plane, const warp_group *group,
                  float *pixels) {
    const size_t stride = plane->stride;
    for (int n = 0; n < GROUP; n += 2) {
        const float *p = plane->pixels + group->at[n];
        const float *q = plane->pixels + group->at[n + 1];
        snow_scalar_vec across = snow_scalar_load(group->across + 2 * n);
        snow_scalar_vec down = snow_scalar_load(group->down + 2 * n);
        snow_scalar_vec a =
            mixed(two_pixels(p, q), two_pixels(p + 2, q + 2), across);
        snow_scalar_vec b =
            mixed(two_pixels(p + stride, q + stride),
                  two_pixels(p + stride + 2, q + stride + 2), across);
        snow_scalar_store(pixels + 2 * n, mixed(a, b, down));
    }
}
