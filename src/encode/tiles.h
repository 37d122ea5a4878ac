/* encode/tiles.h - tiles of a plane of voxels, transposed. */
#ifndef SNOW_TILES_H
#define SNOW_TILES_H

#include "simd/isa.h"

/* Lines of a tile, and bytes of a line: a cache line. */
#define SNOW_TILE_LINES 64
#define SNOW_TILE_BYTES 64

/* Value n of line u, for all 64 lines and 64 / size values, goes to place u of
 * row n: in + stride u + size n to out + pitch n + size u.  The tile at `next`,
 * which has the same stride, will be asked for next: it is fetched into the
 * cache. */
typedef void snow_transpose_fn(const unsigned char *in, size_t stride,
                               unsigned char *out, size_t pitch,
                               const unsigned char *next);

/* The instance for values of `size` bytes (1, 2, 4, 8); `isa` is resolved. */
snow_transpose_fn *snow_transpose_of(size_t size, snow_isa isa);

#endif
