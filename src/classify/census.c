/* classify/census.c - how often values occur, exact and without a copy of them.
 *
 * 8 and 16 bit voxels are counted once by their native value, and all else is
 * read from these counts.  For other types doubles are turned to 64-bit keys of
 * the same order and the wanted one is found 16 bits at a time, most
 * significant first, by counting (radix selection): four passes over the voxels
 * whatever the range of values, which equal bins could not do for data from
 * 1e-3 to 1e38. */
#include "classify/look.h"

#include <math.h>
#include <string.h>

#define BLOCK 1024
#define DIGIT_BITS 16
#define DIGITS (1 << DIGIT_BITS)

/* Voxels that a sampled pass reads at least, when there are as many. */
#define SAMPLE (INT64_C(1) << 24)

static int64_t voxel_count(const snow_volume *volume) {
    const int64_t *dims = volume->info.dims;
    return dims[0] * dims[1] * dims[2];
}

/* From block to block, in voxels. */
static int64_t stride_of(const snow_volume *volume, snow_effort effort) {
    int64_t skip = voxel_count(volume) / SAMPLE;
    return effort == SNOW_EXACT || skip < 1 ? BLOCK : BLOCK * skip;
}

/* Data values from voxel `first` on; returns how many. */
static size_t read_block(const snow_volume *volume, int64_t first,
                         double values[BLOCK]) {
    int64_t left = voxel_count(volume) - first;
    size_t count = left < BLOCK ? (size_t)left : BLOCK;
    snow_volume_natives(volume, first, count, values);
    for (size_t i = 0; i < count; i++)
        values[i] = volume->info.slope * values[i] + volume->info.intercept;
    return count;
}

/* --- 8 and 16 bit types ----------------------------------------------------
 */

/* The smallest value of a counted type; false for the others. */
static bool counted_type(snow_type type, int *smallest) {
    *smallest = type == SNOW_INT8    ? INT8_MIN
                : type == SNOW_INT16 ? INT16_MIN
                                     : 0;
    return type == SNOW_INT8 || type == SNOW_UINT8 || type == SNOW_INT16 ||
           type == SNOW_UINT16;
}

static void count_natives(const snow_volume *volume, uint64_t *counts) {
    int64_t n = voxel_count(volume);
    memset(counts, 0, DIGITS * sizeof *counts);
#define COUNT_TYPE(name, c_type, smallest)     \
    case name: {                               \
        const c_type *voxels = volume->voxels; \
        for (int64_t i = 0; i < n; i++)        \
            counts[voxels[i] - (smallest)]++;  \
        break;                                 \
    }
    switch (volume->info.type) {
        COUNT_TYPE(SNOW_INT8, int8_t, INT8_MIN)
        COUNT_TYPE(SNOW_UINT8, uint8_t, 0)
        COUNT_TYPE(SNOW_INT16, int16_t, INT16_MIN)
        COUNT_TYPE(SNOW_UINT16, uint16_t, 0)
    default:
        break;
    }
#undef COUNT_TYPE
}

/* The n-th counted value in the order of data values (a negative slope turns
 * that of natives), and its count. */
static uint64_t nth_value(const snow_census *census, int n, double *value) {
    const snow_volume_info *info = &census->volume->info;
    int smallest, place = info->slope < 0 ? DIGITS - 1 - n : n;
    counted_type(info->type, &smallest);
    *value = info->slope * (place + smallest) + info->intercept;
    return census->counts[place];
}

static void measure_counts(snow_census *census) {
    for (int n = 0; n < DIGITS; n++) {
        double value;
        uint64_t count = nth_value(census, n, &value);
        if (!count || !isfinite(value))
            continue;
        if (!census->finite) {
            census->min = value;
            census->at_min = count;
        }
        census->max = value;
        census->finite += count;
    }
}

static double counted_quantile(const snow_census *census, uint64_t rank) {
    for (int n = 0; n < DIGITS; n++) {
        double value;
        uint64_t count = nth_value(census, n, &value);
        if (!isfinite(value))
            continue;
        if (rank < count)
            return value;
        rank -= count;
    }
    return census->max;
}

/* --- all types -------------------------------------------------------------
 */

static void measure_values(snow_census *census) {
    double values[BLOCK];
    size_t count;
    for (int64_t at = 0; at < voxel_count(census->volume);
         at += (int64_t)count) {
        count = read_block(census->volume, at, values);
        for (size_t i = 0; i < count; i++) {
            double value = values[i];
            if (!isfinite(value))
                continue;
            if (!census->finite++)
                census->min = census->max = value;
            if (value < census->min) {
                census->min = value;
                census->at_min = 0;
            }
            census->at_min += value == census->min;
            if (value > census->max)
                census->max = value;
        }
    }
}

snow_status snow_census_new(const snow_volume *volume, snow_census *out) {
    snow_census census = {.volume = volume, .min = NAN, .max = NAN};
    int smallest;
    if (!counted_type(volume->info.type, &smallest)) {
        measure_values(&census);
        *out = census;
        return SNOW_OK;
    }
    census.counts =
        snow_allocate(volume->context, DIGITS * sizeof *census.counts);
    if (!census.counts)
        return SNOW_NO_MEMORY;
    count_natives(volume, census.counts);
    measure_counts(&census);
    *out = census;
    return SNOW_OK;
}

