/* classify/values/value_range.h - data values as numbers of 14 bits, which the
 * value path interpolates before it colours them. */
#ifndef SNOW_CLASSIFY_VALUE_RANGE_H
#define SNOW_CLASSIFY_VALUE_RANGE_H

#include "transfer/transfer.h"
#include "volume/volume.h"

/* The largest number, and what stands for a hole: a voxel without a value. */
#define SNOW_VALUE_MOST 16383
#define SNOW_VALUE_HOLE INT16_MIN

/* The finite data values of a volume, or their decimal logarithms. */
typedef struct snow_data_range {
    double low, high; /* low > high: there is none */
    bool log;
    bool holes; /* some voxels are NaN, or have no logarithm */
} snow_data_range;

/* Reads all voxels, and those next to clip planes.  `threads` as in
 * base/thread_pool.h.  Errors: SNOW_STATUS_STOPPED. */
snow_status snow_data_range_measure(const snow_volume *volume, bool log,
                                    int threads, snow_data_range *out);

/* Number V stands for the data value low + V (high - low) / SNOW_VALUE_MOST, or
 * for its decimal logarithm; values beyond the ends are clamped. */
typedef struct snow_value_scale14 {
    double low, high;
    bool log;
} snow_value_scale14;

static inline bool snow_value_same_scale(const snow_value_scale14 *a,
                                         const snow_value_scale14 *b) {
    return a->low == b->low && a->high == b->high && a->log == b->log;
}

/* The scale of a look: all of the data, or, where the look shows less than 1/64
 * of that, what it shows, widened by four times its length on each side. */
snow_value_scale14 snow_value_scale_of(const snow_data_range *data,
                                       const snow_transfer *transfer);

/* The number of a data value, and the data value of any number V. */
int16_t snow_value_number(const snow_value_scale14 *scale, double value);
double snow_value_of(const snow_value_scale14 *scale, double v);

/* The number beyond a side of the volume: the odd reflection of the one
 * inside, if both are there, else that at the side; of labels the latter. */
static inline int16_t snow_value_beyond(int16_t side, int16_t inside,
                                        bool labels) {
    bool odd = !labels && side != SNOW_VALUE_HOLE && inside != SNOW_VALUE_HOLE;
    return (int16_t)(odd ? 2 * side - inside : side);
}

/* A converter of native values of one type. */
typedef struct snow_value_coder {
    snow_value_scale14 scale;
    snow_type type;
    double slope, intercept;
    int32_t lowest;   /* native value of the table's first number */
    int16_t *numbers; /* of types of 8 and 16 bits: by native value */
    /* Of 8 bits, where the table is a straight line between two places. */
    bool straight;
    uint8_t first, last;  /* places in the table */
    uint16_t whole, part; /* its slope, the latter of 2^16 */
    const double *names; /* of labels, rising: a number is a place among them */
    int name_count;
    size_t capacity; /* bytes */
} snow_value_coder;

/* `coder` begins as zeros or was made before; its names are set by the caller.
 * Errors: SNOW_STATUS_NO_MEMORY.  Free with snow_value_coder_fini. */
snow_status snow_value_coder_make(const snow_volume *volume,
                                  const snow_value_scale14 *scale,
                                  snow_value_coder *coder);
void snow_value_coder_fini(snow_context *context, snow_value_coder *coder);

/* The numbers of `count` native values in a row. */
void snow_value_code_row(const snow_value_coder *coder, const void *natives,
                         size_t count, int16_t *out);

/* The same of voxels that clip planes have left out: where a slab that is seen
 * may read them they have their values still, and are no holes.  `count` voxels
 * along `axis`, the first at `at`. */
void snow_value_code_clipped(const snow_value_coder *coder,
                             const snow_volume *volume, const int64_t at[3],
                             int axis, size_t count, int16_t *out);

#endif
