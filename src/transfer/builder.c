/* transfer/builder.c - transfer functions under construction: positions of
 * values in a range, and control points.
 *
 * Values of points never decrease: errors of rounding logarithms are
 * corrected. */
#include "base/minmax.h"
#include "transfer/look.h"

#include <math.h>
#include <string.h>

void snow_full_range(const snow_histogram *histogram, double *low,
                     double *high) {
    *low = histogram->finite ? histogram->min : 0;
    *high = histogram->finite ? histogram->max : 1;
    if (histogram->scale.log && !(*low > 0))
        *low = *high / 10;
    if (*low < *high)
        return;
    /* If there is one value, it shows if it is above 0; 0 and less is empty. */
    if (histogram->scale.log)
        *low = *high / 10;
    else if (*high > 0)
        *low = 0;
    else
        *high = *low < 0 ? 0 : 1;
}

/* A window of a file without modality (cal_min and cal_max of NIfTI) is that of
 * a program rather than of a radiologist: it counts if so many values lie in
 * it, and fill so much of it.  In a wider one all would be one grey. */
#define FEWEST 0.01

snow_status snow_window_of(const snow_histogram *histogram,
                           snow_transfer_builder *builder, double *low,
                           double *high, bool *is) {
    const double *window = histogram->volume->info.window;
    uint64_t inside = 1, all = 1;
    *is = false;
    if (histogram->scale.log || !(window[0] < window[1]) ||
        !(window[0] < histogram->max && window[1] > histogram->min))
        return SNOW_STATUS_OK;
    if (!*histogram->volume->info.modality)
        SNOW_TRY(
            snow_count_bins(histogram, window[0], window[1], 1, &inside, &all));
    const double filled =
        fmin(window[1], histogram->max) - fmax(window[0], histogram->min);
    if (!*histogram->volume->info.modality &&
        ((double)inside < FEWEST * (double)all ||
         filled < FEWEST * (window[1] - window[0])))
        return SNOW_STATUS_OK;
    *is = true;
    *low = window[0];
    *high = window[1];
    strcpy(builder->range_note, "; the file's own window");
    return SNOW_STATUS_OK;
}

/* What may be left out at either end of a range, and how many times smaller
 * that has to make it: three values or a ten-thousandth; of slices, where a
 * patch of broken pixels is no object, also a hundredth. */
#define FEW 0.0001
#define FEW_LEAST 3.0
#define FEW_PAY 4.0
#define MANY 0.01
#define MANY_PAY 1000.0

/* Takes the upper end, the lower one, or both, where that pays.  Halves are
 * compared, since the whole may be more than a double holds. */
static bool shrink(double range[2], const double ends[2], double pays) {
    const double half = range[1] / 2 - range[0] / 2;
    if (!(ends[0] < ends[1]))
        return false;
    const bool high = half >= pays * (ends[1] / 2 - range[0] / 2);
    if (high)
        range[1] = ends[1];
    const bool low =
        range[1] / 2 - range[0] / 2 >= pays * (range[1] / 2 - ends[0] / 2);
    if (low)
        range[0] = ends[0];
    if (high || low || half < pays * (ends[1] / 2 - ends[0] / 2))
        return high || low;
    range[0] = ends[0];
    range[1] = ends[1];
    return true;
}

/* The ends without so many values at either. */
static snow_status ends_without(const snow_histogram *histogram, double count,
                                double ends[2]) {
    const double all = (double)histogram->finite;
    const double share = (floor(count) + 0.5) / all;
    const double shares[2] = {share, 1 - share};
    return snow_quantiles(histogram, SNOW_HISTOGRAM_SAMPLED, shares, 2, ends);
}

/* Leaves out at most so many values at either end, and no more than pay: where
 * all of them would, 1, 2, 4 and so on are tried. */
static snow_status leave_out(const snow_histogram *histogram, double most,
                             double pays, double range[2]) {
    double trial[2] = {range[0], range[1]}, all[2], ends[2];
    SNOW_TRY(ends_without(histogram, most, all));
    if (!shrink(trial, all, pays))
        return SNOW_STATUS_OK;
    for (double count = 1; count < most; count *= 2) {
        SNOW_TRY(ends_without(histogram, count, ends));
        shrink(range, ends, pays);
    }
    shrink(range, all, pays);
    return SNOW_STATUS_OK;
}

