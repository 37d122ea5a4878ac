/* combine/pixels.h - what is done with 64 pixels and a bit for each: the inner
 * loops of the exchange, for every level of vectors.  All levels give the same
 * bits.
 *
 * Pixels are 2 or 4 floats, alpha last.  Packed ones lie one after another
 * without those whose bit is 0; loops may touch SNOW_PIXELS_SLACK bytes beyond
 * the last packed one, which they change only while packing. */
#ifndef SNOW_PIXELS_H
#define SNOW_PIXELS_H

#include "simd/isa.h"

#define SNOW_PIXELS_SLACK 64

typedef struct snow_pixel_loops {
    /* Which of `count` <= 64 pixels have anything in them (-0 is nothing); only
     * these are read. */
    uint64_t (*look)(const float *pixels, int count);
    /* Packs those of 64 pixels whose bits are set, and reads no others; returns
     * where the next one goes. */
    float *(*pack)(float *out, const float *pixels, uint64_t bits);
    /* Lays packed pixels behind those of `tile`; returns the first that is
     * left.  tile += (1 - tile.alpha) * pixel, in this order of operations. */
    const float *(*lay)(float *tile, const float *packed, uint64_t bits);
} snow_pixel_loops;

/* What is done with a pixel that comes behind another.  All but over make no
 * difference of the two, and take pixels (value, weight) whose nothing is 0. */
typedef enum snow_laying {
    SNOW_LAY_OVER = 0,
    SNOW_LAY_MOST, /* the larger of each float */
    SNOW_LAY_SUM
} snow_laying;

/* `loops` of 2 channels with another way of laying pixels. */
snow_pixel_loops snow_pixels_laying(const snow_pixel_loops *loops,
                                    snow_laying laying);

/* The loops for 2 or 4 channels. */
const snow_pixel_loops *snow_pixels_pick(snow_isa isa, int channels);

#endif
