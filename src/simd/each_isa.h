/* simd/each_isa.h - includes a template once for each instruction set, after
 * simd/select.h for it.  Define TEMPLATE, the template's name in quotes, before
 * including; it is undefined again. */
#define SELECT_SCALAR
#include "simd/select.h"

#include TEMPLATE
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include TEMPLATE
#define SELECT_AVX512
#include "simd/select.h"

#include TEMPLATE
#endif
#undef TEMPLATE
