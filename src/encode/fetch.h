/* encode/fetch.h - the rows of a slice as contiguous native values, whichever
 * way the volume is cut.
 *
 *   slices along z and y   rows run along x and lie in the volume as they are
 *   slices along x         rows run along y: a block of slices is transposed
 *                          in small tiles, so that a cache line of the volume,
 *                          which holds a voxel of each of up to 64 slices, is
 *                          read once for all of them
 *
 * and of the slice half-way between two, whose voxels are the means of theirs
 * (of integers, halves rounded up). */
#ifndef SNOW_FETCH_H
#define SNOW_FETCH_H

#include "classify/classify.h"
#include "encode/rows.h"
#include "encode/tiles.h"

/* Where the rows of one band come from, for one thread. */
typedef struct snow_fetch {
    const unsigned char *voxels; /* the band's first row, first slice */
    size_t column_step, row_step, slice_step; /* bytes in the volume */
    snow_type type;
    size_t size;          /* of a voxel */
    size_t columns, rows; /* of the band */
    int64_t slices;       /* of the slab */
    bool between, transposed;
    snow_transpose_fn *transpose;
    /* The block: `room` slices, `pitch` bytes from row to row. */
    size_t pitch, slice_pitch;
    int64_t room, block_first, block_count;
    unsigned char *block, *mean;
} snow_fetch;

/* What a band is cut from. */
typedef struct snow_fetch_order {
    const snow_volume *volume;
    const snow_placement *placement;
    int64_t first_slice, slices; /* the slab */
    int64_t first_row, rows;     /* the band */
    bool between;
    snow_isa isa; /* resolved */
} snow_fetch_order;

/* Bytes of scratch that a band needs. */
size_t snow_fetch_bytes(const snow_fetch_order *order);

/* Sets up for a band; the scratch is aligned to 64 and stays the caller's. */
void snow_fetch_begin(snow_fetch *fetch, const snow_fetch_order *order,
                      void *scratch);

/* The band's rows of slice `slice` of the slab; with `between` of the doubled
 * slices.  Slices are asked for in order.  Valid until the next call. */
void snow_fetch_slice(snow_fetch *fetch, int64_t slice, snow_rows *out);

#endif
