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

/* The height of the numbers beside bars. */
static inline double snow_number_height(const snow_overlay *overlay) {
    return fmax(9, floor(0.028 * snow_shorter_side(overlay) + 0.5));
}

static inline snow_status snow_begin_strokes(snow_overlay *overlay,
                                             double height) {
    double radius = fmax(0.7, SNOW_STROKE * height);
    return snow_overlay_begin(overlay, radius,
                              radius + fmax(1, SNOW_BORDER * height));
}

#endif
