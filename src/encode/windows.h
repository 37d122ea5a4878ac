/* encode/windows.h - rows of a band read as bit masks, and windows of them.
 *
 * The sheared method wants to know of a few neighbouring columns, in many rows,
 * which hold a voxel, and where in IA the first of these lies.  All three
 * encodings are decoded to this one form:
 *
 *   bits    64 zeros | one bit a column, lowest first | zeros to the end
 *   rank    per word: voxels of the row before it
 *   voxel   per row: its first voxel in IA
 *   any     per word: columns that hold a voxel in any of the rows
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
    uint64_t *any;                                /* [word] */
    const unsigned char *codes[SNOW_WINDOW_ROWS]; /* of the row's first voxel */
    const uint16_t *normals[SNOW_WINDOW_ROWS];    /* NULL: none */
    const uint16_t *fades[SNOW_WINDOW_ROWS];      /* NULL: none */
    size_t words;                                 /* a row, padding included */
    bool fetch;    /* set by who reads: whether the cache is asked for the rows'
                      part of IA, most of which is to be used */
    uint64_t held; /* rows that hold a voxel */
} snow_mask_rows;

/* Words of a row of so many columns. */
static inline size_t snow_window_words(int64_t columns) {
    return (size_t)columns / 64 + 3;
}

/* Whether any row has a voxel in the `count` columns from `column` on, up to
 * SNOW_WINDOW_MOST, which overlap the rows. */
static inline bool snow_window_any(const snow_mask_rows *rows, int64_t column,
                                   int count) {
    size_t at = (size_t)(column + SNOW_WINDOW_PAD);
    const uint64_t *any = rows->any + at / 64;
    uint64_t window = any[0] >> at % 64 | any[1] << 1 << (63 - at % 64);
    return (window & ((UINT64_C(1) << count) - 1)) != 0;
}

/* Windows of `count` columns from `column` on, up to SNOW_WINDOW_MOST, which
 * overlap the rows: -count < column < columns.  Returns the rows, held and
 * wanted, whose window holds a voxel; of each its bits, and how many voxels of
 * its row lie before it.  All SNOW_WINDOW_ROWS bits may be written. */
typedef uint64_t snow_windows_fn(const snow_mask_rows *rows, uint64_t wanted,
                                 int64_t column, int count, uint64_t *bits,
                                 uint32_t *before);

/* Decodes rows first + n of a slice of the bands, for n from the lowest to the
 * highest bit of `wanted`; rows that do not exist are empty, as are the others.
 * `spans` is room for one row's.  The rows' part of IA is asked of the cache.
 */
typedef void snow_mask_rows_fn(const snow_bands *bands, int64_t slice,
                               int64_t first, uint64_t wanted, snow_span *spans,
                               snow_mask_rows *rows);

typedef struct snow_window_fns {
    snow_windows_fn *windows;
    snow_mask_rows_fn *read;
} snow_window_fns;

const snow_window_fns *snow_window_fns_of(snow_isa isa);

#endif
