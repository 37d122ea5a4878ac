/* classify/sample/sample.c - the table-to-sample loops of all instruction sets
 * (model, points 3, 4 and 6): colour = min(1, c * factor + white) times
 * opacity. */
#include "classify/sample/sample.h"

#include <string.h>

/* Indexed by bytes of a code, channels, and variant: plain, shaded, and both
 * with gradient opacity. */
typedef snow_sample_fn *snow_sample_table[2][2][4];

/* Copies the largest number of values that a window of this width can hold. The
 * length of the row would cost mispredicted branches. */
#define SAMPLE_COPY(to, from, count)                          \
    do {                                                      \
        memcpy(to, from, 32 * sizeof *(to));                  \
        if ((count) > 32)                                     \
            memcpy((to) + 32, (from) + 32,                    \
                   (SNOW_SAMPLE_MARGIN - 32) * sizeof *(to)); \
    } while (0)

#define TEMPLATE "classify/sample/sample_isa.h"
#include "simd/each_isa.h"

snow_sample_fn *snow_sample_of(snow_isa isa, int code_bytes, int channels,
                               bool shaded, bool with_gradient_opacity) {
    int bytes = code_bytes == 2, color = channels == 4;
    int how = shaded + 2 * with_gradient_opacity;
    return SNOW_OF_ISA(isa, samples)[bytes][color][how];
}
