/* composite/over.h - composition (Cp in figure 7): composites sheets into the
 * image, front to back, with Porter and Duff's over operator. Pixels are
 * premultiplied, in the linear space of their stored values. */
#ifndef SNOW_OVER_H
#define SNOW_OVER_H

#include "splat/splat.h"

#include <snowglass/render.h>

/* front += (1 - front.alpha) * back, for `count` pixels of `channels` floats,
 * alpha last. */
void snow_over_row(float *front, const float *back, size_t count, int channels);

/* The same for one number of channels. */
typedef void snow_composite_fn(float *front, const float *back, size_t count);

/* The loop of an instruction set (resolved) for 2 or 4 channels; all give the
 * same bits. */
snow_composite_fn *snow_over_pick(snow_isa isa, int channels);

/* Composites a sheet behind the image, row by row with `composite`, which must
 * fit their number of channels, and clears the sheet. Both have the same size.
 */
void snow_composite_sheet(float *image, snow_sheet *sheet,
                          snow_composite_fn *composite);

#endif
