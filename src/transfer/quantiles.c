/* transfer/quantiles.c - the values at given ranks, exactly.
 *
 * Doubles are converted to 64-bit keys of the same order and a quantile is
 * found 16 bits at a time, most significant first, by counting (radix
 * selection). This takes four passes over the voxels whatever the range of
 * values, which equal bins could not do for data from 1e-3 to 1e38. */
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
    int shift;    /* of the digit */
    uint64_t all; /* number of all values */
} digit_count;

/* Counts the next digit of all values that begin with a search's prefix; `user`
 * points to a digit_count. */
static snow_status count_digits(const snow_volume *slab, void *user) {
    digit_count *d = user;
    double values[SNOW_WALK_BLOCK];
    int shift = d->shift;
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
            /* A key with the order of doubles: all bits of negative numbers
             * are inverted, of others the sign bit; -0 counts as 0. */
            const double value = values[i] + 0.0;
            uint64_t key;
            memcpy(&key, &value, sizeof key);
            key = key >> 63 ? ~key : key | UINT64_C(1) << 63;
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
    for (int shift = 64 - SNOW_DIGIT_BITS; shift >= 0;
         shift -= SNOW_DIGIT_BITS) {
        memset(counts, 0, count * SNOW_DIGITS * sizeof *counts);
        digit_count d = {histogram, histogram_mode, searches, count, shift, 0};
        SNOW_TRY(
            snow_histogram_visit(histogram, histogram_mode, count_digits, &d));
        SNOW_TRY(snow_histogram_sum(histogram, &d.all, 1));
        for (size_t n = 0; n < count && d.all; n++) {
            SNOW_TRY(snow_histogram_sum_table(histogram, searches[n].counts));
            if (shift == 64 - SNOW_DIGIT_BITS)
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
    for (size_t n = 0; n < count && status == SNOW_STATUS_OK; n++) {
        const uint64_t key = searches[n].prefix;
        const uint64_t bits = key >> 63 ? key ^ UINT64_C(1) << 63 : ~key;
        memcpy(&out[n], &bits, sizeof bits);
    }
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
