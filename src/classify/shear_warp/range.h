/* classify/shear_warp/range.h - data values as values of 14 bits, which the
 * shear-warp interpolates before it colours them. */
#ifndef SNOW_CLASSIFY_SHEAR_WARP_RANGE_H
#define SNOW_CLASSIFY_SHEAR_WARP_RANGE_H

#include "transfer/scale.h"
#include "transfer/transfer.h"
#include "volume/volume.h"

/* The largest quantized value, and what stands for a hole: a voxel without a
 * value. */
#define SNOW_VALUE_MOST 16383
#define SNOW_VALUE_HOLE INT16_MIN

/* The finite data values of a volume, or their decimal logarithms, or their
 * places on a symmetric scale (transfer/scale.h). */
typedef struct snow_data_range {
    double low, high; /* low > high: there is none */
    bool log;
    bool holes;    /* some voxels are NaN, or have no logarithm */
    double linear; /* of a symmetric scale; 0: of none */
    bool masked;   /* holes have a border that is lit */
} snow_data_range;

/* Whether a range is of a look's scale; NULL: of data values. */
static inline bool snow_data_range_is_of(const snow_data_range *range,
                                         const snow_transfer *look) {
    return range->log == (look && look->log) &&
           range->linear == (look ? look->linear : 0);
}

/* Reads all voxels, and those next to clip planes.  `threads` as in
 * base/thread_pool.h.  Errors: SNOW_STATUS_STOPPED. */
snow_status snow_data_range_measure(const snow_volume *volume, snow_scale scale,
                                    int threads, snow_data_range *out);

/* Integers of 8 and 16 bits become quantized values by a multiplication, which
 * vectors do in registers.  Native value n, clamped to bottom .. top, is
 *
 *     t = ((n factor + offset) mod 2^16) >> shift
 *     V = (t weight + 2^14) >> 15
 *
 * With R = top - bottom up to 2047 V is k (n - bottom), k the whole part of
 * SNOW_VALUE_MOST / R: t is that, and the weight keeps it as it is.  With a
 * larger R t is n - bottom times the largest power of 2 that leaves it below
 * 2^15, and V at most SNOW_VALUE_MOST.  Where the slope is negative it is top -
 * n. */
typedef struct snow_fixed_quantizer {
    int32_t bottom, top;
    uint16_t factor, offset;
    int16_t shift, weight;
} snow_fixed_quantizer;

static inline int16_t snow_quantize_fixed(const snow_fixed_quantizer *fixed,
                                          int32_t native) {
    uint16_t t = (uint16_t)((uint32_t)native * fixed->factor + fixed->offset);
    return (int16_t)(((t >> fixed->shift) * fixed->weight + 0x4000) >> 15);
}

/* Number V stands for the data value low + V (high - low) / SNOW_VALUE_MOST, or
 * for its decimal logarithm, or its place on a symmetric scale; values beyond
 * the ends are clamped. */
typedef struct snow_value_scale14 {
    double low, high;
    bool log;
    double linear; /* as in snow_data_range */
    bool whole;    /* quantized values are made by the fixed-point quantizer */
    bool clamps;   /* there are values beyond the ends */
    snow_fixed_quantizer fixed;
} snow_value_scale14;

static inline bool snow_value_same_scale(const snow_value_scale14 *a,
                                         const snow_value_scale14 *b) {
    return a->low == b->low && a->high == b->high && a->log == b->log &&
           a->linear == b->linear && a->whole == b->whole &&
           a->fixed.bottom == b->fixed.bottom && a->fixed.top == b->fixed.top;
}

/* The scale of a look: all of the data, or, where the look shows less than 1/64
 * of that, what it shows, widened by four times its length on each side; NULL:
 * all.  Of integers it ends at one, and `high` is where the fixed-point
 * quantizer has SNOW_VALUE_MOST. */
snow_value_scale14 snow_value_scale_of(const snow_data_range *data,
                                       const snow_transfer *transfer,
                                       const snow_volume_info *info);

/* A data value, or its place on a symmetric scale. */
static inline double snow_place_of(double linear, double value) {
    return linear > 0 ? snow_scale_place((snow_scale){false, linear}, value)
                      : value;
}

/* The data value of any number V. */
double snow_value_of(const snow_value_scale14 *scale, double v);

#endif
