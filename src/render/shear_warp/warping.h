/* render/shear_warp/warping.h - how the intermediate image of a picture is
 * warped. */
#ifndef SNOW_RENDER_SHEAR_WARP_WARPING_H
#define SNOW_RENDER_SHEAR_WARP_WARPING_H

#include "warp/warp.h"

typedef struct snow_shear_warp_warping snow_shear_warp_warping;

/* Pixels `from` to `to` - 1 of line y of the picture, whose pixel 0 is the
 * first of `pixels`; `spare` is for work. */
typedef void snow_show_line_fn(const snow_shear_warp_warping *warping, int y,
                               int from, int to, float *spare, float *pixels);

struct snow_shear_warp_warping {
    snow_intermediate_view plane;
    bool perspective;
    snow_shear shear;              /* or */
    snow_perspective_shear scaled; /* in perspective */
    snow_filter filter;
    snow_warp_fn *warp;
    snow_warp_places_fn *places; /* in perspective */
    int width, height;           /* of the picture */
    /* How many lines before and behind the one that a pixel is in its warp may
     * read; with one to spare for rounding. */
    int before, behind;
    /* Where pixels are means of many places; else NULL. */
    snow_show_line_fn *line;
    size_t spare_floats; /* of a thread */
    /* Called when all of the image, or all lines around a piece, are there;
     * NULL: nothing is to be done. */
    void (*made)(const snow_shear_warp_warping *warping);
    const void *of;
};

#endif
