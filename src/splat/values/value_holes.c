/* splat/values/value_holes.c - values and differences beside holes, number by
 * number; see holes.tmpl.h. */
#include "splat/values/value_room.h"

#include <math.h>

/* The mean of what is there, from the sum of its values by weights. */
static int16_t weighed(int value, int weight) {
    if (weight >= SNOW_VALUE_FULL)
        return (int16_t)value;
    if (weight < SNOW_VALUE_FULL / 2)
        return SNOW_VALUE_HOLE;
    double mean = floor((double)value * SNOW_VALUE_FULL / weight + 0.5);
    return (int16_t)fmax(fmin(mean, INT16_MAX), SNOW_VALUE_HOLE + 1);
}

void snow_value_weigh(int16_t values[32], const int16_t weights[32],
                      uint32_t lanes) {
    for (; lanes; lanes &= lanes - 1) {
        int n = __builtin_ctz(lanes);
        values[n] = weighed(values[n], weights[n]);
    }
}

/* --- differences ------------------------------------------------------------
 */

/* Twice the difference for one step: of both sides, of the one that is there,
 * or none. */
static int16_t quotient(int before, int here, int after) {
    bool front = before != SNOW_VALUE_HOLE, back = after != SNOW_VALUE_HOLE;
    if (front && back)
        return (int16_t)value_saturate(after - before);
    if (front || back)
        return (int16_t)value_saturate(2 *
                                       (back ? after - here : here - before));
    return 0;
}

void snow_value_slopes(const int16_t *before, const int16_t *here,
                       const int16_t *after, int16_t out[32]) {
    for (int n = 0; n < 32; n++)
        out[n] = quotient(before[n], here[n], after[n]);
}

/* What sheet `n` has at lane `lane` of a row of another one. */
static int16_t value_at(const value_sides *s, int n, int lane) {
    const snow_value_store *store = s->splat->store;
    if (n < 0 || n >= s->splat->sheet_count)
        return SNOW_VALUE_HOLE;
    const snow_value_sheet *sheet = s->splat->sheets + n;
    const int64_t *rows = snow_value_at(store, sheet->slice) + s->row;
    int64_t next = sheet->half ? store->rows + 2 * store->margin : 0;
    int along = s->lanes ? s->lanes->weight[lane] : s->weights[0];
    int64_t first = s->column + (s->lanes ? s->lanes->at[lane] : lane);
    int value[2], weight[2];
    for (int y = 0; y < 2; y++) {
        int v[2], w[2];
        for (int x = 0; x < 2; x++) {
            int64_t column = first + x;
            int a = store->values[rows[y] + column];
            int b = store->values[rows[y + next] + column];
            w[x] = SNOW_VALUE_FULL / 2 *
                   ((a != SNOW_VALUE_HOLE) + (b != SNOW_VALUE_HOLE));
            a = a == SNOW_VALUE_HOLE ? 0 : a;
            b = b == SNOW_VALUE_HOLE ? 0 : b;
            v[x] = (a + b + 1) >> 1;
        }
        value[y] = value_between(v[0], v[1], along);
        weight[y] = value_between(w[0], w[1], along);
    }
    return weighed(value_between(value[0], value[1], s->weights[1]),
                   value_between(weight[0], weight[1], s->weights[1]));
}

/* Between the sheets in front and behind, where slices have nothing. */
static int16_t near_difference(const value_sides *s, int lane) {
    const snow_value_sheet *sheet = s->splat->sheets + s->sheet;
    int rising = s->sheet + 1 < s->splat->sheet_count
                     ? (sheet[1].at > sheet->at ? 1 : -1)
                     : (sheet->at > sheet[-1].at ? 1 : -1);
    int before = value_at(s, s->sheet - rising, lane);
    int after = value_at(s, s->sheet + rising, lane);
    if (before == SNOW_VALUE_HOLE || after == SNOW_VALUE_HOLE)
        return 0;
    return (int16_t)value_saturate(2 * (after - before));
}

void snow_value_bridge(const value_sides *s, uint32_t lanes, int16_t *across) {
    const snow_value_sheet *sheet = s->splat->sheets + s->sheet;
    bool lone = sheet->half != sheet->half_across;
    bool first = lone || sheet->before == sheet->slice;
    bool last = lone || sheet->after == sheet->slice;
    if (sheet->before == sheet->after) /* the only slice */
        return;
    for (; lanes; lanes &= lanes - 1) {
        int n = __builtin_ctz(lanes);
        int before = first ? SNOW_VALUE_HOLE : s->before[n];
        int after = last ? SNOW_VALUE_HOLE : s->after[n];
        bool none = before == SNOW_VALUE_HOLE && after == SNOW_VALUE_HOLE;
        across[n] =
            none ? near_difference(s, n) : quotient(before, s->here[n], after);
    }
}
