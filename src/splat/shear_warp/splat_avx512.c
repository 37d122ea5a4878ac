/* splat/shear_warp/splat_avx512.c - tiles in AVX-512; see splat.c. */
#include "simd/rows.h"
#include "splat/shear_warp/scratch.h"

#include <string.h>

#if SNOW_HAS_AVX
#define SELECT_AVX512
#include "simd/select.h"

#include "splat/shear_warp/tile.tmpl.h"
#endif
