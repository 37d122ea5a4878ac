/* render/modes/interpolate.c - loops of render/modes/interpolate.h for each
 * scalar type. */
#include "render/modes/interpolate.h"
#include "classify/classify.h"

#include <math.h>
#include <string.h>

/* Of voxels `across` apart in a row, rows `down` apart. */
#define SUM(name, type, text)                                                  \
    static void sum_##name(const void *voxels, int64_t across, int64_t down,   \
                           const snow_interpolate_window *p, double sums[2]) { \
        const type *row = voxels;                                              \
        for (int j = 0; j < p->count[1]; j++, row += down) {                   \
            double values = 0, weights = 0;                                    \
            for (int i = 0; i < p->count[0]; i++) {                            \
                double value = (double)row[i * across];                        \
                bool counts = value - value == 0; /* is finite */              \
                values += counts ? p->weights[0][i] * value : 0;               \
                weights += counts ? p->weights[0][i] : 0;                      \
            }                                                                  \
            sums[0] += p->weights[1][j] * values;                              \
            sums[1] += p->weights[1][j] * weights;                             \
        }                                                                      \
    }
SNOW_TYPE_MAP(SUM)
#undef SUM

void snow_interpolate(const snow_interpolate_window *p, double sums[2]) {
    const int64_t *dims = p->volume->info.dims;
    const int64_t strides[3] = {1, dims[0], dims[0] * dims[1]};
    int64_t across = strides[p->axes[0]], down = strides[p->axes[1]];
    int64_t first = p->first[0] * across + p->first[1] * down +
                    p->slice * strides[p->axes[2]];
    const void *voxels = (const char *)p->volume->voxels +
                         (size_t)first * snow_type_size(p->volume->info.type);
    sums[0] = sums[1] = 0;
    if (p->count[0] <= 0 || p->count[1] <= 0)
        return;
    switch (p->volume->info.type) {
#define CASE(name, type, text)                     \
    case SNOW_TYPE_##name:                         \
        sum_##name(voxels, across, down, p, sums); \
        break;
        SNOW_TYPE_MAP(CASE)
#undef CASE
    case SNOW_TYPE_NONE:
        break;
    }
}

/* Adds one row of the window. */
static void add_row(const snow_interpolate_window *p, int j, double sums[4]) {
    double gradients[3 * SNOW_INTERPOLATE_MOST];
    uint32_t columns[SNOW_INTERPOLATE_MOST];
    const int64_t *dims = p->volume->info.dims;
    snow_gradient_row row = {.volume = p->volume, .axis = p->axes[0]};
    row.at[p->axes[1]] = p->first[1] + j;
    row.at[p->axes[2]] = p->slice;
    for (int i = 0; i < p->count[0]; i++)
        columns[i] = (uint32_t)(p->first[0] + i);
    snow_gradients_of_row(&row, columns, (size_t)p->count[0],
                          SNOW_INTERPOLATE_MOST, gradients);
    for (int i = 0; i < p->count[0]; i++) {
        int64_t at[3] = {row.at[0], row.at[1], row.at[2]};
        at[p->axes[0]] = columns[i];
        double weight = p->weights[0][i] * p->weights[1][j];
        if (p->volume->info.type >= SNOW_TYPE_FLOAT32 &&
            !isfinite(snow_volume_native(
                p->volume, (at[2] * dims[1] + at[1]) * dims[0] + at[0])))
            continue;
        for (int n = 0; n < 3; n++)
            sums[n] += weight * gradients[n * SNOW_INTERPOLATE_MOST + i];
        sums[3] += weight;
    }
}

void snow_interpolate_gradient(const snow_interpolate_window *p,
                               double gradient[3]) {
    double sums[4] = {0};
    for (int j = 0; j < p->count[1]; j++)
        add_row(p, j, sums);
    for (int n = 0; n < 3; n++)
        gradient[n] = sums[3] > 0 ? sums[n] / sums[3] : 0;
}
