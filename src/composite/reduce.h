/* composite/reduce.h - what takes the place of over in other modes (model,
 * point 8): a sheet changes the image in an order that does not matter.
 *
 * A sheet's pixel is (n, w): the sum of its voxels' weighted values, and that
 * of their weights.  Values are of 0 to 1 here (modes.h).  A pixel of the image
 * begins as zeros and is
 *
 *   mip        (largest n / w of the sheets with w >= 1/2, 1), or (0, 0) while
 *              there is none; minip is the same of negated values
 *   mean, sum  (sum of n, sum of w) */
#ifndef SNOW_REDUCE_H
#define SNOW_REDUCE_H

#include "composite/over.h"

/* From this weight on a sheet's value is known: 1/2, less a margin, so that
 * rounding does not decide in the many views where a weight is just 1/2. */
#define SNOW_WEIGHT_ENOUGH 0.499f

/* The loop of a mode other than over and iso, for two channels. */
snow_over_fn *snow_reduce_of(snow_mode mode);

#endif
