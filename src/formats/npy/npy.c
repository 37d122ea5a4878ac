/* formats/npy/npy.c - NumPy arrays: .npy.
 *
 * The last index is x, the one before it y, as for pictures in NumPy; then z,
 * and before these channel and time:
 *
 *     (y, x)   (z, y, x)   (time, z, y, x)   (time, channel, z, y, x)
 *
 * The same array gives the same volume in C and in Fortran order, which is only
 * the order in the file.  Half floats become float32 and booleans uint8,
 * exactly; complex numbers, objects and records are refused. */
#include "formats/array.h"
#include "formats/write.h"
#include "io/npy_header.h"

#include <string.h>

/* NumPy's letters and sizes; the byte order stands before them. */
static const struct {
    const char *name;
    snow_type type;
    snow_coding coding;
} types[] = {
    {"i1", SNOW_TYPE_INT8, SNOW_CODING_PLAIN},
    {"u1", SNOW_TYPE_UINT8, SNOW_CODING_PLAIN},
    {"i2", SNOW_TYPE_INT16, SNOW_CODING_PLAIN},
    {"u2", SNOW_TYPE_UINT16, SNOW_CODING_PLAIN},
    {"i4", SNOW_TYPE_INT32, SNOW_CODING_PLAIN},
    {"u4", SNOW_TYPE_UINT32, SNOW_CODING_PLAIN},
    {"i8", SNOW_TYPE_INT64, SNOW_CODING_PLAIN},
    {"u8", SNOW_TYPE_UINT64, SNOW_CODING_PLAIN},
    {"f2", SNOW_TYPE_FLOAT32, SNOW_CODING_HALF},
    {"f4", SNOW_TYPE_FLOAT32, SNOW_CODING_PLAIN},
    {"f8", SNOW_TYPE_FLOAT64, SNOW_CODING_PLAIN},
    {"b1", SNOW_TYPE_UINT8, SNOW_CODING_BOOL},
};

/* "<f4", ">i2", "|u1"; "=" is the order of an unknown machine. */
static bool parse_type(const char *text, snow_type *type, snow_array *array) {
    if (!*text || !strchr("<>|", *text))
        return false;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strcmp(text + 1, types[i].name)) {
            *type = types[i].type;
            array->coding = types[i].coding;
            array->big_endian = *text == '>';
            return true;
        }
    return false;
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
    if (!parse_type(header.type, &info->type, &array))
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
    static const snow_axis_hint none[NPY_MOST_AXES];
    int64_t channel;
    snow_axes roles;
    snow_axes_assign(header.axes, lay.size, none, &roles);
    SNOW_TRY(snow_volume_pick_axes(context, options, &roles, lay.size, info,
                                   &channel));
    snow_array_place(&roles, lay.step, channel, info, &array);
    return snow_array_read(source, options, &array, info, out);
}

const snow_format snow_format_npy = {
    .name = "npy",
    .text = "NumPy arrays (.npy)",
    .suffixes = {".npy", ".npy.gz", ".npz"},
    .probe = snow_npy_probe,
    .crops = true,
    .channels = true,
    .read = read_npy,
    .write = snow_npy_write,
};
