/* composite/over.h - composition (Cp in figure 7): composites sheets into the
 * image, front to back, with Porter and Duff's over operator. Pixels are
 * premultiplied, in the linear space of their stored values. */
#ifndef SNOW_OVER_H
#define SNOW_OVER_H

#include "splat/footprint/splat.h"

/* Lays `count` pixels behind others. */
typedef void snow_composite_fn(float *front, const float *back, size_t count);

/* front += (1 - front.alpha) * back; pixels of 2 or 4 floats, alpha last. */
snow_composite_fn *snow_over_of(int channels);

/* Composites a sheet behind the image, row by row with `composite`, which must
 * fit their number of channels, and clears the sheet. Both have one size. */
void snow_composite_sheet(float *image, snow_sheet *sheet,
                          snow_composite_fn *composite);

/* --- projections, which replace over in other modes ----------------------
 *
 * A sheet changes the image, and the order of sheets has no effect
 * (docs/model.md).
 *
 * A sheet's pixel is (n, w): the sum of its voxels' weighted values, and that
 * of their weights. Values are from 0 to 1 here (render/modes/modes.h). A pixel
 * of the image begins as zeros and is
 *
 *   mip        (largest n / w of the sheets with w >= 1/2, 1), or (0, 0) if
 *              there is none; minip is the same for negated values
 *   mean, sum  (sum of n, sum of w) */

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
