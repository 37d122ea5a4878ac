/* encode/decode.h - decodes rows of a band to bit masks, and windows of them.
 *
 * The shear-warp method needs to know which of a few neighbouring columns hold
 * a voxel, in many rows, and where in IA the first of these is. All three
 * encodings are decoded to this form:
 *
 *   bits    64 zeros | one bit a column, lowest first | zeros to the end
 *   rank    per word: voxels of the row before it
 *   voxel   per row: its first voxel in IA
 *   any     per word: columns that hold a voxel in any of the rows
 *
 * The same word of all rows is stored together, so that a window is extracted
 * from several rows at once. */
#ifndef SNOW_ENCODE_DECODE_H
#define SNOW_ENCODE_DECODE_H

#include "encode/bands/bands.h"
#include "simd/isa.h"

#define SNOW_DECODE_ROWS 64 /* a mask of rows is one 64-bit word */
#define SNOW_DECODE_PAD 64  /* bits before the first column */

typedef struct snow_mask_rows {
    uint64_t *bits; /* [word * SNOW_DECODE_ROWS + row] */
    uint32_t *rank;
    uint64_t *any;                                /* [word] */
    const unsigned char *codes[SNOW_DECODE_ROWS]; /* of the row's first voxel */
    const uint16_t *normals[SNOW_DECODE_ROWS];    /* NULL: none */
    const uint16_t *gradient_factors[SNOW_DECODE_ROWS]; /* NULL: none */
    size_t words; /* a row, padding included */
    bool fetch; /* set by the caller: prefetch the rows' part of IA, if most of
                   it will be used */
    uint64_t held; /* rows that hold a voxel */
} snow_mask_rows;

/* Words of a row of `columns` columns. */
static inline size_t snow_decode_words(int64_t columns) {
    return (size_t)columns / 64 + 3;
}

/* Lays the words of rows out in a block (snow_lay_out). */
void snow_mask_rows_lay_out(snow_mask_rows *rows, int64_t columns, char *base,
                            size_t *at);

/* Whether any row has a voxel in `count` columns from `column` on. `count` is
 * at most SNOW_WINDOW_MOST; the window overlaps the rows. */
static inline bool snow_decode_any(const snow_mask_rows *rows, int64_t column,
                                   int count) {
    size_t at = (size_t)(column + SNOW_DECODE_PAD);
    const uint64_t *any = rows->any + at / 64;
    uint64_t window = any[0] >> at % 64 | any[1] << 1 << (63 - at % 64);
    return (window & ((UINT64_C(1) << count) - 1)) != 0;
}

/* Extracts windows of `count` columns from `column` on. `count` is at most
 * SNOW_WINDOW_MOST; windows overlap the rows: -count < column < columns.
 * Returns which rows, held and wanted, have a voxel in their window; for each
 * of them writes its bits, and the number of voxels of its row before it. All
 * SNOW_DECODE_ROWS bits may be written. */
typedef uint64_t snow_decode_fn(const snow_mask_rows *rows, uint64_t wanted,
                                int64_t column, int count, uint64_t *bits,
                                uint32_t *before);

/* Decodes rows first + n of a slice of the bands, for n from the lowest to the
 * highest bit of `wanted`. Rows that do not exist or are not wanted are empty.
 * `spans` has room for one row's spans. Prefetches the rows' part of IA. */
typedef void snow_mask_rows_fn(const snow_bands *bands, int64_t slice,
                               int64_t first, uint64_t wanted, snow_span *spans,
                               snow_mask_rows *rows);

typedef struct snow_decode_fns {
    snow_decode_fn *windows;
    snow_mask_rows_fn *read;
} snow_decode_fns;

const snow_decode_fns *snow_decode_fns_of(snow_isa isa);

#endif
