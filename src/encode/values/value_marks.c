/* encode/values/value_marks.c - which voxels of a row of natives are outside of
 * invisible runs, without making numbers of them: the rule rises or falls, so
 * that a run is a range of natives. */
#include "encode/values/value_encode.h"

#include <string.h>

/* --- ranges -----------------------------------------------------------------
 */

/* The native that is `step` from the one of number 0. */
static int32_t native_of(const snow_value_rule *rule, int32_t step) {
    bool falls = snow_value_by_rule(rule, rule->top) <
                 snow_value_by_rule(rule, rule->bottom);
    return falls ? rule->top - step : rule->bottom + step;
}

/* The first step of which the number is not below v; one more than all: none
 * is. */
static int32_t step_of(const snow_value_rule *rule, int v) {
    int32_t low = 0, high = rule->top - rule->bottom + 1;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (snow_value_by_rule(rule, native_of(rule, middle)) < v)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

snow_value_natives snow_value_natives_of(const snow_value_coder *coder,
                                         snow_value_run run) {
    const snow_value_rule *rule = &coder->scale.rule;
    const bool narrow = snow_type_size(coder->type) == 1;
    const int32_t least = coder->type == SNOW_TYPE_INT8    ? INT8_MIN
                          : coder->type == SNOW_TYPE_INT16 ? INT16_MIN
                                                           : 0;
    int32_t from = step_of(rule, run.first), end = step_of(rule, run.last + 1);
    if (from >= end)
        return (snow_value_natives){.none = true};
    int32_t a = native_of(rule, from), b = native_of(rule, end - 1);
    int32_t first = a < b ? a : b, last = a < b ? b : a;
    if (first == rule->bottom) /* those beyond are clamped */
        first = least;
    if (last == rule->top)
        last = least + (narrow ? UINT8_MAX : UINT16_MAX);
    return (snow_value_natives){.first = (uint16_t)first,
                                .width = (uint16_t)(last - first)};
}

/* --- rows -------------------------------------------------------------------
 */

/* Bits first .. first + count - 1. */
static void set_bits(uint32_t *bits, size_t first, size_t count) {
    for (size_t n = first; n < first + count; n++)
        bits[n / 32] |= UINT32_C(1) << n % 32;
}

/* Bits of a row, at bit `first` of `words` words, which are zeros. */
static void place_bits(const uint64_t *from, size_t count, size_t first,
                       uint32_t *bits, size_t words) {
    const size_t shift = first % 32;
    for (size_t n = 0; n < count; n += 64) {
        size_t word = (first + n) / 32;
        uint64_t here = from[n / 64];
        bits[word] |= (uint32_t)(here << shift);
        if (word + 1 < words)
            bits[word + 1] |= (uint32_t)(here << shift >> 32);
        if (shift && word + 2 < words)
            bits[word + 2] |= (uint32_t)(here >> (64 - shift));
    }
}

/* Whether the number beyond a side is outside of a run: that of a voxel, of
 * which the one inside is `step` on. */
static bool is_beyond_outside(const snow_value_coder *coder,
                              const unsigned char *natives, int64_t column,
                              int64_t step, snow_value_run run) {
    int64_t size = (int64_t)snow_type_size(coder->type);
    int16_t side, inside;
    snow_value_code_row(coder, natives + column * size, 1, &side);
    snow_value_code_row(coder, natives + (column + step) * size, 1, &inside);
    int16_t beyond = snow_value_beyond(side, inside, false);
    return beyond < run.first || beyond > run.last;
}

void snow_value_mark_natives(const snow_value_store *s,
                             const snow_value_store_params *params,
                             const snow_value_natives *range, int run,
                             const unsigned char *natives, uint64_t *room,
                             uint32_t *bits) {
    const snow_value_loops *loops = snow_value_loops_of(params->isa);
    const size_t count = (size_t)s->columns, margin = (size_t)s->margin;
    const size_t size = snow_type_size(params->coder->type);
    const int64_t step = s->columns > 1;
    memset(bits, 0, snow_value_words(s) * sizeof *bits);
    if (range->none)
        memset(room, 0xff, (count + 63) / 64 * sizeof *room);
    else if (size == 1)
        loops->outside_bytes(natives, count, *range, room);
    else
        loops->outside_words(natives, count, *range, room);
    if (count % 64)
        room[count / 64] &= ~UINT64_C(0) >> (64 - count % 64);
    place_bits(room, count, margin, bits, snow_value_words(s));
    for (int end = 0; end < 2; end++) {
        int64_t column = end ? s->columns - 1 : 0, in = end ? -step : step;
        const unsigned char *side = natives + column * (int64_t)size;
        bool same = memcmp(side, side + in * (int64_t)size, size) == 0;
        if (same ? room[column / 64] >> column % 64 & 1
                 : is_beyond_outside(params->coder, natives, column, in,
                                     s->runs[run]))
            set_bits(bits, end ? margin + count : 0, margin);
    }
}
