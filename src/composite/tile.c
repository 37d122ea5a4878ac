/* composite/tile.c - the tile functions for all instruction sets. */
#include "composite/tile.h"

#include <string.h>

#define SELECT_SCALAR
#include "simd/select.h"

#include "composite/tile_isa.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "composite/tile_isa.h"
#define SELECT_AVX512
#include "simd/select.h"

#include "composite/tile_isa.h"
#endif

snow_tile_fn *snow_tile_of(snow_isa isa, int channels) {
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return channels == 2 ? tile2_avx512 : tile4_avx512;
    if (isa == SNOW_ISA_AVX2)
        return channels == 2 ? tile2_avx2 : tile4_avx2;
#endif
    (void)isa;
    return channels == 2 ? tile2_scalar : tile4_scalar;
}

void snow_tile_clear(float *pixels, size_t count, int channels) {
    size_t step = (size_t)channels;
    memset(pixels, 0, count * step * sizeof *pixels);
    for (size_t i = 0; i < count; i++)
        pixels[i * step + step - 1] = -1;
}

void snow_tile_finish(float *pixels, size_t count, int channels) {
    size_t step = (size_t)channels;
    for (size_t i = 0; i < count; i++)
        pixels[i * step + step - 1] += 1;
}
