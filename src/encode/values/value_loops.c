/* encode/values/value_loops.c - the loops over rows of numbers and stored
 * values, of each instruction set (value_rows.tmpl.h). */
#include "encode/values/value_encode.h"

#include "simd/rows.h"

#define TEMPLATE "encode/values/value_rows.tmpl.h"
#include "simd/each_isa.h"

const snow_value_loops *snow_value_loops_of(snow_isa isa) {
    return SNOW_OF_ISA(isa, &loops);
}
