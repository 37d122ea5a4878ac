/* splat/separable/rows.c - the loops of splat/separable/rows.h, for each
 * instruction set. */
#include "splat/separable/rows.h"

#include <string.h>

#define TEMPLATE "splat/separable/rows.tmpl.h"
#include "simd/each_isa.h"

const snow_row_fns *snow_row_fns_of(snow_isa isa) {
    return SNOW_OF_ISA(isa, &row_fns);
}
