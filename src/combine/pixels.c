/* combine/pixels.c - the loops of pixels.h on every level, and the choice of
 * one. */
#include "combine/active.h"

#include <string.h>

/* The order matters, so a blank line keeps the two from being sorted. */
#define SELECT_SCALAR
#include "simd/select.h"

#include "combine/pixels_levels.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "combine/pixels_levels.h"
#define SELECT_AVX512
#include "simd/select.h"

#include "combine/pixels_levels.h"
#endif

const snow_pixel_loops *snow_pixels_pick(snow_isa isa, int channels) {
#if SNOW_HAS_AVX
    switch (snow_isa_resolve(isa)) {
    case SNOW_ISA_AVX512:
        return channels == 2 ? &loops_2_avx512 : &loops_4_avx512;
    case SNOW_ISA_AVX2:
        return channels == 2 ? &loops_2_avx2 : &loops_4_avx2;
    default:
        break;
    }
#endif
    (void)isa;
    return channels == 2 ? &loops_2_scalar : &loops_4_scalar;
}
