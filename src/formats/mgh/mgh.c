/* formats/mgh/mgh.c - volumes of FreeSurfer: .mgh, and .mgz, which is the same
 * packed by gzip.
 *
 * After surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat.  All numbers
 * are big-endian:
 *
 *     0  version, 1; its second byte says what the values mean, since 2022
 *     4  width, height, depth, frames
 *    20  type     24  degrees of freedom
 *    28  whether the place that follows is given (2 bytes)
 *    30  spacing x y z
 *    42  direction of x, of y, of z; 78  centre, in millimetres, RAS+
 *   284  voxels, x fastest, frame after frame
 *
 * Behind the voxels stand repetition time, other numbers of the scan, and the
 * commands that made the file, which are not used. */
#include "formats/array.h"
#include "formats/bytes/number.h"
#include "io/filters/filters.h"

#include <math.h>

#define HEADER_BYTES 284

static const snow_coded_type types[] = {
    {0, SNOW_TYPE_UINT8}, {1, SNOW_TYPE_INT32},   {3, SNOW_TYPE_FLOAT32},
    {4, SNOW_TYPE_INT16}, {10, SNOW_TYPE_UINT16}, {0, SNOW_TYPE_NONE}};

static int64_t whole(const unsigned char *header, int at) {
    return snow_integer_at(header + at, 4, true);
}

/* Sizes from 1, a type that has a code, and a flag. */
static bool is_header(const unsigned char *bytes) {
    if (bytes[0] || bytes[1] || bytes[3] != 1)
        return false;
    for (int i = 0; i < 4; i++)
        if (whole(bytes, 4 + 4 * i) < 1)
            return false;
    return snow_number_at(bytes + 20, 4, true) <= 10 &&
           snow_number_at(bytes + 28, 2, true) <= 1;
}

/* Raw data may look so too, but not with zeros behind: those of another name
 * are taken to be raw. */
static bool probe_mgh(const unsigned char *bytes, size_t size) {
    bool zeros = size >= HEADER_BYTES && is_header(bytes);
    for (int i = 90; i < HEADER_BYTES && zeros; i++)
        zeros = !bytes[i];
    return zeros;
}

/* What a file without a place has: FreeSurfer's slices from front to back. */
static const double usual[3][3] = {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}};

/* The centre is voxel size / 2, counted from 0.  Returns false if there is no
 * place, or none that is one. */
static bool take_place(const unsigned char *header, snow_volume_info *info) {
    double inverse[3][3];
    for (int i = 0; i < 3; i++) {
        info->matrix[i][3] = snow_float_at(header + 78 + 4 * i, true);
        for (int j = 0; j < 3; j++) {
            double step = snow_float_at(header + 30 + 4 * j, true);
            info->matrix[i][j] =
                step * snow_float_at(header + 42 + 12 * j + 4 * i, true);
            info->matrix[i][3] -=
                info->matrix[i][j] * (double)info->dims[j] / 2;
        }
    }
    for (int i = 0; i < 12; i++)
        if (!isfinite(info->matrix[i / 4][i % 4]))
            return false;
    return snow_number_at(header + 28, 2, true) == 1 &&
           snow_matrix_invert3((const double(*)[4])info->matrix, inverse);
}

static void place(snow_context *context, const unsigned char *header,
                  snow_volume_info *info) {
    memcpy(info->unit, "mm", sizeof "mm");
    info->medical = true;
    if (take_place(header, info))
        return;
    snow_notify(context,
                "the header has no valid place; slices are taken to be coronal "
                "with voxels of 1x1x1 mm, as FreeSurfer does");
    for (int i = 0; i < 3; i++) {
        info->matrix[i][3] = 0;
        for (int j = 0; j < 3; j++) {
            info->matrix[i][j] = usual[i][j];
            info->matrix[i][3] -= usual[i][j] * (double)info->dims[j] / 2;
        }
    }
}

static snow_status parse(snow_context *context, const unsigned char *header,
                         snow_volume_info *info) {
    if (!is_header(header))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "the first 284 bytes are not a header of FreeSurfer's "
                         "MGH; get the file again");
    info->type = snow_type_of_code(types, (int)whole(header, 20));
    if (!info->type)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "voxels of MGH type %d are not supported; types 0, 1, "
                         "3, 4 and 10 are, so convert it by mri_convert -odt "
                         "float",
                         (int)whole(header, 20));
    for (int i = 0; i < 3; i++)
        info->dims[i] = whole(header, 4 + 4 * i);
    info->times = whole(header, 16);
    return SNOW_STATUS_OK;
}

static snow_status read_mgh(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    unsigned char header[HEADER_BYTES];
    snow_array array = {.big_endian = true, .more = true};
    *info = snow_volume_info_default("mgh");
    SNOW_TRY(snow_source_read_all(source, header, sizeof header, "the header"));
    SNOW_TRY(parse(context, header, info));
    place(context, header, info);
    SNOW_TRY(snow_volume_pick_time(context, "frame", options, info));
    snow_array_of_volumes(info, 0, &array);
    snow_volume *volume = NULL;
    SNOW_TRY(
        snow_array_read(source, options, &array, info, out ? &volume : NULL));
    return snow_volume_give(out ? snow_source_verify(source) : SNOW_STATUS_OK,
                            volume, out);
}

const snow_format snow_format_mgh = {
    .name = "mgh",
    .text = "FreeSurfer volumes (.mgh, .mgz)",
    .suffixes = {".mgh", ".mgz", ".mgh.gz"},
    .probe = probe_mgh,
    .crops = true,
    .read = read_mgh,
};
