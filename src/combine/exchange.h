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
 *
 * Pixels are numbered in order of lines, line 0 first; a piece is a run of
 * these numbers.  With SNOW_PIECES_INTERLACED the order of lines is not that of
 * the picture: snow_exchange_line tells which line is where. */
#ifndef SNOW_EXCHANGE_H
#define SNOW_EXCHANGE_H

#include "combine/pixels.h"
#include "comm/comm.h"

#include <snowglass/ranks.h>

/* Columns x0 .. x1 - 1 of lines y0 .. y1 - 1; empty where x0 >= x1. */
typedef struct snow_rectangle {
    int x0, y0, x1, y1;
} snow_rectangle;

/* How the picture is cut into pieces. */
typedef enum snow_pieces {
    SNOW_PIECES_AUTO = 0,  /* counted where that pays, else even */
    SNOW_PIECES_EVEN,      /* equally many pixels */
    SNOW_PIECES_COUNTED,   /* about equally many active pixels of all local
                              images together, but at most four times an even
                              piece; costs a reduction among the ranks */
    SNOW_PIECES_INTERLACED /* even, but near lines lie far from one another:
                              each piece has a share of every region */
} snow_pieces;

/* An exchange without pixels, to learn how long it takes on a simulated
 * machine: masks of active pixels travel, with messages of the right length
 * around them, but no pixel is touched. */
typedef struct snow_rehearsal {
    /* Bit i tells whether pixel (x + i, y) is active, for i < count <= 64. */
    uint64_t (*active)(void *user, int y, int x, int count);
    void *user;
} snow_rehearsal;

/* A local image in the making.  What is there of it is sent while the rest is
 * drawn. */
typedef struct snow_unfinished {
    /* Draws a little more; false: nothing is left to begin. */
    bool (*step)(void *user);
    /* Whether lines y0 .. y1 - 1 are there; then what of them was drawn, as in
     * the order. */
    bool (*look)(void *user, int y0, int y1, snow_rectangle *drawn);
    /* Returns when all is there; once. */
    void (*end)(void *user);
    void *user;
} snow_unfinished;

/* What is combined.  All but `pixels`, `stride`, `drawn` and the users of the
 * rehearsal and of what is unfinished is the same on all ranks. */
typedef struct snow_exchange_order {
    int width, height, channels; /* of the picture; 2 (grey, a) or 4 (r, g, b,
                                    a), premultiplied */
    const float *pixels;         /* the local image: its line 0, column 0 */
    size_t stride;               /* floats from line to line */
    snow_rectangle drawn;        /* all else of it is transparent, and not
                                    read */
    const int *ranks;            /* from front to back */
    snow_combining method;
    int radix;          /* of RADIX, at least 2; 0: chosen */
    int grain;          /* pieces are whole runs of so many pixels: 1, or
                           width */
    snow_pieces pieces; /* of all methods but the tree, which has one */
    snow_laying laying; /* of 2 channels where it is not over */
    bool whole;         /* all pixels travel, as in the paper: no masks */
    const snow_unfinished *unfinished; /* tells `drawn`; NULL: all is there */
    /* snow_exchange_counts, summed up over all ranks: counted pieces are cut by
     * these, NULL: by the local images. */
    const int64_t *counts;
    int count_groups;
    const snow_rehearsal *rehearsal; /* NULL: a real exchange */
    /* Seconds that a simulated processor takes (snow_comm_work) to look at a
     * pixel of its local image, or to move 16 bytes of a gathered picture; and
     * to lay a pixel over another, or to round it to 8 bits. */
    double scan_seconds, blend_seconds;
} snow_exchange_order;

/* This rank's part of the picture: pixels first .. first + count - 1; count may
 * be 0.  Owned by the combiner until its next exchange; `pixels` is NULL in a
 * rehearsal.  Bit i % 64 of active[i / 64 - first / 64] tells whether pixel i
 * is not nothing. */
typedef struct snow_piece {
    int64_t first, count;
    float *pixels;
    const uint64_t *active;
} snow_piece;

