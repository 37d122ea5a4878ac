/* render/modes/interpolate_cubic.c - the loops of render/modes/interpolate.h
 * for the usual window, for each scalar type. */
#include "render/modes/interpolate.h"

#include <math.h>

/* Weights of neighbours -1 .. 4 that sum differences: half of what the voxel
 * before has, less half of what the one behind has. */
static void cubic_differences(const float weights[4], float out[8]) {
    const float padded[8] = {0,          0,          weights[0],
                             weights[1], weights[2], weights[3]};
    for (int n = 0; n < 6; n++)
        out[n] = (padded[n] - (n + 2 < 6 ? padded[n + 2] : 0)) / 2;
}

#define TEMPLATE "render/modes/interpolate_cubic.tmpl.h"
#include "volume/each_type.h"

snow_cubic_grid snow_cubic_grid_of(const snow_volume *volume, const int axes[3],
                                   double base) {
    const int64_t *dims = volume->info.dims;
    const int64_t steps[3] = {1, dims[0], dims[0] * dims[1]};
    bool whole = volume->info.type < SNOW_TYPE_FLOAT32;
    return (snow_cubic_grid){
        .voxels = volume->voxels,
        .type = volume->info.type,
        .axes = {axes[0], axes[1], axes[2]},
        .steps = {steps[axes[0]], steps[axes[1]], steps[axes[2]]},
        .base = whole ? round(base) : base,
    };
}

float snow_interpolate_cubic(const snow_cubic_grid *grid,
                             const snow_cubic_window *near, int64_t slices) {
    switch (grid->type) {
#define CASE(name, type, text) \
    case SNOW_TYPE_##name:     \
        return value_##name(grid, near, slices);
        SNOW_TYPE_MAP(CASE)
#undef CASE
    case SNOW_TYPE_NONE:
        break;
    }
    return 0;
}

void snow_interpolate_cubic_gradient(const snow_cubic_grid *grid,
                                     const snow_cubic_window *near,
                                     double gradient[3]) {
    float slopes[2] = {0, 0};
    switch (grid->type) {
#define CASE(name, type, text)             \
    case SNOW_TYPE_##name:                 \
        slopes_##name(grid, near, slopes); \
        break;
        SNOW_TYPE_MAP(CASE)
#undef CASE
    case SNOW_TYPE_NONE:
        break;
    }
    gradient[grid->axes[0]] = (double)slopes[0];
    gradient[grid->axes[1]] = (double)slopes[1];
    gradient[grid->axes[2]] = (double)(snow_interpolate_cubic(grid, near, 1) -
                                       snow_interpolate_cubic(grid, near, -1)) /
                              2;
}
