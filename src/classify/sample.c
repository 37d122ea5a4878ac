/* classify/sample.c - the table-to-sample loops of all levels (model, points 3,
 * 4 and 6): colour = min(1, c * factor + white) times opacity. */
#include "classify/sample.h"

#include <string.h>

/* By bytes of a code, channels, and whether shaded. */
typedef snow_sample_fn *snow_sample_table[2][2][2];

#define SELECT_SCALAR
#include "simd/select.h"

#include "classify/sample_levels.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "classify/sample_levels.h"
#define SELECT_AVX512
#include "simd/select.h"

#include "classify/sample_levels.h"
#endif

snow_sample_fn *snow_sample_of(snow_isa isa, int code_bytes, int channels,
                               bool shaded) {
    int bytes = code_bytes == 2, color = channels == 4;
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return samples_avx512[bytes][color][shaded];
    if (isa == SNOW_ISA_AVX2)
        return samples_avx2[bytes][color][shaded];
#endif
    (void)isa;
    return samples_scalar[bytes][color][shaded];
}
