/* composite/projection.c - the loops of composite/projection.h. */
#include "composite/projection.h"

/* Without branches, so that compilers can vectorize it. Values are never
 * negative; an image begins as zeros. */
void snow_keep_largest(float *restrict image, const float *restrict sheet,
                       size_t count) {
    for (size_t i = 0; i < count; i++) {
        bool known = sheet[2 * i + 1] >= SNOW_WEIGHT_ENOUGH;
        float weight = known ? sheet[2 * i + 1] : 1;
        float value = known ? sheet[2 * i] / weight : 0;
        image[2 * i] = value > image[2 * i] ? value : image[2 * i];
        image[2 * i + 1] = known ? 1 : image[2 * i + 1];
    }
}

void snow_add_up(float *restrict image, const float *restrict sheet,
                 size_t count) {
    for (size_t i = 0; i < 2 * count; i++)
        image[i] += sheet[i];
}

snow_composite_fn *snow_projection_op_of(snow_mode mode) {
    return mode == SNOW_MODE_MIP || mode == SNOW_MODE_MINIP ? snow_keep_largest
                                                            : snow_add_up;
}
