/* classify/hidden.c - see hidden.h.
 *
 *   opacity       /\            between two points it changes in proportion, so
 *               _/  \__         that a range ends at the last point that is not
 *   ___________/       \____    interesting
 *   <-- low -->         <-->
 */
#include "classify/hidden.h"

#include <math.h>

static bool is_hidden_at(const snow_transfer *t, double threshold, size_t n) {
    return !snow_is_interesting(t->opacities[n].opacity, threshold);
}

int snow_hidden_ranges(const snow_transfer *t, const snow_volume_info *info,
                       double threshold, double spare,
                       snow_hidden_range out[SNOW_HIDDEN_MOST]) {
    const size_t points = t->opacity_count;
    int count = 0;
    if (t->log || t->linear > 0 || snow_transfer_has_labels(t, info))
        return 0;
    for (size_t n = 0; n < points && count < SNOW_HIDDEN_MOST; n++) {
        if (!is_hidden_at(t, threshold, n))
            continue;
        snow_hidden_range range = {-INFINITY, INFINITY};
        if (n > 0)
            range.low = t->opacities[n].value + spare;
        while (n + 1 < points && is_hidden_at(t, threshold, n + 1))
            n++;
        if (n + 1 < points)
            range.high = t->opacities[n].value - spare;
        if (range.low <= range.high)
            out[count++] = range;
    }
    return count;
}

bool snow_is_hidden(const snow_transfer *transfer, const snow_volume_info *info,
                    double threshold, double spare, double low, double high) {
    snow_hidden_range ranges[SNOW_HIDDEN_MOST];
    const int count =
        snow_hidden_ranges(transfer, info, threshold, spare, ranges);
    for (int n = 0; n < count; n++)
        if (ranges[n].low <= low && ranges[n].high >= high)
            return true;
    return false;
}
