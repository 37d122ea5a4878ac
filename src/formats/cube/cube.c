/* formats/cube/cube.c - Gaussian's cube files, which most programs of chemistry
 * write.  After "cubegen" in the manual of Gaussian 16:
 *
 *     two lines of comment
 *     atoms, origin x y z [, values of a voxel]      atoms < 0: orbitals
 *     n, step x y z          three lines: along axis 1, the slowest, 2 and 3
 *     number, charge, x y z  of each atom
 *     count, numbers         of orbitals: which they are, in any lines
 *     the values, axis 3 and what a voxel has of them fastest
 *
 * Lengths are in Bohr, those of an axis with n < 0 in angstrom. */
#include "formats/array.h"
#include "formats/ascii.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* CODATA 2018, in angstrom. */
#define BOHR 0.529177210903

#define LINE_BYTES 4096
#define MOST_ATOMS 1e8
#define MOST_VALUES 1e6

/* The numbers of the four lines behind the comments. */
typedef struct cube_header {
    double first[5], axis[3][4];
    int64_t atoms, values;
} cube_header;

static bool is_whole(double value, double most) {
    return floor(value) == value && fabs(value) <= most;
}

/* One of the four lines; false if it is none. */
static bool take_line(const char *line, int number, cube_header *out) {
    double *axis = number ? out->axis[number - 1] : NULL;
    const int count =
        snow_text_reals(line, "", axis ? axis : out->first, axis ? 4 : 5);
    for (int i = 0; i < count; i++)
        if (!isfinite(axis ? axis[i] : out->first[i]))
            return false;
    if (axis)
        return count == 4 && axis[0] != 0 && is_whole(axis[0], INT32_MAX);
    if (count == 4)
        out->first[4] = 1;
    return (count == 4 || count == 5) && is_whole(out->first[0], MOST_ATOMS) &&
           is_whole(out->first[4], MOST_VALUES) && out->first[4] >= 1;
}

static bool probe_cube(const unsigned char *bytes, size_t size) {
    char line[128];
    cube_header header;
    for (int n = 0; n < 6; n++) {
        const unsigned char *end = size ? memchr(bytes, '\n', size) : NULL;
        const size_t length = end ? (size_t)(end - bytes) : size;
        if (!end || memchr(bytes, 0, length))
            return false;
        if (n >= 2) {
            snprintf(line, sizeof line, "%.*s", (int)length,
                     (const char *)bytes);
            if (length >= sizeof line || !take_line(line, n - 2, &header))
                return false;
        }
        size -= length + 1;
        bytes = end + 1;
    }
    return true;
}

static snow_status fail_line(snow_source *source, int number) {
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "its line %d is not that of a Gaussian cube file; the "
                     "file is cut or damaged, write it again",
                     number);
}

static snow_status read_header(snow_source *source, snow_volume_info *info,
                               cube_header *out) {
    char line[LINE_BYTES];
    bool got;
    for (int n = 0; n < 6; n++) {
        SNOW_TRY(snow_source_read_line(source, line, sizeof line, &got));
        if (!got || (n >= 2 && !take_line(line, n - 2, out)))
            return fail_line(source, n + 1);
        if (n < 2 && !*info->description)
            snow_copy_name(line + strspn(line, " \t"), info->description,
                           sizeof info->description);
    }
    out->atoms = (int64_t)fabs(out->first[0]);
    out->values = (int64_t)out->first[4];
    for (int64_t i = 0; i < out->atoms; i++) {
        double atom[5];
        SNOW_TRY(snow_source_read_line(source, line, sizeof line, &got));
        if (!got || snow_text_reals(line, "", atom, 5) != 5)
            return fail_line(source, (int)i + 7);
    }
    return SNOW_STATUS_OK;
}

/* Orbitals have numbers, which are their names.  They may stand in several
 * lines, of which each ends with a number. */
static snow_status read_orbitals(snow_source *source, cube_header *header,
                                 snow_volume_info *info) {
    char line[LINE_BYTES];
    double numbers[LINE_BYTES / 2];
    int64_t count = 0, all = 0;
    for (bool first = true; first || count < all; first = false) {
        bool got;
        SNOW_TRY(snow_source_read_line(source, line, sizeof line, &got));
        const int found =
            got ? snow_text_reals(line, "", numbers, LINE_BYTES / 2) : 0;
        if (found < 1 ||
            (first && (!is_whole(numbers[0], MOST_VALUES) || numbers[0] < 1)))
            return fail_line(source, (int)header->atoms + 7);
        if (first) {
            all = header->values = (int64_t)numbers[0];
            snow_channels_begin(info, all, false);
        }
        for (int i = first; i < found; i++, count++)
            if (count < SNOW_CHANNELS_MAX)
                snprintf(info->channel[count].name,
                         sizeof info->channel[count].name, "orbital %.0f",
                         numbers[i]);
    }
    return count == all ? SNOW_STATUS_OK
                        : fail_line(source, (int)header->atoms + 7);
}

static void place(const cube_header *header, snow_volume_info *info) {
    for (int j = 0; j < 3; j++) {
        const double *axis = header->axis[j];
        for (int i = 0; i < 3; i++)
            info->matrix[i][j] = (axis[0] > 0 ? BOHR : 1) * axis[1 + i];
        info->matrix[j][3] =
            (header->axis[0][0] > 0 ? BOHR : 1) * header->first[1 + j];
    }
    memcpy(info->unit, "angstrom", sizeof "angstrom");
}

static snow_status read_cube(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    cube_header header;
    snow_text_grid grid = {.order = {2, 1, 0}};
    *info = snow_volume_info_default("cube");
    SNOW_TRY(read_header(source, info, &header));
    if (header.first[0] < 0)
        SNOW_TRY(read_orbitals(source, &header, info));
    for (int i = 0; i < 3; i++)
        grid.dims[i] = (int64_t)fabs(header.axis[i][0]);
    grid.values = header.values;
    place(&header, info);
    SNOW_TRY(snow_volume_pick_channel(snow_source_context(source), options,
                                      grid.values, info, &grid.value));
    SNOW_TRY(snow_read_grid(source, &grid, options, info, out));
    return out ? snow_source_finish(source) : SNOW_STATUS_OK;
}

const snow_format snow_format_cube = {
    .name = "cube",
    .text = "Gaussian cube files (.cube, .cub)",
    .suffixes = {".cube", ".cub", ".cube.gz"},
    .probe = probe_cube,
    .crops = true,
    .channels = true,
    .read = read_cube,
};
