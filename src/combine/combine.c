/* combine/combine.c - the combining tree of section 4, within one process. Over
 * is associative, so a tree gives the picture of a chain, except for float
 * rounding. The order of operations depends on the number of parts only. */
#include "combine/combine.h"

void snow_combine_tree(float *const *images, int parts, size_t pixels,
                       int channels) {
    for (int distance = 1; distance < parts; distance *= 2)
        for (int receiver = 0; receiver + distance < parts;
             receiver += 2 * distance)
            snow_over_row(images[receiver], images[receiver + distance], pixels,
                          channels);
}
