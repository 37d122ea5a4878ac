/* combine/pixels.h - the inner loops of the exchange, over pixels and a bit for
 * each, for every level of vectors.  All levels give the same bits.
 *
 * Pixels are 2 or 4 floats, alpha last.  Packed ones lie one after another
 * without those whose bit is 0; loops may touch SNOW_PIXELS_SLACK bytes beyond
 * the last packed one, which they change only while packing.  Bit i % 64 of
 * word i / 64 is pixel i's. */
#ifndef SNOW_PIXELS_H
#define SNOW_PIXELS_H

#include "simd/isa.h"

#define SNOW_PIXELS_SLACK 64

struct snow_active;

typedef struct snow_pixel_loops {
    /* Which of `count` <= 64 pixels have anything in them (-0 is nothing); only
     * these are read. */
    uint64_t (*look)(const float *pixels, int count);
    /* Looks at `count` pixels, of which the first is number `at`: sets the bits
     * of those that have anything in words[0], which is word at / 64, and so
     * on, and packs these pixels; returns where the next one goes. */
    float *(*scan)(const float *pixels, int64_t at, int64_t count,
                   uint64_t *words, float *out);
    /* Lays layers over one another, from front to back, in pixels first .. last
     * - 1 (as snow_active_merge, which see): the bits of the result to words[0]
     * and so on, its pixels, packed or all, to `out`; returns where the next
     * one goes; adds to *laid.  Over is front += (1 - front.alpha) * back, in
     * this order of operations. */
    float *(*merge)(struct snow_active *layers, int count, int64_t first,
                    int64_t last, uint64_t *words, float *out, bool packed,
                    int64_t *laid);
} snow_pixel_loops;

/* What is done with a pixel that comes behind another.  All but over make no
 * difference of the two, and take pixels (value, weight) whose nothing is 0. */
typedef enum snow_laying {
    SNOW_LAY_OVER = 0,
    SNOW_LAY_MOST, /* the larger of each float */
    SNOW_LAY_SUM
} snow_laying;

/* The loops for 2 or 4 channels; `laying` other than over is of 2. */
const snow_pixel_loops *snow_pixels_pick(snow_isa isa, int channels,
                                         snow_laying laying);

#endif
