/* formats/array.h - arrays of voxels with regular strides in a source, in any
 * order of axes; for the readers of formats that hold arrays.
 *
 * An array's bytes begin at the source's position.  Voxel (x, y, z) begins at
 * byte
 *
 *     first + x * step[0] + y * step[1] + z * step[2]
 *
 * which covers C and Fortran order, interleaved channels, time steps before and
 * after, and records with other data between them. */
#ifndef SNOW_FORMATS_ARRAY_H
#define SNOW_FORMATS_ARRAY_H

#include "formats/axes.h"
#include "formats/format.h"

/* How one value is stored.  A type that the library lacks becomes the next
 * larger one that holds all of its values exactly. */
typedef enum snow_coding {
    SNOW_CODING_PLAIN, /* as info->type */
    SNOW_CODING_HALF,  /* IEEE 754 binary16; float32 */
    SNOW_CODING_BOOL   /* one byte, true unless 0; uint8 of 0 and 1 */
} snow_coding;

typedef struct snow_array {
    snow_coding coding;
    bool big_endian;
    uint64_t step[3]; /* strides in bytes; see above */
    uint64_t first;
    uint64_t
        all;   /* size of the data in bytes; the source is read to their end */
    bool more; /* the file continues after the data: the source is left at their
                  end, not finished */
} snow_array;

/* The type and coding of values of NumPy, whose kind may also be "b". */
snow_type snow_numpy_type(char kind, size_t bytes, snow_coding *coding);

/* Bytes of a stored value. */
size_t snow_coding_size(snow_coding coding, snow_type type);

/* Computes the strides along each of `rank` nested axes, the first one fastest
 * with values of `value` bytes, and the size of all.  Returns false if a size
 * is below 1 or a product exceeds 63 bits. */
bool snow_array_steps(const int64_t *sizes, int rank, uint64_t value,
                      uint64_t *steps, uint64_t *all);

/* The same of a grid of voxels of so many values each, of which one is taken,
 * from a byte of the source on: sets first, step and all. */
bool snow_array_of_grid(snow_type type, const int64_t dims[3], int64_t channels,
                        int64_t channel, uint64_t begin, snow_array *out);

/* Copies stored values from strides to strides, as they are in memory. */
void snow_coding_put(snow_coding coding, bool big_endian, size_t size,
                     const unsigned char *from, uint64_t step,
                     unsigned char *to, uint64_t to_step, uint64_t count);

/* Places the time step of info among volumes that follow one another behind
 * `skip` bytes.  What is too large is refused where it is read. */
void snow_array_of_volumes(const snow_volume_info *info, uint64_t skip,
                           snow_array *array);

/* Values of `size` bytes in a row, of which all are read. */
static inline snow_region snow_array_flat(uint64_t bytes, size_t size) {
    const int64_t count = (int64_t)(bytes / size);
    return (snow_region){.all = bytes,
                         .value = size,
                         .dims = {count, 1, 1},
                         .count = {count, 1, 1}};
}

/* Completes a reader: applies the options' box, checks that the source can hold
 * the bytes, and makes the volume unless `out` is NULL, swapping bytes where
 * the order is not the machine's.  Reads the voxels in the memory order of all
 * volumes, and finishes the source unless more follows.  Errors:
 * SNOW_STATUS_BAD_INPUT, SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY. */
snow_status snow_array_read(snow_source *source,
                            const snow_volume_options *options,
                            const snow_array *array, snow_volume_info *info,
                            snow_volume **out);

/* The same of an array in memory, in the machine's byte order. */
snow_status snow_array_take(snow_context *context,
                            const snow_volume_options *options,
                            const snow_array *array, const void *bytes,
                            snow_volume_info *info, snow_volume **out);

/* The same for decimal numbers in text, with `channels` per voxel, one of which
 * is used.  What follows them stays in the source, which is not finished. */
snow_status snow_array_read_text(snow_source *source,
                                 const snow_volume_options *options,
                                 int64_t channels, int64_t channel,
                                 snow_volume_info *info, snow_volume **out);

/* Converts an IEEE 754 binary16 number; exact. */
float snow_half_to_float(uint16_t half);

/* What a reader knows of channels before it picks one: that there are so many,
 * each of no name and colour, of which all are shown, or the first; that the
 * first are red, green and blue, as in a photograph, the next opacity. */
void snow_channels_begin(snow_volume_info *info, int64_t count, bool shown);

/* All are of emitted light, if there are few, but those with a bit of
 * `through`, which are of light that passes through: these are shown only
 * alone. */
void snow_channels_are_light(snow_volume_info *info, uint64_t through);

/* Copies as many whole letters of a name as fit; '?' for a byte that begins
 * none in UTF-8. */
void snow_copy_name(const char *text, char *out, size_t size);
void snow_channels_are_colors(snow_volume_info *info);

/* For readers of voxels with several values: selects the options' channel or
 * component, which must be below `channels`, and reports the choice if there
 * are several.  Begins the channels of info unless the reader has.  Errors:
 * SNOW_STATUS_BAD_USAGE if it does not exist, or is the magnitude. */
snow_status snow_volume_pick_channel(snow_context *context,
                                     const snow_volume_options *options,
                                     int64_t channels, snow_volume_info *info,
                                     int64_t *out);

/* The same for values that lie next to each other and may be a vector, of space
 * if info->directions says so, which is kept of three floats.  Sets
 * info->components, and info->magnitude if the options ask for the magnitude of
 * all, or for nothing, and they are 2 or 3 floats; then *out is the first one,
 * and the others are asked for one by one (components.h).  info->type
 * is set already. */
snow_status snow_volume_pick_component(snow_context *context,
                                       const snow_volume_options *options,
                                       int64_t count, snow_volume_info *info,
                                       int64_t *out);

/* One or the other: `count` values of a voxel are colours or a vector. */
snow_status snow_volume_pick_value(snow_context *context,
                                   const snow_volume_options *options,
                                   int64_t count, bool colors,
                                   snow_volume_info *info, int64_t *out);

/* For readers of arrays: takes sizes and number of steps from the axes, then
 * selects channel or component, and time step.  info->type is set already. */
snow_status snow_volume_pick_axes(snow_context *context,
                                  const snow_volume_options *options,
                                  const snow_axes *roles, const int64_t *sizes,
                                  snow_volume_info *info, int64_t *channel);

/* The voxels of an array of nested axes with these strides, at the channel and
 * info->time. */
void snow_array_place(const snow_axes *roles, const uint64_t *steps,
                      int64_t channel, const snow_volume_info *info,
                      snow_array *array);

#endif
