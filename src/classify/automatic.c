/* classify/automatic.c - the look that the histogram suggests.
 *
 * A first picture should show the object, not the air around it, as a surface
 * that can be shaded, and show what is denser inside as denser.  The threshold
 * between background and object is Otsu's (N. Otsu, "A threshold selection
 * method from gray-level histograms", IEEE Trans. SMC 9, 1979) on a histogram
 * whose ends are robust.  Some additions were found by looking at many volumes:
 *
 *   - When the "object" is most of the volume there was no background at all;
 *     the upper part is then parted once more.
 *   - When the values are one heap instead of two, with no threshold that
 *     explains much, and its upper part is no small share, the object fills the
 *     volume (a cut-out of a brain, say).  There are no surfaces then; the
 *     faces of the block show most: all is nearly solid, black to white over
 *     all values, and is best not shaded.  So are volumes of one slice.  Values
 *     that go as far below 0 as above are densities about a mean (of proteins),
 *     whose upper part is what matters.
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

/* Otsu's threshold explains so much of the variance of one heap of values (a
 * normal distribution: 0.64, an even one 0.75), and at least so much of the
 * volume lies above it. */
#define ONE_HEAP 0.70
#define UPPER_PART 0.25

/* Values that reach below 0 by this share of what they reach above it. */
#define ABOUT_0 0.25

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

/* How much of the variance of all values the two parts explain, 0 to 1. */
static double explained(const uint64_t *counts, const split *s) {
    double all = 0, moment = 0, square = 0;
    for (int i = 0; i < BINS; i++) {
        double count = (double)counts[i], at = i + 0.5;
        all += count;
        moment += count * at;
        square += count * at * at;
    }
    double mean = moment / all, variance = square / all - mean * mean;
    double between = (mean - s->below) * (s->above - mean);
    return variance > 0 ? between / variance : 1;
}

static bool fills_volume(const uint64_t *counts, uint64_t all, const split *s,
                         double low, double high) {
    return share_of(counts, (int)s->at, BINS, all) >= UPPER_PART &&
           explained(counts, s) < ONE_HEAP && low > -ABOUT_0 * high;
}

static void read_counts(const uint64_t *counts, uint64_t all, bool log,
                        double low, double high, snow_parting *out) {
    split s = {0}, veil = {0};
    out->top = out->high = high;
    out->low = low;
    if (!part_bins(counts, 0, BINS, &s)) {
        out->constant = true;
        return;
    }
    out->solid = fills_volume(counts, all, &s, low, high);
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

/* One slice: a picture, in which everything but its darkest is to be seen; or
 * more of them that are as solid as lets some light through. */
static void draft_solid(const snow_parting *p, bool slice, bool log,
                        snow_draft *draft) {
    draft_grey(draft, p->low, p->high);
    draft->colors[0].red = draft->colors[0].green = draft->colors[0].blue = 0;
    draft->flat = true;
    add_opacity(draft, p->low, 0);
    if (slice) {
        add_opacity(draft, snow_between_on(log, p->low, p->high, 0.05), 1);
        return;
    }
    add_opacity(draft, snow_between_on(log, p->low, p->high, 0.15), 0);
    add_opacity(draft, snow_between_on(log, p->low, p->high, 0.30), 0.30);
    add_opacity(draft, p->high, 0.70);
}

/* How many axes have one voxel: 1 is a slice, 2 a row. */
static int axes_of_one(const snow_census *census) {
    snow_part part;
    snow_volume_get_part(census->volume, &part);
    return (part.dims[0] == 1) + (part.dims[1] == 1) + (part.dims[2] == 1);
}

/* All voxels have one value, or none is finite. */
static void draft_constant(const snow_census *census, snow_draft *draft) {
    double low, high;
    snow_full_range(census, &low, &high);
    draft_grey(draft, low, high);
    add_opacity(draft, low, 0);
    add_opacity(draft, high, 0.8);
    draft->reason = "one value only";
    draft->flat = true;
}

snow_status snow_draft_automatic(const snow_census *census, snow_draft *draft) {
    bool log = census->log;
    snow_parting p;
    SNOW_TRY(snow_part_histogram(census, &p));
    draft->reason = "from the histogram";
    draft->opacity_count = 0;
    if (p.constant) {
        draft_constant(census, draft);
        return SNOW_OK;
    }
    if (p.solid || axes_of_one(census) == 1) {
        draft_solid(&p, axes_of_one(census) == 1, log, draft);
        return SNOW_OK;
    }
    draft->flat = axes_of_one(census) > 1;
    double start = p.with_faint
                       ? p.faint
                       : snow_between_on(log, p.background, p.threshold, 0.6);
    add_opacity(draft, start, 0);
    if (p.with_faint)
        add_opacity(draft, p.threshold, 0.05);
    add_opacity(draft, snow_between_on(log, p.threshold, p.object, 0.15), 0.25);
    add_opacity(draft, p.object, 0.4);
    add_opacity(draft, p.top, 0.8);
    draft_grey(draft, start, draft->opacities[draft->opacity_count - 1].value);
    return SNOW_OK;
}
