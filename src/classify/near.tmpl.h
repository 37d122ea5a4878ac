/* classify/near.tmpl.h - sums over a window of 4 x 4 voxels (classify/probe.h).
 * Define before including:
 *
 *   NEAR_TYPE   C type of a voxel
 *   NEAR_WIDE   the type in which the base is taken off: float where that holds
 *               every voxel, else double
 *   NEAR_NAME(part)  names of the functions
 *
 * All are undefined at the end.  Rows lie
 * `down` voxels apart, and a row's voxels `across`, which is 1 where it
 * matters, so that rows are vectors. */

/* A row of voxels, first .. end - 1 of the window. */
static inline __attribute__((always_inline)) void
NEAR_NAME(row)(const NEAR_TYPE *row, int64_t across, NEAR_WIDE base, int count,
               float *out) {
    for (int i = 0; i < count; i++)
        out[i] = (float)((NEAR_WIDE)row[i * across] - base);
}

static inline __attribute__((always_inline)) float
NEAR_NAME(value_of)(const NEAR_TYPE *voxels, int64_t across, int64_t down,
                    const snow_near *near, NEAR_WIDE base) {
    float sums[4] = {0}, row[4];
    for (int j = 0; j < 4; j++) {
        NEAR_NAME(row)(voxels + j * down, across, base, 4, row);
        for (int i = 0; i < 4; i++)
            sums[i] += near->weights[1][j] * row[i];
    }
    for (int i = 0; i < 4; i++)
        sums[i] *= near->weights[0][i];
    return sums[0] + sums[1] + (sums[2] + sums[3]);
}

static float NEAR_NAME(value)(const snow_near_grid *grid, const snow_near *near,
                              int64_t slices) {
    const NEAR_TYPE *voxels =
        (const NEAR_TYPE *)grid->voxels + near->at + slices * grid->steps[2];
    NEAR_WIDE base = (NEAR_WIDE)grid->base;
    return grid->steps[0] == 1
               ? NEAR_NAME(value_of)(voxels, 1, grid->steps[1], near, base)
               : NEAR_NAME(value_of)(voxels, grid->steps[0], grid->steps[1],
                                     near, base);
}

/* Along u and v: differences of neighbours are taken of the weights instead. */
static inline __attribute__((always_inline)) void
NEAR_NAME(slopes_of)(const NEAR_TYPE *voxels, int64_t across, int64_t down,
                     const snow_near *near, NEAR_WIDE base, float slopes[2]) {
    float u[8], v[8], along_v[8] = {0}, across_v[8] = {0}, row[8] = {0};
    near_differences(near->weights[0], u);
    near_differences(near->weights[1], v);
    for (int j = 0; j < 6; j++) {
        float weight = j > 0 && j < 5 ? near->weights[1][j - 1] : 0;
        NEAR_NAME(row)(voxels + (j - 1) * down - across, across, base, 6, row);
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

static void NEAR_NAME(slopes)(const snow_near_grid *grid, const snow_near *near,
                              float slopes[2]) {
    const NEAR_TYPE *voxels = (const NEAR_TYPE *)grid->voxels + near->at;
    NEAR_WIDE base = (NEAR_WIDE)grid->base;
    if (grid->steps[0] == 1)
        NEAR_NAME(slopes_of)(voxels, 1, grid->steps[1], near, base, slopes);
    else
        NEAR_NAME(slopes_of)
    (voxels, grid->steps[0], grid->steps[1], near, base, slopes);
}

#undef NEAR_TYPE
#undef NEAR_WIDE
#undef NEAR_NAME
