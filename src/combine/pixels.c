/* combine/pixels.c - the loops of pixels.h for every instruction set, and the
 * choice of one. */
#include "combine/active.h"

#define TEMPLATE "combine/pixels_isa.h"
#include "simd/each_isa.h"

/* For 2 channels and each snow_composite_op, and for 4. */
const snow_pixel_loops *snow_pixels_pick(snow_isa isa, int channels,
                                         snow_composite_op composite_op) {
    isa = snow_isa_resolve(isa);
    const snow_pixel_loops *const loops[] = {
        SNOW_OF_ISA(isa, &loops_over2), SNOW_OF_ISA(isa, &loops_most2),
        SNOW_OF_ISA(isa, &loops_sum2), SNOW_OF_ISA(isa, &loops_over4)};
    return loops[channels == 2 ? (int)composite_op : 3];
}
