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

/* --- borders -------------------------------------------------------------- */

/* The bells of a border: as far as gradients of values, and what is stored. */
#define BORDER_REACH 2

/* Columns around a row of samples, and of each what its holes weigh in the rows
 * and slices around, and how that grows along v and p. */
#define HOLE_COLUMNS (32 * SNOW_VALUE_SPREAD_MOST + 8)
typedef struct hole_columns {
    int64_t first, count;
    bool any, some[HOLE_COLUMNS]; /* there are holes; in a column */
    double weight[HOLE_COLUMNS], along[HOLE_COLUMNS], across[HOLE_COLUMNS];
} hole_columns;

static int64_t clamp(int64_t i, int64_t count) {
    return i < 0 ? 0 : i < count ? i : count - 1;
}

/* Adds those of a row of voxels. */
static void add_holes(const snow_value_store *s, int64_t slice, int64_t row,
                      const double by[3], hole_columns *out) {
    const int64_t *at = snow_value_at(s, slice) + row;
    const int32_t *ends =
        s->ends[slice * (s->rows + 2 * s->margin) + s->margin + row];
    int64_t from = out->first > ends[0] ? out->first : ends[0];
    int64_t end = out->first + out->count;
    end = end < ends[1] ? end : ends[1];
    const int16_t *values = s->values + *at;
    bool any = false;
    for (int64_t i = from; i < end; i++)
        any |= values[i] == SNOW_VALUE_HOLE;
    if (!any)
        return;
    if (!out->any)
        for (int64_t n = 0; n < out->count; n++)
            out->weight[n] = out->along[n] = out->across[n] = out->some[n] = 0;
    out->any = true;
    for (int64_t i = from; i < end; i++)
        if (values[i] == SNOW_VALUE_HOLE) {
            out->some[i - out->first] = true;
            out->weight[i - out->first] += by[0];
            out->along[i - out->first] += by[1];
            out->across[i - out->first] += by[2];
        }
}

/* Those around the active samples of a row, from the first to the last.  Beyond
 * a side all is as the last voxels there. */
static void find_holes(const snow_value_store *s, const value_spot *first,
                       const value_spot *last, hole_columns *out) {
    double place[3];
    value_place_of(first, place);
    const value_bell v = value_bell_at(place[1], s->rows, BORDER_REACH);
    const value_bell w = value_bell_at(place[2], s->slices, BORDER_REACH);
    out->any = false;
    out->first = clamp(first->i - BORDER_REACH + 1, s->columns);
    out->count = clamp(last->i + BORDER_REACH, s->columns) - out->first + 1;
    for (int z = 0; z < w.taps; z++)
        for (int y = 0; y < v.taps; y++) {
            const double by[3] = {w.weight[z] * v.weight[y],
                                  w.weight[z] * v.slope[y],
                                  w.slope[z] * v.weight[y]};
            if (w.weight[z] != 0 || w.slope[z] != 0)
                add_holes(s, clamp(w.at[z], s->slices), clamp(v.at[y], s->rows),
                          by, out);
        }
}

/* Of a sample: twice the gradient of what is there, as numbers; zeros are
 * there. */
static void lean_of(const snow_value_store *s, const hole_columns *holes,
                    const value_spot *spot, int16_t out[3]) {
    double place[3], sums[3] = {0, 0, 0};
    bool near = false;
    for (int x = 1 - BORDER_REACH; x <= BORDER_REACH; x++)
        near |= holes->some[clamp(spot->i + x, s->columns) - holes->first];
    if (!near)
        return;
    value_place_of(spot, place);
    const value_bell u = value_bell_at(place[0], s->columns, BORDER_REACH);
    for (int x = 0; x < u.taps; x++) {
        int64_t n = clamp(u.at[x], s->columns) - holes->first;
        sums[0] += u.slope[x] * holes->weight[n];
        sums[1] += u.weight[x] * holes->along[n];
        sums[2] += u.weight[x] * holes->across[n];
    }
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (int16_t)floor(-2 * SNOW_VALUE_MOST * sums[axis] + 0.5);
}

/* A row of samples on an end of their slab. */
static void lean_row(value_sample at, uint32_t active, int end,
                     int16_t *const border[3]) {
    const snow_value_store *s = at.splat->store;
    hole_columns holes;
    at.lane = __builtin_ctz(active);
    const value_spot first = value_spot_of(&at, end);
    at.lane = 31 - __builtin_clz(active);
    const value_spot last = value_spot_of(&at, end);
    find_holes(s, &first, &last, &holes);
    for (int n = 0; active; active &= active - 1, n++) {
        int16_t lean[3] = {0, 0, 0};
        at.lane = __builtin_ctz(active);
        const value_spot spot = value_spot_of(&at, end);
        if (holes.any)
            lean_of(s, &holes, &spot, lean);
        for (int axis = 0; axis < 3; axis++)
            border[axis][n] = lean[axis];
    }
}

void snow_value_lean(const value_sample *first, const value_slab *slab,
                     const bool holes[2], value_queue *q, int count) {
    value_sample at = *first;
    for (uint32_t rows = slab->rows; rows; rows &= rows - 1) {
        at.row = __builtin_ctz(rows);
        const uint32_t active = slab->active[at.row];
        const int some = __builtin_popcount(active);
        for (int end = 0; end < 2; end++) {
            int16_t *border[3];
            for (int axis = 0; axis < 3; axis++) {
                border[axis] = q->border[3 * end + axis] + count;
                memset(border[axis], 0, (size_t)some * sizeof **border);
            }
            if (active && holes[end])
                lean_row(at, active, end, border);
        }
        count += some;
    }
}
