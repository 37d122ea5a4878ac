/* transfer/signal.c - the range of a channel of emitted light: from above the
 * noise of its background to all but its brightest voxels.
 *
 * The background is where most values lie, and only values below it tell how
 * far it spreads: those above it are mixed with light.  The median and the
 * spread of all voxels would not do, since in dense tissue the median is the
 * signal.
 *
 *         b            b is the mode, s = 1.4826 median(b - v) over v <= b: the
 *       . | .          standard deviation of a normal background
 *      .  |  .
 *    .    |    .  lo = b + 3 s                  hi
 *  .______|______.____|___.........______________|__...  */
#include "transfer/look.h"

#include <math.h>
#include <string.h>

#define BINS 256
#define SMOOTH 2 /* bins on each side */

/* Percentiles between which the mode is sought; that where a histogram whose
 * mode is the signal begins; and that of the values above the noise. */
#define LOWEST 0.001
#define HIGHEST 0.999
#define DENSE 0.01
#define BRIGHTEST 0.999

/* Of a normal distribution: its standard deviation, by the median of
 * magnitudes. */
#define NORMAL 1.4826
#define DEVIATIONS 3

/* Up to which the standardized uptake of PET is usually shown. */
#define USUAL_SUV 7.0

/* How many of the finite values do not exceed one, as a share. */
static snow_status share_up_to(const snow_histogram *histogram, double value,
                               double *share) {
    uint64_t count = 0, all = 0;
    *share = 0;
    if (value < histogram->min)
        return SNOW_STATUS_OK;
    if (!(value > histogram->min))
        *share = (double)histogram->at_min / (double)histogram->finite;
    else {
        SNOW_TRY(
            snow_count_bins(histogram, histogram->min, value, 1, &count, &all));
        *share = (double)count / (double)all;
    }
    return SNOW_STATUS_OK;
}

/* The middle of the fullest bin, of the middle one of several. */
static snow_status find_mode(const snow_histogram *histogram,
                             const double ends[2], double *mode) {
    uint64_t counts[BINS], all, most = 0;
    int first = 0, last = 0;
    SNOW_TRY(snow_count_bins(histogram, ends[0], ends[1], BINS, counts, &all));
    for (int n = 0; n < BINS; n++) {
        uint64_t sum = 0;
        for (int i = n - SMOOTH; i <= n + SMOOTH; i++)
            sum += i >= 0 && i < BINS ? counts[i] : 0;
        if (sum > most)
            first = n;
        if (sum >= most)
            last = n == first || last == n - 1 ? n : last;
        most = sum > most ? sum : most;
    }
    *mode = ends[0] + (ends[1] - ends[0]) * ((first + last) / 2 + 0.5) / BINS;
    return SNOW_STATUS_OK;
}

/* The end of the background. */
static snow_status find_noise(const snow_histogram *histogram, double *noise) {
    const double shares[3] = {LOWEST, HIGHEST, DENSE};
    double ends[3], mode, share, below;
    SNOW_TRY(
        snow_quantiles(histogram, SNOW_HISTOGRAM_SAMPLED, shares, 3, ends));
    mode = *noise = ends[0];
    if (!(ends[0] < ends[1])) /* nearly all voxels have one value */
        return SNOW_STATUS_OK;
    SNOW_TRY(find_mode(histogram, ends, &mode));
    if (mode - ends[0] > (ends[1] - ends[0]) / 4) {
        *noise = ends[2];
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(share_up_to(histogram, mode, &share));
    share /= 2; /* the median of those */
    SNOW_TRY(
        snow_quantiles(histogram, SNOW_HISTOGRAM_SAMPLED, &share, 1, &below));
    *noise = mode + DEVIATIONS * NORMAL * (mode - below);
    return SNOW_STATUS_OK;
}

bool snow_is_pet(const snow_volume_info *info) {
    return strcmp(info->modality, "PT") == 0 && info->format &&
           strcmp(info->format, "dicom") == 0 && info->dims[2] > 1;
}

snow_status snow_signal_range(const snow_histogram *histogram, double *low,
                              double *high, snow_transfer_builder *builder) {
    double noise, share, top;
    bool is;
    if (snow_is_pet(&histogram->volume->info)) {
        share = BRIGHTEST; /* of a dose, of which there may be none */
        SNOW_TRY(
            snow_quantiles(histogram, SNOW_HISTOGRAM_SAMPLED, &share, 1, &top));
        if (strncmp(histogram->volume->info.value_unit, "SUV", 3) == 0)
            top = top > 0 ? USUAL_SUV : 0;
        *low = top > 0 ? 0 : *low;
        *high = top > 0 ? top : *high;
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(snow_window_of(histogram, builder, low, high, &is));
    if (is || histogram->scale.log || !(histogram->min < histogram->max))
        return SNOW_STATUS_OK;
    SNOW_TRY(find_noise(histogram, &noise));
    SNOW_TRY(share_up_to(histogram, noise, &share));
    share += BRIGHTEST * (1 - share);
    SNOW_TRY(
        snow_quantiles(histogram, SNOW_HISTOGRAM_SAMPLED, &share, 1, &top));
    *low = noise;
    *high = top > noise ? top : fmax(histogram->max, noise + 1);
    return SNOW_STATUS_OK;
}
