/* formats/mrc/mrc.c - density maps of electron microscopy and crystallography:
 * MRC and CCP4, .mrc .map .rec .ccp4.
 *
 * After the MRC2014 format (Cheng et al., J. Struct. Biol. 192, 2015, 146-150;
 * ccpem.ac.uk/mrc_format/mrc2014.php) and IMOD's notes on bytes.  A header of
 * 1024 bytes in words of four, counted from 1 here as there, then NSYMBT bytes
 * of extended header, then the voxels:
 *
 *     1-3 NC NR NS     columns (fastest), rows, sections
 *     4   MODE         type of the voxels
 *     5-7 start        grid point of the first column, row and section
 *     8-10 MX MY MZ    intervals of the unit cell along its axes X Y Z
 *     11-16            lengths of the cell (angstrom), angles (degrees)
 *     17-19 MAPC R S   which of X Y Z (1 2 3) columns, rows, sections are
 *     23  ISPG         space group; 401 and more: several volumes
 *     24  NSYMBT       bytes of the extended header
 *     50-52 ORIGIN     of the volume, angstrom
 *     53  "MAP ", 54 machine stamp
 *
 * The voxels stay in the order of the file; the matrix gives the directions of
 * columns, rows and sections, which supports any order of axes and slanted
 * cells. */
#include "formats/array.h"
#include "formats/bytes/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HEADER_BYTES 1024
#define VOLUME_STACK 401 /* the space group of several volumes in a file */

/* IMOD marks its files and has a flag for signed bytes; without the mark they
 * are signed, by the format's description. */
#define IMOD_STAMP 1146047817

#define DEGREE (3.14159265358979323846 / 180)

typedef struct mrc_header {
    const unsigned char *bytes;
    bool big_endian;
} mrc_header;

/* Words by their numbers in the format's description, from 1. */
static int32_t whole(const mrc_header *header, int number) {
    return (int32_t)snow_integer_at(header->bytes + 4 * (number - 1), 4,
                                    header->big_endian);
}

static double real(const mrc_header *header, int number) {
    return snow_float_at(header->bytes + 4 * (number - 1), header->big_endian);
}

/* True if the words that have few valid values have one of them: the sizes and
 * the mode, and the axes, which some programs leave unset. */
static bool has_mode(const mrc_header *header) {
    int32_t mode = whole(header, 4);
    return whole(header, 1) > 0 && whole(header, 2) > 0 &&
           whole(header, 3) > 0 && mode >= 0 && mode <= 101;
}

static bool is_plausible(const mrc_header *header) {
    bool axes = has_mode(header);
    for (int i = 0; i < 3; i++) {
        int32_t axis = whole(header, 17 + i);
        axes = axes && axis >= -3 && axis <= 3;
    }
    return axes;
}

/* The stamp gives the byte order, if programs wrote it; otherwise it is the
 * order in which the header is plausible. */
static mrc_header header_of(const unsigned char *bytes) {
    mrc_header header = {bytes, bytes[212] == 0x11};
    const mrc_header other = {bytes, !header.big_endian};
    const bool better = is_plausible(&other)
                            ? !is_plausible(&header)
                            : !has_mode(&header) && has_mode(&other);
    return better ? other : header;
}

/* Recognised by "MAP ", which files from before 2000 lack: those are known by
 * their names alone. */
static bool probe_mrc(const unsigned char *bytes, size_t size) {
    if (size < HEADER_BYTES || memcmp(bytes + 208, "MAP", 3) != 0)
        return false;
    const mrc_header header = header_of(bytes);
    return has_mode(&header);
}

static void parse_mode(const mrc_header *header, snow_volume_info *info,
                       snow_coding *coding) {
    static const snow_coded_type modes[] = {
        {0, SNOW_TYPE_INT8},   {1, SNOW_TYPE_INT16},    {2, SNOW_TYPE_FLOAT32},
        {6, SNOW_TYPE_UINT16}, {12, SNOW_TYPE_FLOAT32}, {0, SNOW_TYPE_NONE}};
    const int32_t mode = whole(header, 4);
    info->type = snow_type_of_code(modes, mode);
    if (!mode && whole(header, 39) == IMOD_STAMP && !(whole(header, 40) & 1))
        info->type = SNOW_TYPE_UINT8;
    *coding = mode == 12 ? SNOW_CODING_HALF : SNOW_CODING_PLAIN;
}

