/* splat/shear_warp/splat_avx2.c - tiles in AVX2; see splat.c. */
#include "simd/rows.h"
#include "splat/shear_warp/scratch.h"

#include <string.h>

#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "splat/shear_warp/tile.tmpl.h"
#endif
