/* render/slice.h - what pictures of several slices need of that of one. */
#ifndef SNOW_RENDER_SLICE_H
#define SNOW_RENDER_SLICE_H

#include "transform/transform.h"

/* Turns a view that faces a slice so that an axis of the slice is up.  The
 * lengths in the world across the picture and down it; returns the least
 * spacing. */
double snow_slice_measure(const snow_volume_info *info, int axis,
                          snow_view *view, double extent[2]);

/* The zoom with which a pixel has this length in the world. */
void snow_slice_scale(const snow_volume_info *info, double pitch,
                      snow_view *view);

#endif
