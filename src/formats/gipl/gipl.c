/* formats/gipl/gipl.c - GIPL, the volumes of Guy's Image Processing Lab: .gipl
 * and .gipl.gz.
 *
 * As ITK (c3d, ITK-SNAP) and MIRTK read them.  A header of 256 bytes, mostly
 * big-endian, then the voxels:
 *
 *     0  sizes x y z t (2 bytes each)     8  type (2 bytes)
 *    10  spacing x y z t (4 bytes each)  26  text
 *   106  MIRTK: directions of x and y (4 numbers each)
 *   204  origin (8 bytes each)
 *   244  815: MIRTK has written it       252  a number that marks the format
 *
 * The origin is the first voxel in LPS, as ITK has it; where MIRTK wrote
 * directions too, it is the centre of the volume in RAS. */
#include "base/vec3.h"
#include "formats/bytes/number.h"
#include "formats/format.h"

#include <math.h>

#define HEADER_BYTES 256
#define MIRTK 815

static const snow_coded_type types[] = {
    {1, SNOW_TYPE_UINT8},  {7, SNOW_TYPE_INT8},     {8, SNOW_TYPE_UINT8},
    {15, SNOW_TYPE_INT16}, {16, SNOW_TYPE_UINT16},  {31, SNOW_TYPE_UINT32},
    {32, SNOW_TYPE_INT32}, {64, SNOW_TYPE_FLOAT32}, {65, SNOW_TYPE_FLOAT64},
    {0, SNOW_TYPE_NONE},
};

static bool is_marked(const unsigned char *header, bool big) {
    const uint64_t mark = snow_number_at(header + 252, 4, big);
    return mark == 719555000 || mark == 4026526128;
}

static bool probe_gipl(const unsigned char *bytes, size_t size) {
    return size >= HEADER_BYTES &&
           (is_marked(bytes, true) || is_marked(bytes, false));
}

static void place_of_itk(const unsigned char *header, bool big,
                         snow_volume_info *info) {
    for (int i = 0; i < 3; i++) {
        const double turn = i < 2 ? -1 : 1;
        info->matrix[i][i] = turn * info->spacing[i];
        info->matrix[i][3] =
            turn * snow_double_at(header + 204 + 8 * i, big) + 0.0;
    }
}

static void place_of_mirtk(const unsigned char *header, bool big,
                           snow_volume_info *info) {
    double axis[3][3]; /* x, y, z */
    for (int i = 0; i < 3; i++) {
        axis[0][i] = snow_float_at(header + 106 + 4 * i, big);
        axis[1][i] = snow_float_at(header + 122 + 4 * i, big);
    }
    snow_cross(axis[0], axis[1], axis[2]);
    for (int i = 0; i < 3; i++) {
        info->matrix[i][3] = snow_double_at(header + 204 + 8 * i, big);
        for (int j = 0; j < 3; j++) {
            info->matrix[i][j] = info->spacing[j] * axis[j][i];
            info->matrix[i][3] -=
                info->matrix[i][j] * (double)(info->dims[j] - 1) / 2;
        }
    }
    info->medical = true;
}

static snow_status parse(snow_context *context, const unsigned char *header,
                         bool big, snow_volume_info *info) {
    const int code = (int)snow_number_at(header + 8, 2, big);
    bool unknown = false;
    info->type = snow_type_of_code(types, code);
    if (!info->type)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "voxels of GIPL type %d are not supported; convert "
                         "them to a real type of 8 to 64 bits",
                         code);
    for (int i = 0; i < 4; i++) {
        int64_t size = (int64_t)snow_number_at(header + 2 * i, 2, big);
        *(i < 3 ? &info->dims[i] : &info->times) = size ? size : 1;
    }
    for (int i = 0; i < 3; i++) {
        const double step = snow_float_at(header + 10 + 4 * i, big);
        const bool good = step != 0 && isfinite(step);
        info->spacing[i] = good ? step : 1;
        unknown = unknown || (!good && info->dims[i] > 1);
    }
    if (unknown)
        snow_notify(context, "a spacing of the header is invalid and taken as "
                             "1; --spacing sets others");
    memcpy(info->unit, "mm", sizeof "mm");
    if (snow_number_at(header + 244, 4, big) == MIRTK)
        place_of_mirtk(header, big, info);
    else
        place_of_itk(header, big, info);
    return snow_volume_info_check(context, info);
}

static snow_status read_gipl(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    unsigned char header[HEADER_BYTES];
    *info = snow_volume_info_default("gipl");
    SNOW_TRY(snow_source_read_all(source, header, sizeof header, "the header"));
    const bool big = is_marked(header, true);
    if (!probe_gipl(header, sizeof header))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "the first 256 bytes are not a GIPL header; get the "
                         "file again");
    SNOW_TRY(parse(context, header, big, info));
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, info));
    return snow_volume_read(source, options, big, 0, info, out);
}

const snow_format snow_format_gipl = {
    .name = "gipl",
    .text = "GIPL volumes of ITK-SNAP and MIRTK (.gipl)",
    .suffixes = {".gipl", ".gipl.gz"},
    .probe = probe_gipl,
    .crops = true,
    .read = read_gipl,
};
