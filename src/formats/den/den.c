/* formats/den/den.c - DEN, the volumes of VolPack's examples and of UNC Chapel
 * Hill.
 *
 * 31 numbers of 16 bits in either byte order, then bytes, x fastest:
 *
 *   0        version, 1
 *   1 .. 9   first, last and count of voxels along x, y, z: as measured
 *  10 .. 18  of the extract, 19 .. 27 of the data in the file
 *  28 .. 30  warps, and the number of bytes that follow
 *
 * The format knows no spacing. */
#include "formats/bytes/number.h"
#include "formats/format.h"

#define NUMBERS 31
#define HEADER_BYTES (2 * NUMBERS)
#define HELD 25 /* the counts of the data in the file */
#define LENGTH 29

static int number(const unsigned char *bytes, int index) {
    /* The version is 1. */
    return (int)snow_number_at(bytes + 2 * index, 2, bytes[0] == 0);
}

/* No other data are consistent in this way by chance. */
static bool probe_den(const unsigned char *bytes, size_t size) {
    if (size < HEADER_BYTES || number(bytes, 0) != 1)
        return false;
    for (int group = 1; group < HELD; group += 9)
        for (int i = group; i < group + 3; i++)
            if (number(bytes, i + 6) < 1 ||
                number(bytes, i + 3) - number(bytes, i) + 1 !=
                    number(bytes, i + 6))
                return false;
    return true;
}

static snow_status read_den(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    unsigned char bytes[HEADER_BYTES];
    size_t size;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &size));
    if (!probe_den(bytes, size))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "the first 62 bytes are not a DEN header; get the "
                         "file again, or give --dims and --type");
    *info = snow_volume_info_default("den");
    info->type = SNOW_TYPE_UINT8;
    for (int i = 0; i < 3; i++)
        info->dims[i] = number(bytes, HELD + i);
    /* The number of bytes, whose 16-bit halves have an order of their own. */
    int64_t a = number(bytes, LENGTH), b = number(bytes, LENGTH + 1);
    int64_t voxels = info->dims[0] * info->dims[1] * info->dims[2];
    if (!(a + (b << 16) == voxels || b + (a << 16) == voxels))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "its header gives %lldx%lldx%lld voxels but another "
                         "number of bytes; get the file again",
                         (long long)info->dims[0], (long long)info->dims[1],
                         (long long)info->dims[2]);
    SNOW_TRY(snow_volume_pick_time(context, "time step", options, info));
    return snow_volume_read(source, options, false, HEADER_BYTES, info, out);
}

const snow_format snow_format_den = {
    .name = "den",
    .text = "DEN, volumes of VolPack's examples (.den)",
    .suffixes = {".den", ".den.gz"},
    .probe = probe_den,
    .crops = true,
    .read = read_den,
};
