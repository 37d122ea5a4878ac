/* transfer/overlay.c - the look of an overlay that is no labels.
 *
 * Maps of statistics are shown as those who make them do: what is far from 0,
 * on either side of it, over a body that shows through elsewhere.  How far is a
 * percentile of the magnitudes other than 0, which fill what was not analysed:
 *
 *   opacity   0.9 -.                       .- 0.9
 *                   `- 0.35         0.35 -'
 *                      |______0______|
 *               -top  -start      start  top
 *
 * Activities are seen where an SUV is that of tumours rather than of blood and
 * liver, and doses from 5 % of the most on, both translucent.  Other values
 * have the colours of hot. */
#include "transfer/look.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Bins of either sign, beside that of 0. */
#define BINS 1024

/* Percentiles of magnitudes: where opacities start, and where they end. */
#define START 95
#define TOP 99.9

/* SUV: where it is seen, and what is brightest; the same of a dose's most. */
#define UPTAKE 2.5
#define MOST_UPTAKE 7
#define DOSE 0.05

/* As of fields: the weaker sign reaches so far, relative to the other, and the
 * middle value is so near to 0. */
#define WEAKER 0.2
#define NEAR 0.3

/* Counts of values around 0. */
typedef struct magnitudes {
    uint64_t counts[2 * BINS + 1];
    uint64_t all, small; /* but those of 0; in the bin of 0 */
    double bin;          /* its width */
} magnitudes;

static double percentile(const magnitudes *m, double percent) {
    double sum = (double)m->small;
    for (int n = 1; n <= BINS; n++) {
        sum += (double)(m->counts[BINS - n] + m->counts[BINS + n]);
        if (100 * sum > percent * (double)m->all)
            return m->bin * (n - 0.5);
    }
    return m->bin * (BINS + 0.5);
}

/* Those of -most..most; returns all but those of the bin of 0. */
static snow_status count(const snow_histogram *histogram, double most,
                         magnitudes *m, uint64_t *beside) {
    uint64_t all;
    SNOW_TRY(
        snow_count_bins(histogram, -most, most, 2 * BINS + 1, m->counts, &all));
    *beside = 0;
    for (int n = 1; n <= BINS; n++)
        *beside += m->counts[BINS - n] + m->counts[BINS + n];
    return SNOW_STATUS_OK;
}

/* The bin of 0 is counted by itself first, since many voxels may be 0. */
static snow_status measure(const snow_histogram *histogram, magnitudes *m) {
    const double most = fmax(fabs(histogram->min), fabs(histogram->max));
    m->bin = 2 * most / (2 * BINS + 1);
    SNOW_TRY(count(histogram, m->bin / 2, m, &m->small));
    SNOW_TRY(count(histogram, most, m, &m->all));
    m->all += m->small;
    return SNOW_STATUS_OK;
}

/* The middle one of the values but 0 is near to it, seen from the top. */
static bool has_both_signs(const snow_histogram *histogram, const magnitudes *m,
                           double top) {
    const double weaker = fmin(-histogram->min, histogram->max);
    uint64_t sum = m->small / 2;
    int n = 0;
    for (; n < 2 * BINS && 2 * sum < m->all; n++)
        sum += n == BINS ? 0 : m->counts[n];
    return weaker >= WEAKER * top &&
           fabs((double)n - BINS) * m->bin <= NEAR * top;
}

static void build_statistics(const magnitudes *m, bool both,
                             snow_transfer_builder *builder) {
    const double start = percentile(m, START);
    const double top = fmax(percentile(m, TOP), start + m->bin);
    builder->opacity_count = 0;
    builder->low = both ? -top : 0;
    builder->high = top;
    if (both) {
        snow_transfer_builder_add_opacity(builder, -top, 0.9);
        snow_transfer_builder_add_opacity(builder, -start, 0.35);
        snow_transfer_builder_add_opacity(builder, -start, 0);
    }
    snow_transfer_builder_add_opacity(builder, start, 0);
    snow_transfer_builder_add_opacity(builder, start, 0.35);
    snow_transfer_builder_add_opacity(builder, top, 0.9);
    builder->unshaded = builder->around_0 = false;
    builder->preset = NULL;
    builder->colormap = both ? "seismic" : "hot";
    builder->reason = both ? "both signs" : "statistics";
    snprintf(builder->range_note, sizeof builder->range_note,
             ", from percentile %d of %s other than 0 on", START,
             both ? "magnitudes" : "values");
}

/* Values that mean something by their modality; false: these do not. */
static bool build_known(const snow_histogram *histogram, const snow_look *look,
                        snow_transfer_builder *builder) {
    const snow_volume_info *info = &histogram->volume->info;
    const bool dose = !strcmp(info->modality, "RTDOSE");
    const double start = dose ? DOSE * histogram->max : UPTAKE;
    if ((!dose && strncmp(info->value_unit, "SUV", 3) != 0) ||
        !(histogram->max > start))
        return false;
    builder->low = 0;
    builder->high = dose ? histogram->max : MOST_UPTAKE;
    builder->opacity_count = 0;
    snow_transfer_builder_add_opacity(builder, start, 0);
    snow_transfer_builder_add_opacity(builder, start, dose ? 0.05 : 0.2);
    if (dose) /* whose middle is not to be hidden by what surrounds it */
        snow_transfer_builder_add_opacity(builder, histogram->max / 2, 0.15);
    snow_transfer_builder_add_opacity(builder, builder->high, dose ? 0.4 : 0.6);
    builder->unshaded = builder->around_0 = false;
    builder->preset = NULL;
    builder->colormap = dose ? "turbo" : "hot";
    builder->reason = dose ? "a dose" : "PET";
    if (look->opacity_count)
        return true;
    if (dose)
        strcpy(builder->range_note, ", from 5% of the most on");
    else
        snprintf(builder->range_note, sizeof builder->range_note,
                 ", from %g %s on", UPTAKE, info->value_unit);
    return true;
}

snow_status snow_transfer_builder_overlay(const snow_histogram *histogram,
                                          const snow_look *look,
                                          snow_transfer_builder *builder) {
    const snow_volume_info *info = &histogram->volume->info;
    const bool below = histogram->min<0, above = histogram->max> 0;
    const bool known = look->overlay || !strcmp(info->modality, "RTDOSE");
    magnitudes m;
    if (known && snow_look_is_unranged(look) &&
        build_known(histogram, look, builder))
        return SNOW_STATUS_OK;
    if (!look->overlay)
        return SNOW_STATUS_OK;
    if (!look->colormap) {
        builder->colormap = "hot";
        builder->preset = NULL;
    }
    if (!snow_look_is_unranged(look) || !above ||
        !(histogram->min < histogram->max) ||
        !(info->estimate || (below && histogram->fractions)) ||
        snow_are_hounsfield(info, histogram->min, histogram->max))
        return SNOW_STATUS_OK;
    SNOW_TRY(measure(histogram, &m));
    const bool both =
        below && has_both_signs(histogram, &m, percentile(&m, TOP));
    if (m.all && (both || !below))
        build_statistics(&m, both, builder);
    return SNOW_STATUS_OK;
}
