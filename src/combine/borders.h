/* combine/borders.h - where pieces begin and end, and the order of lines.
 *
 * A rising function leads from fractions of the picture (piece t of n begins at
 * t / n) to pixels: straight for even pieces, by the counts of active pixels in
 * groups of lines for counted ones.  Equal fractions give equal borders, so
 * that cuts into 2 and into 4 fit. */
#ifndef SNOW_BORDERS_H
#define SNOW_BORDERS_H

#include "combine/exchange.h"

#define SNOW_BINS_MOST SNOW_COUNTS_MOST

/* A counted piece has at most so many times the pixels of an even one, whatever
 * is seen in the picture: what bounds buffers. */
#define SNOW_PIECE_MOST 4

typedef struct snow_borders {
    int width, height, grain;
    bool counted;
    int bins;                            /* groups of lines */
    int64_t weights[SNOW_BINS_MOST + 1]; /* of all bins before; the last: of
                                            all */
} snow_borders;

/* Even pieces. */
void snow_borders_even(snow_borders *borders, int width, int height, int grain);

/* Makes them counted: counts[i] is the number of active pixels in bin i, of all
 * ranks; used up. */
void snow_borders_count(snow_borders *borders, int64_t *counts);

/* The first line of a bin; that of bin `bins` is the height. */
int snow_borders_line(const snow_borders *borders, int bin);

/* Where piece t of n begins; piece n where the picture ends. */
int64_t snow_border(const snow_borders *borders, int piece, int pieces);

/* The most pixels that any of so many pieces has, or a bound of it. */
int64_t snow_border_room(const snow_borders *borders, int pieces);

/* Fills order[place] with the lines 0 .. height - 1 so that any run of places
 * has lines from all over the picture: in the order of their numbers read
 * backwards in binary (van der Corput 1935). */
void snow_order_lines(int *order, int height);

#endif
