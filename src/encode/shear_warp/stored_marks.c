/* encode/shear_warp/stored_marks.c - which voxels of a row of stored values are
 * outside of transparent intervals, without making quantized values of them:
 * the fixed-point quantizer rises or falls, so that an interval is a range of
 * stored values. */
#include "encode/shear_warp/encode.h"

#include <string.h>

/* --- ranges --------------------------------------------------------------- */

/* The native that is `step` from the one of number 0. */
static int32_t native_of(const snow_fixed_quantizer *fixed, int32_t step) {
    bool falls = snow_quantize_fixed(fixed, fixed->top) <
                 snow_quantize_fixed(fixed, fixed->bottom);
    return falls ? fixed->top - step : fixed->bottom + step;
}

/* The first step of which the number is not below v; one more than all: none
 * is. */
static int32_t step_of(const snow_fixed_quantizer *fixed, int v) {
    int32_t low = 0, high = fixed->top - fixed->bottom + 1;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (snow_quantize_fixed(fixed, native_of(fixed, middle)) < v)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

snow_value_stored_range
snow_value_stored_range_of(const snow_quantizer *quantizer,
                           snow_transparent_interval interval) {
    const snow_fixed_quantizer *fixed = &quantizer->scale.fixed;
    const bool narrow = snow_type_size(quantizer->type) == 1;
    const int32_t least = snow_type_lowest(quantizer->type);
    int32_t from = step_of(fixed, interval.first),
            end = step_of(fixed, interval.last + 1);
    if (from >= end)
        return (snow_value_stored_range){.none = true};
    int32_t a = native_of(fixed, from), b = native_of(fixed, end - 1);
    int32_t first = a < b ? a : b, last = a < b ? b : a;
    if (first == fixed->bottom) /* those beyond are clamped */
        first = least;
    if (last == fixed->top)
        last = least + (narrow ? UINT8_MAX : UINT16_MAX);
    return (snow_value_stored_range){.first = (uint16_t)first,
                                     .width = (uint16_t)(last - first)};
}

/* --- rows ----------------------------------------------------------------- */

/* Whether the number beyond a side is outside of an interval: that of a voxel,
 * of which the one inside is `step` on. */
static bool is_beyond_outside(const snow_quantizer *quantizer,
                              const unsigned char *stored, int64_t column,
                              int64_t step,
                              snow_transparent_interval interval) {
    int64_t size = (int64_t)snow_type_size(quantizer->type);
    int16_t side, inside;
    snow_quantize_row(quantizer, stored + column * size, 1, &side);
    snow_quantize_row(quantizer, stored + (column + step) * size, 1, &inside);
    int16_t beyond = snow_value_beyond(side, inside, false);
    interval = snow_transparent_open(interval);
    return beyond < interval.first || beyond > interval.last;
}

/* Sets `count` bits from `first` on. */
static void set_bits(uint32_t *bits, size_t first, size_t count) {
    for (const size_t end = first + count; first < end;) {
        const size_t at = first % 32, left = end - first;
        const size_t some = left < 32 - at ? left : 32 - at;
        bits[first / 32] |= ~UINT32_C(0) >> (32 - some) << at;
        first += some;
    }
}

/* A bit for each native of a row that is not in a range, from bit `by` on; to
 * so many words. */
static void find_outside(const snow_value_store *s,
                         const snow_value_store_params *params,
                         const snow_value_stored_range *range,
                         const unsigned char *stored, int by, uint32_t *out,
                         size_t words) {
    const snow_value_loops *loops = snow_value_loops_of(params->isa);
    const size_t count = (size_t)s->columns;
    const size_t made = (count + (size_t)by + 63) / 64 * 2;
    if (made < words)
        memset(out + made, 0, (words - made) * sizeof *out);
    if (range->none) {
        memset(out, 0, made * sizeof *out);
        set_bits(out, (size_t)by, count);
    } else if (snow_type_size(params->quantizer->type) == 1)
        loops->outside_bytes(stored, count, by, *range, out);
    else
        loops->outside_words(stored, count, by, *range, out);
}

void snow_value_mark_stored(const snow_value_store *s,
                            const snow_value_store_params *params,
                            const snow_value_stored_range *range, int interval,
                            const unsigned char *stored, uint32_t *bits) {
    const int64_t size = (int64_t)snow_type_size(params->quantizer->type);
    const int64_t step = s->columns > 1;
    const size_t margin = (size_t)s->margin, count = (size_t)s->columns;
    find_outside(s, params, range, stored, s->margin, bits,
                 snow_value_words(s));
    for (int end = 0; end < 2; end++) {
        int64_t column = end ? s->columns - 1 : 0, in = end ? -step : step;
        const size_t at = (size_t)column + margin;
        const unsigned char *side = stored + column * size;
        const unsigned char *next = side + in * size;
        const bool same =
            side[0] == next[0] && (size == 1 || side[1] == next[1]);
        if (same ? bits[at / 32] >> at % 32 & 1
                 : is_beyond_outside(params->quantizer, stored, column, in,
                                     s->intervals[interval]))
            set_bits(bits, end ? margin + count : 0, margin);
    }
}

int64_t snow_value_count_stored(const snow_value_store *s,
                                const snow_value_store_params *params,
                                const unsigned char *stored, uint32_t *bits) {
    const size_t words = ((size_t)s->columns + 63) / 64 * 2;
    int64_t outside = 0;
    for (int n = 0; n < s->counted_ranges; n++) {
        find_outside(s, params, &s->counted[n], stored, 0, bits, words);
        outside += snow_value_loops_of(params->isa)->count(bits, words);
    }
    return s->counted_ranges * s->columns - outside;
}
