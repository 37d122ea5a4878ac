/* combine/pixels.h - the inner loops of the exchange, over pixels and a mask
 * bit for each, for every instruction set. All give the same bits.
 *
 * Pixels are 2 or 4 floats, alpha last. Packed ones are contiguous, without
 * those whose bit is 0; loops may access SNOW_PIXELS_SLACK bytes beyond the
 * last packed one, which they change only while packing. Bit i % 64 of word i /
 * 64 is pixel i's. */
#ifndef SNOW_PIXELS_H
#define SNOW_PIXELS_H

#include "simd/isa.h"

#define SNOW_PIXELS_SLACK 64

struct snow_active;

typedef struct snow_pixel_loops {
    /* The mask of the active ones among `count` <= 64 pixels (-0 counts as 0);
     * only these are read. */
    uint64_t (*look)(const float *pixels, int count);
    /* Scans `count` pixels, the first of which is number `at`: sets the bits of
     * active ones in words[0], which is word at / 64, and after, and packs
     * these pixels; returns the end of the packed ones. */
    float *(*scan)(const float *pixels, int64_t at, int64_t count,
                   uint64_t *words, float *out);
    /* Composites layers, from front to back, in pixels first .. last - 1 (see
     * snow_active_merge): writes the mask of the result to words[0] and after,
     * its pixels, packed or all, to `out`; returns their end; adds to *laid.
     * Over is front += (1 - front.alpha) * back, in this order of steps. */
    float *(*merge)(struct snow_active *layers, int count, int64_t first,
                    int64_t last, uint64_t *words, float *out, bool packed,
                    int64_t *laid);
} snow_pixel_loops;

/* How a pixel is combined with one behind it. All except over are commutative,
 * and take pixels (value, weight) whose empty value is 0. */
typedef enum snow_composite_op {
    SNOW_COMPOSITE_OVER = 0,
    SNOW_COMPOSITE_MAXIMUM, /* the larger of each float */
    SNOW_COMPOSITE_SUM
} snow_composite_op;

/* The loops for 2 or 4 channels; a `composite_op` other than over needs 2. */
const snow_pixel_loops *snow_pixels_pick(snow_isa isa, int channels,
                                         snow_composite_op composite_op);

#endif