/* Figures of the last exchange, for benchmarks. */
#define SNOW_ROUNDS_MOST 32
typedef struct snow_exchange_figures {
    snow_combining method; /* what AUTO chose */
    int rounds, radices[SNOW_ROUNDS_MOST];
    bool counted;            /* whether pieces were cut by count */
    int64_t active;          /* pixels of the local image that are */
    int64_t scanned, laid;   /* pixels looked at; laid over one another */
    int64_t receive_largest; /* bytes of the largest message that came */
    int64_t early;           /* bytes sent before the local image was there */
    double begin_at; /* what share of the picture's pixels a rank had best begin
                        to draw behind, that it may send more of them early: its
                        own are drawn last */
} snow_exchange_figures;

/* Buffers, kept from picture to picture.  The communicator outlives it. */
typedef struct snow_combiner snow_combiner;
snow_status snow_combiner_new(snow_comm *comm, snow_combiner **out);
void snow_combiner_free(snow_combiner *combiner);

/* Collective.  Over is associative, so all methods give the picture of a chain
 * but for float rounding, and the same bits every time.  A second exchange of
 * the same sizes, method and pieces takes no memory; where pieces are counted,
 * unless they are larger than before.  Errors, on all ranks
 * alike: SNOW_NO_MEMORY, SNOW_BAD_USAGE (an order that is none), those of the
 * transport.
 *
 * An unfinished local image is ended, whatever becomes of the exchange; before
 * it where its pieces are counted without `counts`. */
snow_status snow_exchange(snow_combiner *combiner,
                          const snow_exchange_order *order, snow_piece *out);

const snow_exchange_figures *snow_exchange_told(const snow_combiner *combiner);

/* Where every rank's piece lies after an exchange: firsts[rank] ..
 * firsts[rank + 1] - 1 need not hold, so both are told. */
void snow_exchange_pieces(const snow_combiner *combiner, int64_t *firsts,
                          int64_t *counts);

/* This rank's active pixels in groups of lines of the picture of the last
 * exchange, SNOW_COUNTS_MOST at most; how many groups, the same on all ranks,
 * 0 where pieces were not counted.  Good for the next picture, which often is
 * much like the last one; groups of another number are passed over. */
#define SNOW_COUNTS_MOST 256
int snow_exchange_counts(const snow_combiner *combiner, const int64_t **counts);

/* The line of the picture that is in place `place` of the order of lines. */
int snow_exchange_line(const snow_combiner *combiner, int place);

/* Pixels of one line of the picture. */
typedef struct snow_pixel_run {
    int32_t x, y, count;
} snow_pixel_run;

/* Collective.  Brings runs of pixels of `pixel_bytes` each, packed one after
 * another, to rank 0, whose `picture` (width * height * pixel_bytes, cleared by
 * the caller) they are copied into; on the other ranks it may be NULL.  Runs
 * of all ranks are apart.  Runs that are transparent need not be sent; a run
 * costs SNOW_RUN_BYTES besides its pixels, and gaps of fewer bytes between runs
 * of a line, which follow one another from left to right, must be sent.  In a
 * rehearsal `pixels` and `picture` are NULL.  Sides are at most 65535.  Errors:
 * as those of snow_exchange; on one rank alone SNOW_BAD_USAGE and
 * SNOW_NO_MEMORY, of its own runs, which then do not reach the picture. */
#define SNOW_RUN_BYTES 6
snow_status snow_gather(snow_combiner *combiner, int width, int height,
                        const snow_pixel_run *runs, size_t run_count,
                        const void *pixels, size_t pixel_bytes, void *picture);

/* Local work: makes room for this rank's runs, lest snow_gather take memory
 * where the other ranks cannot know whether there is enough. */
snow_status snow_gather_reserve(snow_combiner *combiner, int width, int height,
                                size_t run_count, int64_t pixels,
                                size_t pixel_bytes);

/* Collective.  Brings the piece of the last exchange as it is: `bits` 8 rounds
 * channels to whole steps of 1/255, one byte each; 0: floats.  Errors: as those
 * of snow_gather. */
snow_status snow_gather_piece(snow_combiner *combiner, const snow_piece *piece,
                              int bits, void *picture);

/* How many messages a rank of the gather's tree waits for at a time: 2 to the
 * number of ranks, which is no tree at all; 0: chosen. */
void snow_gather_radix(snow_combiner *combiner, int radix);

#endif
