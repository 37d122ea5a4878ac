/* encode/windows.h - rows of a band read as bit masks, and windows of them.
 *
 * The sheared method wants to know of a few neighbouring columns, in many rows,
 * which hold a voxel, and where in IA the first of these lies.  All three
 * encodings are decoded to this one form:
 *
 *   bits    64 zeros | one bit a column, lowest first | zeros to the end
 *   rank    per word: voxels of the row before it
 *   voxel   per row: its first voxel in IA
 *
 * The same word of all rows lies together, so that a window is cut out of
 * several rows at once. */
#ifndef SNOW_WINDOWS_H
#define SNOW_WINDOWS_H

#include "encode/bands.h"
#include "simd/isa.h"

#define SNOW_WINDOW_ROWS 64 /* a mask of rows is one word */
#define SNOW_WINDOW_PAD 64  /* bits before the first column */

typedef struct snow_mask_rows {
    uint64_t *bits; /* [word * SNOW_WINDOW_ROWS + row] */
    uint32_t *rank;
    const unsigned char *codes[SNOW_WINDOW_ROWS]; /* of the row's first voxel */
    const uint16_t *normals[SNOW_WINDOW_ROWS];    /* NULL: none */
    const uint16_t *fades[SNOW_WINDOW_ROWS];      /* NULL: none */
    size_t words;                                 /* a row, padding included */
    uint64_t held;                                /* rows that hold a voxel */
} snow_mask_rows;

/* Words of a row of so many columns. */
static inline size_t snow_window_words(int64_t columns) {
    return (size_t)columns / 64 + 3;
}

/* Windows of `count` columns from `column` on, up to SNOW_WINDOW_MOST, which
 * overlap the rows: -count < column < columns.  Returns the rows, held and
 * wanted, whose window holds a voxel; of each its bits, and how many voxels of
 * its row lie before it.  All SNOW_WINDOW_ROWS bits may be written. */
typedef uint64_t snow_windows_fn(const snow_mask_rows *rows, uint64_t wanted,
                                 int64_t column, int count, uint64_t *bits,
                                 uint32_t *before);

/* Decodes rows first .. first + count - 1 of a slice of the bands, `count` at
 * most SNOW_WINDOW_ROWS; rows that do not exist are empty.  `spans` is room for
 * one row's. */
typedef void snow_mask_rows_fn(const snow_bands *bands, int64_t slice,
                               int64_t first, int count, snow_span *spans,
                               snow_mask_rows *rows);

typedef struct snow_window_fns {
    snow_windows_fn *windows;
    snow_mask_rows_fn *read;
} snow_window_fns;

const snow_window_fns *snow_window_fns_of(snow_isa isa);

#endif
