/* volume/metaimage_write.c - MetaImage files with header and voxels in one.
 *
 * The world is turned from RAS+ to MetaImage's LPS.  Numbers have 17 digits,
 * enough to bring back every double. */
#include "volume/metaimage.h"
#include "volume/write.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* One direction per index axis, of length 1; the lengths are the spacings.
 * Where rounding would change the product, the whole column is kept as the
 * direction, with a spacing of 1. */
static void split_column(const snow_volume_info *info, int column,
                         double direction[3], double *spacing) {
    double length = info->spacing[column];
    bool same = true;
    for (int i = 0; i < 3; i++) {
        double value = (i < 2 ? -1 : 1) * info->matrix[i][column] + 0.0;
        direction[i] = value / length;
        same = same && direction[i] * length == value;
    }
    *spacing = same ? length : 1;
    for (int i = 0; i < 3 && !same; i++)
        direction[i] = (i < 2 ? -1 : 1) * info->matrix[i][column] + 0.0;
}

static int print_geometry(char *text, size_t room,
                          const snow_volume_info *info) {
    double direction[3][3], spacing[3];
    int used = snprintf(text, room, "TransformMatrix =");
    for (int j = 0; j < 3; j++) {
        split_column(info, j, direction[j], &spacing[j]);
        used += snprintf(text + used, room - (size_t)used, " %.17g %.17g %.17g",
                         direction[j][0], direction[j][1], direction[j][2]);
    }
    /* Without the key the directions would make it a patient. */
    return used + snprintf(text + used, room - (size_t)used,
                           "\n%s"
                           "Offset = %.17g %.17g %.17g\n"
                           "ElementSpacing = %.17g %.17g %.17g\n",
                           info->medical ? "" : "AnatomicalOrientation = ???\n",
                           -info->matrix[0][3] + 0.0, -info->matrix[1][3] + 0.0,
                           info->matrix[2][3], spacing[0], spacing[1],
                           spacing[2]);
}

snow_status snow_metaimage_write(const snow_volume *volume, const char *path,
                                 snow_writer *writer) {
    (void)path;
    const snow_volume_info *info = &volume->info;
    char text[2048];
    int used = snprintf(text, sizeof text,
                        "ObjectType = Image\n"
                        "NDims = 3\n"
                        "BinaryData = True\n"
                        "BinaryDataByteOrderMSB = False\n"
                        "CompressedData = False\n");
    used += print_geometry(text + used, sizeof text - (size_t)used, info);
    if (info->slope != 1 || info->intercept != 0)
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "ElementToIntensityFunctionSlope = %.17g\n"
                         "ElementToIntensityFunctionOffset = %.17g\n",
                         info->slope, info->intercept);
    used += snprintf(text + used, sizeof text - (size_t)used,
                     "DimSize = %lld %lld %lld\n"
                     "ElementType = %s\n"
                     "ElementDataFile = LOCAL\n",
                     (long long)info->dims[0], (long long)info->dims[1],
                     (long long)info->dims[2], metaimage_type_name(info->type));
    SNOW_TRY(snow_writer_write(writer, text, (size_t)used));
    return snow_write_voxels(volume, writer);
}
