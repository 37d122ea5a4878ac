/* splat/values/value_splat_v128.c - tiles in NEON or in WebAssembly's vectors;
 * see value_splat.c. */
#include "simd/rows.h"
#include "splat/values/value_room.h"

#include <string.h>

#if SNOW_HAS_V128
#define SELECT_V128
#include "simd/select.h"

#include "splat/values/tile.tmpl.h"
#endif
