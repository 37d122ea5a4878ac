/* combine/exchange.h - the exchange step: local images of many
 * processors (combination, Cb in figure 7) glued to one picture.
 *
 * Two steps.  The exchange leaves every rank with a piece of the picture, all
 * local images laid over one another there; the gather brings pieces to the
 * display processor.  Between the two a rank may do to its piece what it likes:
 * the warp, 8 bits.
 *
 *   local images   ranks[0] nearest          pieces          the picture
 *   +-------+ +-------+ +-------+           +-------+        +-------+
 *   |  ##   | | ###   | |       |  exchange |   0   | gather |       |
 *   |  ##   | |   ##  | |   ### | --------> |---1---| -----> |       |
 *   |       | |       | |   ### |           |   2   |        |       |
 *   +-------+ +-------+ +-------+           +-------+        +-------+
 */
#ifndef SNOW_EXCHANGE_H
#define SNOW_EXCHANGE_H

#include "comm/comm.h"

#include <snowglass/ranks.h>

/* Columns x0 .. x1 - 1 of lines y0 .. y1 - 1; empty where x0 >= x1. */
typedef struct snow_rectangle {
    int x0, y0, x1, y1;
} snow_rectangle;

/* What is combined.  All but `pixels`, `stride` and `drawn` is the same on all
 * ranks. */
typedef struct snow_exchange_order {
    int width, height, channels; /* of the picture; (grey, a) or (r, g, b, a),
                                    premultiplied */
    const float *pixels;         /* the local image: its line 0, column 0 */
    size_t stride;               /* floats from line to line */
    snow_rectangle drawn;        /* all else of it is transparent, and not
                                    read */
    const int *ranks;            /* from front to back */
    snow_combining method;
    int radix; /* of RADIX; 0: chosen */
    int grain; /* pieces are whole runs of so many pixels, in
                  order of lines: 1, or width */
} snow_exchange_order;

/* This rank's part of the picture: pixels first .. first + count - 1 in order
 * of lines; count may be 0.  Owned by the combiner until its next call. */
typedef struct snow_piece {
    int64_t first, count;
    float *pixels;
} snow_piece;

/* Buffers, kept from picture to picture. */
typedef struct snow_combiner snow_combiner;
snow_status snow_combiner_new(snow_comm *comm, snow_combiner **out);
void snow_combiner_free(snow_combiner *combiner);

/* Collective.  Over is associative, so all methods give the picture of a chain
 * but for float rounding.  Errors: agreed on by the caller; SNOW_NO_MEMORY. */
snow_status snow_exchange(snow_combiner *combiner,
                          const snow_exchange_order *order, snow_piece *out);

/* Where every rank's piece lies after an exchange: firsts[rank] ..
 * firsts[rank + 1] - 1 need not hold, so both are told. */
void snow_exchange_pieces(const snow_combiner *combiner, int64_t *firsts,
                          int64_t *counts);

/* Pixels of one line of the picture. */
typedef struct snow_pixel_run {
    int32_t x, y, count;
} snow_pixel_run;

/* Collective.  Brings runs of pixels of `pixel_bytes` each, packed one after
 * another, to rank 0, whose `picture` (width * height * pixel_bytes, cleared by
 * the caller) they are copied into; on the other ranks it may be NULL.  Runs
 * that are transparent need not be sent. */
snow_status snow_gather(snow_combiner *combiner, int width,
                        const snow_pixel_run *runs, size_t run_count,
                        const void *pixels, size_t pixel_bytes, void *picture);

#endif
