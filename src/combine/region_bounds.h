/* combine/region_bounds.h - borders of regions.
 *
 * A rising function maps fractions of the picture (region t of n begins at t /
 * n) to pixels: linear for even regions, by the counts of active pixels in
 * groups of lines for counted ones. Equal fractions give equal bounds, so that
 * divisions into 2 and into 4 match. */
#ifndef SNOW_REGION_BOUNDS_H
#define SNOW_REGION_BOUNDS_H

#include "combine/exchange.h"

#define SNOW_BINS_MOST SNOW_COUNTS_MOST

/* A counted region has at most this many times the pixels of an even one, for
 * any picture: this bounds buffers. */
#define SNOW_IMAGE_REGION_MOST 4

typedef struct snow_region_bounds {
    int width, height, grain;
    bool counted;
    int bins;                            /* groups of lines */
    int64_t weights[SNOW_BINS_MOST + 1]; /* of all bins before; the total */
} snow_region_bounds;

/* Even regions. */
void snow_region_bounds_even(snow_region_bounds *bounds, int width, int height,
                             int grain);

/* Counted regions: counts[i] is the number of active pixels in bin i, of all
 * ranks; destroyed. */
void snow_region_bounds_count(snow_region_bounds *bounds, int64_t *counts);

/* The first line of a bin; that of bin `bins` is the height. */
int snow_region_bounds_line(const snow_region_bounds *bounds, int bin);

/* The begin of region t of n; for t = n the end of the picture. */
int64_t snow_region_begin(const snow_region_bounds *bounds, int region,
                          int regions);

/* The most pixels of any of n regions, or an upper bound. */
int64_t snow_region_capacity(const snow_region_bounds *bounds, int regions);

#endif
