/* formats/vtk/grid.c - the geometry of VTK's image data and rectilinear grids.
 */
#include "formats/vtk/vtk.h"

#include <stdio.h>
#include <string.h>

vtk_grid snow_vtk_grid_default(void) {
    return (vtk_grid){.points = {1, 1, 1},
                      .spacing = {1, 1, 1},
                      .direction = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

/* An axis of one point has one cell too, a flat one, whose centre is the
 * point. */
static void place_image(const vtk_grid *grid, const vtk_array *array,
                        snow_volume_info *info) {
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
}

snow_status snow_vtk_describe(snow_context *context, vtk_grid *grid,
                              const vtk_array *array,
                              const snow_volume_options *options,
                              snow_volume_info *info) {
    int64_t voxels;
    uint64_t bytes;
    info->type = array->type;
    snprintf(info->quantity, sizeof info->quantity, "%.63s", array->name);
    for (int i = 0; i < 3; i++) {
        info->dims[i] = grid->points[i];
        if (array->cells && grid->points[i] > 1)
            info->dims[i]--;
    }
    if (!snow_volume_count(info->dims, info->type, &voxels, &bytes))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "a grid of %lldx%lldx%lld points is empty or too "
                         "large for any file; correct its sizes",
                         (long long)grid->points[0], (long long)grid->points[1],
                         (long long)grid->points[2]);
    grid->uneven = (snow_uneven){.count = {0}};
    memcpy(grid->uneven.count, info->dims, sizeof info->dims);
    if (grid->rectilinear)
        return snow_vtk_place_rectilinear(context, grid, array->cells, options,
                                          info);
    place_image(grid, array, info);
    return SNOW_STATUS_OK;
}

/* Returns where a text lies in bytes; NULL: nowhere. */
static const unsigned char *find_text(const unsigned char *bytes, size_t size,
                                      const char *text) {
    size_t length = strlen(text);
    for (size_t i = 0; i + length <= size; i++)
        if (!memcmp(bytes + i, text, length))
            return bytes + i;
    return NULL;
}

/* All XML files of VTK have the element near their front, and the type in
 * it. */
bool snow_vtk_probe_xml(const unsigned char *bytes, size_t size,
                        const char *type) {
    size_t near = size < 1024 ? size : 1024;
    char words[2][64];
    if (!size || (*bytes != '<' && *bytes != 0xef && *bytes > ' '))
        return false;
    const unsigned char *tag = find_text(bytes, near, "<VTKFile");
    if (!tag || !type)
        return tag;
    const unsigned char *end = memchr(tag, '>', (size_t)(bytes + near - tag));
    snprintf(words[0], sizeof words[0], "type=\"%s\"", type);
    snprintf(words[1], sizeof words[1], "type='%s'", type);
    size_t length = (size_t)((end ? end : bytes + near) - tag);
    return find_text(tag, length, words[0]) || find_text(tag, length, words[1]);
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
