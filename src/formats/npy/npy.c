/* formats/npy/npy.c - NumPy arrays: .npy.
 *
 * The last index is x, the one before it y, as for pictures in NumPy; then z,
 * and before these channel and time:
 *
 *     (y, x)   (z, y, x)   (time, z, y, x)   (time, channel, z, y, x)
 *
 * Bytes of (y, x, 3) or (y, x, 4) are colours.  Pictures have row 0 at the top.
 *
 * The same array gives the same volume in C and in Fortran order, which is only
 * the order in the file.  Half floats become float32 and booleans uint8,
 * exactly; complex numbers, objects and records are refused. */
#include "formats/array.h"
#include "formats/write.h"
#include "io/npy_header.h"

#include <stdio.h>
#include <string.h>

/* "<f4", ">i2", "|u1"; "=" is the order of an unknown machine. */
static snow_type parse_type(const char *text, snow_array *array) {
    const size_t length = strlen(text);
    array->big_endian = *text == '>';
    return length == 3 && strchr("<>|", *text)
               ? snow_numpy_type(text[1], (size_t)(text[2] - '0'),
                                 &array->coding)
               : SNOW_TYPE_NONE;
}

/* Sizes and strides by meaning: x, y, z, then channel or time; missing axes
 * have the size 1. */
typedef struct layout {
    int64_t size[NPY_MOST_AXES];
    uint64_t step[NPY_MOST_AXES];
    uint64_t all;
} layout;

/* Returns false if the sizes are invalid. */
static bool lay_out(const npy_header *header, size_t value, layout *out) {
    int64_t sizes[NPY_MOST_AXES];
    uint64_t steps[NPY_MOST_AXES];
    int last = header->axes - 1;
    /* In the order of the file, the fastest first. */
    for (int i = 0; i <= last; i++)
        sizes[i] = header->shape[header->fortran_order ? i : last - i];
    if (!snow_array_steps(sizes, header->axes, value, steps, &out->all))
        return false;
    for (int i = 0; i < NPY_MOST_AXES; i++) {
        int at = header->fortran_order ? last - i : i;
        out->size[i] = i <= last ? sizes[at] : 1;
        out->step[i] = i <= last ? steps[at] : out->all;
    }
    return true;
}

/* Returns whether three axes are those of a picture in colours. */
static bool is_coloured(snow_type type, int axes, const int64_t *size) {
    return type == SNOW_TYPE_UINT8 && axes == 3 &&
           (size[0] == 3 || size[0] == 4) && size[1] > 8 && size[2] > 8;
}

/* A file written by numpy.savez is a zip archive of .npy files. */
static snow_status refuse_archive(snow_source *source) {
    char bytes[2];
    size_t got;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &got));
    if (got < 2 || memcmp(bytes, "PK", 2) != 0)
        return SNOW_STATUS_OK;
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "is an archive of arrays; unzip it and open one of its "
                     ".npy files");
}

static snow_status read_npy(snow_source *source,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    npy_header header;
    snow_array array = {0};
    layout lay;
    *info = snow_volume_info_default("npy");
    SNOW_TRY(refuse_archive(source));
    SNOW_TRY(snow_npy_read_header(source, &header));
    info->type = parse_type(header.type, &array);
    if (!info->type)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "values of the NumPy type \"%s\" are not supported; "
                         "save the array with .astype('float32')",
                         header.type);
    if (header.axes < 1 || header.axes > NPY_MOST_AXES)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "an array of %d axes is not a volume; save one of the "
                         "shape (z, y, x), or with time before these",
                         header.axes);
    if (!lay_out(&header, snow_coding_size(array.coding, info->type), &lay))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "its shape is empty or too large for any file; save "
                         "the array again");
    array.all = lay.all;
    /* Finds x, y and z, and the requested component or channel and time step.
     */
    const snow_axis_hint hints[NPY_MOST_AXES] = {
        {.components = is_coloured(info->type, header.axes, lay.size)}};
    int64_t channel;
    snow_axes roles;
    snow_axes_assign(header.axes, lay.size, hints, &roles);
    if (roles.space[1] >= 0 && roles.space[2] < 0)
        snow_image_turn(info->matrix);
    SNOW_TRY(snow_volume_pick_axes(context, options, &roles, lay.size, info,
                                   &channel));
    snow_array_place(&roles, lay.step, channel, info, &array);
    return snow_array_read(source, options, &array, info, out);
}

/* --- writing, of shape (z, y, x), C order, version 1 -----------------------
 */

/* Our names of types begin with NumPy's letters.  Padded with blanks, so that
 * the values are aligned for mapping. */
static size_t print_header(const snow_volume_info *info, char *text,
                           size_t capacity) {
    size_t size = snow_type_size(info->type);
    int used = snprintf(
        text + 10, capacity - 10,
        "{'descr': '%c%c%zu', 'fortran_order': False, 'shape': (%lld, %lld, "
        "%lld), }",
        size > 1 ? '<' : '|', *snow_type_name(info->type), size,
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

static snow_status write_npy(const snow_volume *volume, const char *path,
                             snow_writer *writer) {
    const snow_volume_info *info = &volume->info;
    char text[512];
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

const snow_format snow_format_npy = {
    .name = "npy",
    .text = "NumPy arrays (.npy)",
    .suffixes = {".npy", ".npy.gz", ".npz"},
    .probe = snow_npy_probe,
    .crops = true,
    .channels = true,
    .read = read_npy,
    .write = SNOW_WRITER(write_npy),
};
