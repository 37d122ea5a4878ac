/* transfer/stored_values.c - voxels of 8 and 16 bits, which are counted once by
 * their native value: all else is computed from these counts. */
#include "transfer/walk.h"

#include <math.h>
#include <string.h>

/* Bytes that are compared at once. */
#define EVEN 32

/* Returns whether these bytes are copies of one value of `size` bytes, 1 or 2.
 * Empty regions usually are, and incrementing the same count again and again
 * is slow. */
static bool is_even(const void *bytes, size_t size) {
    uint64_t words[EVEN / sizeof(uint64_t)];
    memcpy(words, bytes, sizeof words);
    uint64_t turned = words[0] << 8 * size | words[0] >> (64 - 8 * size);
    uint64_t differ = words[0] ^ turned;
    for (size_t n = 1; n < sizeof words / sizeof *words; n++)
        differ |= words[0] ^ words[n];
    return !differ;
}

/* Voxels between two questions for a stop. */
#define BLOCK 65536

/* Returns what of the walk's run lies in memory without a gap, up to a block;
 * the walk goes on behind it. */
static const void *next_part(snow_voxel_walk *w, uint64_t *count) {
    const snow_volume *volume = w->volume;
    *count = w->end - w->at < BLOCK ? w->end - w->at : BLOCK;
    const int64_t at =
        snow_volume_run(volume, (int64_t)w->at + w->ahead, count);
    w->at += *count;
    return (const char *)volume->voxels +
           at * (int64_t)snow_type_size(volume->info.type);
}

static bool has_more(snow_voxel_walk *w) {
    return (w->at < w->end || snow_voxel_walk_next_run(w)) &&
           !snow_voxel_walk_is_stopped(w);
}

/* `user` points to a histogram with counts. */
static snow_status count_stored(const snow_volume *volume, void *user) {
    const snow_histogram *histogram = user;
    uint64_t *counts = histogram->counts, count;
    snow_voxel_walk w =
        snow_voxel_walk_begin(histogram, volume, false, SNOW_HISTOGRAM_EXACT);
#define COUNT_TYPE(name, c_type, smallest)                                     \
    case name: {                                                               \
        const uint64_t some = EVEN / sizeof(c_type);                           \
        while (has_more(&w)) {                                                 \
            const c_type *at = next_part(&w, &count);                          \
            const c_type *end = at + count;                                    \
            while (at < end)                                                   \
                if ((uint64_t)(end - at) >= some && is_even(at, sizeof *at)) { \
                    counts[*at - (smallest)] += some;                          \
                    at += some;                                                \
                } else {                                                       \
                    const c_type *last =                                       \
                        (uint64_t)(end - at) < some ? end : at + some;         \
                    while (at < last)                                          \
                        counts[*at++ - (smallest)]++;                          \
                }                                                              \
        }                                                                      \
        break;                                                                 \
    }
    switch (volume->info.type) {
        COUNT_TYPE(SNOW_TYPE_INT8, int8_t, INT8_MIN)
        COUNT_TYPE(SNOW_TYPE_UINT8, uint8_t, 0)
        COUNT_TYPE(SNOW_TYPE_INT16, int16_t, INT16_MIN)
        COUNT_TYPE(SNOW_TYPE_UINT16, uint16_t, 0)
    default:
        break;
    }
#undef COUNT_TYPE
    return SNOW_STATUS_OK;
}

uint64_t snow_stored_values_nth(const snow_histogram *histogram, int n,
                                double *value) {
    const snow_volume_info *info = &histogram->volume->info;
    int place = info->slope < 0 ? SNOW_DIGITS - 1 - n : n;
    *value =
        info->slope * (place + snow_type_lowest(info->type)) + info->intercept;
    return histogram->scale.log && !(*value > 0) ? 0 : histogram->counts[place];
}

static void measure_counts(snow_histogram *histogram) {
    for (int n = 0; n < SNOW_DIGITS; n++) {
        double value;
        uint64_t count = snow_stored_values_nth(histogram, n, &value);
        if (!count || !isfinite(value))
            continue;
        if (!histogram->finite) {
            histogram->min = value;
            histogram->at_min = count;
        }
        histogram->max = value;
        histogram->finite += count;
    }
    for (int n = 0; n < SNOW_DIGITS && histogram->scale.log; n++)
        histogram->dropped += histogram->counts[n];
    histogram->dropped -= histogram->scale.log ? histogram->finite : 0;
}

snow_status snow_stored_values_count(snow_histogram *histogram) {
    SNOW_TRY(snow_histogram_new_tables(histogram, 1, &histogram->counts));
    SNOW_TRY(snow_histogram_visit(histogram, SNOW_HISTOGRAM_EXACT, count_stored,
                                  histogram));
    SNOW_TRY(snow_histogram_sum_table(histogram, histogram->counts));
    measure_counts(histogram);
    return SNOW_STATUS_OK;
}

double snow_stored_values_quantile(const snow_histogram *histogram,
                                   uint64_t rank) {
    for (int n = 0; n < SNOW_DIGITS; n++) {
        double value;
        uint64_t count = snow_stored_values_nth(histogram, n, &value);
        if (!isfinite(value))
            continue;
        if (rank < count)
            return value;
        rank -= count;
    }
    return histogram->max;
}

/* --- the range alone ------------------------------------------------------ */

/* The extremes of native values. */
typedef struct extremes {
    const snow_histogram *histogram;
    bool until_negative; /* data values below 0 end the search */
    bool any, negative;
    int low, high;
} extremes;

static double data_value(const snow_volume *volume, int native) {
    return volume->info.slope * native + volume->info.intercept;
}

/* Finds the extremes, `user`, of the voxels that a volume answers for. */
static snow_status find_extremes_of_part(const snow_volume *volume,
                                         void *user) {
    extremes *n = user;
    snow_voxel_walk w = snow_voxel_walk_begin(n->histogram, volume, false,
                                              SNOW_HISTOGRAM_EXACT);
    while (!(n->until_negative && n->negative) && has_more(&w)) {
        const uint64_t left = w.end - w.at, count = left < BLOCK ? left : BLOCK;
        int32_t low = 0, high = 0;
        snow_volume_extremes(volume, (int64_t)w.at + w.ahead, count, &low,
                             &high);
        n->low = n->any && n->low < low ? n->low : low;
        n->high = n->any && n->high > high ? n->high : high;
        n->any = true;
        n->negative =
            data_value(volume, n->low) < 0 || data_value(volume, n->high) < 0;
        w.at += count;
    }
    return SNOW_STATUS_OK;
}

snow_status snow_stored_values_range(snow_histogram *histogram, bool *found) {
    const snow_volume *volume = histogram->volume;
    extremes n = {.histogram = histogram,
                  .until_negative = histogram->need == SNOW_NEED_SIGN};
    *found = false;
    SNOW_TRY(snow_histogram_visit(histogram, SNOW_HISTOGRAM_EXACT,
                                  find_extremes_of_part, &n));
    double low = data_value(volume, n.low), high = data_value(volume, n.high);
    if (!n.any || !isfinite(low) || !isfinite(high))
        return SNOW_STATUS_OK;
    histogram->min = low < high ? low : high;
    histogram->max = low < high ? high : low;
    histogram->finite = 1;
    *found = !histogram->scale.log || histogram->min > 0;
    return SNOW_STATUS_OK;
}
