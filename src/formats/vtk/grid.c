/* formats/vtk/grid.c - the geometry of VTK's image data. */
#include "formats/vtk/vtk.h"

#include <string.h>

vtk_grid snow_vtk_grid_default(void) {
    return (vtk_grid){.points = {1, 1, 1},
                      .spacing = {1, 1, 1},
                      .direction = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

/* An axis of one point has one cell too, a flat one, whose centre is the
 * point. */
snow_status snow_vtk_describe(snow_context *context, const vtk_grid *grid,
                              const vtk_array *array, snow_volume_info *info) {
    int64_t voxels;
    uint64_t bytes;
    info->type = array->type;
    for (int i = 0; i < 3; i++) {
        info->dims[i] = grid->points[i];
        if (array->cells && grid->points[i] > 1)
            info->dims[i]--;
    }
    for (int i = 0; i < 3; i++) {
        info->matrix[i][3] = grid->origin[i];
        for (int j = 0; j < 3; j++) {
            double step = grid->direction[i][j] * grid->spacing[j];
            bool shifted = array->cells && grid->points[j] > 1;
            info->matrix[i][j] = step;
            info->matrix[i][3] +=
                step * ((double)grid->first[j] + (shifted ? 0.5 : 0));
        }
    }
    if (!snow_volume_count(info->dims, info->type, &voxels, &bytes))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "a grid of %lldx%lldx%lld points is empty or too "
                         "large for any file; correct its sizes",
                         (long long)grid->points[0], (long long)grid->points[1],
                         (long long)grid->points[2]);
    return SNOW_STATUS_OK;
}

/* Value of a hexadecimal digit, or -1. */
static int digit(char c) {
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    const char *at = c ? strchr(digits, c) : NULL;
    return at ? (int)(at - digits) % 16 : -1;
}

void snow_vtk_decode_name(char *name) {
    char *to = name;
    for (const char *at = name; *at; at++, to++) {
        int high = *at == '%' ? digit(at[1]) : -1;
        int low = high >= 0 ? digit(at[2]) : -1;
        *to = *at;
        if (low >= 0 && 16 * high + low > 0) {
            *to = (char)(16 * high + low);
            at += 2;
        }
    }
    *to = 0;
}
