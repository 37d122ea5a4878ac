/* composite/tile_perspective.c - the tile functions for all instruction sets,
 * in perspective. */
#include "composite/tile_perspective.h"

#define SELECT_SCALAR
#include "simd/select.h"

#include "composite/tile_perspective_isa.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "composite/tile_perspective_isa.h"
#define SELECT_AVX512
#include "simd/select.h"

#include "composite/tile_perspective_isa.h"
#endif

snow_perspective_tile_fn *snow_perspective_tile_of(snow_isa isa, int channels) {
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return channels == 2 ? ray_tile2_avx512 : ray_tile4_avx512;
    if (isa == SNOW_ISA_AVX2)
        return channels == 2 ? ray_tile2_avx2 : ray_tile4_avx2;
#endif
    (void)isa;
    return channels == 2 ? ray_tile2_scalar : ray_tile4_scalar;
}
