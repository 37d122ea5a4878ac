/* composite/projection.h - the projections that replace over in other modes
 * (docs/model.md): a sheet changes the image, and the order of sheets has no
 * effect.
 *
 * A sheet's pixel is (n, w): the sum of its voxels' weighted values, and that
 * of their weights. Values are from 0 to 1 here (render/modes/modes.h). A pixel
 * of the image begins as zeros and is
 *
 *   mip        (largest n / w of the sheets with w >= 1/2, 1), or (0, 0) if
 *              there is none; minip is the same for negated values
 *   mean, sum  (sum of n, sum of w) */
#ifndef SNOW_COMPOSITE_PROJECTION_H
#define SNOW_COMPOSITE_PROJECTION_H

#include "composite/over.h"

/* From this weight on a sheet's value counts: 1/2, less a margin, so that
 * rounding has no effect in the many views where a weight is exactly 1/2. */
#define SNOW_WEIGHT_ENOUGH 0.499f

/* The loops, and that of a mode other than over and iso, for two channels. */
void snow_keep_largest(float *restrict image, const float *restrict sheet,
                       size_t count);
void snow_add_up(float *restrict image, const float *restrict sheet,
                 size_t count);
snow_composite_fn *snow_projection_op_of(snow_mode mode);

#endif
