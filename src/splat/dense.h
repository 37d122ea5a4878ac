/* splat/dense.h - a dense slice for splatting in gather form: the samples of
 * its interesting voxels on the whole grid, zeros between, with a margin on all
 * sides; and a map of the windows that are not empty.
 *
 *        <- taps ->             <- taps ->
 *   rows of zeros (taps)                        A window is `taps` voxels wide
 *      0 0 0 0 | . a b . . c . | 0 0 0 0        and high.  Its place counts
 *      0 0 0 0 | . . d . . . . | 0 0 0 0        from the margin's corner, so
 *   rows of zeros (taps)                        voxel (0, 0) is at (taps, taps)
 *
 * `reached` has one bit for each place of a window: whether it holds an
 * interesting voxel. The first and last places are always empty. */
#ifndef SNOW_DENSE_H
#define SNOW_DENSE_H

#include "encode/encode.h"

/* Size of a slice and of its windows. */
typedef struct snow_dense_shape {
    int64_t columns, rows;
    int channels;
    int taps_u, taps_v, padded_u; /* splat/kernel_table.h */
} snow_dense_shape;

typedef struct snow_dense {
    snow_dense_shape shape;
    size_t stride;          /* floats from row to row */
    float *samples;         /* all rows, margins included */
    size_t words;           /* 32-bit words of a row of the maps */
    uint32_t *row_bits;     /* per voxel row: windows that contain its voxels */
    uint32_t *reached;      /* per row of windows; `words` to a row */
    snow_span *extents;     /* per voxel row: where it may be nonzero */
    int64_t c0, c1, r0, r1; /* interesting voxels: columns c0 .. c1 - 1, rows r0
                               .. r1 - 1; c0 >= c1 if there are none */
    int64_t walked;         /* rows added so far */
} snow_dense;

/* Whether positions in a slice of this shape fit 32 bits, as loops require. */
bool snow_dense_serves(const snow_dense_shape *shape);

/* Bytes that a slice of this shape takes. */
uint64_t snow_dense_bytes(const snow_dense_shape *shape);

/* Reserves memory for slices of a shape; the record begins as zeros. Errors:
 * SNOW_STATUS_NO_MEMORY. Free with snow_dense_fini. */
snow_status snow_dense_make(snow_context *context,
                            const snow_dense_shape *shape, snow_dense *dense);
void snow_dense_fini(snow_context *context, snow_dense *dense);

/* Decompresses a slice: begin, the spans and samples of each row in order, end.
 * The rest of an earlier slice is cleared on the way. */
void snow_dense_begin(snow_dense *dense);
void snow_dense_add_row(snow_dense *dense, const snow_span *spans, size_t count,
                        const float *samples);
void snow_dense_end(snow_dense *dense);

#endif
