/* render/modes/interpolate_cubic.tmpl.h - sums over a window of 4 x 4 voxels
 * (render/modes/interpolate.h) for one scalar type (volume/each_type.h):
 * TYPED(value), TYPED(slopes).  Rows lie `down` voxels apart, and a row's voxels
 * `across`, which is 1 where it matters, so that rows are vectors. */

/* The type in which the base is taken off: it holds every voxel. */
#ifdef LOWEST
#define WIDE float
#else
#define WIDE double
#endif

/* A row of voxels, first .. end - 1 of the window. */
static inline __attribute__((always_inline)) void
TYPED(row)(const TYPE *row, int64_t across, WIDE base, int count, float *out) {
    for (int i = 0; i < count; i++)
        out[i] = (float)((WIDE)row[i * across] - base);
}

static inline __attribute__((always_inline)) float
TYPED(value_of)(const TYPE *voxels, int64_t across, int64_t down,
                const snow_cubic_window *near, WIDE base) {
    float sums[4] = {0}, row[4];
    for (int j = 0; j < 4; j++) {
        TYPED(row)(voxels + j * down, across, base, 4, row);
        for (int i = 0; i < 4; i++)
            sums[i] += near->weights[1][j] * row[i];
    }
    for (int i = 0; i < 4; i++)
        sums[i] *= near->weights[0][i];
    return sums[0] + sums[1] + (sums[2] + sums[3]);
}

static float TYPED(value)(const snow_cubic_grid *grid,
                          const snow_cubic_window *near, int64_t slices) {
    const TYPE *voxels =
        (const TYPE *)grid->voxels + near->at + slices * grid->steps[2];
    WIDE base = (WIDE)grid->base;
    return grid->steps[0] == 1
               ? TYPED(value_of)(voxels, 1, grid->steps[1], near, base)
               : TYPED(value_of)(voxels, grid->steps[0], grid->steps[1], near,
                                 base);
}

/* Along u and v: differences of neighbours are taken of the weights instead. */
static inline __attribute__((always_inline)) void
TYPED(slopes_of)(const TYPE *voxels, int64_t across, int64_t down,
                 const snow_cubic_window *near, WIDE base, float slopes[2]) {
    float u[8], v[8], along_v[8] = {0}, across_v[8] = {0}, row[8] = {0};
    cubic_differences(near->weights[0], u);
    cubic_differences(near->weights[1], v);
    for (int j = 0; j < 6; j++) {
        float weight = j > 0 && j < 5 ? near->weights[1][j - 1] : 0;
        TYPED(row)(voxels + (j - 1) * down - across, across, base, 6, row);
        for (int i = 0; i < 8; i++) {
            along_v[i] += weight * row[i];
            across_v[i] += v[j] * row[i];
        }
    }
    slopes[0] = slopes[1] = 0;
    for (int i = 0; i < 6; i++)
        slopes[0] += u[i] * along_v[i];
    for (int i = 0; i < 4; i++)
        slopes[1] += near->weights[0][i] * across_v[i + 1];
}

static void TYPED(slopes)(const snow_cubic_grid *grid,
                          const snow_cubic_window *near, float slopes[2]) {
    const TYPE *voxels = (const TYPE *)grid->voxels + near->at;
    WIDE base = (WIDE)grid->base;
    if (grid->steps[0] == 1)
        TYPED(slopes_of)(voxels, 1, grid->steps[1], near, base, slopes);
    else
        TYPED(slopes_of)
    (voxels, grid->steps[0], grid->steps[1], near, base, slopes);
}

#undef WIDE
#undef TYPE
#undef TYPED
#undef LOWEST
