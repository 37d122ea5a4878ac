/* transfer/scale.c - see scale.h. */
#include "transfer/scale.h"

#include "base/exp_log.h"

#include <math.h>

static double between(double low, double high, double share) {
    if (share >= 1)
        return high;
    double value = isfinite(high - low) ? low + share * (high - low)
                                        : low * (1 - share) + high * share;
    return value < high ? value : high;
}

double snow_scale_place(snow_scale scale, double value) {
    if (scale.log)
        return snow_log2_rising(value);
    double size = fabs(value) / scale.linear;
    if (size > 1)
        size = 1 + SNOW_LN2 * snow_log2_rising(size);
    return copysign(size, value);
}

double snow_scale_value(snow_scale scale, double place) {
    if (scale.log)
        return snow_exp2(place);
    double size = fabs(place);
    if (size > 1)
        size = snow_exp2((size - 1) / SNOW_LN2);
    return copysign(size * scale.linear, place);
}

static bool is_linear(snow_scale scale) {
    return !scale.log && !(scale.linear > 0);
}

double snow_between_on(snow_scale scale, double low, double high,
                       double share) {
    if (is_linear(scale) || share >= 1)
        return between(low, high, share);
    if (share == 0)
        return low;
    double from = snow_scale_place(scale, low),
           to = snow_scale_place(scale, high);
    double value = snow_scale_value(scale, from + share * (to - from));
    return value < high ? value : high;
}

double snow_share_on(snow_scale scale, double low, double high, double value) {
    if (!is_linear(scale)) {
        double from = snow_scale_place(scale, low);
        return (snow_scale_place(scale, value) - from) /
               (snow_scale_place(scale, high) - from);
    }
    /* Uses halves if the range exceeds the largest double. */
    double half = isfinite(high - low) ? 1 : 0.5;
    return (half * value - half * low) / (half * high - half * low);
}

double snow_round_below(double length) {
    double ten = pow(10, floor(log10(length)));
    double share = length / ten * (1 + 1e-9);
    return ten * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}
