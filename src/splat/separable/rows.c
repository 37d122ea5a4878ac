/* splat/separable/rows.c - the loops of splat/separable/rows.h, for each
 * instruction set. */
#include "splat/separable/rows.h"

#include <string.h>

#define SELECT_SCALAR
#include "simd/select.h"

#include "splat/separable/rows.tmpl.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "splat/separable/rows.tmpl.h"
#define SELECT_AVX512
#include "simd/select.h"

#include "splat/separable/rows.tmpl.h"
#endif

const snow_row_fns *snow_row_fns_of(snow_isa isa) {
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return &row_fns_avx512;
    if (isa == SNOW_ISA_AVX2)
        return &row_fns_avx2;
#endif
    (void)isa;
    return &row_fns_scalar;
}
