/* classify/shear_warp/quantizer.h - native values of any type as quantized
 * values. */
#ifndef SNOW_CLASSIFY_SHEAR_WARP_QUANTIZER_H
#define SNOW_CLASSIFY_SHEAR_WARP_QUANTIZER_H

#include "classify/shear_warp/range.h"

/* The number beyond a side of the volume: the odd reflection of the one
 * inside, if both are there, else that at the side; of labels the latter. */
static inline int16_t snow_value_beyond(int16_t side, int16_t inside,
                                        bool labels) {
    bool odd = !labels && side != SNOW_VALUE_HOLE && inside != SNOW_VALUE_HOLE;
    return (int16_t)(odd ? 2 * side - inside : side);
}

/* A converter of native values of one type. */
typedef struct snow_quantizer {
    snow_value_scale14 scale;
    snow_type type;
    double slope, intercept;
    bool is_fixed;       /* by the fixed-point quantizer */
    int32_t lowest;      /* native value of the table's first number */
    int16_t *quantized;  /* of types of 8 and 16 bits: by native value */
    const double *names; /* of labels, rising: a number is a place among them */
    int name_count;
} snow_quantizer;

/* `coder` begins as zeros or was made before; its names are set by the caller.
 * Errors: SNOW_STATUS_NO_MEMORY.  Free with snow_quantizer_fini. */
snow_status snow_quantizer_make(const snow_volume *volume,
                                const snow_value_scale14 *scale,
                                snow_quantizer *quantizer);
void snow_quantizer_fini(snow_context *context, snow_quantizer *quantizer);

/* The quantized values of `count` native values in a row. */
void snow_quantize_row(const snow_quantizer *quantizer, const void *stored,
                       size_t count, int16_t *out);

/* The same of voxels that clip planes, which make floats of integers, have left
 * out: where a slab that is seen
 * may read them they have their values still, and are no holes.  `count` voxels
 * along `axis`, the first at `at`. */
void snow_quantize_clipped(const snow_quantizer *quantizer,
                           const snow_volume *volume, const int64_t at[3],
                           int axis, size_t count, int16_t *out);

#endif
