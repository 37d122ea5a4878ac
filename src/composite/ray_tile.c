/* composite/ray_tile.c - the tile functions of all levels in perspective. */
#include "composite/ray_tile.h"

#define SELECT_SCALAR
#include "simd/select.h"

#include "composite/ray_tile_levels.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "composite/ray_tile_levels.h"
#define SELECT_AVX512
#include "simd/select.h"

#include "composite/ray_tile_levels.h"
#endif

snow_ray_tile_fn *snow_ray_tile_of(snow_isa isa, int channels) {
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return channels == 2 ? ray_tile2_avx512 : ray_tile4_avx512;
    if (isa == SNOW_ISA_AVX2)
        return channels == 2 ? ray_tile2_avx2 : ray_tile4_avx2;
#endif
    (void)isa;
    return channels == 2 ? ray_tile2_scalar : ray_tile4_scalar;
}
