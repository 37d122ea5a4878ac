/* warp/lines.tmpl.h - resamples lines of the picture from the intermediate
 * image, in groups of pixels. Include simd/select.h first, and define:
 *
 *   WARP_CHANNELS  floats of a pixel: 2 or 4
 *   WARP_BEFORE    lines and columns that are read before a pixel's place
 *   WARP_NAME      names of the functions: for a line whose places are a number
 *                  of steps apart, and (_places) for any places; (_mix)
 *                  interpolates the pixels of a group at their places
 *
 * All are undefined at the end. Places become offsets and fractions in loops
 * that the compiler vectorizes. */

/* Computes a group's offsets and fractions from its places (x, y); beyond
 * `count` they are copies. */
TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_place)(const snow_intermediate_view *plane, const int64_t *x,
                  const int64_t *y, int count, warp_group *group) {
    const int32_t stride = (int32_t)plane->stride; /* below 2^23 */
    const int64_t before = WARP_BEFORE * (stride + WARP_CHANNELS);
    for (int n = 0; n < GROUP; n++)
        group->at[n] = (int64_t)(int32_t)(y[n] >> 32) * stride +
                       (x[n] >> 32) * WARP_CHANNELS - before;
    for (int n = 0; n < GROUP; n++) {
        group->across[n] = fraction_of(x[n]);
        group->down[n] = fraction_of(y[n]);
    }
    for (int n = count; n < GROUP; n++)
        group->at[n] = group->at[0];
}

/* Prefetches what the pixels of a group read: lines of the picture may run
 * across those of the intermediate image, where the hardware prefetcher fails.
 */
TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_fetch)(const snow_intermediate_view *plane, const int64_t *x,
                  const int64_t *y) {
    const int32_t stride = (int32_t)plane->stride;
    for (int n = 0; n < GROUP; n++) {
        const float *at = plane->pixels +
                          (int64_t)(int32_t)(y[n] >> 32) * stride +
                          (x[n] >> 32) * WARP_CHANNELS;
        for (int m = -WARP_BEFORE; m < WARP_BEFORE + 2; m++)
            __builtin_prefetch(at + m * stride);
    }
}

/* A group's pixels, of which `count` are written, clamped to valid
 * premultiplied values. */
TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_group)(const snow_intermediate_view *plane, const int64_t *x,
                  const int64_t *y, int count, float *pixels) {
    const V(vec) zero = V(set1)(0), one = V(set1)(1);
    float mixtures[WARP_CHANNELS * GROUP];
    warp_group group;
    WARP_NAME(_place)(plane, x, y, count, &group);
    WARP_NAME(_mix)(plane, &group, mixtures);
    for (int at = 0; at < WARP_CHANNELS * GROUP; at += LANES) {
        V(vec) v = V(min)(V(max)(V(load)(mixtures + at), zero), one);
        v = V(min)(v, WARP_CHANNELS == 4 ? V(alpha4)(v) : V(alpha2)(v));
        V(store)(mixtures + at, v);
    }
    if (count == GROUP)
        memcpy(pixels, mixtures, sizeof mixtures);
    else
        memcpy(pixels, mixtures,
               (size_t)(count * WARP_CHANNELS) * sizeof *pixels);
}

TARGET static void WARP_NAME()(const snow_intermediate_view *plane,
                               const snow_warp_line *line, int first, int count,
                               float *pixels) {
    int64_t x[GROUP], y[GROUP], steps[2][GROUP];
    bool across = line->step[1] > ACROSS || line->step[1] < -ACROSS;
    for (int i = 0; i < GROUP; i++) {
        steps[0][i] = i * line->step[0];
        steps[1][i] = i * line->step[1];
    }
    for (int n = 0; n < count; n += GROUP) {
        int64_t left = line->start[0] + (first + n) * line->step[0];
        int64_t top = line->start[1] + (first + n) * line->step[1];
        for (int i = 0; i < GROUP; i++) {
            x[i] = left + GROUP * line->step[0] + steps[0][i];
            y[i] = top + GROUP * line->step[1] + steps[1][i];
        }
        if (across && count - n >= 2 * GROUP)
            WARP_NAME(_fetch)(plane, x, y);
        for (int i = 0; i < GROUP; i++) {
            x[i] = left + steps[0][i];
            y[i] = top + steps[1][i];
        }
        WARP_NAME(_group)
        (plane, x, y, count - n < GROUP ? count - n : GROUP,
         pixels + n * WARP_CHANNELS);
    }
}

TARGET static void WARP_NAME(_places)(const snow_intermediate_view *plane,
                                      const int64_t (*places)[2], int count,
                                      float *pixels) {
    for (int n = 0; n < count; n += GROUP) {
        int64_t x[GROUP] = {0}, y[GROUP] = {0};
        int some = count - n < GROUP ? count - n : GROUP;
        for (int i = 0; i < some; i++) {
            x[i] = places[n + i][0];
            y[i] = places[n + i][1];
        }
        WARP_NAME(_group)(plane, x, y, some, pixels + n * WARP_CHANNELS);
    }
}

#undef WARP_CHANNELS
#undef WARP_BEFORE
#undef WARP_NAME
