/* transfer/automatic.c - makes a transfer function from the histogram.
 *
 * A first picture should show the object, not the air around it, as a surface
 * that can be shaded, and show denser parts inside as denser.  The threshold
 * between background and object is Otsu's (N. Otsu, "A threshold selection
 * method from gray-level histograms", IEEE Trans. SMC 9, 1979) on a histogram
 * with robust ends.  Some additions were found by looking at many volumes:
 *
 *   - If the "object" is most of the volume there was no background at all; the
 *     upper part is then split once more.
 *   - If the values form one cluster, the threshold explains little variance,
 *     and the upper part is no small share, the object fills the volume (a
 *     cut-out of a brain, for example).  There are no surfaces then, and the
 *     faces of the block show most: all is nearly solid, black to white over
 *     all values, and unshaded.  The same holds for volumes of few slices.
 *     Where voxels are left out, by a mask, their border is the surface.
 *     Values that reach as far below 0 as above are densities about a mean (of
 *     proteins), whose upper part is what matters.
 *   - A CT in Hounsfield units gets the preset for bone or for soft tissue: its
 *     values say what they are.  A slice is shown over its file's own window.
 *   - Structure below the threshold (leaves, lung vessels, smoke) is kept as a
 *     faint veil, from Otsu's threshold of the lower part on, if it is sparse;
 *     otherwise it would be fog.
 *
 *   opacity                                    ___--- 0.8 at the top
 *                                     ___---
 *                             .---'   0.4 at the object's mean
 *                  ...-------'        0.25 a little above the threshold
 *   ______.....---'                   0.05 at it, 0 at the faint threshold */
#include "transfer/look.h"

#include <math.h>
#include <string.h>

#define BINS 1024

/* Robust ends of the histogram: 0.2 % and 0.5 % are cut off.  Padding at the
 * smallest value is ignored at the top if it is more than a quarter, so that a
 * vessel of 1 % of the voxels is not cut off. */
#define CUT_LOW 0.002
#define CUT_HIGH 0.005
#define PADDING 0.25

/* If more of the volume than this is above the threshold, there is no
 * background. */
#define MOST_OBJECT 0.6

/* The values form one cluster if Otsu's threshold explains no more than this
 * share of the variance (a normal distribution: 0.64, a uniform one 0.75), and
 * at least this share of the volume lies above it. */
#define ONE_HEAP 0.70
#define UPPER_PART 0.25

/* Values that reach below 0 by this share of their reach above it. */
#define ABOUT_0 0.25

/* A veil is drawn if the object, and the veil itself, are at most these shares
 * of the volume. */
#define VEIL_OBJECT 0.4
#define VEIL_MOST 0.2

/* The grey where opacity starts, as in the colour map light-grey: below it,
 * shading would make skin look black. */
#define DARKEST (0xa6 / 255.0)

/* White without light on it, as in the colour map dim-grey: below 250 of 255.
 */
#define LIGHTEST (0xf7 / 255.0)

typedef struct split {
    double at;           /* the threshold, in bins */
    double below, above; /* mean bin on each side */
} split;

/* Finds Otsu's threshold in bins first..last-1: the greatest variance between
 * the two parts.  If several cuts are equally good (a gap in the histogram) the
 * middle one is used.  Returns false if all counts are in one bin. */
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

/* The share of the variance of all values that the two parts explain, 0 to
 * 1. */
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

/* `there` is the share of the volume that has values: what a mask leaves out is
 * background, too. */
static void read_counts(const uint64_t *counts, uint64_t all, double there,
                        snow_scale scale, double low, double high,
                        snow_histogram_split *out) {
    split s = {0}, veil = {0};
    out->top = out->high = high;
    out->low = low;
    if (!part_bins(counts, 0, BINS, &s)) {
        out->constant = true;
        return;
    }
    out->fills_volume = fills_volume(counts, all, &s, low, high);
    for (int tries = 0; tries < 3; tries++) {
        split upper = {0};
        if (there * share_of(counts, (int)s.at, BINS, all) < MOST_OBJECT ||
            !part_bins(counts, (int)s.at, BINS, &upper))
            break;
        s = upper;
    }
    out->background = snow_between_on(scale, low, high, s.below / BINS);
    out->threshold = snow_between_on(scale, low, high, s.at / BINS);
    out->object = snow_between_on(scale, low, high, s.above / BINS);
    if (there * share_of(counts, (int)s.at, BINS, all) > VEIL_OBJECT ||
        !part_bins(counts, 0, (int)s.at, &veil))
        return;
    out->faint = snow_between_on(scale, low, high, veil.at / BINS);
    out->with_faint =
        there * share_of(counts, (int)veil.at, (int)s.at, all) <= VEIL_MOST &&
        out->faint < out->threshold;
}

