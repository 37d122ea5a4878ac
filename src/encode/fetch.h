/* encode/fetch.h - fetches the rows of a slice as contiguous native values, for
 * any slice axis.
 *
 *   slices along z and y   rows run along x and are used in place
 *   slices along x         rows run along y: a block of slices is transposed
 *                          in small tiles, so that a cache line of the volume,
 *                          which holds a voxel of each of up to 64 slices, is
 *                          read once for all of them
 */
#ifndef SNOW_FETCH_H
#define SNOW_FETCH_H

#include "classify/classify.h"
#include "simd/isa.h"

/* --- transpose.c: tiles of a plane of voxels ---

 * Lines of a tile, and bytes of a line: a cache line. */
#define SNOW_TILE_LINES 64
#define SNOW_TILE_BYTES 64

/* Value n of line u, for all 64 lines and 64 / size values, goes to position u
 * of row n: from in + stride u + size n to out + pitch n + size u. The tile at
 * `next`, which has the same stride, is prefetched. */
typedef void snow_transpose_fn(const unsigned char *in, size_t stride,
                               unsigned char *out, size_t pitch,
                               const unsigned char *next);

/* The instance for values of `size` bytes (1, 2, 4, 8); `isa` is resolved. */
snow_transpose_fn *snow_transpose_of(size_t size, snow_isa isa);

/* --- fetch.c --- */

/* Native voxels: each row is contiguous, and the next begins `stride` bytes
 * later. Voxels needed next, for prefetching, lie `ahead` bytes further; 0 if
 * there are none. */
typedef struct snow_rows {
    const unsigned char *voxels;
    size_t stride, ahead;
    size_t columns, rows;
} snow_rows;

/* The source of one band's rows, for one thread. */
typedef struct snow_fetch {
    const unsigned char *voxels; /* the band's first row, first slice */
    size_t column_step, row_step, slice_step; /* bytes in the volume */
    snow_type type;
    size_t size;          /* of a voxel */
    size_t columns, rows; /* of the band */
    int64_t slices;       /* of the slab */
    bool transposed;
    snow_transpose_fn *transpose;
    /* The block: `capacity` slices, `pitch` bytes from row to row. */
    size_t pitch, slice_pitch;
    int64_t capacity, block_first, block_count;
    unsigned char *block;
} snow_fetch;

/* The source of a band. */
typedef struct snow_fetch_params {
    const snow_volume *volume;
    const snow_placement *placement;
    int64_t first_slice, slices; /* the slab */
    int64_t first_row, rows;     /* the band */
    snow_isa isa;                /* resolved */
} snow_fetch_params;

/* Bytes of scratch that a band needs. */
size_t snow_fetch_bytes(const snow_fetch_params *params);

/* Sets up for a band; the scratch, aligned to 64, belongs to the caller. */
void snow_fetch_begin(snow_fetch *fetch, const snow_fetch_params *params,
                      void *scratch);

/* The band's rows of slice `slice` of the slab. Call it for the slices in
 * order. The rows are valid until the next call. */
void snow_fetch_slice(snow_fetch *fetch, int64_t slice, snow_rows *out);

#endif
