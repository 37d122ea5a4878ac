/* warp/linear.tmpl.h - the bilinear functions of one level: simd/select.h's
 * words are in force.  No product is fused with its sum, so that all levels
 * make the same bits.
 *
 * Pixels go in groups.  First their places become offsets and fractions, in
 * loops that the compiler carries to vectors; then each pixel is a mixture of
 * four neighbours, of which a vector holds one pixel of four floats, or two of
 * two. */

/* Fills what a group's places (x, y) say. */
TARGET static inline __attribute__((always_inline)) void
NAME(place_group)(const snow_plane *plane, const int64_t *x, const int64_t *y,
                  const int channels, linear_group *group) {
    const int32_t stride = (int32_t)plane->stride; /* shear.c: up to 2^23 */
    for (int n = 0; n < GROUP; n++)
        group->at[n] =
            (int64_t)(int32_t)(y[n] >> 32) * stride + (x[n] >> 32) * channels;
    for (int n = 0; n < GROUP; n++) {
        group->across[2 * n] = group->across[2 * n + 1] = fraction_of(x[n]);
        group->down[2 * n] = group->down[2 * n + 1] = fraction_of(y[n]);
    }
}

TARGET static inline __attribute__((always_inline)) void
NAME(linear_colors)(const snow_plane *plane, const linear_group *group,
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
NAME(linear_greys)(const snow_plane *plane, const linear_group *group,
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

/* A group's pixels, of which `count` are written, held to the laws of
 * premultiplied ones. */
TARGET static inline __attribute__((always_inline)) void
NAME(linear_pixels)(const snow_plane *plane, const int64_t *x, const int64_t *y,
                    int count, float *pixels, const int channels) {
    const V(vec) zero = V(set1)(0), one = V(set1)(1);
    float mixtures[4 * GROUP];
    linear_group group;
    NAME(place_group)(plane, x, y, channels, &group);
    for (int n = count; n < GROUP; n++)
        group.at[n] = group.at[0];
    if (channels == 4)
        NAME(linear_colors)(plane, &group, mixtures);
    else
        NAME(linear_greys)(plane, &group, mixtures);
    for (int at = 0; at < GROUP * channels; at += LANES) {
        V(vec) v = V(min)(V(max)(V(load)(mixtures + at), zero), one);
        v = V(min)(v, channels == 4 ? V(alpha4)(v) : V(alpha2)(v));
        V(store)(mixtures + at, v);
    }
    if (count == GROUP)
        memcpy(pixels, mixtures, (size_t)(GROUP * channels) * sizeof *pixels);
    else
        memcpy(pixels, mixtures, (size_t)(count * channels) * sizeof *pixels);
}

TARGET static inline __attribute__((always_inline)) void
NAME(linear_line)(const snow_plane *plane, const snow_warp_line *line,
                  int first, int count, float *pixels, const int channels) {
    int64_t x[GROUP], y[GROUP], steps[2][GROUP];
    for (int i = 0; i < GROUP; i++) {
        steps[0][i] = i * line->step[0];
        steps[1][i] = i * line->step[1];
    }
    for (int n = 0; n < count; n += GROUP) {
        int64_t left = line->start[0] + (first + n) * line->step[0];
        int64_t top = line->start[1] + (first + n) * line->step[1];
        for (int i = 0; i < GROUP; i++) {
            x[i] = left + steps[0][i];
            y[i] = top + steps[1][i];
        }
        NAME(linear_pixels)
        (plane, x, y, count - n < GROUP ? count - n : GROUP,
         pixels + n * channels, channels);
    }
}

TARGET static inline __attribute__((always_inline)) void
NAME(linear_places)(const snow_plane *plane, const int64_t (*places)[2],
                    int count, float *pixels, const int channels) {
    for (int n = 0; n < count; n += GROUP) {
        int64_t x[GROUP] = {0}, y[GROUP] = {0};
        int some = count - n < GROUP ? count - n : GROUP;
        for (int i = 0; i < some; i++) {
            x[i] = places[n + i][0];
            y[i] = places[n + i][1];
        }
        NAME(linear_pixels)
        (plane, x, y, some, pixels + n * channels, channels);
    }
}

TARGET static void NAME(linear2)(const snow_plane *plane,
                                 const snow_warp_line *line, int first,
                                 int count, float *pixels) {
    NAME(linear_line)(plane, line, first, count, pixels, 2);
}

TARGET static void NAME(linear4)(const snow_plane *plane,
                                 const snow_warp_line *line, int first,
                                 int count, float *pixels) {
    NAME(linear_line)(plane, line, first, count, pixels, 4);
}

TARGET static void NAME(linear2_places)(const snow_plane *plane,
                                        const int64_t (*places)[2], int count,
                                        float *pixels) {
    NAME(linear_places)(plane, places, count, pixels, 2);
}

TARGET static void NAME(linear4_places)(const snow_plane *plane,
                                        const int64_t (*places)[2], int count,
                                        float *pixels) {
    NAME(linear_places)(plane, places, count, pixels, 4);
}
