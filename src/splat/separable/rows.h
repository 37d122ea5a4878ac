/* splat/separable/rows.h - splatting of whole rows (R in figure 7), for modes
 * that need nearly every voxel: a row of EA and IA is decompressed, and rows
 * are added up with the weights of a comb (splat/separable/comb.h), along u and
 * then along v.
 *
 *   bits, codes   0 1 1 0 1   a b c
 *   spread        0 a b 0 c             values, as floats
 *   set           w0 row[n] + w1 row[n + 1] + ...        along u
 *   add           w0 row0[n] + w1 row1[n] + ... to a line, along v
 *
 * Maximum projection does the same by tiles (snow_maximum_tile), most of which
 * add nothing once the brightest voxels are in.
 *
 * avx2 and avx512 give the same bits. */
#ifndef SNOW_SPLAT_SEPARABLE_ROWS_H
#define SNOW_SPLAT_SEPARABLE_ROWS_H

#include "simd/isa.h"
#include "splat/separable/comb.h"

/* Floats that may be read and written beyond the last. */
#define SNOW_ROWS_BEYOND 16

/* Sums of rows over n = first .. end - 1 for one or two phases: sum i, of
 * rows[i * lead + m][n] * weights[i][m] over m = 0 .. taps - 1, goes into
 * lines[i][n]. */
typedef struct snow_rows_job {
    const float *rows[SNOW_TAPS_MOST + 1];
    const float *weights[2];
    float *lines[2]; /* the second may be NULL: one phase */
    int taps, lead;  /* lead: 0 or 1 */
    int first, end;
} snow_rows_job;

typedef void snow_rows_fn(const snow_rows_job *job);

/* A tile of one slice for maximum projection: 16 or 32 columns of the lattice
 * for up to 64 rows of voxels, of which only those that may matter are read.
 *
 *   windows of voxels     decompressed, along u        combed along v
 *   row i   . a b . .  --> phase 0 | phase 1 of row i  --> lines of a cell
 *
 * A line holds the pixels of each phase along u, one phase after the other. */
#define SNOW_MAXIMUM_WINDOW 80 /* floats of a decompressed window */
#define SNOW_MAXIMUM_LINE 32   /* pixels at most */
#define SNOW_MAXIMUM_CELLS 64
#define SNOW_MAXIMUM_ROWS 64

/* The picture is rounded to steps in the end, so values that exceed it only by
 * rounding need not be examined: many pixels have the same value. */
#define SNOW_MAXIMUM_STEPS 65535

/* Larger than all values: for pixels that no slice reaches. */
#define SNOW_MAXIMUM_NONE 2.0f

/* A patch: four columns of a cell, of all phases. */
#define SNOW_PATCH_COLUMNS 4

/* For this many places of a row a block has an upper bound of the sheet, in
 * steps (render/modes/max_bounds.c). */
#define SNOW_BLOCK_COLUMNS 4

typedef struct snow_maximum_tile {
    int columns; /* 16, or 32 of one phase */
    /* Along u and v. */
    int phases[2], stride[2], taps[2], lead[2];
    const float *weights[2][2]; /* [axis][phase] */
    /* Windows (encode/decode.h) of `window` columns; numbers as for spread8.
     */
    uint64_t held;
    const uint64_t *bits;
    const uint32_t *before;
    const unsigned char *const *codes;
    int code_bytes, window;
    float scale, start;
    float *samples;    /* SNOW_MAXIMUM_ROWS windows */
    float *ring;       /* as many filtered rows, not shared */
    const float *zero; /* a filtered row of zeros */
    /* Cells to draw, whose rows are combed. */
    uint64_t cells;
    /* Factors of a cell's pixels, line by line; NULL: none. */
    const float *factors;
    float *lines;    /* of cell 0 */
    uint16_t *least; /* step of each patch's smallest pixel, kept up to date;
                        from cell 0 on */
    size_t patches;  /* from one cell's patches to the next cell's */
} snow_maximum_tile;

/* Finds the tiles of a band's cells that a slice may change: those with a patch
 * below one of its blocks. Patch p of cell n covers columns p * step to p *
 * step + across - 1 of blocks, rows n * stride to n * stride + reach - 1. */
typedef struct snow_maximum_look {
    const uint16_t *blocks; /* of the slice */
    int64_t columns;        /* of blocks, in all */
    int64_t row, column;    /* of patch 0 of cell 0, may be negative */
    const uint16_t *least;
    size_t patches; /* from one cell's patches to the next cell's */
    int step, across, stride, reach;
    uint64_t cells;
    int fours;       /* of patches of a tile, 1 or 2 */
    int first, end;  /* tiles to examine */
    uint64_t *found; /* [tile]: its cells; 8 more are written too */
} snow_maximum_look;

typedef struct snow_row_fns {
    /* Decompresses the voxels of `words` words of bits, `step` apart, lowest
     * bit first, into 64 floats for each word: start + scale * code, and 0
     * where there is no voxel. Codes have one or two bytes. */
    void (*spread8)(const uint64_t *bits, size_t step, size_t words,
                    const unsigned char *codes, float scale, float start,
                    float *row);
    void (*spread16)(const uint64_t *bits, size_t step, size_t words,
                     const unsigned char *codes, float scale, float start,
                     float *row);
    snow_rows_fn *set; /* the sum */
    snow_rows_fn *add; /* the line and the sum */
    void (*look)(const snow_maximum_look *look);
    void (*comb)(const snow_maximum_tile *tile); /* the held rows, along u */
    void (*most)(const snow_maximum_tile *tile); /* the cells: the larger of
                                                    their values and the sums */
    /* For rows of `count` numbers, an upper bound of the cubic B-spline through
     * any four, rows[0][n] to rows[3][n], between the two in the middle. */
    void (*hull)(const float *const *rows, int64_t count, float *highest);
    /* The largest of each four of 4 * count numbers. */
    void (*fours)(const float *numbers, int64_t count, float *largest);
    /* The steps of numbers from 0 to 1, with the rounding error of a sum added.
     */
    void (*blocks)(const float *numbers, int64_t count, uint16_t *blocks);
    /* Interleaves (value, weight) of `count` pixels of one or two phases. */
    void (*weave)(const float *const *values, const float *const *weights,
                  int phases, int count, float *pairs);
    /* The same for `count` pixels of a line of a tile, rounded to steps; 0 and
     * 0 where there is no value. */
    void (*settle)(const float *line, int phases, int columns, int count,
                   float *pairs);
} snow_row_fns;

/* `isa` is resolved. */
const snow_row_fns *snow_row_fns_of(snow_isa isa);

#endif
