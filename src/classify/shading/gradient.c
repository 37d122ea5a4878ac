/* classify/shading/gradient.c - gradients of native values in index space
 * (model, section 4), for each scalar type. */
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

#define TEMPLATE "classify/shading/gradient.tmpl.h"
#include "volume/each_type.h"

typedef void gradient_fn(const snow_volume *volume, const int64_t at[3],
                         double gradient[3]);
typedef void gradient_row_fn(const snow_gradient_row *row,
                             const uint32_t *columns, size_t count,
                             size_t capacity, double *gradients);

static const struct type_gradients {
    gradient_fn *one;
    gradient_row_fn *row;
} types[] = {
#define ENTRY(name, type, text) \
    [SNOW_TYPE_##name] = {gradient_##name, row_##name},
    SNOW_TYPE_MAP(ENTRY)};

/* Voxels first .. end - 1 of the columns, one by one. */
static void one_by_one(const snow_gradient_row *row, const uint32_t *columns,
                       size_t first, size_t end, size_t capacity,
                       double *gradients) {
    const snow_volume_info *info = &row->volume->info;
    int64_t at[3] = {row->at[0], row->at[1], row->at[2]};
    for (size_t n = first; n < end; n++) {
        double gradient[3];
        at[row->axis] = columns[n];
        types[info->type].one(row->volume, at, gradient);
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
