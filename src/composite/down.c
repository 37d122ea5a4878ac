/* composite/down.c - the line function for each level. */
#include "composite/down.h"

#define SELECT_SCALAR
#include "simd/select.h"
#define DOWN_CHANNELS 2
#define DOWN_ALPHA V(alpha2)
#define DOWN_NAME(part) NAME(down2##part)
#include "composite/down.tmpl.h"
#define DOWN_CHANNELS 4
#define DOWN_ALPHA V(alpha4)
#define DOWN_NAME(part) NAME(down4##part)
#include "composite/down.tmpl.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"
#define DOWN_CHANNELS 2
#define DOWN_ALPHA V(alpha2)
#define DOWN_NAME(part) NAME(down2##part)
#include "composite/down.tmpl.h"
#define DOWN_CHANNELS 4
#define DOWN_ALPHA V(alpha4)
#define DOWN_NAME(part) NAME(down4##part)
#include "composite/down.tmpl.h"
#define SELECT_AVX512
#include "simd/select.h"
#define DOWN_CHANNELS 2
#define DOWN_ALPHA V(alpha2)
#define DOWN_NAME(part) NAME(down2##part)
#include "composite/down.tmpl.h"
#define DOWN_CHANNELS 4
#define DOWN_ALPHA V(alpha4)
#define DOWN_NAME(part) NAME(down4##part)
#include "composite/down.tmpl.h"
#endif

snow_down_fn *snow_down_of(snow_isa isa, int channels) {
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return channels == 2 ? down2_avx512 : down4_avx512;
    if (isa == SNOW_ISA_AVX2)
        return channels == 2 ? down2_avx2 : down4_avx2;
#endif
    (void)isa;
    return channels == 2 ? down2_scalar : down4_scalar;
}