/* Where the number of intervals along an axis is missing, the cell is that of
 * the voxels. */
static int32_t intervals(const mrc_header *header, const int order[3],
                         int axis) {
    int32_t given = whole(header, 8 + axis);
    for (int j = 0; j < 3 && given <= 0; j++)
        if (order[j] == axis)
            return whole(header, 1 + j);
    return given;
}

/* The cell's axes as columns, in angstrom: X along x, Y in the plane of x and
 * y, as in the Protein Data Bank.  Returns false if it is not a cell. */
static bool cell_axes(const mrc_header *header, const int order[3],
                      double axes[3][3]) {
    double length[3], cosine[3];
    bool right = true;
    for (int i = 0; i < 3; i++) {
        length[i] = real(header, 11 + i);
        double angle = real(header, 14 + i);
        /* Microscopes know no distance of images. */
        if (i == 2 && length[i] == 0)
            length[i] = length[0] / intervals(header, order, 0) *
                        intervals(header, order, i);
        right = right && length[i] > 0 && isfinite(length[i]);
        /* Microscopes often write angles of 0 and mean 90, whose cosine is 0
         * exactly. */
        if (angle == 0 || angle == 90)
            cosine[i] = 0;
        else
            cosine[i] = cos(angle * DEGREE);
        right = right && cosine[i] > -1 && cosine[i] < 1;
    }
    if (!right)
        return false;
    double sine = sqrt(1 - cosine[2] * cosine[2]);
    double up = (cosine[0] - cosine[1] * cosine[2]) / sine;
    double rest = 1 - cosine[1] * cosine[1] - up * up;
    if (!(rest > 0))
        return false;
    const double unit[3][3] = {
        {1, cosine[2], cosine[1]}, {0, sine, up}, {0, 0, sqrt(rest)}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            axes[i][j] = unit[i][j] * length[j] / intervals(header, order, j);
    return true;
}

/* The cell axis of columns, rows and sections, from 0; three zeros mean the
 * usual order.  Others that are no order are left unset by programs, and taken
 * as the usual one, as ChimeraX has it. */
static void parse_order(snow_context *context, const mrc_header *header,
                        int order[3]) {
    int seen = 0, given = 0;
    for (int i = 0; i < 3; i++) {
        int32_t axis = whole(header, 17 + i);
        given |= axis;
        order[i] = axis >= -3 && axis <= 3 ? abs(axis) - 1 : -1;
        if (order[i] >= 0)
            seen |= 1 << order[i];
    }
    for (int i = 0; i < 3 && seen != 7; i++)
        order[i] = i;
    if (given && seen != 7)
        snow_notify(context,
                    "its axes MAPC, MAPR, MAPS are %d, %d and %d; they are "
                    "taken as 1, 2 and 3",
                    (int)whole(header, 17), (int)whole(header, 18),
                    (int)whole(header, 19));
}

/* ORIGIN is used if given, otherwise the grid point of the first voxel. */
static void place_origin(const mrc_header *header, snow_volume_info *info) {
    double origin[3];
    bool given = false, finite = true;
    for (int i = 0; i < 3; i++) {
        origin[i] = real(header, 50 + i);
        finite = finite && isfinite(origin[i]);
        given = given || origin[i] != 0;
    }
    /* Before "MAP " was introduced these words had another meaning. */
    given = given && finite && memcmp(header->bytes + 208, "MAP", 3) == 0;
    for (int i = 0; i < 3; i++) {
        double start = 0;
        for (int j = 0; j < 3; j++)
            start += info->matrix[i][j] * whole(header, 5 + j);
        info->matrix[i][3] = given ? origin[i] : start;
    }
}

/* An axis below 0 runs from the cell's end, as IMOD has it for rows from the
 * top (MAPR -2): the volume stays where it is. */
static void turn_axes(const mrc_header *header, const int order[3],
                      snow_volume_info *info) {
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3 && whole(header, 17 + j) == -order[j] - 1; i++) {
            double *row = info->matrix[i];
            row[3] += row[j] * (double)(info->dims[j] - 1);
            row[j] = 0 - row[j];
        }
}

