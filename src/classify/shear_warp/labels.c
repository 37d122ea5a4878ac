/* classify/shear_warp/labels.c - see labels.h. */
#include "classify/shear_warp/labels.h"

#include "volume/clip_planes.h"

#include <math.h>
#include <string.h>

#define BLOCK 1024

/* All slabs of a label have one alpha, whose rounding adds up where that of
 * values does not. */
#define FAINTEST 0.0625

/* --- names ---------------------------------------------------------------- */

int snow_value_label_of(const double *names, int count, double value) {
    int low = 0, high = count;
    while (low < high) {
        int middle = (low + high) / 2;
        if (names[middle] < value)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

snow_status snow_value_labels_name(snow_context *context,
                                   snow_value_labels *labels, double value) {
    int at = snow_value_label_of(labels->names, labels->count, value);
    if (at < labels->count && labels->names[at] == value)
        return SNOW_STATUS_OK;
    if (labels->count == SNOW_VALUE_LABELS_MOST)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "the volume has too many labels for method shear-warp: the "
            "limit is %d; take method footprint",
            SNOW_VALUE_LABELS_MOST);
    SNOW_TRY(
        SNOW_RESERVE(context, labels->names, labels->count, labels->count + 1));
    memmove(labels->names + at + 1, labels->names + at,
            (size_t)(labels->count - at) * sizeof *labels->names);
    labels->names[at] = value;
    labels->count++;
    return SNOW_STATUS_OK;
}

snow_status snow_value_labels_add(const snow_volume *volume,
                                  snow_value_labels *labels) {
    const snow_volume_info *info = &volume->info;
    int64_t all = info->dims[0] * info->dims[1] * info->dims[2];
    double last = NAN;
    for (int64_t first = 0; first < all; first += BLOCK) {
        double stored[BLOCK];
        size_t count = all - first < BLOCK ? (size_t)(all - first) : BLOCK;
        snow_volume_stored(volume, first, count, stored);
        for (size_t n = 0; n < count; n++) {
            if (stored[n] == last || isnan(stored[n]))
                continue;
            last = stored[n];
            SNOW_TRY(snow_value_labels_name(
                volume->context, labels, info->slope * last + info->intercept));
        }
    }
    /* And those next to planes that cut it, which are drawn up to there. */
    for (size_t n = 0; volume->clip && n < volume->clip->voxel_count; n++)
        SNOW_TRY(snow_value_labels_name(
            volume->context, labels,
            info->slope * volume->clip->voxels[n].native + info->intercept));
    return SNOW_STATUS_OK;
}

/* --- looks ---------------------------------------------------------------- */

static void find_look(const snow_value_look *look, snow_value_labels *labels,
                      int n) {
    snow_label_look *out = &labels->looks[n];
    double rgba[4];
    snow_transfer_evaluate(look->transfer, labels->names[n], rgba);
    memcpy(out->rgb, rgba, sizeof out->rgb);
    out->opacity = snow_is_interesting(rgba[3], look->threshold) ? rgba[3] : 0;
    out->step = -expm1(labels->exponent * log1p(-out->opacity));
}

snow_status snow_value_labels_look(snow_context *context,
                                   const snow_value_look *look,
                                   snow_value_labels *labels,
                                   snow_value_table *table) {
    double most = 0;
    SNOW_TRY(SNOW_RESERVE(context, labels->looks, 0, labels->count));
    labels->steps = look->steps;
    labels->exponent = look->exponent / look->steps;
    snow_value_table_begin(look, table);
    for (int n = 0; n < labels->count; n++) {
        find_look(look, labels, n);
        most = fmax(most, labels->looks[n].opacity);
    }
    snow_value_table_scale(table, -expm1(look->exponent * log1p(-most)),
                           FAINTEST);
    for (int n = 0, first = 0; n < labels->count; n++) {
        bool seen = labels->looks[n].step > 0, last = n + 1 == labels->count;
        if ((seen || last) && n - seen >= first)
            snow_value_table_hide(
                table, (snow_transparent_interval){(int16_t)first,
                                                   (int16_t)(n - seen)});
        if (seen)
            first = n + 1;
    }
    return SNOW_STATUS_OK;
}

void snow_value_labels_fini(snow_context *context, snow_value_labels *labels) {
    snow_release(context, labels->names);
    snow_release(context, labels->looks);
    *labels = (snow_value_labels){0};
}