/* Where so many voxels have no value, as those outside a mask, they are the
 * background. */
#define LEFT_OUT 0.02

/* The share of the voxels that have values; 1 where only clip planes have left
 * out others: these cut the object and its background alike. */
static double share_there(const snow_histogram *histogram) {
    snow_extent part;
    if (histogram->clipped && !histogram->masked)
        return 1;
    snow_volume_find_extent(histogram->volume, &part);
    double all =
        (double)part.dims[0] * (double)part.dims[1] * (double)part.dims[2];
    return (double)(histogram->finite + histogram->dropped) / all;
}

static bool is_left(const snow_histogram *histogram) {
    return share_there(histogram) < 1 - LEFT_OUT;
}

/* Narrows the ends to a window; values beyond it count as those at its ends. */
static snow_status narrow(const snow_histogram *histogram,
                          const double window[2], double ends[2],
                          uint64_t *counts, bool *narrowed) {
    uint64_t above = 0, all, inside = 0;
    const double low = fmax(ends[0], window[0]),
                 high = fmin(ends[1], window[1]);
    if (!(low < high) || (low == ends[0] && high == ends[1]))
        return SNOW_STATUS_OK;
    ends[0] = low;
    ends[1] = high;
    if (high < histogram->max)
        SNOW_TRY(
            snow_count_bins(histogram, high, histogram->max, 1, &above, &all));
    SNOW_TRY(snow_count_bins(histogram, low, high, BINS, counts, &all));
    for (int i = 0; i < BINS; i++)
        inside += counts[i];
    above = above < all - inside ? above : all - inside;
    counts[BINS - 1] += above;
    counts[0] += all - inside - above;
    *narrowed = true;
    return SNOW_STATUS_OK;
}

snow_status snow_histogram_split_at(const snow_histogram *histogram,
                                    const double *window,
                                    snow_histogram_split *out) {
    *out =
        (snow_histogram_split){.constant = !(histogram->min < histogram->max)};
    if (out->constant)
        return SNOW_STATUS_OK;
    double padding = (double)histogram->at_min / (double)histogram->finite;
    if (padding <= PADDING)
        padding = 0;
    const double shares[2] = {CUT_LOW, 1 - CUT_HIGH * (1 - padding)};
    double ends[2];
    SNOW_TRY(
        snow_quantiles(histogram, SNOW_HISTOGRAM_SAMPLED, shares, 2, ends));
    if (!(ends[0] < ends[1])) {
        ends[0] = histogram->min;
        ends[1] = histogram->max;
    }
    uint64_t counts[BINS], all;
    SNOW_TRY(snow_count_bins(histogram, ends[0], ends[1], BINS, counts, &all));
    if (window)
        SNOW_TRY(narrow(histogram, window, ends, counts, &out->narrowed));
    read_counts(counts, all, is_left(histogram) ? share_there(histogram) : 1,
                histogram->scale, ends[0], ends[1], out);
    return SNOW_STATUS_OK;
}

static void build_grey(snow_transfer_builder *builder, const char *name,
                       double low, double high, double dark, double light) {
    builder->name = name;
    builder->low = low;
    builder->high = high;
    builder->color_count = 2;
    builder->colors[0] = (snow_color_point){low, dark, dark, dark};
    builder->colors[1] = (snow_color_point){high, light, light, light};
}

/* One slice is drawn as a picture that shows everything but its darkest values,
 * which are air around a body; of measures it shows all.  Several slices are
 * solid but let some light through. */
