/* splat/shear_warp/splat_scalar.c - tiles in plain C; see splat.c. */
/* Where there are no vectors little is won by it. */
#define VALUE_INLINE static inline __attribute__((unused))

#include "simd/rows.h"
#include "splat/shear_warp/scratch.h"

#include <string.h>

#define SELECT_SCALAR
#include "simd/select.h"

#include "splat/shear_warp/tile.tmpl.h"
