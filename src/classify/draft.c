/* classify/draft.c - drafts of transfer functions: where values lie in a range,
 * on a plain or a logarithmic scale, and points that become a draft.
 *
 * Values of a draft never fall: rounding of logarithms is mended. */
#include "base/power.h"
#include "classify/look.h"

#include <math.h>
#include <string.h>

double snow_between(double low, double high, double share) {
    if (share >= 1)
        return high;
    double value = isfinite(high - low) ? low + share * (high - low)
                                        : low * (1 - share) + high * share;
    return value < high ? value : high;
}

double snow_between_on(bool log, double low, double high, double share) {
    if (!log || share >= 1)
        return snow_between(low, high, share);
    if (share == 0)
        return low;
    double from = snow_log2_rising(low), to = snow_log2_rising(high);
    double value = snow_exp2(from + share * (to - from));
    return value < high ? value : high;
}

double snow_share_on(bool log, double low, double high, double value) {
    if (log)
        return (snow_log2_rising(value) - snow_log2_rising(low)) /
               (snow_log2_rising(high) - snow_log2_rising(low));
    /* Halves, where the range is more than a double can hold. */
    double scale = isfinite(high - low) ? 1 : 0.5;
    return (scale * value - scale * low) / (scale * high - scale * low);
}

void snow_full_range(const snow_census *census, double *low, double *high) {
    *low = census->finite ? census->min : 0;
    *high = census->finite ? census->max : 1;
    if (census->log && !(*low > 0))
        *low = *high / 10;
    if (*low < *high)
        return;
    /* One value: what is above 0 shows, 0 and less is empty. */
    if (census->log)
        *low = *high / 10;
    else if (*high > 0)
        *low = 0;
    else
        *high = *low < 0 ? 0 : 1;
}

/* --- points ---------------------------------------------------------------
 */

/* From the end of the background to the brightest of the object. */
static snow_status object_range(const snow_census *census, double *low,
                                double *high) {
    snow_parting p;
    SNOW_TRY(snow_part_histogram(census, &p));
    snow_full_range(census, low, high);
    if (!p.constant) {
        *low = snow_between_on(census->log, p.background, p.threshold, 0.6);
        *high = p.top;
    }
    return SNOW_OK;
}

/* Points, whose values are shares of a range unless they are data. */
static void copy_colors(const snow_points *points, bool log, double low,
                        double high, snow_draft *draft) {
    bool shares = points->values != SNOW_VALUES_DATA;
    draft->color_count = points->color_count;
    for (size_t i = 0; i < points->color_count; i++) {
        draft->colors[i] = points->colors[i];
        if (shares)
            draft->colors[i].value =
                snow_between_on(log, low, high, points->colors[i].value);
    }
}

static void copy_opacities(const snow_points *points, bool log, double low,
                           double high, snow_draft *draft) {
    bool shares = points->values != SNOW_VALUES_DATA;
    draft->opacity_count = points->opacity_count;
    for (size_t i = 0; i < points->opacity_count; i++) {
        draft->opacities[i] = points->opacities[i];
        if (shares)
            draft->opacities[i].value =
                snow_between_on(log, low, high, points->opacities[i].value);
    }
}

/* Where colours alone belong: over all of what there are opacities for. */
static void widen(double value, double *low, double *high) {
    *low = value < *low ? value : *low;
    *high = value > *high ? value : *high;
}

/* The values that points in data units reach over. */
static void own_range(const snow_points *points, double *low, double *high) {
    *low = INFINITY;
    *high = -INFINITY;
    if (points->color_count) {
        widen(points->colors[0].value, low, high);
        widen(points->colors[points->color_count - 1].value, low, high);
    }
    if (points->opacity_count) {
        widen(points->opacities[0].value, low, high);
        widen(points->opacities[points->opacity_count - 1].value, low, high);
    }
}

snow_status snow_draft_points(const snow_points *points,
                              const snow_census *census, snow_draft *draft) {
    double low, high;
    if (points->values == SNOW_VALUES_OBJECT)
        SNOW_TRY(object_range(census, &low, &high));
    else if (points->values == SNOW_VALUES_RANGE)
        snow_full_range(census, &low, &high);
    else
        own_range(points, &low, &high);
    draft->name = points->name;
    draft->low = low;
    draft->high = high;
    if (points->color_count)
        copy_colors(points, census->log, low, high, draft);
    if (points->opacity_count)
        copy_opacities(points, census->log, low, high, draft);
    draft->gradient_count = points->gradient_count;
    if (points->gradient_count)
        memcpy(draft->gradients, points->gradients,
               points->gradient_count * sizeof *points->gradients);
    return SNOW_OK;
}
