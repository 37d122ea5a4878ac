/* warp/lines.tmpl.h - resamples lines of the picture from the intermediate
 * image, in groups of pixels. Include simd/select.h first, and define:
 *
 *   WARP_CHANNELS  floats of a pixel: 2 or 4
 *   WARP_BEFORE    lines and columns that are read before a pixel's place
 *   WARP_NAME      names of the functions: for a line whose places are a number
 *                  of steps apart, and (_places) for any places; (_mix)
 *                  interpolates the pixels of a group at their places
 *
 * All are undefined at the end. */

/* A group's offsets from its places; beyond `count` they are copies. */
TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_place)(const snow_intermediate_view *plane, int count,
                  warp_group *group) {
    const V(wide) stride = (V(wide)){0} + plane->stride; /* below 2^23 */
    const uint64_t before = WARP_BEFORE * (plane->stride + WARP_CHANNELS);
    for (int n = 0; n < GROUP; n += LANES / 2) {
        V(wide) x, y, at;
        memcpy(&x, group->x + n, sizeof x);
        memcpy(&y, group->y + n, sizeof y);
        at = V(low_times)(y >> 32, stride) + (x >> 32 << (WARP_CHANNELS / 2)) -
             before;
        memcpy(group->at + n, &at, sizeof at);
    }
    for (int n = count; n < GROUP; n++)
        group->at[n] = group->at[0];
}

/* A group's pixels, of which `count` are written, clamped to valid
 * premultiplied values. */
TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_group)(const snow_intermediate_view *plane, int count,
                  warp_group *group, float *pixels) {
    const V(vec) zero = V(set1)(0), one = V(set1)(1);
    float some[WARP_CHANNELS * GROUP];
    float *out = count < GROUP ? some : pixels;
    WARP_NAME(_place)(plane, count, group);
    WARP_NAME(_mix)(plane, group, out);
    for (int at = 0; at < WARP_CHANNELS * GROUP; at += LANES) {
        V(vec) v = V(min)(V(max)(V(load)(out + at), zero), one);
        V(store)(out + at, V(min)(v, VC(alpha, WARP_CHANNELS)(v)));
    }
    if (count < GROUP)
        memcpy(pixels, some, (size_t)(count * WARP_CHANNELS) * sizeof *some);
}

/* The places of a group that begins at (x, y). */
TARGET static inline __attribute__((always_inline)) void
WARP_NAME(_step)(const V(wide) *steps, uint64_t start, uint64_t *places) {
    for (int n = 0; n < 2 * GROUP / LANES; n++) {
        V(wide) place = steps[n] + start;
        memcpy(places + n * LANES / 2, &place, sizeof place);
    }
}

TARGET static void WARP_NAME()(const snow_intermediate_view *plane,
                               const snow_warp_line *line, int first, int count,
                               float *pixels) {
    warp_group group;
    V(wide) steps[2][2 * GROUP / LANES];
    for (int axis = 0; axis < 2; axis++)
        for (int n = 0; n < GROUP; n++)
            steps[axis][n / (LANES / 2)][n % (LANES / 2)] =
                (uint64_t)(n * line->step[axis]);
    for (int n = 0; n < count; n += GROUP) {
        const int64_t x = first + n;
        WARP_NAME(_step)
        (steps[0], (uint64_t)(line->start[0] + x * line->step[0]), group.x);
        WARP_NAME(_step)
        (steps[1], (uint64_t)(line->start[1] + x * line->step[1]), group.y);
        WARP_NAME(_group)
        (plane, count - n < GROUP ? count - n : GROUP, &group,
         pixels + n * WARP_CHANNELS);
    }
}

TARGET static void WARP_NAME(_places)(const snow_intermediate_view *plane,
                                      const int64_t (*places)[2], int count,
                                      float *pixels) {
    for (int n = 0; n < count; n += GROUP) {
        warp_group group = {0};
        int some = count - n < GROUP ? count - n : GROUP;
        for (int i = 0; i < some; i++) {
            group.x[i] = (uint64_t)places[n + i][0];
            group.y[i] = (uint64_t)places[n + i][1];
        }
        WARP_NAME(_group)(plane, some, &group, pixels + n * WARP_CHANNELS);
    }
}

#undef WARP_CHANNELS
#undef WARP_BEFORE
#undef WARP_NAME
