/* splat/shear_warp/cubic.tmpl.h - resampled slices by the cubic B-spline in the
 * plane; along P it is in the voxels already.  Included by holes.tmpl.h. */

/* Four rows of voxels that are mixed along u, and their weights. */
typedef struct NAME(lines) {
    float values[4][32], weights[4][32];
    int64_t row[4]; /* what is there */
} NAME(lines);

static inline void NAME(spline)(double at, float out[4]) {
    double t = at - floor(at), s = 1 - t;
    out[0] = (float)(s * s * s / 6);
    out[1] = (float)((4 - 6 * t * t + 3 * t * t * t) / 6);
    out[2] = (float)((4 - 6 * s * s + 3 * s * s * s) / 6);
    out[3] = (float)(t * t * t / 6);
}

/* Mixes the four voxels of 32 quantized values along u to line `at`. */
TARGET VALUE_INLINE void NAME(mix_parts_along)(const NAME(part) parts[4],
                                               float (*u)[32], bool weigh,
                                               int at, NAME(lines) *out) {
    int16_t voxels[4][32], weights[4][32];
    for (int x = 0; x < 4; x++) {
        V(row_store)(voxels[x], parts[x].value);
        V(row_store)(weights[x], parts[x].weight);
    }
    for (int n = 0; n < 32; n += LANES) {
        V(vec) value = V(set1)(0), weight = V(set1)(0);
        for (int x = 0; x < 4; x++) {
            V(vec) share = V(load)(u[x] + n);
            value = V(add)(value, V(mul)(share, V(row_floats)(voxels[x] + n)));
            if (weigh)
                weight = V(add)(weight,
                                V(mul)(share, V(row_floats)(weights[x] + n)));
        }
        V(store)(out->values[at] + n, value);
        V(store)(out->weights[at] + n, weight);
    }
}

/* Row `row` of voxels, mixed along u. */
TARGET VALUE_INLINE void NAME(mix_line)(const NAME(source) *s, int64_t row,
                                        float (*u)[32], bool weigh,
                                        const bool between, NAME(lines) *out) {
    NAME(part) parts[4];
    int at = (int)(row & 3);
    if (out->row[at] == row)
        return;
    out->row[at] = row;
    for (int x = 0; x < 4; x++)
        parts[x] = NAME(parts)(s, row, x - 1, between);
    NAME(mix_parts_along)(parts, u, weigh, at, out);
}

/* Four lines to one of quantized values. */
TARGET VALUE_INLINE void NAME(mix_lines)(float (*lines)[32], int64_t row,
                                         const float v[4], int16_t *out) {
    for (int n = 0; n < 32; n += LANES) {
        V(vec) sum = V(set1)(0);
        for (int y = 0; y < 4; y++)
            sum = V(add)(sum, V(mul)(V(set1)(v[y]),
                                     V(load)(lines[(row - 1 + y) & 3] + n)));
        V(row_round)(out + n, sum);
    }
}

/* Four lines to a row of a resampled slice; `weigh`: there may be holes. */
TARGET VALUE_INLINE void NAME(mix_row)(NAME(lines) *lines, int64_t at,
                                       const float v[4], bool weigh,
                                       int16_t *out) {
    NAME(mix_lines)(lines->values, at, v, out);
    if (weigh) {
        int16_t weights[32];
        NAME(mix_lines)(lines->weights, at, v, weights);
        snow_value_weigh(out, weights, ~UINT32_C(0));
    }
}

/* As NAME(fill). */
TARGET static void NAME(fill_cubic)(const NAME(source) *s, int64_t first,
                                    uint64_t rows,
                                    const snow_value_place *place,
                                    int16_t (*out)[32], bool weigh,
                                    bool between) {
    NAME(lines) lines;
    float one[4], u[4][32], v[4];
    NAME(spline)(place->at[0], one);
    NAME(spline)(place->at[1], v);
    for (int n = 0; n < 4; n++) {
        lines.row[n] = INT64_MIN;
        for (int lane = 0; lane < 32; lane++)
            u[n][lane] = one[n];
    }
    for (; rows; rows &= rows - 1) {
        int row = __builtin_ctzll(rows);
        int64_t at = first + row;
        for (int y = -1; y < 3; y++)
            NAME(mix_line)(s, at + y, u, weigh, between, &lines);
        NAME(mix_row)(&lines, at, v, weigh, out[row]);
    }
}

/* Differences along P, from those of the resampled slices beside; returns the
 * lanes that have a hole there. */
TARGET static inline uint32_t
NAME(cross_cubic)(const snow_resampled_slice *resampled, const int16_t *before,
                  const int16_t *after, int16_t *out) {
    const V(row) none = V(row_set1)(SNOW_VALUE_HOLE + 1);
    V(row) a = V(row_load)(before), b = V(row_load)(after);
    V(row) way = V(row_subs)(b, a);
    if (resampled->one_sided)
        way = V(row_adds)(way, way);
    V(row_store)(out, way);
    return V(row_gt)(none, a) | V(row_gt)(none, b);
}
