/* classify/quantile.c - order statistics of a volume's values, exact and
 * without a copy of them.
 *
 * Doubles are turned to 64-bit keys of the same order and the wanted one is
 * found 16 bits at a time, most significant first, by counting (radix
 * selection): four passes over the voxels whatever the range of values, which
 * equal bins could not do for data from 1e-3 to 1e38. */
#include "classify/look.h"

#include <math.h>
#include <string.h>

#define BLOCK 1024
#define DIGIT_BITS 16
#define DIGITS (1 << DIGIT_BITS)

static int64_t voxel_count(const snow_volume *volume) {
    const int64_t *dims = volume->info.dims;
    return dims[0] * dims[1] * dims[2];
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

void snow_take_census(const snow_volume *volume, snow_census *out) {
    snow_census census = {0, NAN, NAN, 0};
    double values[BLOCK];
    size_t count;
    for (int64_t at = 0; at < voxel_count(volume); at += (int64_t)count) {
        count = read_block(volume, at, values);
        for (size_t i = 0; i < count; i++) {
            double value = values[i];
            if (!isfinite(value))
                continue;
            if (!census.finite++)
                census.min = census.max = value;
            if (value < census.min) {
                census.min = value;
                census.at_min = 0;
            }
            census.at_min += value == census.min;
            if (value > census.max)
                census.max = value;
        }
    }
    *out = census;
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

/* Counts the next digit of all values that begin as a search's prefix does. */
static void count_digits(const snow_volume *volume, search *searches,
                         size_t count, int shift) {
    double values[BLOCK];
    size_t got;
    uint64_t above =
        shift + DIGIT_BITS < 64 ? ~UINT64_C(0) << (shift + DIGIT_BITS) : 0;
    for (int64_t at = 0; at < voxel_count(volume); at += (int64_t)got) {
        got = read_block(volume, at, values);
        for (size_t i = 0; i < got; i++) {
            if (!isfinite(values[i]))
                continue;
            uint64_t key = key_of(values[i]);
            for (size_t n = 0; n < count; n++)
                if ((key & above) == searches[n].prefix)
                    searches[n].counts[key >> shift & (DIGITS - 1)]++;
        }
    }
}

static void take_digit(search *s, int shift) {
    uint64_t digit = 0;
    while (s->rank >= s->counts[digit])
        s->rank -= s->counts[digit++];
    s->prefix |= digit << shift;
}

snow_status snow_quantiles(const snow_volume *volume, uint64_t finite,
                           const double *fractions, size_t count, double *out) {
    search searches[SNOW_QUANTILES_MOST];
    size_t bytes = count * DIGITS * sizeof(uint64_t);
    uint64_t *counts = snow_allocate(volume->context, bytes);
    if (!counts)
        return SNOW_NO_MEMORY;
    for (size_t n = 0; n < count; n++) {
        double rank = ceil(fractions[n] * (double)finite) - 1;
        rank = rank > 0 ? rank : 0;
        uint64_t last = finite - 1;
        searches[n] = (search){0, rank < (double)last ? (uint64_t)rank : last,
                               counts + n * DIGITS};
    }
    for (int shift = 64 - DIGIT_BITS; shift >= 0; shift -= DIGIT_BITS) {
        memset(counts, 0, bytes);
        count_digits(volume, searches, count, shift);
        for (size_t n = 0; n < count; n++)
            take_digit(&searches[n], shift);
    }
    for (size_t n = 0; n < count; n++)
        out[n] = value_of(searches[n].prefix);
    snow_release(volume->context, counts);
    return SNOW_OK;
}