/* An invalid cell is common in such files; the voxels are usable even so. */
static void set_matrix(snow_context *context, const mrc_header *header,
                       const snow_volume_options *options, const int order[3],
                       snow_volume_info *info) {
    double axes[3][3];
    if (cell_axes(header, order, axes)) {
        memcpy(info->unit, "angstrom", sizeof "angstrom");
        if (whole(header, 8) <= 0 || whole(header, 9) <= 0 ||
            whole(header, 10) <= 0)
            snow_notify(context,
                        "its number of intervals MX, MY or MZ is missing; the "
                        "unit cell is taken to be as large as the volume");
        if (real(header, 13) == 0 && !snow_spacing_given(options))
            snow_notify(context, SNOW_WIDTH_IS_DISTANCE, axes[0][0]);
    } else {
        if (!snow_spacing_given(options))
            snow_notify(context,
                        "the unit cell of the header is invalid; voxels "
                        "of 1x1x1 are used, --spacing sets others");
        for (int i = 0; i < 9; i++)
            axes[i / 3][i % 3] = i % 4 == 0;
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            info->matrix[i][j] = axes[i][order[j]];
    place_origin(header, info);
    turn_axes(header, order, info);
}

static snow_status parse_header(snow_context *context, const mrc_header *header,
                                const snow_volume_options *options,
                                snow_volume_info *info, snow_array *array,
                                uint64_t *extended) {
    int order[3];
    if (!has_mode(header))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "is not an MRC file: its sizes or mode are invalid; "
                         "check the name, or get it again");
    const unsigned char *stamp = header->bytes + 212;
    if ((stamp[0] == 0x11 && stamp[1] == 0x11 && !header->big_endian) ||
        (stamp[0] == 0x44 && stamp[1] == 0x44 && header->big_endian))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "its machine stamp says %s-endian, but its sizes are "
                         "%s-endian; correct bytes 213 and 214 (44 44: little, "
                         "11 11: big)",
                         header->big_endian ? "little" : "big",
                         header->big_endian ? "big" : "little");
    parse_mode(header, info, &array->coding);
    if (!info->type)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "voxels of MRC mode %d are not supported; modes 0, 1, "
                         "2, 6 and 12 are, so convert it to one of them",
                         (int)whole(header, 4));
    parse_order(context, header, order);
    if (whole(header, 24) < 0)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "its extended header has %d bytes; correct NSYMBT",
                         (int)whole(header, 24));
    *extended = (uint64_t)whole(header, 24);
    array->big_endian = header->big_endian;
    for (int i = 0; i < 3; i++)
        info->dims[i] = whole(header, 1 + i);
    /* A stack of volumes has MZ sections for each. */
    int32_t sections = whole(header, 10);
    if (whole(header, 23) >= VOLUME_STACK && sections > 0 &&
        info->dims[2] % sections == 0) {
        info->times = info->dims[2] / sections;
        info->dims[2] = sections;
    }
    set_matrix(context, header, options, order, info);
    return SNOW_STATUS_OK;
}

static snow_status read_mrc(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    unsigned char bytes[HEADER_BYTES];
    uint64_t extended = 0;
    snow_array array = {0};
    *info = snow_volume_info_default("mrc");
    SNOW_TRY(snow_source_read_all(source, bytes, sizeof bytes, "the header"));
    const mrc_header header = header_of(bytes);
    SNOW_TRY(parse_header(context, &header, options, info, &array, &extended));
    SNOW_TRY(snow_volume_pick_time(context, "volume", options, info));
    snow_array_of_volumes(info, 0, &array);
    /* Copies of a header may speak of an extended one that was not copied. */
    if (extended && snow_source_remaining(source) == (int64_t)array.all) {
        snow_notify(context,
                    "its extended header is missing: the voxels begin at byte "
                    "%d",
                    HEADER_BYTES);
        extended = 0;
    }
    SNOW_TRY(snow_source_skip(source, extended, "the extended header"));
    return snow_array_read(source, options, &array, info, out);
}

const snow_format snow_format_mrc = {
    .name = "mrc",
    .text = "MRC and CCP4 density maps (.mrc, .map, .rec, .ccp4)",
    .suffixes = {".mrc", ".map", ".rec", ".ccp4", ".mrc.gz", ".map.gz"},
    .probe = probe_mrc,
    .crops = true,
    .read = read_mrc,
};
