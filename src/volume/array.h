/* volume/array.h - voxels that lie at regular steps in a source, in any order
 * of axes; for the readers of formats that hold arrays.
 *
 * An array's bytes follow the source's place.  Voxel (x, y, z) begins at byte
 *
 *     first + x * step[0] + y * step[1] + z * step[2]
 *
 * which says C and Fortran order, interleaved channels, time steps before and
 * behind, and records with other data between them. */
#ifndef SNOW_VOLUME_ARRAY_H
#define SNOW_VOLUME_ARRAY_H

#include "volume/volume.h"

/* How one value is stored.  What is no type of ours becomes the next larger
 * one that holds every value of it exactly. */
typedef enum snow_coding {
    SNOW_CODING_PLAIN, /* as info->type */
    SNOW_CODING_HALF,  /* IEEE 754 binary16; float32 */
    SNOW_CODING_BOOL   /* a byte, true unless 0; uint8 of 0 and 1 */
} snow_coding;

typedef struct snow_array {
    snow_coding coding;
    bool big_endian;
    uint64_t step[3]; /* bytes; see above */
    uint64_t first;
    uint64_t all; /* bytes of all that belongs to the data; the source is read
                     to their end */
    bool more;    /* other things follow in the file: the source is left behind
                     the data, not finished */
} snow_array;

/* Bytes of a stored value. */
size_t snow_coding_size(snow_coding coding, snow_type type);

/* The steps between neighbours along each of `rank` axes that lie one within
 * the other, the first one fastest with `value` bytes, and all bytes.  False
 * when a size is below 1 or a product above 63 bits. */
bool snow_array_steps(const int64_t *sizes, int rank, uint64_t value,
                      uint64_t *steps, uint64_t *all);

/* The end of a reader, as snow_volume_read: lays the window of the options,
 * checks that the source can hold the bytes, makes the volume unless `out` is
 * NULL, in the order of memory that all volumes have, reads it, and finishes
 * the source unless more follows.  Errors: SNOW_BAD_INPUT, SNOW_BAD_USAGE,
 * SNOW_NO_MEMORY. */
snow_status snow_array_read(snow_source *source,
                            const snow_volume_options *options,
                            const snow_array *array, snow_volume_info *info,
                            snow_volume **out);

/* The same for decimal numbers in text, `channels` for each voxel, of which one
 * is wanted.  What follows them stays in the source, which is not finished. */
snow_status snow_array_read_text(snow_source *source,
                                 const snow_volume_options *options,
                                 int64_t channels, int64_t channel,
                                 snow_volume_info *info, snow_volume **out);

/* The value of an IEEE 754 binary16 number; exact. */
float snow_half_to_float(uint16_t half);

/* For readers of voxels with several values: takes the options' channel, which
 * is below `channels`, and tells the listener when there are several.
 * Errors: SNOW_BAD_USAGE when there is no such channel. */
snow_status snow_volume_pick_channel(snow_context *context,
                                     const snow_volume_options *options,
                                     int64_t channels, int64_t *out);

#endif
