/* transfer/refine.c - points so close that straight lines between them follow a
 * symmetric logarithm: renderers know no such scale.  With STEP the lines are
 * off by at most STEP^2 / 8 of a unit of the scale, and a look has more than
 * ten of these. */
#include "transfer/scale.h"
#include "transfer/transfer.h"

#include <math.h>
#include <string.h>

#define STEP 0.25

/* How many lines go from one value to the other. */
static size_t lines_between(double linear, double a, double b) {
    const snow_scale scale = {false, linear};
    double unit =
        snow_share_on(scale, 0, linear, b) - snow_share_on(scale, 0, linear, a);
    if (!(a < b) || (a >= -linear && b <= linear))
        return 1;
    return (size_t)fmin(fmax(ceil(unit / STEP), 1), 65536);
}

/* Points as rows of `width` numbers, of which the first is the value. */
static snow_status refine(snow_context *context, double linear, size_t width,
                          double **points, size_t *count) {
    const snow_scale scale = {false, linear};
    double *given = *points, *made = NULL, *at;
    size_t all = 1;
    for (size_t n = 0; n + 1 < *count; n++)
        all += lines_between(linear, given[n * width], given[(n + 1) * width]);
    SNOW_TRY(SNOW_RESERVE(context, made, 0, all * width));
    at = made;
    for (size_t n = 0; n + 1 < *count; n++) {
        const double *a = given + n * width, *b = a + width;
        size_t lines = lines_between(linear, *a, *b);
        for (size_t i = 0; i < lines; i++, at += width) {
            double share = (double)i / (double)lines;
            for (size_t c = 1; c < width; c++)
                at[c] = a[c] + share * (b[c] - a[c]);
            at[0] = snow_between_on(scale, *a, *b, share);
            at[0] = i ? fmax(at[0], *(at - width)) : *a;
        }
    }
    memcpy(at, given + (*count - 1) * width, width * sizeof *at);
    snow_release(context, given);
    *points = made;
    *count = all;
    return SNOW_STATUS_OK;
}

snow_status snow_transfer_refine(snow_transfer *t, double linear) {
    double *colors = (double *)t->colors, *opacities = (double *)t->opacities;
    if (!(linear > 0))
        return SNOW_STATUS_OK;
    t->linear = linear;
    snow_status status =
        refine(t->context, linear, sizeof *t->colors / sizeof *colors, &colors,
               &t->color_count);
    t->colors = (snow_color_point *)colors;
    if (status == SNOW_STATUS_OK)
        status =
            refine(t->context, linear, sizeof *t->opacities / sizeof *opacities,
                   &opacities, &t->opacity_count);
    t->opacities = (snow_opacity_point *)opacities;
    return status;
}
