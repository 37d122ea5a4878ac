/* formats/nrrd/write.c - writes NRRD files with header and raw voxels in one.
 *
 * Source: "Definition of NRRD File Format", teem.sourceforge.net/nrrd. Numbers
 * have 17 digits, enough to restore every double. */
#include "formats/write.h"

#include <stdio.h>
#include <string.h>

/* NRRD's names of the scalar types, which all its readers know. */
static const char *type_name(snow_type type) {
    switch (type) {
    case SNOW_TYPE_FLOAT32:
        return "float";
    case SNOW_TYPE_FLOAT64:
        return "double";
    default:
        return snow_type_name(type); /* int8, uint8, ... */
    }
}

/* Space directions and origin; the caller's buffer is large enough. */
static int print_geometry(char *text, size_t capacity,
                          const snow_volume_info *info) {
    const char *unit = info->unit;
    int used =
        snprintf(text, capacity, "space%s\nspace directions:",
                 info->medical ? ": right-anterior-superior" : " dimension: 3");
    for (int j = 0; j < 4; j++) {
        const double vector[3] = {info->matrix[0][j], info->matrix[1][j],
                                  info->matrix[2][j]};
        used += snow_text_print(text + used, capacity - (size_t)used, "%s",
                                j < 3 ? " (" : "\nspace origin: (");
        used += snow_print_numbers(text + used, capacity - (size_t)used, vector,
                                   3, ",");
        used += snprintf(text + used, capacity - (size_t)used, ")");
    }
    used += snprintf(text + used, capacity - (size_t)used, "\n");
    if (*unit && !strpbrk(unit, "\"\\\r\n"))
        used +=
            snprintf(text + used, capacity - (size_t)used,
                     "space units: \"%s\" \"%s\" \"%s\"\n", unit, unit, unit);
    return used;
}

/* The keys of 3D Slicer's segmentations, and one for opacity. */
static snow_status write_labels(const snow_volume *volume,
                                snow_writer *writer) {
    for (size_t n = 0; n < volume->label_count; n++) {
        const snow_label *label = &volume->labels[n];
        char text[512];
        int used = snow_text_print(text, sizeof text,
                                   "Segment%zu_LabelValue:=%.17g\n"
                                   "Segment%zu_Name:=%s\n",
                                   n, label->value, n, label->name);
        if (label->color[0] >= 0) {
            used += snprintf(text + used, sizeof text - (size_t)used,
                             "Segment%zu_Color:=", n);
            used += snow_print_numbers(text + used, sizeof text - (size_t)used,
                                       label->color, 3, " ");
            used += snprintf(text + used, sizeof text - (size_t)used, "\n");
        }
        if (label->color[3] >= 0)
            used += snow_text_print(text + used, sizeof text - (size_t)used,
                                    "Segment%zu_Opacity:=%.17g\n", n,
                                    label->color[3]);
        SNOW_TRY(snow_writer_write(writer, text, (size_t)used));
    }
    return SNOW_STATUS_OK;
}

snow_status snow_nrrd_write(const snow_volume *volume, const char *path,
                            snow_writer *writer) {
    const snow_volume_info *info = &volume->info;
    char text[2048];
    if (info->slope != 1 || info->intercept != 0)
        return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                         "%s: NRRD cannot hold slope %g and intercept %g; "
                         "write .nii or .mha",
                         path, info->slope, info->intercept);
    int used = snprintf(text, sizeof text,
                        "NRRD0004\n"
                        "type: %s\n"
                        "dimension: 3\n"
                        "sizes: %lld %lld %lld\n",
                        type_name(info->type), (long long)info->dims[0],
                        (long long)info->dims[1], (long long)info->dims[2]);
    used += print_geometry(text + used, sizeof text - (size_t)used, info);
    used += snprintf(text + used, sizeof text - (size_t)used,
                     "kinds: domain domain domain\n"
                     "encoding: raw\n"
                     "%s%s%s%s",
                     snow_type_size(info->type) > 1 ? "endian: little\n" : "",
                     *info->value_unit ? "sample units: " : "",
                     info->value_unit, *info->value_unit ? "\n" : "");
    SNOW_TRY(snow_writer_write(writer, text, (size_t)used));
    SNOW_TRY(write_labels(volume, writer));
    SNOW_TRY(snow_writer_write(writer, "\n", 1));
    return snow_write_voxels(volume, writer);
}
