/* transfer/field.c - whether values are those of a computed field, and of which
 * signs. */
#include "volume/field.h"
#include "transfer/look.h"

#include <math.h>

/* Floats that reach so far cannot have fractions there, as densities in SI
 * units; no scanner counts so far. */
static bool is_beyond_fractions(const snow_histogram *histogram) {
    const snow_type type = histogram->volume->info.type;
    double reach = fmax(fabs(histogram->min), fabs(histogram->max));
    return type == SNOW_TYPE_FLOAT32   ? reach >= 0x1p24
           : type == SNOW_TYPE_FLOAT64 ? reach >= 0x1p53
                                       : false;
}

/* Numbers with fractions where a field may be. */
bool snow_is_field(const snow_histogram *histogram) {
    return (histogram->fractions || is_beyond_fractions(histogram)) &&
           snow_volume_may_be_field(&histogram->volume->info);
}

bool snow_are_measures(const snow_histogram *histogram) {
    const snow_volume_info *info = &histogram->volume->info;
    return snow_is_field(histogram) ||
           (*info->value_unit && snow_volume_may_be_field(info));
}

/* Voxels of either sign that are left out of a field's reach, as those of noise
 * and of a few sources are. */
#define FAR 0.002

/* A field is around 0 if the middle one of its values is that near to it, and
 * its weaker side reaches that far, relative to its reach. */
#define NEAR 0.3
#define WEAKER 0.2

snow_status snow_is_signed_field(const snow_histogram *histogram,
                                 bool *is_signed, double *reach) {
    const double shares[3] = {FAR, 0.5, 1 - FAR};
    double q[3];
    SNOW_TRY(snow_quantiles(histogram, SNOW_HISTOGRAM_SAMPLED, shares, 3, q));
    *reach = fmax(fabs(q[0]), fabs(q[2]));
    if (!(*reach > 0))
        *reach = fmax(fabs(histogram->min), fabs(histogram->max));
    char text[40]; /* what is reported is used, as of other looks */
    snow_text_print(text, sizeof text, "%.5g", *reach);
    double again;
    if (snow_parse_double(text, &again) && isfinite(again))
        *reach = again;
    if (!(*reach > 0))
        *reach = 1;
    *is_signed = snow_is_field(histogram) && !histogram->scale.log &&
                 fmin(-q[0], q[2]) > 0 &&
                 snow_share_on(histogram->scale, 0, *reach,
                               fmin(-q[0], q[2])) >= WEAKER &&
                 snow_share_on(histogram->scale, 0, *reach, fabs(q[1])) <= NEAR;
    return SNOW_STATUS_OK;
}

/* Values are below 0, as charges of electrons and potentials are, and the most
 * frequent ones, of so many bins, are high: the background. */
#define MODE_BINS 64

snow_status snow_is_field_below_0(const snow_histogram *histogram,
                                  bool *is_below) {
    const double shares[2] = {FAR, 1 - FAR};
    uint64_t counts[MODE_BINS], all;
    double q[2];
    int most = 0;
    *is_below = false;
    if (histogram->scale.log)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_quantiles(histogram, SNOW_HISTOGRAM_SAMPLED, shares, 2, q));
    if (!(q[0] < 0 ? q[1] <= -WEAKER * q[0] : histogram->max <= 0))
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_count_bins(histogram, histogram->min, histogram->max,
                             MODE_BINS, counts, &all));
    for (int i = 1; i < MODE_BINS; i++)
        most = counts[i] > counts[most] ? i : most;
    *is_below = most >= MODE_BINS / 2;
    return SNOW_STATUS_OK;
}
