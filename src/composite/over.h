/* composite/over.h - composition (Cp in figure 7): composites sheets into the
 * image, front to back, with Porter and Duff's over operator. Pixels are
 * premultiplied, in the linear space of their stored values. */
#ifndef SNOW_OVER_H
#define SNOW_OVER_H

#include "splat/splat.h"

#include <snowglass/render.h>

/* Lays `count` pixels behind others. */
typedef void snow_composite_fn(float *front, const float *back, size_t count);

/* front += (1 - front.alpha) * back; pixels of 2 or 4 floats, alpha last. */
snow_composite_fn *snow_over_of(int channels);

static inline void snow_over_row(float *front, const float *back, size_t count,
                                 int channels) {
    snow_over_of(channels)(front, back, count);
}

/* Composites a sheet behind the image, row by row with `composite`, which must
 * fit their number of channels, and clears the sheet. Both have one size. */
void snow_composite_sheet(float *image, snow_sheet *sheet,
                          snow_composite_fn *composite);

#endif
