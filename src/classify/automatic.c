/* classify/automatic.c - the look that the histogram suggests.
 *
 * A first picture should show the object, not the air around it, as a surface
 * that can be shaded, and show what is denser inside as denser.  The threshold
 * between background and object is Otsu's (N. Otsu, "A threshold selection
 * method from gray-level histograms", IEEE Trans. SMC 9, 1979) on a histogram
 * whose ends are robust.  Two additions were found by looking at many volumes:
 *
 *   - When the "object" is most of the volume there was no background at all;
 *     the upper part is then parted once more.
 *   - Structure below the threshold (leaves, lung vessels, smoke) is kept as a
 *     faint veil from Otsu's threshold of the lower part on, provided that it
 *     is sparse; else it would be fog.
 *
 *   opacity                                    ___--- 0.8 at the top
 *                                     ___---
 *                             .---'   0.4 at the object's mean
 *                  ...-------'        0.25 a little above the threshold
 *   ______.....---'                   0.05 at it, 0 at the faint threshold
 */
#include "classify/look.h"

#include <math.h>

#define BINS 1024

/* Robust ends of the histogram: 0.2 % and 0.5 % are cut off.  Padding at the
 * smallest value is left out of account at the top when it is more than a
 * quarter, so that a vessel of 1 % of the voxels is not cut off. */
#define CUT_LOW 0.002
#define CUT_HIGH 0.005
#define PADDING 0.25

/* More of the volume than this above the threshold: no background there. */
#define MOST_OBJECT 0.6

/* A veil is drawn when the object is at most, and the veil itself at most,
 * this share of the volume. */
#define VEIL_OBJECT 0.4
#define VEIL_MOST 0.2

/* Grey where opacity starts: below it shading would make skin look black. */
#define DARKEST 0.65

typedef struct split {
    double at;           /* the threshold, in bins */
    double below, above; /* mean bin on each side */
} split;

/* Otsu's threshold in bins first..last-1: the greatest variance between the
 * two parts.  Where several cuts are equally good (a gap in the histogram) the
 * middle one is taken.  False when all counts are in one bin. */
static bool part_bins(const uint64_t *counts, int first, int last, split *out) {
    double all = 0, moment = 0, weight = 0, sum = 0, best = -1;
    int from = 0, to = 0;
    for (int i = first; i < last; i++) {
        all += (double)counts[i];
        moment += (double)counts[i] * (i + 0.5);
    }
    for (int i = first; i + 1 < last; i++) {
        weight += (double)counts[i];
        sum += (double)counts[i] * (i + 0.5);
        if (weight <= 0 || weight >= all)
            continue;
        double gap = moment * weight - sum * all;
        double variance = gap / all * (gap / all) / (weight * (all - weight));
        if (variance > best) {
            best = variance;
            from = i;
            out->below = sum / weight;
            out->above = (moment - sum) / (all - weight);
        }
        if (variance >= best)
            to = i;
    }
    out->at = (from + to) / 2.0 + 1;
    return best >= 0;
}

static double share_of(const uint64_t *counts, int first, int last,
                       uint64_t all) {
    double sum = 0;
    for (int i = first; i < last; i++)
        sum += (double)counts[i];
    return sum / (double)all;
}

static void read_counts(const uint64_t *counts, uint64_t all, bool log,
                        double low, double high, snow_parting *out) {
    split s = {0}, veil = {0};
    out->top = high;
    if (!part_bins(counts, 0, BINS, &s)) {
        out->constant = true;
        return;
    }
    for (int tries = 0; tries < 3; tries++) {
        split upper = {0};
        if (share_of(counts, (int)s.at, BINS, all) < MOST_OBJECT ||
            !part_bins(counts, (int)s.at, BINS, &upper))
            break;
        s = upper;
    }
    out->background = snow_between_on(log, low, high, s.below / BINS);
    out->threshold = snow_between_on(log, low, high, s.at / BINS);
    out->object = snow_between_on(log, low, high, s.above / BINS);
    if (share_of(counts, (int)s.at, BINS, all) > VEIL_OBJECT ||
        !part_bins(counts, 0, (int)s.at, &veil))
        return;
    out->faint = snow_between_on(log, low, high, veil.at / BINS);
    out->with_faint =
        share_of(counts, (int)veil.at, (int)s.at, all) <= VEIL_MOST &&
        out->faint < out->threshold;
}

snow_status snow_part_histogram(const snow_census *census, snow_parting *out) {
    snow_parting parting = {0};
    if (!(census->min < census->max)) {
        parting.constant = true;
        *out = parting;
        return SNOW_OK;
    }
    double padding = (double)census->at_min / (double)census->finite;
    if (padding <= PADDING)
        padding = 0;
    const double shares[2] = {CUT_LOW, 1 - CUT_HIGH * (1 - padding)};
    double ends[2];
    SNOW_TRY(snow_quantiles(census, SNOW_SAMPLED, shares, 2, ends));
    if (!(ends[0] < ends[1])) {
        ends[0] = census->min;
        ends[1] = census->max;
    }
    uint64_t counts[BINS], all;
    SNOW_TRY(snow_count_bins(census, ends[0], ends[1], BINS, counts, &all));
    read_counts(counts, all, census->log, ends[0], ends[1], &parting);
    *out = parting;
    return SNOW_OK;
}

/* Appends a point, not below the one before it. */
static void add_opacity(snow_draft *draft, double value, double opacity) {
    size_t n = draft->opacity_count++;
    if (n && value < draft->opacities[n - 1].value)
        value = draft->opacities[n - 1].value;
    draft->opacities[n] = (snow_opacity_point){value, opacity};
}

static void draft_grey(snow_draft *draft, double low, double high) {
    draft->name = "grey";
    draft->low = low;
    draft->high = high;
    draft->color_count = 2;
    draft->colors[0] = (snow_color_point){low, DARKEST, DARKEST, DARKEST};
    draft->colors[1] = (snow_color_point){high, 1, 1, 1};
}

snow_status snow_draft_automatic(const snow_census *census, snow_draft *draft) {
    snow_parting p;
    SNOW_TRY(snow_part_histogram(census, &p));
    draft->reason = "from the histogram";
    draft->opacity_count = 0;
    if (p.constant) {
        double low, high;
        snow_full_range(census, &low, &high);
        draft_grey(draft, low, high);
        add_opacity(draft, low, 0);
        add_opacity(draft, high, 0.8);
        draft->reason = "one value only";
        return SNOW_OK;
    }
    double start = p.with_faint ? p.faint
                                : snow_between_on(census->log, p.background,
                                                  p.threshold, 0.6);
    add_opacity(draft, start, 0);
    if (p.with_faint)
        add_opacity(draft, p.threshold, 0.05);
    add_opacity(
        draft, snow_between_on(census->log, p.threshold, p.object, 0.15), 0.25);
    add_opacity(draft, p.object, 0.4);
    add_opacity(draft, p.top, 0.8);
    draft_grey(draft, start, draft->opacities[draft->opacity_count - 1].value);
    return SNOW_OK;
}
