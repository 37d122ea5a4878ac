/* combine/borders.h - borders of regions, and the order of lines.
 *
 * A rising function maps fractions of the picture (region t of n begins at t /
 * n) to pixels: linear for even regions, by the counts of active pixels in
 * groups of lines for counted ones. Equal fractions give equal borders, so that
 * divisions into 2 and into 4 match. */
#ifndef SNOW_BORDERS_H
#define SNOW_BORDERS_H

#include "combine/exchange.h"

#define SNOW_BINS_MOST SNOW_COUNTS_MOST

/* A counted region has at most this many times the pixels of an even one, for
 * any picture: this bounds buffers. */
#define SNOW_IMAGE_REGION_MOST 4

typedef struct snow_borders {
    int width, height, grain;
    bool counted;
    int bins;                            /* groups of lines */
    int64_t weights[SNOW_BINS_MOST + 1]; /* of all bins before; the total */
} snow_borders;

/* Even regions. */
void snow_borders_even(snow_borders *borders, int width, int height, int grain);

/* Counted regions: counts[i] is the number of active pixels in bin i, of all
 * ranks; destroyed. */
void snow_borders_count(snow_borders *borders, int64_t *counts);

/* The first line of a bin; that of bin `bins` is the height. */
int snow_borders_line(const snow_borders *borders, int bin);

/* The begin of region t of n; for t = n the end of the picture. */
int64_t snow_border(const snow_borders *borders, int region, int regions);

/* The most pixels of any of n regions, or an upper bound. */
int64_t snow_border_room(const snow_borders *borders, int regions);

/* Fills order[place] with the lines 0 .. height - 1 so that any run of places
 * has lines from all over the picture: sorted by their numbers with the bits
 * reversed (van der Corput 1935). */
void snow_order_lines(int *order, int height);

#endif
