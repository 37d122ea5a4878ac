/* transfer/evaluate.c - the opacity and colour of a value.
 *
 * Points are in rising order, so a value is looked up by bisection for the
 * first point beyond it.  If a value repeats, the value itself belongs to the
 * later point, and the step is above it.
 *
 * A logarithmic scale changes only the interpolation between points: positions
 * of values among points are compared as values, exactly. */
#include "transfer/transfer.h"

#include "base/exp_log.h"

#include <math.h>
#include <string.h>

/* The position of a value on the way from a to b on a logarithmic scale, 0 < a
 * < b, a <= value <= b: from 0 to 1, never decreasing; points with equal
 * logarithms are joined by a straight line. */
static double part_of_decades(double value, double a, double b) {
    double from = snow_log2_rising(a), to = snow_log2_rising(b);
    if (!(from < to))
        return (value - a) / (b - a);
    return (snow_log2_rising(value) - from) / (to - from);
}

double snow_white_share(double white, double least, double opacity) {
    const double ground = white * opacity;
    if (!(least < ground))
        return 0;
    if (!(least > 0))
        return 1;
    return snow_opacity_of(snow_clarity(opacity), 1 - least / ground) / opacity;
}

/* The position of `value` on the way from a to b, which differ; uses halves if
 * their distance exceeds the largest double. */
static double part_of_way(bool log, double value, double a, double b) {
    if (log)
        return part_of_decades(value, a, b);
    if (isfinite(b - a))
        return (value - a) / (b - a);
    return (value / 2 - a / 2) / (b / 2 - a / 2);
}

static double mix(double a, double b, double t) {
    return a + (b - a) * t;
}

/* The value of point n; points of both kinds, of `size` bytes, begin with
 * it. */
static inline double value_of(const void *points, size_t size, size_t n) {
    const char *first = points;
    return *(const double *)(const void *)(first + n * size);
}

/* The number of points at or before a value, which is not NaN; tries `guess`
 * first. */
static inline size_t points_up_to(const void *points, size_t size, size_t count,
                                  double value, size_t guess) {
    if ((guess == 0 || value_of(points, size, guess - 1) <= value) &&
        (guess == count || value_of(points, size, guess) > value))
        return guess;
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (value_of(points, size, middle) > value)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static inline double opacity_behind(const snow_opacity_point *points,
                                    size_t count, bool log, size_t up_to,
                                    double value) {
    if (up_to == 0)
        return points[0].opacity;
    if (up_to == count)
        return points[up_to - 1].opacity;
    double t =
        part_of_way(log, value, points[up_to - 1].value, points[up_to].value);
    return mix(points[up_to - 1].opacity, points[up_to].opacity, t);
}

static inline void color_behind(const snow_transfer *transfer, size_t up_to,
                                double value, double rgb[3]) {
    const snow_color_point *a = transfer->colors + (up_to ? up_to - 1 : 0);
    const snow_color_point *b = a;
    double t = 0;
    if (up_to > 0 && up_to < transfer->color_count) {
        b = a + 1;
        t = part_of_way(transfer->log, value, a->value, b->value);
    }
    rgb[0] = mix(a->red, b->red, t);
    rgb[1] = mix(a->green, b->green, t);
    rgb[2] = mix(a->blue, b->blue, t);
}

double snow_transfer_opacity(const snow_transfer *transfer, double value) {
    if (isnan(value) || (transfer->log && !(value > 0)))
        return 0;
    size_t up_to =
        points_up_to(transfer->opacities, sizeof *transfer->opacities,
                     transfer->opacity_count, value, 0);
    return opacity_behind(transfer->opacities, transfer->opacity_count,
                          transfer->log, up_to, value);
}

double snow_transfer_evaluate_gradient(const snow_transfer *transfer,
                                       double magnitude) {
    const snow_opacity_point *points = transfer->gradients;
    size_t count = transfer->gradient_count;
    if (!count)
        return 1;
    if (isnan(magnitude))
        return points[count - 1].opacity;
    size_t up_to = points_up_to(points, sizeof *points, count, magnitude, 0);
    return opacity_behind(points, count, false, up_to, magnitude);
}

void snow_transfer_color(const snow_transfer *transfer, double value,
                         double rgb[3]) {
    if (transfer->log && !(value > 0)) {
        memset(rgb, 0, 3 * sizeof *rgb);
        return;
    }
    size_t up_to = points_up_to(transfer->colors, sizeof *transfer->colors,
                                transfer->color_count, value, 0);
    color_behind(transfer, up_to, value, rgb);
}

void snow_transfer_near(const snow_transfer *transfer, double value,
                        snow_transfer_hint *hint, double rgba[4]) {
    if (transfer->log && !(value > 0)) {
        memset(rgba, 0, 4 * sizeof *rgba);
        return;
    }
    hint->color = points_up_to(transfer->colors, sizeof *transfer->colors,
                               transfer->color_count, value, hint->color);
    hint->opacity =
        points_up_to(transfer->opacities, sizeof *transfer->opacities,
                     transfer->opacity_count, value, hint->opacity);
    color_behind(transfer, hint->color, value, rgba);
    rgba[3] = opacity_behind(transfer->opacities, transfer->opacity_count,
                             transfer->log, hint->opacity, value);
}

void snow_transfer_evaluate(const snow_transfer *transfer, double value,
                            double rgba[4]) {
    memset(rgba, 0, 4 * sizeof *rgba);
    if (isnan(value))
        return;
    snow_transfer_hint hint = {0, 0};
    snow_transfer_near(transfer, value, &hint, rgba);
}

/* --- categories ----------------------------------------------------------- */

/* Returns whether values are the numbers of things rather than quantities: the
 * colours of categories have steps, and do not change in between. */
bool snow_transfer_has_labels(const snow_transfer *transfer,
                              const snow_volume_info *info) {
    const snow_color_point *c = transfer->colors;
    bool steps = false;
    for (size_t n = 1; n < transfer->color_count; n++) {
        if (c[n].red == c[n - 1].red && c[n].green == c[n - 1].green &&
            c[n].blue == c[n - 1].blue)
            continue;
        if (c[n].value != c[n - 1].value)
            return false;
        steps = true;
    }
    return steps &&
           (transfer->labels || info->whole || info->type < SNOW_TYPE_FLOAT32);
}

int snow_transfer_slopes(const snow_transfer *transfer,
                         const snow_volume_info *info) {
    return (transfer->gradient_count ? SNOW_SLOPES_FADE : 0) |
           (snow_transfer_has_labels(transfer, info) ? SNOW_SLOPES_WIDE : 0);
}
