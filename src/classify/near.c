/* classify/near.c - the loops of classify/probe.h for the usual window, for
 * each scalar type. */
#include "classify/probe.h"

#include <math.h>

/* Weights of neighbours -1 .. 4 that sum differences: half of what the voxel
 * before has, less half of what the one behind has. */
static void near_differences(const float weights[4], float out[8]) {
    const float padded[8] = {0,          0,          weights[0],
                             weights[1], weights[2], weights[3]};
    for (int n = 0; n < 6; n++)
        out[n] = (padded[n] - (n + 2 < 6 ? padded[n + 2] : 0)) / 2;
}

#define NEAR_TYPE int8_t
#define NEAR_WIDE float
#define NEAR_NAME(part) near_##part##_INT8
#include "classify/near.tmpl.h"
#define NEAR_TYPE uint8_t
#define NEAR_WIDE float
#define NEAR_NAME(part) near_##part##_UINT8
#include "classify/near.tmpl.h"
#define NEAR_TYPE int16_t
#define NEAR_WIDE float
#define NEAR_NAME(part) near_##part##_INT16
#include "classify/near.tmpl.h"
#define NEAR_TYPE uint16_t
#define NEAR_WIDE float
#define NEAR_NAME(part) near_##part##_UINT16
#include "classify/near.tmpl.h"
#define NEAR_TYPE int32_t
#define NEAR_WIDE double
#define NEAR_NAME(part) near_##part##_INT32
#include "classify/near.tmpl.h"
#define NEAR_TYPE uint32_t
#define NEAR_WIDE double
#define NEAR_NAME(part) near_##part##_UINT32
#include "classify/near.tmpl.h"
#define NEAR_TYPE int64_t
#define NEAR_WIDE double
#define NEAR_NAME(part) near_##part##_INT64
#include "classify/near.tmpl.h"
#define NEAR_TYPE uint64_t
#define NEAR_WIDE double
#define NEAR_NAME(part) near_##part##_UINT64
#include "classify/near.tmpl.h"
#define NEAR_TYPE float
#define NEAR_WIDE double
#define NEAR_NAME(part) near_##part##_FLOAT32
#include "classify/near.tmpl.h"
#define NEAR_TYPE double
#define NEAR_WIDE double
#define NEAR_NAME(part) near_##part##_FLOAT64
#include "classify/near.tmpl.h"

snow_near_grid snow_near_grid_of(const snow_volume *volume, const int axes[3],
                                 double base) {
    const int64_t *dims = volume->info.dims;
    const int64_t steps[3] = {1, dims[0], dims[0] * dims[1]};
    bool whole = volume->info.type < SNOW_FLOAT32;
    return (snow_near_grid){
        .voxels = volume->voxels,
        .type = volume->info.type,
        .axes = {axes[0], axes[1], axes[2]},
        .steps = {steps[axes[0]], steps[axes[1]], steps[axes[2]]},
        .base = whole ? round(base) : base,
    };
}

float snow_near_value(const snow_near_grid *grid, const snow_near *near,
                      int64_t slices) {
    switch (grid->type) {
#define CASE(name, type, text) \
    case SNOW_##name:          \
        return near_value_##name(grid, near, slices);
        SNOW_TYPE_MAP(CASE)
#undef CASE
    case SNOW_TYPE_NONE:
        break;
    }
    return 0;
}

void snow_near_gradient(const snow_near_grid *grid, const snow_near *near,
                        double gradient[3]) {
    float slopes[2] = {0, 0};
    switch (grid->type) {
#define CASE(name, type, text)                  \
    case SNOW_##name:                           \
        near_slopes_##name(grid, near, slopes); \
        break;
        SNOW_TYPE_MAP(CASE)
#undef CASE
    case SNOW_TYPE_NONE:
        break;
    }
    gradient[grid->axes[0]] = (double)slopes[0];
    gradient[grid->axes[1]] = (double)slopes[1];
    gradient[grid->axes[2]] = (double)(snow_near_value(grid, near, 1) -
                                       snow_near_value(grid, near, -1)) /
                              2;
}