static void build_solid(const snow_histogram *histogram,
                        const snow_histogram_split *p, bool slice,
                        snow_transfer_builder *builder) {
    const snow_scale scale = histogram->scale;
    build_grey(builder, "dim-grey", p->low, p->high, 0, LIGHTEST);
    builder->unshaded = true;
    if (slice && snow_are_measures(histogram)) {
        snow_transfer_builder_add_opacity(builder, p->low, 1);
        snow_transfer_builder_add_opacity(builder, p->high, 1);
        return;
    }
    snow_transfer_builder_add_opacity(builder, p->low, 0);
    if (slice) {
        snow_transfer_builder_add_opacity(
            builder, snow_between_on(scale, p->low, p->high, 0.05), 0);
        snow_transfer_builder_add_opacity(
            builder, snow_between_on(scale, p->low, p->high, 0.06), 1);
        return;
    }
    snow_transfer_builder_add_opacity(
        builder, snow_between_on(scale, p->low, p->high, 0.15), 0);
    snow_transfer_builder_add_opacity(
        builder, snow_between_on(scale, p->low, p->high, 0.30), 0.30);
    snow_transfer_builder_add_opacity(builder, p->high, 0.70);
}

/* The number of axes with one voxel: 1 is a slice, 2 a row. */
static int axes_of_one(const snow_volume *volume) {
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    return (part.dims[0] == 1) + (part.dims[1] == 1) + (part.dims[2] == 1);
}

/* Two to five slices, each of 16 times as many rows and columns, are no more of
 * a body than one: shading would show their noise. */
bool snow_is_slice(const snow_volume *volume) {
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    const int64_t *n = part.dims;
    const int64_t least =
        n[0] < n[1] ? (n[0] < n[2] ? n[0] : n[2]) : (n[1] < n[2] ? n[1] : n[2]);
    return axes_of_one(volume) == 1 ||
           (least > 1 && least <= 5 &&
            (n[0] >= 16 * least) + (n[1] >= 16 * least) +
                    (n[2] >= 16 * least) ==
                2);
}

/* For a volume whose voxels all have one value, or none finite. */
static void build_constant(const snow_histogram *histogram,
                           snow_transfer_builder *builder) {
    double low, high;
    snow_full_range(histogram, &low, &high);
    build_grey(builder, "dim-grey", low, high, 0, LIGHTEST);
    builder->unshaded = true;
    snow_transfer_builder_add_opacity(builder, low, 0);
    snow_transfer_builder_add_opacity(builder, high, 0.8);
    builder->reason = "one value only";
}

/* Bins of 100 Hounsfield units, from -1100 on. */
#define BINS_HU 40
#define BIN_HU(value) (((value) + 1100) / 100)

/* The preset for a CT in Hounsfield units: for bone, if that is 0.5 % of the
 * body, else, and for a slab, of which only rings would be left, for soft
 * tissue; -1 for other volumes.  Of what names no modality
 * 2 % have to be air. */
static snow_status hounsfield_preset(const snow_histogram *histogram,
                                     int *preset) {
    const snow_volume_info *info = &histogram->volume->info;
    uint64_t counts[BINS_HU], all;
    if (histogram->scale.log ||
        !snow_are_hounsfield(info, histogram->min, histogram->max))
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_count_bins(histogram, -1100, 2900, BINS_HU, counts, &all));
    double air = share_of(counts, 0, BIN_HU(-900), all);
    double body = share_of(counts, BIN_HU(-200), BINS_HU, all);
    double bone = share_of(counts, BIN_HU(300), BINS_HU, all);
    /* A slab is seen from its face, which is a cut. */
    snow_volume_info whole;
    snow_volume_whole(histogram->volume, &whole);
    const bool slab = snow_volume_thin_axis(&whole) >= 0;
    if (body > 0 && (*info->modality || air >= 0.02))
        *preset = snow_preset_from_name(
            bone >= 0.005 * body && !slab ? "ct-bone" : "ct-soft");
    return SNOW_STATUS_OK;
}

/* Whether the look is that of a field, and of one of both signs. */
static snow_status find_field(const snow_histogram *histogram,
                              const snow_look *look,
                              const snow_histogram_split *p, bool *field,
                              bool *is_signed) {
    double reach;
    bool is_scan;
    *field = snow_is_field(histogram) && axes_of_one(histogram->volume) == 0 &&
             !look->base && !look->preset;
    if (!*field)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_is_signed_field(histogram, is_signed, &reach));
    SNOW_TRY(snow_is_scan(histogram, p->low, p->high, *is_signed, &is_scan));
    *field = !is_scan;
    return SNOW_STATUS_OK;
}

/* The preset of that name, with its reason. */
static snow_status build_preset(const snow_histogram *histogram, int preset,
                                const char *note,
                                snow_transfer_builder *builder) {
    builder->reason = builder->preset = snow_preset_name((size_t)preset);
    strcpy(builder->range_note, note);
    return snow_transfer_builder_points(snow_preset_look((size_t)preset),
                                        histogram, builder);
}