/* Hounsfield units: air between tissue, which the smallest values along rays
 * show; and the least that a scanner measures, below which voxels are padded.
 */
#define AIR_LOW (-1000)
#define AIR_HIGH (-500)
#define FLOOR (-1024)

double snow_hounsfield_floor(const snow_histogram *histogram, double low) {
    const bool is = snow_are_hounsfield(&histogram->volume->info,
                                        histogram->min, histogram->max);
    return is && low < FLOOR && histogram->max > FLOOR ? FLOOR : low;
}

snow_status snow_robust_range(const snow_histogram *histogram, snow_range kind,
                              double *low, double *high,
                              snow_transfer_builder *builder) {
    const double full[2] = {*low, *high}, count = (double)histogram->finite;
    double range[2] = {*low, *high};
    bool is;
    if (kind == SNOW_RANGE_LEAST && !histogram->scale.log &&
        snow_are_hounsfield(&histogram->volume->info, histogram->min,
                            histogram->max)) {
        *low = AIR_LOW;
        *high = AIR_HIGH;
        strcpy(builder->range_note, "; air in Hounsfield units");
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(snow_window_of(histogram, builder, low, high, &is));
    if (is || histogram->scale.log || !histogram->finite)
        return SNOW_STATUS_OK;
    SNOW_TRY(
        leave_out(histogram, fmax(FEW_LEAST, FEW * count), FEW_PAY, range));
    if (kind == SNOW_RANGE_SLICES)
        SNOW_TRY(leave_out(histogram, MANY * count, MANY_PAY, range));
    *low = snow_hounsfield_floor(histogram, range[0]);
    *high = range[1];
    if (*low > full[0] || *high < full[1])
        snow_text_print(builder->range_note, sizeof builder->range_note,
                        "; few values outside, the data are %.5g..%.5g",
                        full[0], full[1]);
    return SNOW_STATUS_OK;
}

void snow_transfer_builder_symlog(snow_histogram *histogram,
                                  const snow_look *look,
                                  snow_transfer_builder *builder) {
    double low = look->low, high = look->high;
    if (!(look->symlog < 0))
        return;
    if (look->range != SNOW_RANGE_VALUES)
        snow_full_range(histogram, &low, &high);
    histogram->scale.linear = builder->scale.linear =
        snow_round_below(fmax(fabs(low), fabs(high)) / 1000);
}

/* --- points --------------------------------------------------------------- */

snow_status snow_transfer_builder_reserve(snow_context *context, size_t colors,
                                          size_t opacities, size_t gradients,
                                          snow_transfer_builder *builder) {
    uint64_t bytes;
    if (!snow_mul_u64(opacities + gradients, sizeof(snow_opacity_point),
                      &bytes) ||
        !snow_add_u64(bytes, colors * sizeof(snow_color_point), &bytes))
        bytes = UINT64_MAX;
    SNOW_TRY(snow_reserve(context, &builder->block, 0, bytes, 1));
    builder->colors = builder->block;
    builder->opacities = (void *)(builder->colors + colors);
    builder->gradients = builder->opacities + opacities;
    return SNOW_STATUS_OK;
}

snow_status snow_object_range(const snow_histogram *histogram, double *low,
                              double *high) {
    snow_histogram_split p;
    SNOW_TRY(snow_histogram_split_at(histogram, NULL, &p));
    snow_full_range(histogram, low, high);
    if (!p.constant) {
        *low =
            snow_between_on(histogram->scale, p.background, p.threshold, 0.6);
        *high = p.top;
    }
    return SNOW_STATUS_OK;
}

void snow_transfer_builder_add_opacity(snow_transfer_builder *builder,
                                       double value, double opacity) {
    size_t n = builder->opacity_count++;
    if (n && value < builder->opacities[n - 1].value)
        value = builder->opacities[n - 1].value;
    builder->opacities[n] = (snow_opacity_point){value, opacity};
}

/* Copies points; their values are shares of a range unless they are data
 * values. */
static void copy_points(const snow_look *points, snow_scale scale, double low,
                        double high, snow_transfer_builder *builder) {
    bool shares = points->domain != SNOW_DOMAIN_DATA;
    if (points->color_count)
        builder->color_count = points->color_count;
    if (points->opacity_count)
        builder->opacity_count = points->opacity_count;
    for (size_t i = 0; i < points->color_count; i++) {
        builder->colors[i] = points->colors[i];
        if (shares)
            builder->colors[i].value =
                snow_between_on(scale, low, high, points->colors[i].value);
    }
    for (size_t i = 0; i < points->opacity_count; i++) {
        builder->opacities[i] = points->opacities[i];
        if (shares)
            builder->opacities[i].value =
                snow_between_on(scale, low, high, points->opacities[i].value);
    }
}

double snow_transfer_builder_place(const snow_transfer_builder *builder,
                                   double low, double high, double share) {
    if (!builder->around_0 || !(low < 0) || !(high > 0))
        return snow_between_on(builder->scale, low, high, share);
    return share < 0.5
               ? snow_between_on(builder->scale, low, 0, 2 * share)
               : snow_between_on(builder->scale, 0, high, 2 * share - 1);
}

/* The range of values of points in data units. */
static void own_range(const snow_look *points, double *low, double *high) {
    const size_t colors = points->color_count, count = points->opacity_count;
    *low = INFINITY;
    *high = -INFINITY;
    for (int last = 0; last < 2; last++) {
        if (colors) {
            const double at = points->colors[last ? colors - 1 : 0].value;
            *low = SNOW_MIN(at, *low);
            *high = SNOW_MAX(at, *high);
        }
        if (count) { /* all values that have opacities */
            const double at = points->opacities[last ? count - 1 : 0].value;
            *low = SNOW_MIN(at, *low);
            *high = SNOW_MAX(at, *high);
        }
    }
}

snow_status snow_transfer_builder_points(const snow_look *points,
                                         const snow_histogram *histogram,
                                         snow_transfer_builder *builder) {
    double low, high;
    if (points->domain == SNOW_DOMAIN_OBJECT)
        SNOW_TRY(snow_object_range(histogram, &low, &high));
    else if (points->domain == SNOW_DOMAIN_RANGE)
        snow_full_range(histogram, &low, &high);
    else if (points->domain == SNOW_DOMAIN_SYMMETRIC) {
        bool is_signed;
        builder->around_0 = true;
        SNOW_TRY(snow_is_signed_field(histogram, &is_signed, &high));
        low = -high;
    } else
        own_range(points, &low, &high);
    builder->name = points->name;
    builder->low = low;
    builder->high = high;
    copy_points(points, histogram->scale, low, high, builder);
    builder->gradient_count = points->gradient_opacity_count;
    if (points->gradient_opacity_count)
        memcpy(builder->gradients, points->gradient_opacities,
               points->gradient_opacity_count *
                   sizeof *points->gradient_opacities);
    return SNOW_STATUS_OK;
}

/* What is reported is used: a chosen value has five digits, and as many more as
 * its range needs to be distinguished. */
static double rounded(const snow_transfer_builder *builder, double value) {
    double span = builder->high - builder->low;
    double most = fmax(fabs(builder->low), fabs(builder->high));
    char text[40];
    int digits = 5;
    for (; span > 0 && span < most && digits < 17; digits++)
        span *= 10;
    snow_text_print(text, sizeof text, "%.*g", digits, value);
    double again = NAN;
    snow_text_scan(text, "%lf", &again);
    return isfinite(again) ? again : value;
}

void snow_transfer_builder_round(snow_transfer_builder *builder) {
    double low = rounded(builder, builder->low);
    double high = rounded(builder, builder->high);
    for (size_t i = 0; i < builder->color_count; i++)
        builder->colors[i].value = rounded(builder, builder->colors[i].value);
    for (size_t i = 0; i < builder->opacity_count; i++)
        builder->opacities[i].value =
            rounded(builder, builder->opacities[i].value);
    builder->low = low;
    builder->high = high;
}
