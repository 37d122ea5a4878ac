/* combine/pixels.c - the loops of pixels.h for every instruction set, and the
 * choice of one. */
#include "combine/active.h"

#include <string.h>

/* The order matters, so a blank line keeps the two from being sorted. */
#define SELECT_SCALAR
#include "simd/select.h"

#include "combine/pixels_isa.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "combine/pixels_isa.h"
#define SELECT_AVX512
#include "simd/select.h"

#include "combine/pixels_isa.h"
#endif

/* The loops of an instruction set: for 2 channels and each snow_composite_op,
 * and for 4. */
#define LOOPS(level)                                                     \
    {                                                                    \
        &loops_over2_##level, &loops_most2_##level, &loops_sum2_##level, \
            &loops_over4_##level                                         \
    }

const snow_pixel_loops *snow_pixels_pick(snow_isa isa, int channels,
                                         snow_composite_op composite_op) {
    static const snow_pixel_loops *const levels[][4] = {
        LOOPS(scalar),
#if SNOW_HAS_AVX
        LOOPS(avx2),
        LOOPS(avx512),
#endif
    };
    int level = 0;
#if SNOW_HAS_AVX
    isa = snow_isa_resolve(isa);
    level = isa == SNOW_ISA_AVX512 ? 2 : isa == SNOW_ISA_AVX2;
#endif
    (void)isa;
    return levels[level][channels == 2 ? (int)composite_op : 3];
}
