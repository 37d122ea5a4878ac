/* encode/transpose.h - transposes tiles of a plane of voxels. */
#ifndef SNOW_ENCODE_TRANSPOSE_H
#define SNOW_ENCODE_TRANSPOSE_H

#include "simd/isa.h"

/* Lines of a tile, and bytes of a line: a cache line. */
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

#endif
