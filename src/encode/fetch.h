/* encode/fetch.h - the rows of a slice as contiguous native values, whichever
 * way the volume is cut.
 *
 *   slices along z and y   rows run along x and lie in the volume as they are
 *   slices along x         rows run along y: a block of slices is transposed
 *                          in small tiles, so that a cache line of the volume,
 *                          which holds a voxel of each of 64 slices, is read
 *                          once for all of them
 *
 * and of the slice half-way between two, whose voxels are the means of theirs.
 */
#ifndef SNOW_FETCH_H
#define SNOW_FETCH_H

#include "classify/classify.h"

/* Bytes that a line of the volume gives to a tile. */
#define SNOW_FETCH_LINE 64

/* Where the rows of one band come from, for one thread. */
typedef struct snow_fetch {
    const snow_volume *volume;
    const snow_placement *placement;
    size_t size;                 /* of a voxel */
    int64_t first_row, rows;     /* the band */
    int64_t first_slice, slices; /* the slab */
    bool transposed;
    bool between;
    size_t pitch; /* bytes from row to row in the block */
    int64_t block_slices, block_first, block_count; /* what the block holds */
    unsigned char *block, *mean;
} snow_fetch;

/* Bytes of scratch that a band of `rows` rows needs. */
size_t snow_fetch_bytes(const snow_volume *volume,
                        const snow_placement *placement, int64_t rows,
                        bool between);

/* Sets up for a band; the scratch is aligned to 64 and stays the caller's. */
void snow_fetch_begin(snow_fetch *fetch, const snow_volume *volume,
                      const snow_placement *placement, int64_t first_slice,
                      int64_t slices, int64_t first_row, int64_t rows,
                      bool between, void *scratch);

/* Row `row` of the band, of slice `slice` of the slab; with fetch->between of
 * the doubled slices.  Slices are asked for in order.  Valid until the next
 * call. */
const void *snow_fetch_row(snow_fetch *fetch, int64_t slice, int64_t row);

#endif
