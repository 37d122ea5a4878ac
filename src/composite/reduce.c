/* composite/reduce.c - the loops of composite/reduce.h. */
#include "composite/reduce.h"

/* Without branches, so that compilers make vectors of it.  Values are not below
 * 0, which is where an image begins. */
static void keep_largest(float *restrict image, const float *restrict sheet,
                         size_t count) {
    for (size_t i = 0; i < count; i++) {
        bool known = sheet[2 * i + 1] >= SNOW_WEIGHT_ENOUGH;
        float weight = known ? sheet[2 * i + 1] : 1;
        float value = known ? sheet[2 * i] / weight : 0;
        image[2 * i] = value > image[2 * i] ? value : image[2 * i];
        image[2 * i + 1] = known ? 1 : image[2 * i + 1];
    }
}

static void add_up(float *restrict image, const float *restrict sheet,
                   size_t count) {
    for (size_t i = 0; i < 2 * count; i++)
        image[i] += sheet[i];
}

snow_over_fn *snow_reduce_of(snow_mode mode) {
    return mode == SNOW_MODE_MIP || mode == SNOW_MODE_MINIP ? keep_largest
                                                            : add_up;
}
