/* transfer/quantiles.c - the values at given ranks, exactly.
 *
 * Doubles are converted to 64-bit keys of the same order, floats to 32-bit
 * ones, and a quantile is found 16 bits at a time, most significant first, by
 * counting (radix selection). This takes four or two passes over the voxels
 * whatever the range of values, which equal bins could not do for data from
 * 1e-3 to 1e38. */
#include "transfer/walk.h"

#include <math.h>
#include <string.h>

/* The search for one quantile: the bits found so far, and its rank among the
 * values that share them. */
typedef struct search {
    uint64_t prefix;
    uint64_t rank; /* from 0 */
    uint64_t *counts;
} search;

/* The counts of one digit for several searches. */
typedef struct digit_count {
    const snow_histogram *histogram;
    snow_histogram_mode histogram_mode;
    search *searches;
    size_t count;
    bool floats;  /* keys have 32 bits */
    int shift;    /* of the digit */
    uint64_t all; /* number of all values */
} digit_count;

/* Whether data values are floats, as they are stored. */
static bool has_floats(const snow_volume_info *info) {
    return info->type == SNOW_TYPE_FLOAT32 && info->slope == 1 &&
           info->intercept == 0;
}

/* A key with the order of values: all bits of negative numbers are inverted, of
 * others the sign bit; -0 counts as 0. */
static uint64_t key_of(double value) {
    const double number = value + 0.0;
    uint64_t key;
    memcpy(&key, &number, sizeof key);
    return key >> 63 ? ~key : key | UINT64_C(1) << 63;
}

/* The same of a float. */
static uint32_t key_of_float(float value) {
    const float number = value + 0.0F;
    uint32_t key;
    memcpy(&key, &number, sizeof key);
    return key >> 31 ? ~key : key | UINT32_C(1) << 31;
}

static double value_of(uint64_t key) {
    const uint64_t bits = key >> 63 ? key ^ UINT64_C(1) << 63 : ~key;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double value_of_float(uint32_t key) {
    const uint32_t bits = key >> 31 ? key ^ UINT32_C(1) << 31 : ~key;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* Counts the next digit of all values that begin with a search's prefix; `user`
 * points to a digit_count. */
static snow_status count_digits(const snow_volume *slab, void *user) {
    digit_count *d = user;
    double values[SNOW_WALK_BLOCK];
    const bool floats = d->floats;
    const int shift = d->shift;
    uint64_t above = shift + SNOW_DIGIT_BITS < 64
                         ? ~UINT64_C(0) << (shift + SNOW_DIGIT_BITS)
                         : 0;
    size_t got;
    snow_voxel_walk w = snow_voxel_walk_begin(
        d->histogram, slab, d->histogram->scale.log, d->histogram_mode);
    while ((got = snow_voxel_walk_next_block(&w, values))) {
        for (size_t i = 0; i < got; i++) {
            if (!isfinite(values[i]))
                continue;
            const uint64_t key =
                floats ? key_of_float((float)values[i]) : key_of(values[i]);
            d->all++;
            for (size_t n = 0; n < d->count; n++)
                if ((key & above) == d->searches[n].prefix)
                    d->searches[n].counts[key >> shift & (SNOW_DIGITS - 1)]++;
        }
    }
    return SNOW_STATUS_OK;
}

/* The rank, from 0, of the value that is not exceeded by a share of `all`. */
static uint64_t rank_of(double fraction, uint64_t all) {
    double rank = ceil(fraction * (double)all) - 1;
    if (rank <= 0)
        return 0;
    return rank < (double)(all - 1) ? (uint64_t)rank : all - 1;
}

/* Finds digit after digit; `counts` has a table for each search. */
static snow_status select_digits(const snow_histogram *histogram,
                                 snow_histogram_mode histogram_mode,
                                 const double *fractions, size_t count,
                                 search *searches, uint64_t *counts) {
    const bool floats = has_floats(&histogram->volume->info);
    const int highest = (floats ? 32 : 64) - SNOW_DIGIT_BITS;
    for (int shift = highest; shift >= 0; shift -= SNOW_DIGIT_BITS) {
        memset(counts, 0, count * SNOW_DIGITS * sizeof *counts);
        digit_count d = {histogram, histogram_mode, searches, count,
                         floats,    shift,          0};
        SNOW_TRY(
            snow_histogram_visit(histogram, histogram_mode, count_digits, &d));
        SNOW_TRY(snow_histogram_sum(histogram, &d.all, 1));
        for (size_t n = 0; n < count && d.all; n++) {
            SNOW_TRY(snow_histogram_sum_table(histogram, searches[n].counts));
            if (shift == highest)
                searches[n].rank = rank_of(fractions[n], d.all);
            uint64_t digit = 0;
            while (searches[n].rank >= searches[n].counts[digit])
                searches[n].rank -= searches[n].counts[digit++];
            searches[n].prefix |= digit << shift;
        }
    }
    return SNOW_STATUS_OK;
}

static snow_status select_keys(const snow_histogram *histogram,
                               snow_histogram_mode histogram_mode,
                               const double *fractions, size_t count,
                               double *out) {
    snow_context *context = histogram->volume->context;
    search searches[SNOW_QUANTILES_MOST] = {{0}};
    uint64_t *counts;
    snow_status status = snow_histogram_new_tables(histogram, count, &counts);
    for (size_t n = 0; n < count && counts; n++)
        searches[n].counts = counts + n * SNOW_DIGITS;
    if (status == SNOW_STATUS_OK)
        status = select_digits(histogram, histogram_mode, fractions, count,
                               searches, counts);
    const bool floats = has_floats(&histogram->volume->info);
    for (size_t n = 0; n < count && status == SNOW_STATUS_OK; n++)
        out[n] = floats ? value_of_float((uint32_t)searches[n].prefix)
                        : value_of(searches[n].prefix);
    snow_release(context, counts);
    return status;
}

snow_status snow_quantiles(const snow_histogram *histogram,
                           snow_histogram_mode histogram_mode,
                           const double *fractions, size_t count, double *out) {
    if (!histogram->counts)
        return select_keys(histogram, histogram_mode, fractions, count, out);
    for (size_t n = 0; n < count; n++)
        out[n] = snow_stored_values_quantile(
            histogram, rank_of(fractions[n], histogram->finite));
    return SNOW_STATUS_OK;
}