void snow_census_free(snow_census *census) {
    snow_release(census->volume->context, census->counts);
}

/* Which bin a value falls into; -1 outside. */
static int bin_of(double value, double low, double high, int bins) {
    if (!(value >= low && value <= high))
        return -1;
    /* Halves, where the range is more than a double can hold. */
    double scale = isfinite(high - low) ? 1 : 0.5;
    double share = (scale * value - scale * low) / (scale * high - scale * low);
    int bin = (int)(share * bins);
    return bin < bins ? bin : bins - 1;
}

uint64_t snow_count_bins(const snow_census *census, double low, double high,
                         int bins, uint64_t *counts) {
    double values[BLOCK], value;
    uint64_t all = 0;
    int64_t stride = stride_of(census->volume, SNOW_SAMPLED);
    memset(counts, 0, (size_t)bins * sizeof *counts);
    for (int n = 0; census->counts && n < DIGITS; n++) {
        uint64_t count = nth_value(census, n, &value);
        int bin = count ? bin_of(value, low, high, bins) : -1;
        if (bin >= 0)
            counts[bin] += count;
    }
    if (census->counts)
        return census->finite;
    for (int64_t at = 0; at < voxel_count(census->volume); at += stride) {
        size_t got = read_block(census->volume, at, values);
        for (size_t i = 0; i < got; i++) {
            int bin = bin_of(values[i], low, high, bins);
            all += isfinite(values[i]) != 0;
            if (bin >= 0)
                counts[bin]++;
        }
    }
    return all;
}

/* A key with the order of doubles: negative ones have all bits turned, others
 * the sign bit; -0 counts as 0. */
static uint64_t key_of(double value) {
    uint64_t bits;
    value += 0.0;
    memcpy(&bits, &value, sizeof bits);
    return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

static double value_of(uint64_t key) {
    uint64_t bits = key >> 63 ? key ^ UINT64_C(1) << 63 : ~key;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* One wanted value: the bits found so far, and its rank among those that
 * share them. */
typedef struct search {
    uint64_t prefix;
    uint64_t rank; /* from 0 */
    uint64_t *counts;
} search;

/* Counts the next digit of all values that begin as a search's prefix does;
 * returns how many values there are. */
static uint64_t count_digits(const snow_volume *volume, int64_t stride,
                             search *searches, size_t count, int shift) {
    double values[BLOCK];
    uint64_t all = 0;
    uint64_t above =
        shift + DIGIT_BITS < 64 ? ~UINT64_C(0) << (shift + DIGIT_BITS) : 0;
    for (int64_t at = 0; at < voxel_count(volume); at += stride) {
        size_t got = read_block(volume, at, values);
        for (size_t i = 0; i < got; i++) {
            if (!isfinite(values[i]))
                continue;
            uint64_t key = key_of(values[i]);
            all++;
            for (size_t n = 0; n < count; n++)
                if ((key & above) == searches[n].prefix)
                    searches[n].counts[key >> shift & (DIGITS - 1)]++;
        }
    }
    return all;
}

static void take_digit(search *s, int shift) {
    uint64_t digit = 0;
    while (s->rank >= s->counts[digit])
        s->rank -= s->counts[digit++];
    s->prefix |= digit << shift;
}

/* The rank from 0 of the value that a share of `all` does not exceed. */
static uint64_t rank_of(double fraction, uint64_t all) {
    double rank = ceil(fraction * (double)all) - 1;
    if (rank <= 0)
        return 0;
    return rank < (double)(all - 1) ? (uint64_t)rank : all - 1;
}

static snow_status select_keys(const snow_census *census, int64_t stride,
                               const double *fractions, size_t count,
                               double *out) {
    search searches[SNOW_QUANTILES_MOST] = {{0}};
    size_t bytes = count * DIGITS * sizeof(uint64_t);
    uint64_t *counts = snow_allocate(census->volume->context, bytes);
    if (!counts)
        return SNOW_NO_MEMORY;
    for (size_t n = 0; n < count; n++)
        searches[n].counts = counts + n * DIGITS;
    for (int shift = 64 - DIGIT_BITS; shift >= 0; shift -= DIGIT_BITS) {
        memset(counts, 0, bytes);
        uint64_t all =
            count_digits(census->volume, stride, searches, count, shift);
        for (size_t n = 0; n < count && all; n++) {
            if (shift == 64 - DIGIT_BITS)
                searches[n].rank = rank_of(fractions[n], all);
            take_digit(&searches[n], shift);
        }
    }
    for (size_t n = 0; n < count; n++)
        out[n] = value_of(searches[n].prefix);
    snow_release(census->volume->context, counts);
    return SNOW_OK;
}

snow_status snow_quantiles(const snow_census *census, snow_effort effort,
                           const double *fractions, size_t count, double *out) {
    if (!census->counts)
        return select_keys(census, stride_of(census->volume, effort), fractions,
                           count, out);
    for (size_t n = 0; n < count; n++)
        out[n] =
            counted_quantile(census, rank_of(fractions[n], census->finite));
    return SNOW_OK;
}
