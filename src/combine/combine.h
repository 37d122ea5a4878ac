/* combine/combine.h - combination (Cb in figure 7): the local images of slabs
 * become one picture. */
#ifndef SNOW_COMBINE_H
#define SNOW_COMBINE_H

#include "composite/over.h"

/* Combines the local images of `parts` processors, given from front to back,
 * into the first, by the paper's hierarchical scheme (lines 14 to 20 of figure
 * 8): in round i processor p with p mod 2^(i+1) = 0 receives the image of p +
 * 2^i and composites it behind its own; log2(parts) rounds, rounded up.
 * `pixels` is the number of pixels of each image; the other images are
 * destroyed. */
void snow_combine_tree(float *const *images, int parts, size_t pixels,
                       int channels);

#endif
