/* classify/shading/gradient.c - gradients of native values in index space
 * (model, point 4), for each scalar type. */
#include "classify/classify.h"

#include <math.h>

/* The difference at `here`; a neighbour counts only if it is finite. */
static double difference(double here, double below, double above) {
    bool has_below = isfinite(below), has_above = isfinite(above);
    if (has_below && has_above)
        return (above - below) / 2;
    if (has_above && isfinite(here))
        return above - here;
    if (has_below && isfinite(here))
        return here - below;
    return 0;
}

#define GRADIENT_TYPE int8_t
#define GRADIENT_NAME gradient_int8
#define GRADIENT_ROW row_int8
#include "classify/shading/gradient.tmpl.h"
#define GRADIENT_TYPE uint8_t
#define GRADIENT_NAME gradient_uint8
#define GRADIENT_ROW row_uint8
#include "classify/shading/gradient.tmpl.h"
#define GRADIENT_TYPE int16_t
#define GRADIENT_NAME gradient_int16
#define GRADIENT_ROW row_int16
#include "classify/shading/gradient.tmpl.h"
#define GRADIENT_TYPE uint16_t
#define GRADIENT_NAME gradient_uint16
#define GRADIENT_ROW row_uint16
#include "classify/shading/gradient.tmpl.h"
#define GRADIENT_TYPE int32_t
#define GRADIENT_NAME gradient_int32
#define GRADIENT_ROW row_int32
#include "classify/shading/gradient.tmpl.h"
#define GRADIENT_TYPE uint32_t
#define GRADIENT_NAME gradient_uint32
#define GRADIENT_ROW row_uint32
#include "classify/shading/gradient.tmpl.h"
#define GRADIENT_TYPE int64_t
#define GRADIENT_NAME gradient_int64
#define GRADIENT_ROW row_int64
#include "classify/shading/gradient.tmpl.h"
#define GRADIENT_TYPE uint64_t
#define GRADIENT_NAME gradient_uint64
#define GRADIENT_ROW row_uint64
#include "classify/shading/gradient.tmpl.h"
#define GRADIENT_TYPE float
#define GRADIENT_NAME gradient_float32
#define GRADIENT_ROW row_float32
#include "classify/shading/gradient.tmpl.h"
#define GRADIENT_TYPE double
#define GRADIENT_NAME gradient_float64
#define GRADIENT_ROW row_float64
#include "classify/shading/gradient.tmpl.h"

typedef void gradient_row_fn(const snow_gradient_row *row,
                             const uint32_t *columns, size_t count,
                             size_t capacity, double *gradients);

static const struct type_gradients {
    snow_gradient_fn *one;
    gradient_row_fn *row;
} types[] = {
    [SNOW_TYPE_INT8] = {gradient_int8, row_int8},
    [SNOW_TYPE_UINT8] = {gradient_uint8, row_uint8},
    [SNOW_TYPE_INT16] = {gradient_int16, row_int16},
    [SNOW_TYPE_UINT16] = {gradient_uint16, row_uint16},
    [SNOW_TYPE_INT32] = {gradient_int32, row_int32},
    [SNOW_TYPE_UINT32] = {gradient_uint32, row_uint32},
    [SNOW_TYPE_INT64] = {gradient_int64, row_int64},
    [SNOW_TYPE_UINT64] = {gradient_uint64, row_uint64},
    [SNOW_TYPE_FLOAT32] = {gradient_float32, row_float32},
    [SNOW_TYPE_FLOAT64] = {gradient_float64, row_float64},
};

snow_gradient_fn *snow_gradient_of(snow_type type) {
    return types[type].one;
}

/* Voxels first .. end - 1 of the columns, one by one. */
static void one_by_one(const snow_gradient_row *row, const uint32_t *columns,
                       size_t first, size_t end, size_t capacity,
                       double *gradients) {
    const snow_volume_info *info = &row->volume->info;
    int64_t at[3] = {row->at[0], row->at[1], row->at[2]};
    for (size_t n = first; n < end; n++) {
        double gradient[3];
        at[row->axis] = columns[n];
        types[info->type].one(row->volume->voxels, info->dims, at, gradient);
        for (size_t i = 0; i < 3; i++)
            gradients[i * capacity + n] = gradient[i];
    }
}

void snow_gradients_of_row(const snow_gradient_row *row,
                           const uint32_t *columns, size_t count,
                           size_t capacity, double *gradients) {
    const snow_volume_info *info = &row->volume->info;
    bool inside = true;
    for (int axis = 0; axis < 3; axis++)
        if (axis != row->axis)
            inside = inside && row->at[axis] > 0 &&
                     row->at[axis] + 1 < info->dims[axis];
    if (!inside || !count) {
        one_by_one(row, columns, 0, count, capacity, gradients);
        return;
    }
    /* Columns rise, so only the first and the last can be at the border. */
    size_t first = columns[0] == 0, end = count;
    if (end > first && columns[end - 1] + 1 == info->dims[row->axis])
        end--;
    one_by_one(row, columns, 0, first, capacity, gradients);
    types[info->type].row(row, columns + first, end - first, capacity,
                          gradients + first);
    one_by_one(row, columns, end, count, capacity, gradients);
}
