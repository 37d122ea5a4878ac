/* classify/sample.c - the table-to-sample loops of all levels (model, points 3,
 * 4 and 6): colour = min(1, c * factor + white) times opacity. */
#include "classify/sample.h"

#include <string.h>

/* By bytes of a code, channels, and how: plain, shaded, and both faded. */
typedef snow_sample_fn *snow_sample_table[2][2][4];

/* Copies as many numbers as a window of so many places can hold: a length that
 * is that of the row would often be guessed wrong. */
#define SAMPLE_COPY(to, from, count)                          \
    do {                                                      \
        memcpy(to, from, 32 * sizeof *(to));                  \
        if ((count) > 32)                                     \
            memcpy((to) + 32, (from) + 32,                    \
                   (SNOW_SAMPLE_MARGIN - 32) * sizeof *(to)); \
    } while (0)

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
                               bool shaded, bool faded) {
    int bytes = code_bytes == 2, color = channels == 4;
    int how = shaded + 2 * faded;
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return samples_avx512[bytes][color][how];
    if (isa == SNOW_ISA_AVX2)
        return samples_avx2[bytes][color][how];
#endif
    (void)isa;
    return samples_scalar[bytes][color][how];
}
