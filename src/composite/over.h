/* composite/over.h - composition (Cp in figure 7): sheets into the image,
 * front to back, by Porter and Duff's over; premultiplied, linear as stored. */
#ifndef SNOW_OVER_H
#define SNOW_OVER_H

#include "splat/splat.h"

#include <snowglass/render.h>

/* front += (1 - front.alpha) * back, for `count` pixels of `channels` floats,
 * alpha last. */
void snow_over_row(float *front, const float *back, size_t count, int channels);

/* The same for one number of channels. */
typedef void snow_over_fn(float *front, const float *back, size_t count);

/* The loop of a level (resolved) for 2 or 4 channels; all give the same bits.
 */
snow_over_fn *snow_over_pick(snow_isa isa, int channels);

/* Lays a sheet behind what the image holds so far, row by row with `lay`, which
 * is for their number of channels, and clears the sheet.  They have one size.
 */
void snow_lay_sheet(float *image, snow_sheet *sheet, snow_over_fn *lay);

#endif
