/* splat/values/value_splat_scalar.c - tiles in plain C; see value_splat.c. */
/* Where there are no vectors little is won by it. */
#define VALUE_INLINE static inline __attribute__((unused))

#include "simd/rows.h"
#include "splat/values/value_room.h"

#include <string.h>

#define SELECT_SCALAR
#include "simd/select.h"

#include "splat/values/tile.tmpl.h"