/* Quantiles, or those of the values times -1. */
static snow_status quantiles_of(const snow_histogram *histogram, bool mirrored,
                                const double *shares, size_t count,
                                double *out) {
    double of[3];
    for (size_t i = 0; i < count; i++)
        of[i] = mirrored ? 1 - shares[i] : shares[i];
    SNOW_TRY(snow_quantiles(histogram, SNOW_HISTOGRAM_SAMPLED, of, count, out));
    for (size_t i = 0; i < count && mirrored; i++)
        out[i] = 0 - out[i];
    return SNOW_STATUS_OK;
}

/* The split of the values times -1. */
static snow_status split_mirrored(const snow_histogram *histogram,
                                  snow_histogram_split *out) {
    uint64_t counts[BINS], all;
    SNOW_TRY(snow_count_bins(histogram, histogram->min, histogram->max, BINS,
                             counts, &all));
    const double there = is_left(histogram) ? share_there(histogram) : 1;
    double padding = share_of(counts, BINS - 1, BINS, all), ends[2];
    padding = padding > PADDING ? padding : 0;
    const double shares[2] = {CUT_LOW, 1 - CUT_HIGH * (1 - padding)};
    SNOW_TRY(quantiles_of(histogram, true, shares, 2, ends));
    if (!(ends[0] < ends[1])) {
        ends[0] = -histogram->max;
        ends[1] = -histogram->min;
    }
    SNOW_TRY(
        snow_count_bins(histogram, -ends[1], -ends[0], BINS, counts, &all));
    for (int i = 0; i < BINS / 2; i++) {
        const uint64_t count = counts[i];
        counts[i] = counts[BINS - 1 - i];
        counts[BINS - 1 - i] = count;
    }
    *out = (snow_histogram_split){.constant = false};
    read_counts(counts, all, there, histogram->scale, ends[0], ends[1], out);
    return SNOW_STATUS_OK;
}

/* A few values are left out at the top of a field. */
#define FIELD_TOP 0.9995

/* Where the middle one of the values is so far from the lowest, there is no
 * background, and the upper half is shown, however few values are high. */
#define MIDDLE 0.05

static snow_status lower_to_middle(const snow_histogram *histogram,
                                   const snow_histogram_split *p, bool mirrored,
                                   double top, double at[3]) {
    const double shares[] = {0.5, 0.75, 0.95};
    double q[3];
    SNOW_TRY(quantiles_of(histogram, mirrored, shares, 3, q));
    for (int i = 0; i < 3 && q[0] >= snow_between_on(histogram->scale, p->low,
                                                     top, MIDDLE);
         i++)
        at[i] = fmin(at[i], q[i]);
    return SNOW_STATUS_OK;
}

/* Fields have no surfaces to shade: a veil through which one sees denser parts,
 * in colours that show the values.  Where all is one cluster its lower half is
 * clear.  `p` is the split of the values, or of those times -1. */
static snow_status build_field(const snow_histogram *histogram,
                               const snow_histogram_split *p, bool mirrored,
                               snow_transfer_builder *builder) {
    static const double opacities[] = {0, 0.025, 0.08, 0.5};
    const double share = FIELD_TOP;
    double top, at[4] = {0, p->threshold, p->object, 0};
    SNOW_TRY(quantiles_of(histogram, mirrored, &share, 1, &top));
    at[3] = top = p->narrowed ? p->top : fmax(top, p->top);
    at[0] = p->with_faint ? p->faint
                          : snow_between_on(histogram->scale, p->background,
                                            p->threshold, 0.6);
    for (int i = 0; i < 3 && p->fills_volume; i++)
        at[i] = snow_between_on(histogram->scale, p->low, top, 0.45 + 0.15 * i);
    SNOW_TRY(lower_to_middle(histogram, p, mirrored, top, at));
    builder->name = builder->colormap = mirrored ? "viridis_r" : "viridis";
    builder->unshaded = true;
    builder->low = mirrored ? 0 - top : at[0];
    builder->high = mirrored ? 0 - at[0] : top;
    for (int i = 0; i < 4; i++) {
        const int point = mirrored ? 3 - i : i;
        snow_transfer_builder_add_opacity(
            builder, mirrored ? 0 - at[point] : at[point], opacities[point]);
    }
    return SNOW_STATUS_OK;
}

