/* formats/npy_write.c - writes NumPy arrays of shape (z, y, x), C order,
 * version 1. */
#include "formats/write.h"
#include "io/npy_header.h"

#include <stdio.h>
#include <string.h>

/* NumPy's letter of a scalar type; the size in bytes follows it. */
static char letter_of(snow_type type) {
    static const char letters[] = {
        [SNOW_TYPE_INT8] = 'i',    [SNOW_TYPE_UINT8] = 'u',
        [SNOW_TYPE_INT16] = 'i',   [SNOW_TYPE_UINT16] = 'u',
        [SNOW_TYPE_INT32] = 'i',   [SNOW_TYPE_UINT32] = 'u',
        [SNOW_TYPE_INT64] = 'i',   [SNOW_TYPE_UINT64] = 'u',
        [SNOW_TYPE_FLOAT32] = 'f', [SNOW_TYPE_FLOAT64] = 'f',
    };
    return letters[type];
}

/* Padded with blanks, so that the values are aligned for mapping. */
static size_t print_header(const snow_volume_info *info, char *text,
                           size_t capacity) {
    size_t size = snow_type_size(info->type);
    int used = snprintf(
        text + 10, capacity - 10,
        "{'descr': '%c%c%zu', 'fortran_order': False, 'shape': (%lld, %lld, "
        "%lld), }",
        size > 1 ? '<' : '|', letter_of(info->type), size,
        (long long)info->dims[2], (long long)info->dims[1],
        (long long)info->dims[0]);
    size_t all = 10 + (size_t)used + 1;
    all = (all + NPY_ALIGNMENT - 1) / NPY_ALIGNMENT * NPY_ALIGNMENT;
    memset(text + 10 + used, ' ', all - 10 - (size_t)used);
    text[all - 1] = '\n';
    memcpy(text, "\x93NUMPY\x01\x00", 8);
    text[8] = (char)((all - 10) & 0xff);
    text[9] = (char)((all - 10) >> 8);
    return all;
}

/* Returns whether axes are rotated, mirrored, or medical. */
static bool is_oriented(const snow_volume_info *info) {
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            if (row == column ? !(info->matrix[row][column] > 0)
                              : info->matrix[row][column] != 0)
                return true;
    return info->medical;
}

snow_status snow_npy_write(const snow_volume *volume, const char *path,
                           snow_writer *writer) {
    const snow_volume_info *info = &volume->info;
    char text[512];
    if (info->slope != 1 || info->intercept != 0)
        return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                         "%s: NumPy arrays cannot hold slope %g and intercept "
                         "%g; write .nii or .mha",
                         path, info->slope, info->intercept);
    size_t used = print_header(info, text, sizeof text);
    SNOW_TRY(snow_writer_write(writer, text, used));
    SNOW_TRY(snow_write_voxels(volume, writer));
    const double *spacing = info->spacing;
    bool oriented = is_oriented(info);
    if (oriented || spacing[0] != 1 || spacing[1] != 1 || spacing[2] != 1)
        snow_notify(volume->context,
                    "%s: NumPy arrays do not hold the geometry; open it with "
                    "--spacing %gx%gx%g%s",
                    path, spacing[0], spacing[1], spacing[2],
                    oriented ? ", and its orientation is lost: write .nrrd or "
                               ".nii to keep it"
                             : "");
    return SNOW_STATUS_OK;
}
