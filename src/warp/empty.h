/* warp/empty.h - tests whether the source of a run of pixels is empty. This
 * test alone skips most runs of most pictures, so it must not divide. */
#ifndef SNOW_WARP_EMPTY_H
#define SNOW_WARP_EMPTY_H

#include "warp/warp.h"

#include <math.h>
#include <string.h>

/* Clears pixels `from` to `to` - 1 of a line but for those of low to high,
 * which are first .. last: false where there are none. */
static inline bool snow_clear_outside(int from, int to, double low, double high,
                                      int channels, float *pixels, int *first,
                                      int *last) {
    size_t bytes = (size_t)channels * sizeof *pixels;
    *first = (int)ceil(fmin(low, to));
    *last = low <= high ? (int)floor(high) : *first - 1;
    if (*last < *first)
        *first = to, *last = to - 1;
    memset(pixels + from * channels, 0, (size_t)(*first - from) * bytes);
    memset(pixels + (*last + 1) * channels, 0,
           (size_t)(to - 1 - *last) * bytes);
    return *first <= *last;
}

/* The largest side of a block, in pixels, for which the inverse is exact. */
#define SNOW_BLOCK_SIDE_MOST 2048

typedef struct snow_blocks {
    const snow_intermediate_view *plane;
    uint64_t inverse[2]; /* 2^32 / width and / height of a block, rounded up */
    bool huge;           /* a block is too large for that */
} snow_blocks;

static inline snow_blocks snow_blocks_of(const snow_intermediate_view *plane) {
    const uint64_t size[2] = {(uint64_t)plane->block_width,
                              (uint64_t)plane->block_height};
    const uint64_t one = UINT64_C(1) << 32;
    return (snow_blocks){
        plane,
        {(one + size[0] - 1) / size[0], (one + size[1] - 1) / size[1]},
        size[0] > SNOW_BLOCK_SIDE_MOST || size[1] > SNOW_BLOCK_SIDE_MOST};
}

/* Blocks that are read between two places, in 2^-32 pixels; along a line places
 * only rise or only fall. `inverse` * size differs from 2^32 by less than the
 * size, so the quotient equals that of the division for places below 2^32 /
 * size: for all places of an intermediate image, whose sides are below 2^21. */
static inline void snow_blocks_between(uint64_t inverse, int64_t a, int64_t b,
                                       int most, size_t range[2]) {
    int64_t low = ((a < b ? a : b) >> 32) - 1,
            high = ((a < b ? b : a) >> 32) + 2;
    low = low < 0 ? 0 : low;
    high = high > most ? most : high;
    range[0] = (size_t)((uint64_t)low * inverse >> 32);
    range[1] = (size_t)((uint64_t)high * inverse >> 32);
}

/* Returns whether anything was drawn in what is read for the pixels between
 * two places, which are within the image. Blocks about as large as the image
 * are not tested. */
static inline bool snow_blocks_drawn(const snow_blocks *blocks,
                                     const int64_t first[2],
                                     const int64_t last[2]) {
    const snow_intermediate_view *plane = blocks->plane;
    size_t x[2], y[2];
    if (blocks->huge)
        return true;
    snow_blocks_between(blocks->inverse[0], first[0], last[0], plane->width - 1,
                        x);
    snow_blocks_between(blocks->inverse[1], first[1], last[1],
                        plane->height - 1, y);
    for (size_t j = y[0]; j <= y[1]; j++)
        for (size_t i = x[0]; i <= x[1]; i++)
            if (plane->drawn[j * (size_t)plane->blocks + i])
                return true;
    return false;
}

#endif
