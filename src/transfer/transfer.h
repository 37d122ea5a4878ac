/* transfer/transfer.h - the private record of a transfer function. */
#ifndef SNOW_TRANSFER_TRANSFER_H
#define SNOW_TRANSFER_TRANSFER_H

#include "base/base.h"

#include <snowglass/transfer.h>

#define SNOW_TRANSFER_TEXT_BYTES 512

struct snow_transfer {
    snow_context *context;
    snow_color_point *colors; /* values do not decrease */
    size_t color_count;       /* at least 1 */
    snow_opacity_point *opacities;
    size_t opacity_count;
    const char *preset; /* that was chosen for a volume; NULL: none */
    bool unshaded;      /* made for pictures without shading */
    bool log;      /* interpolated in the logarithm of values, all above 0 */
    double linear; /* above 0: points follow a symmetric logarithm (scale.h) */
    double white;  /* above 0: the ground of the colours that it is a part of */
    snow_opacity_point *gradients; /* factors by gradient magnitude */
    size_t gradient_count;         /* 0: no gradient opacity */
    snow_label *labels;            /* whose colours these are, or NULL */
    size_t label_count;
    bool grey;                           /* red = green = blue everywhere */
    char text[SNOW_TRANSFER_TEXT_BYTES]; /* a description for people: */
    size_t
        look_bytes; /* its length without the gradient opacity, which follows */
};

/* Opacity alone, since most voxels need no more; and colour alone.  The value
 * is not NaN. */
double snow_transfer_opacity(const snow_transfer *transfer, double value);
void snow_transfer_color(const snow_transfer *transfer, double value,
                         double rgb[3]);

/* Writes the description of the look and of the gradient opacity to the
 * text. */
void snow_transfer_describe(snow_transfer *transfer, const char *chosen);

/* Adds points, so that straight lines between them follow a symmetric logarithm
 * from `linear` on; 0: none.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_transfer_refine(snow_transfer *transfer, double linear);

/* Both, for a value that is not NaN, equal to snow_transfer_evaluate, but
 * faster for values in order.  The hint begins as zeros and is passed on. */
typedef struct snow_transfer_hint {
    size_t color, opacity; /* points at or before the last value */
} snow_transfer_hint;

void snow_transfer_near(const snow_transfer *transfer, double value,
                        snow_transfer_hint *hint, double rgba[4]);

/* Returns whether values are labels: whole numbers that are shown in colours
 * of categories, without any in between. */
bool snow_transfer_has_labels(const snow_transfer *transfer,
                              const snow_volume_info *info);

/* What gradients a picture wants besides those of shading; and of labels, which
 * are smooth and look farther. */
#define SNOW_SLOPES_FADE 1
#define SNOW_SLOPES_WIDE 2
int snow_transfer_slopes(const snow_transfer *transfer,
                         const snow_volume_info *info);

/* What is left of a mixed colour, whose darkest part `least` is multiplied by
 * its opacity: nothing as bright as a white ground, all of black, as of what
 * takes light away.  Lengths that follow one another make that of their sum. */
double snow_white_share(double white, double least, double opacity);

/* So that rounding never decides whether a voxel is above the threshold. */
#define SNOW_THRESHOLD_MARGIN 0.0001

/* Returns whether a voxel of this opacity is above a threshold of 0 to 255
 * (model, section 3). */
static inline bool snow_is_interesting(double opacity, double threshold) {
    return opacity > 0 && (!(threshold > 0) ||
                           255 * opacity > threshold + SNOW_THRESHOLD_MARGIN);
}

#endif
