/* encode/values/value_loops.c - the loops over rows of numbers and natives, of
 * each instruction set (value_rows.tmpl.h). */
#include "encode/values/value_encode.h"

#include "simd/rows.h"

#include <string.h>

#define TEMPLATE "encode/values/value_rows.tmpl.h"
#include "simd/each_isa.h"

const snow_value_loops *snow_value_loops_of(snow_isa isa) {
    static const snow_value_loops scalar = {outside_scalar, pack_scalar,
                                            outside_bytes_scalar,
                                            outside_words_scalar};
#if SNOW_HAS_AVX
    static const snow_value_loops avx2 = {
        outside_avx2, pack_avx2, outside_bytes_avx2, outside_words_avx2};
    static const snow_value_loops avx512 = {outside_avx512, pack_avx512,
                                            outside_bytes_avx512,
                                            outside_words_avx512};
    if (isa == SNOW_ISA_AVX512)
        return &avx512;
    if (isa == SNOW_ISA_AVX2)
        return &avx2;
#endif
    (void)isa;
    return &scalar;
}
