/* classify/transfer.h - the inside of a transfer function. */
#ifndef SNOW_TRANSFER_H
#define SNOW_TRANSFER_H

#include "base/base.h"

#include <snowglass/transfer.h>

#define SNOW_TRANSFER_TEXT_BYTES 256

struct snow_transfer {
    snow_context *context;
    snow_color_point *colors; /* values do not fall */
    size_t color_count;       /* at least 1 */
    snow_opacity_point *opacities;
    size_t opacity_count;
    bool grey;                           /* red = green = blue everywhere */
    char text[SNOW_TRANSFER_TEXT_BYTES]; /* what was chosen, for people */
};

/* Opacity alone: most voxels need no more; and colour alone, of a value that
 * is not NaN. */
double snow_transfer_opacity(const snow_transfer *transfer, double value);
void snow_transfer_color(const snow_transfer *transfer, double value,
                         double rgb[3]);

/* So that rounding never decides whether a voxel is above the threshold. */
#define SNOW_THRESHOLD_MARGIN 0.0001

/* Whether a voxel of this opacity is above a threshold of 0 to 255 (model,
 * point 3). */
static inline bool snow_is_interesting(double opacity, double threshold) {
    return opacity > 0 && (!(threshold > 0) ||
                           255 * opacity > threshold + SNOW_THRESHOLD_MARGIN);
}

#endif