/* Below 0 a field is what stands out downward. */
static snow_status build_any_field(const snow_histogram *histogram,
                                   const snow_histogram_split *p,
                                   snow_transfer_builder *builder) {
    snow_histogram_split own = *p;
    bool mirrored = false;
    if (!p->narrowed)
        SNOW_TRY(snow_is_field_below_0(histogram, &mirrored));
    if (mirrored)
        SNOW_TRY(split_mirrored(histogram, &own));
    return build_field(histogram, own.constant ? p : &own,
                       mirrored && !own.constant, builder);
}

/* Where a file without modality has a window, as NIfTI's cal_min and cal_max,
 * the look of its body is made of the values in it; that of a scan is made for
 * slices, which are drawn over it. */
static snow_status split_within_window(const snow_histogram *histogram,
                                       const snow_look *look,
                                       snow_transfer_builder *builder,
                                       snow_histogram_split *out) {
    double window[2];
    bool is = false;
    if (look->range == SNOW_RANGE_AUTO && !*histogram->volume->info.modality &&
        !snow_is_slice(histogram->volume))
        SNOW_TRY(
            snow_window_of(histogram, builder, &window[0], &window[1], &is));
    SNOW_TRY(snow_histogram_split_at(histogram, is ? window : NULL, out));
    if (!out->narrowed)
        builder->range_note[0] = 0; /* the window is wider than the values */
    return SNOW_STATUS_OK;
}

snow_status snow_transfer_builder_automatic(const snow_histogram *histogram,
                                            const snow_look *look,
                                            snow_transfer_builder *builder) {
    snow_scale scale = histogram->scale;
    snow_histogram_split p;
    SNOW_TRY(split_within_window(histogram, look, builder, &p));
    builder->reason = "from the histogram";
    builder->opacity_count = 0;
    if (p.constant) {
        build_constant(histogram, builder);
        return SNOW_STATUS_OK;
    }
    bool slice = snow_is_slice(histogram->volume), shown;
    int preset = -1;
    p.low = snow_hounsfield_floor(histogram, p.low);
    if (slice)
        SNOW_TRY(snow_window_of(histogram, builder, &p.low, &p.high, &shown));
    else if (look->range == SNOW_RANGE_AUTO && !p.fills_volume)
        SNOW_TRY(hounsfield_preset(histogram, &preset));
    if (preset >= 0)
        return build_preset(histogram, preset, ", for Hounsfield units",
                            builder);
    bool is_signed = false, field;
    SNOW_TRY(find_field(histogram, look, &p, &field, &is_signed));
    if (look->range == SNOW_RANGE_VALUES)
        is_signed = is_signed && look->low < 0 && look->high > 0;
    if (field && is_signed)
        return build_preset(histogram, snow_preset_from_name("signed"),
                            ", for both signs", builder);
    if (field && !look->opacities)
        return build_any_field(histogram, &p, builder);
    if (p.fills_volume && !slice && histogram->masked && is_left(histogram)) {
        /* All that is left, with its surface. */
        build_grey(builder, "light-grey", p.low, p.high, DARKEST, 1);
        snow_transfer_builder_add_opacity(builder, p.low, 0.5);
        snow_transfer_builder_add_opacity(builder, p.high, 0.8);
        return SNOW_STATUS_OK;
    }
    if (slice || p.fills_volume) {
        build_solid(histogram, &p, slice, builder);
        return SNOW_STATUS_OK;
    }
    builder->unshaded = axes_of_one(histogram->volume) > 1;
    double start = p.with_faint
                       ? p.faint
                       : snow_between_on(scale, p.background, p.threshold, 0.6);
    snow_transfer_builder_add_opacity(builder, start, 0);
    if (p.with_faint)
        snow_transfer_builder_add_opacity(builder, p.threshold, 0.05);
    snow_transfer_builder_add_opacity(
        builder, snow_between_on(scale, p.threshold, p.object, 0.15), 0.25);
    snow_transfer_builder_add_opacity(builder, p.object, 0.4);
    snow_transfer_builder_add_opacity(builder, p.top, 0.8);
    build_grey(builder, "light-grey", start,
               builder->opacities[builder->opacity_count - 1].value, DARKEST,
               1);
    return SNOW_STATUS_OK;
}
