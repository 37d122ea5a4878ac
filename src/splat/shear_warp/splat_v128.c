/* splat/shear_warp/splat_v128.c - tiles in SSE4.1, in NEON or in WebAssembly's
 * vectors; see splat/shear_warp/splat.c. */
#include "simd/rows.h"
#include "splat/shear_warp/scratch.h"

#include <string.h>

#if SNOW_HAS_V128
#define SELECT_V128
#include "simd/select.h"

#include "splat/shear_warp/tile.tmpl.h"
#endif
