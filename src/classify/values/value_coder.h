/* classify/values/value_coder.h - native values of any type as numbers. */
#ifndef SNOW_CLASSIFY_VALUE_CODER_H
#define SNOW_CLASSIFY_VALUE_CODER_H

#include "classify/values/value_range.h"

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
    bool ruled;          /* by the scale's rule */
    int32_t lowest;      /* native value of the table's first number */
    int16_t *numbers;    /* of types of 8 and 16 bits: by native value */
    const double *names; /* of labels, rising: a number is a place among them */
    int name_count;
} snow_value_coder;

/* `coder` begins as zeros or was made before; its names are set by the caller.
 * Errors: SNOW_STATUS_NO_MEMORY.  Free with snow_value_coder_fini. */
snow_status snow_value_coder_make(const snow_volume *volume,
                                  const snow_value_scale14 *scale,
                                  snow_value_coder *coder);
void snow_value_coder_fini(snow_context *context, snow_value_coder *coder);

/* The numbers of `count` native values in a row. */
void snow_value_code_row(const snow_value_coder *coder, const void *stored,
                         size_t count, int16_t *out);

/* The same of voxels that clip planes, which make floats of integers, have left
 * out: where a slab that is seen
 * may read them they have their values still, and are no holes.  `count` voxels
 * along `axis`, the first at `at`. */
void snow_value_code_clipped(const snow_value_coder *coder,
                             const snow_volume *volume, const int64_t at[3],
                             int axis, size_t count, int16_t *out);

#endif
