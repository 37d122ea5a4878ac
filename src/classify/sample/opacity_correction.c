/* classify/sample/opacity_correction.c - the loops of
 * classify/sample/opacity_correction.h for all instruction sets. */
#include "classify/sample/opacity_correction.h"

#include <string.h>

/* Indexed by bytes of a code, channels, shading and gradient opacity. */
typedef snow_ray_sample_fn *ray_table[2][2][2][2];

/* The positions in a window as floats, with a margin for vectors. */
static const float ray_places[SNOW_WINDOW_MOST + 17] = {
    0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
    16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31,
    32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47,
    48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60, 61, 62, 63,
    64, 65, 66, 67, 68, 69, 70, 71, 72, 73, 74, 75, 76, 77, 78, 79,
};

#define TEMPLATE "classify/sample/opacity_correction_isa.h"
#include "simd/each_isa.h"

snow_ray_sample_fn *snow_ray_sample_of(snow_isa isa, int code_bytes,
                                       int channels, bool shaded,
                                       bool with_gradient_opacity) {
    int bytes = code_bytes == 2, color = channels == 4;
    return SNOW_OF_ISA(
        isa, ray_samples)[bytes][color][shaded][with_gradient_opacity];
}
