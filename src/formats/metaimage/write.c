/* formats/metaimage/write.c - writes MetaImage files with header and voxels in
 * one.
 *
 * The world is converted from RAS+ to MetaImage's LPS.  Numbers have 17 digits,
 * enough to restore every double.  Directions and spacings are written
 * separately, so their products may differ in the last bit. */
#include "formats/write.h"
#include "formats/metaimage/metaimage.h"

#include <stdio.h>
#include <string.h>

/* Writes "key = numbers" and the end of the line. */
static int print_line(char *text, size_t capacity, const char *key,
                      const double *values, int count) {
    int used = snprintf(text, capacity, "%s = ", key);
    used += snow_print_numbers(text + used, capacity - (size_t)used, values,
                               count, " ");
    return used + snprintf(text + used, capacity - (size_t)used, "\n");
}

static int print_geometry(char *text, size_t capacity,
                          const snow_volume_info *info) {
    const double(*m)[4] = info->matrix;
    const double origin[3] = {-m[0][3], -m[1][3], m[2][3]};
    double directions[9]; /* of length 1, one for each index axis */
    for (int k = 0; k < 9; k++)
        directions[k] =
            (k % 3 < 2 ? -1 : 1) * m[k % 3][k / 3] / info->spacing[k / 3];
    int used = print_line(text, capacity, "TransformMatrix", directions, 9);
    used +=
        print_line(text + used, capacity - (size_t)used, "Offset", origin, 3);
    used += print_line(text + used, capacity - (size_t)used, "ElementSpacing",
                       info->spacing, 3);
    /* A missing unit counts as mm. */
    if (strcmp(info->unit, "um") == 0 || strcmp(info->unit, "cm") == 0)
        used += snprintf(text + used, capacity - (size_t)used,
                         "DistanceUnits = %s\n", info->unit);
    /* Without this key the directions would make it a patient. */
    if (!info->medical)
        used += snprintf(text + used, capacity - (size_t)used,
                         "AnatomicalOrientation = ???\n");
    return used;
}

static int print_scaling(char *text, size_t capacity,
                         const snow_volume_info *info) {
    int used = print_line(text, capacity, "ElementToIntensityFunctionSlope",
                          &info->slope, 1);
    return used + print_line(text + used, capacity - (size_t)used,
                             "ElementToIntensityFunctionOffset",
                             &info->intercept, 1);
}

snow_status snow_metaimage_write(const snow_volume *volume, const char *path,
                                 snow_writer *writer) {
    (void)path;
    static const char *const units[] = {"um", "mm", "cm", NULL};
    const snow_volume_info of_units = snow_write_in_units(&volume->info, units),
                           *info = &of_units;
    char text[2048];
    int used = snprintf(text, sizeof text,
                        "ObjectType = Image\n"
                        "NDims = 3\n"
                        "BinaryData = True\n"
                        "BinaryDataByteOrderMSB = False\n"
                        "CompressedData = False\n");
    used += print_geometry(text + used, sizeof text - (size_t)used, info);
    if (info->slope != 1 || info->intercept != 0)
        used += print_scaling(text + used, sizeof text - (size_t)used, info);
    used += snprintf(text + used, sizeof text - (size_t)used,
                     "DimSize = %lld %lld %lld\n"
                     "ElementType = %s\n"
                     "ElementDataFile = LOCAL\n",
                     (long long)info->dims[0], (long long)info->dims[1],
                     (long long)info->dims[2], metaimage_type_name(info->type));
    SNOW_TRY(snow_writer_write(writer, text, (size_t)used));
    return snow_write_voxels(volume, writer);
}
