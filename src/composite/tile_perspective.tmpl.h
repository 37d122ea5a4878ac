/* composite/tile_perspective.tmpl.h - the lines of a tile in perspective.
 * Include simd/select.h first, and define:
 *
 *   RAY_CHANNELS  floats of a pixel: 2 or 4
 *   RAY_NAME      names of the functions
 *
 * All are undefined at the end. The numbers of taps are arguments, which are
 * constants in the common cases (RAY_NAME()), so that loops unroll and weights
 * stay in registers. The order of additions does not depend on the instruction
 * set. */

#define RAY_PIXELS (LANES / RAY_CHANNELS)

/* A vector of pixels in all held rows. If pixels are at most a voxel apart, a
 * tap of RAY_PIXELS of them reads at most as many voxels: one vector, whose
 * lanes are permuted. Otherwise it gathers. */
TARGET static inline __attribute__((always_inline)) void
RAY_NAME(_group)(const snow_perspective_tile *t, const int n, const int taps,
                 const bool dense) {
    const int32_t *first = t->u.first + n;
    const size_t row_floats = (size_t)t->columns * RAY_CHANNELS;
    uint32_t voxel[RAY_PIXELS];
    V(vec) weights[SNOW_TAPS_MOST];
    for (int i = 0; i < RAY_PIXELS; i++)
        voxel[i] = (uint32_t)(first[i] - first[0]);
    const V(places) pick = VC(places, RAY_CHANNELS)(first),
                    repeat = VC(repeat, RAY_CHANNELS)();
    for (int m = 0; m < taps; m++)
        weights[m] =
            V(pick)(t->u.weights + (size_t)m * t->u.stride + n, repeat);
    const float *samples =
        t->samples + (size_t)(first[0] - t->u.first[0]) * RAY_CHANNELS;
    for (uint64_t left = t->held; left; left &= left - 1) {
        size_t row = (size_t)__builtin_ctzll(left);
        const float *sample = samples + row * t->window;
        V(vec) sum = V(set1)(0);
        for (int m = 0; m < taps; m++, sample += RAY_CHANNELS) {
            V(vec)
            tap = dense ? V(pick)(sample, pick)
                        : VC(gather, RAY_CHANNELS)(sample, voxel);
            sum =
                m == 0 ? V(mul)(weights[0], tap) : V(fma)(weights[m], tap, sum);
        }
        V(store)(t->ring + row * row_floats + (size_t)n * RAY_CHANNELS, sum);
    }
}

/* One line: rows are weighted, added up and composited behind the image.
 * Returns true while it is not opaque. */
TARGET static inline __attribute__((always_inline)) bool
RAY_NAME(_line)(const snow_perspective_tile *t, const float *const *rows, int n,
                const int taps) {
    const int floats = t->columns * RAY_CHANNELS;
    float *line = t->pixels + (size_t)n * t->line;
    const float *row[SNOW_TAPS_MOST];
    V(vec) weights[SNOW_TAPS_MOST], least = V(set1)(0);
    for (int m = 0; m < taps; m++) {
        row[m] = rows[m];
        weights[m] = V(set1)(t->v.weights[(size_t)m * t->v.stride + (size_t)n]);
    }
    for (int at = 0; at < floats; at += LANES) {
        V(vec) front = V(load)(line + at);
        V(vec) sum = V(mul)(weights[0], V(load)(row[0] + at));
        for (int m = 1; m < taps; m++)
            sum = V(fma)(weights[m], V(load)(row[m] + at), sum);
        front = V(fnma)(VC(alpha, RAY_CHANNELS)(front), sum, front);
        V(store)(line + at, front);
        least = V(min)(least, front);
    }
    /* Colours are never negative, so only alpha - 1 counts. */
    return V(any_less)(least, V(set1)(-SNOW_OPAQUE_ENOUGH));
}

TARGET static inline __attribute__((always_inline)) uint64_t
RAY_NAME(_lines)(const snow_perspective_tile *t, const int taps_u,
                 const int taps_v) {
    const float *rows[SNOW_TILE_ROWS];
    const size_t row_floats = (size_t)t->columns * RAY_CHANNELS;
    uint64_t finished = 0;
    for (size_t i = 0; i < SNOW_TILE_ROWS; i++)
        rows[i] = t->held >> i & 1 ? t->ring + i * row_floats : t->zero;
    if (t->dense)
        for (int n = 0; n < t->columns; n += RAY_PIXELS)
            RAY_NAME(_group)(t, n, taps_u, true);
    else
        for (int n = 0; n < t->columns; n += RAY_PIXELS)
            RAY_NAME(_group)(t, n, taps_u, false);
    for (uint64_t lines = t->wanted; lines; lines &= lines - 1) {
        int n = __builtin_ctzll(lines);
        if (!RAY_NAME(_line)(t, rows + (t->v.first[n] - t->row), n, taps_v))
            finished |= lines & -lines;
    }
    return finished;
}

/* The common cases, unrolled; and any other. */
TARGET static uint64_t RAY_NAME()(const snow_perspective_tile *t) {
    const int u = t->u.taps, v = t->v.taps;
    if (u == 4 && v == 4)
        return RAY_NAME(_lines)(t, 4, 4);
    if (u == 2 && v == 2)
        return RAY_NAME(_lines)(t, 2, 2);
    if (u == 6 && v == 6)
        return RAY_NAME(_lines)(t, 6, 6);
    return RAY_NAME(_lines)(t, u, v);
}

#undef RAY_PIXELS
#undef RAY_CHANNELS
#undef RAY_NAME
