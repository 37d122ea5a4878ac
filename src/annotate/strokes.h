/* annotate/strokes.h - sizes that suit a picture, for what is drawn over it. */
#ifndef SNOW_ANNOTATE_STROKES_H
#define SNOW_ANNOTATE_STROKES_H

#include "image/overlay.h"

#include <math.h>

/* Smaller pictures than this have no room for bars. */
#define SNOW_BAR_SIDE_LEAST 128

/* Widths of strokes and of their borders, relative to the letters'
 * height. */
#define SNOW_STROKE 0.062
#define SNOW_BORDER 0.08

static inline double snow_shorter_side(const snow_overlay *overlay) {
    return fmin(overlay->width, overlay->height);
}

/* The height of the letters of numbers and names. */
static inline double snow_number_height(const snow_overlay *overlay) {
    return fmax(9, floor(0.022 * snow_shorter_side(overlay) + 0.5));
}

/* A legend stands in a strip at the right, so much of the width at least and at
 * most, and so far from its edges, in heights of its letters.  Below is room
 * for the scale bar. */
#define SNOW_STRIP_LEAST 0.12
#define SNOW_STRIP_MOST 0.5
#define SNOW_STRIP_MARGIN 0.6
#define SNOW_STRIP_BELOW 3.6

static inline snow_status snow_begin_strokes(snow_overlay *overlay,
                                             double height) {
    double radius = fmax(0.7, SNOW_STROKE * height);
    return snow_overlay_begin(overlay, radius,
                              radius + fmax(1, SNOW_BORDER * height));
}

#endif
