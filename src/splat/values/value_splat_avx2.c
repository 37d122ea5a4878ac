/* splat/values/value_splat_avx2.c - tiles in AVX2; see value_splat.c. */
#include "simd/rows.h"
#include "splat/values/value_room.h"

#include <string.h>

#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "splat/values/tile.tmpl.h"
#endif
