/* splat/values/value_splat_avx512.c - tiles in AVX-512; see value_splat.c. */
#include "simd/rows.h"
#include "splat/values/value_room.h"

#include <string.h>

#if SNOW_HAS_AVX
#define SELECT_AVX512
#include "simd/select.h"

#include "splat/values/tile.tmpl.h"
#endif
