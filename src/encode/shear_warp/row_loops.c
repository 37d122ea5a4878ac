/* encode/shear_warp/row_loops.c - the loops over rows of quantized values and
 * stored values, of each instruction set (encode/shear_warp/rows.tmpl.h). */
#include "encode/shear_warp/encode.h"

#include "simd/rows.h"

#define TEMPLATE "encode/shear_warp/rows.tmpl.h"
#include "simd/each_isa.h"

const snow_value_loops *snow_value_loops_of(snow_isa isa) {
    return SNOW_OF_ISA(isa, &loops);
}
