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

/* --- differences ---------------------------------------------------------- */

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

/* A voxel of a row of a sheet: its value by its weight, and the weight. */
static void voxel_at(const snow_value_store *s, const snow_value_sheet *sheet,
                     int64_t column, int64_t row, int *value, int *weight) {
    int64_t next = sheet->between ? s->rows + 2 * s->margin : 0;
    const int64_t *rows = snow_value_at(s, sheet->slice) + row;
    int a = s->values[rows[0] + column], b = s->values[rows[next] + column];
    const bool has[2] = {a != SNOW_VALUE_HOLE, b != SNOW_VALUE_HOLE};
    *weight = value_toward(has[0] ? SNOW_VALUE_FULL : 0,
                           has[1] ? SNOW_VALUE_FULL : 0, sheet->toward);
    *value = value_toward(has[0] ? a : 0, has[1] ? b : 0, sheet->toward);
}

static void spline(double at, double out[4]) {
    double t = at - floor(at), s = 1 - t;
    out[0] = s * s * s / 6;
    out[1] = (4 - 6 * t * t + 3 * t * t * t) / 6;
    out[2] = (4 - 6 * s * s + 3 * s * s * s) / 6;
    out[3] = t * t * t / 6;
}

static int16_t cubic_at(const value_sides *s, const snow_value_sheet *sheet,
                        int lane) {
    double u[4], v[4], value = 0, weight = 0;
    int along = s->lanes ? s->lanes->at[lane] : lane;
    spline(s->lanes ? value_lane_part(s->lanes, s->step, lane) : s->at[0], u);
    spline(s->at[1], v);
    for (int n = 0; n < 16; n++) {
        int here, full;
        voxel_at(s->splat->store, sheet, s->column + along + n % 4 - 1,
                 s->row + n / 4 - 1, &here, &full);
        value += u[n % 4] * v[n / 4] * here;
        weight += u[n % 4] * v[n / 4] * full;
    }
    return weighed((int)floor(value + 0.5), (int)floor(weight + 0.5));
}

/* What sheet `n` has at lane `lane` of a row of another one. */
static int16_t value_at(const value_sides *s, int n, int lane) {
    if (n < 0 || n >= s->splat->sheet_count)
        return SNOW_VALUE_HOLE;
    const snow_value_sheet *sheet = s->splat->sheets + n;
    int along = s->lanes ? s->lanes->weight[lane] : s->weights[0];
    int64_t first = s->column + (s->lanes ? s->lanes->at[lane] : lane);
    int value[2], weight[2];
    if (s->splat->store->cubic)
        return cubic_at(s, sheet, lane);
    for (int y = 0; y < 2; y++) {
        int v[2], w[2];
        for (int x = 0; x < 2; x++)
            voxel_at(s->splat->store, sheet, first + x, s->row + y, &v[x],
                     &w[x]);
        value[y] = value_between(v[0], v[1], along);
        weight[y] = value_between(w[0], w[1], along);
    }
    return weighed(value_between(value[0], value[1], s->weights[1]),
                   value_between(weight[0], weight[1], s->weights[1]));
}

/* Between the slices in front and behind, of a slice between the sheets half
 * way to those beside it, which have nothing. */
static int16_t near_difference(const value_sides *s, int lane) {
    const snow_value_sheet *sheets = s->splat->sheets;
    const double step = sheets[1].at - sheets[0].at;
    const int count = (int)rint(1 / fabs(step)), past = s->sheet % count;
    int front = s->sheet - (past ? past : count / 2), back = front + count;
    int before = value_at(s, step > 0 ? front : back, lane);
    int after = value_at(s, step > 0 ? back : front, lane);
    if (before == SNOW_VALUE_HOLE || after == SNOW_VALUE_HOLE)
        return 0;
    return (int16_t)value_saturate(2 * (after - before));
}

void snow_value_bridge(const value_sides *s, uint32_t lanes, int16_t *across) {
    const snow_value_sheet *sheet = s->splat->sheets + s->sheet;
    bool lone = sheet->between != sheet->between_across;
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
