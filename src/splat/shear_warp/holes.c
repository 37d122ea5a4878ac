/* splat/shear_warp/holes.c - values and differences beside holes, number by
 * number; see holes.tmpl.h. */
#include "splat/shear_warp/scratch.h"

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

/* A voxel of a row of a resampled slice: its value by its weight, and the
 * weight. */
static void voxel_at(const snow_value_store *s,
                     const snow_resampled_slice *resampled, int64_t column,
                     int64_t row, int *value, int *weight) {
    int64_t next = resampled->between ? s->rows + 2 * s->margin : 0;
    const int64_t *rows = snow_value_at(s, resampled->slice) + row;
    int a = s->values[rows[0] + column], b = s->values[rows[next] + column];
    const bool has[2] = {a != SNOW_VALUE_HOLE, b != SNOW_VALUE_HOLE};
    *weight = value_toward(has[0] ? SNOW_VALUE_FULL : 0,
                           has[1] ? SNOW_VALUE_FULL : 0, resampled->toward);
    *value = value_toward(has[0] ? a : 0, has[1] ? b : 0, resampled->toward);
}

static void spline(double at, double out[4]) {
    double t = at - floor(at), s = 1 - t;
    out[0] = s * s * s / 6;
    out[1] = (4 - 6 * t * t + 3 * t * t * t) / 6;
    out[2] = (4 - 6 * s * s + 3 * s * s * s) / 6;
    out[3] = t * t * t / 6;
}

static int16_t cubic_at(const value_sides *s,
                        const snow_resampled_slice *resampled, int lane) {
    double u[4], v[4], value = 0, weight = 0;
    int along = s->lanes ? s->lanes->at[lane] : lane;
    spline(s->lanes ? value_lane_part(s->lanes, s->step, lane) : s->at[0], u);
    spline(s->at[1], v);
    for (int n = 0; n < 16; n++) {
        int here, full;
        voxel_at(s->splat->store, resampled, s->column + along + n % 4 - 1,
                 s->row + n / 4 - 1, &here, &full);
        value += u[n % 4] * v[n / 4] * here;
        weight += u[n % 4] * v[n / 4] * full;
    }
    return weighed((int)floor(value + 0.5), (int)floor(weight + 0.5));
}

/* What resampled slice `n` has at lane `lane` of a row of another one. */
static int16_t value_at(const value_sides *s, int n, int lane) {
    if (n < 0 || n >= s->splat->resampled_count)
        return SNOW_VALUE_HOLE;
    const snow_resampled_slice *resampled = s->splat->resampled_slices + n;
    int along = s->lanes ? s->lanes->weight[lane] : s->weights[0];
    int64_t first = s->column + (s->lanes ? s->lanes->at[lane] : lane);
    int value[2], weight[2];
    if (s->splat->store->cubic)
        return cubic_at(s, resampled, lane);
    for (int y = 0; y < 2; y++) {
        int v[2], w[2];
        for (int x = 0; x < 2; x++)
            voxel_at(s->splat->store, resampled, first + x, s->row + y, &v[x],
                     &w[x]);
        value[y] = value_between(v[0], v[1], along);
        weight[y] = value_between(w[0], w[1], along);
    }
    return weighed(value_between(value[0], value[1], s->weights[1]),
                   value_between(weight[0], weight[1], s->weights[1]));
}

/* Between the slices in front and behind, of a slice between the resampled
 * slices half way to those beside it, which have nothing. */
static int16_t near_difference(const value_sides *s, int lane) {
    const snow_resampled_slice *resampled_slices = s->splat->resampled_slices;
    const double step = resampled_slices[1].at - resampled_slices[0].at;
    const int count = (int)rint(1 / fabs(step)), past = s->resampled % count;
    int front = s->resampled - (past ? past : count / 2), back = front + count;
    int before = value_at(s, step > 0 ? front : back, lane);
    int after = value_at(s, step > 0 ? back : front, lane);
    if (before == SNOW_VALUE_HOLE || after == SNOW_VALUE_HOLE)
        return 0;
    return (int16_t)value_saturate(2 * (after - before));
}

void snow_value_bridge(const value_sides *s, uint32_t lanes, int16_t *across) {
    const snow_resampled_slice *resampled =
        s->splat->resampled_slices + s->resampled;
    bool lone = resampled->between != resampled->between_across;
    bool first = lone || resampled->before == resampled->slice;
    bool last = lone || resampled->after == resampled->slice;
    if (resampled->before == resampled->after) /* the only slice */
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
#define TAPS (2 * BORDER_REACH)

/* Columns around the samples of a tile. */
#define HOLE_COLUMNS (32 * SNOW_VALUE_SPREAD_MOST + 8)

/* Of each column of some rows of voxels: whether there are holes, what they
 * weigh, and how that grows along v and p. */
typedef struct hole_columns {
    int64_t row; /* -1: none */
    bool any;
    unsigned char some[HOLE_COLUMNS];
    double weight[HOLE_COLUMNS], along[HOLE_COLUMNS], across[HOLE_COLUMNS];
} hole_columns;

/* A bell along an axis, and the part of a voxel that it is for, of 32768. */
typedef struct part_bell {
    int part; /* -1: none */
    value_bell bell;
} part_bell;

/* The holes around the samples of a phase on a resampled slice.  The bells'
 * sums are products: those along p are made once for a row of voxels, those
 * along v once for a row of samples. */
typedef struct hole_slice {
    const snow_value_store *store;
    int64_t first, count; /* columns */
    value_bell slices;
    part_bell u, v;
    hole_columns rows[TAPS]; /* sums along p of voxels' rows, [row % TAPS] */
    hole_columns sums;       /* along p and v, of a row of samples */
} hole_slice;

static int64_t clamp(int64_t i, int64_t count) {
    return i < 0 ? 0 : i < count ? i : count - 1;
}

/* The bell around a place that is such a part of a voxel beyond voxel 0. */
static const value_bell *bell_of(part_bell *kept, int part, int64_t count) {
    if (kept->part != part)
        *kept = (part_bell){part,
                            value_bell_at(part / 32768.0, count, BORDER_REACH)};
    return &kept->bell;
}

static void clear_columns(hole_columns *out, int64_t count) {
    memset(out->some, 0, (size_t)count);
    memset(out->weight, 0, (size_t)count * sizeof *out->weight);
    memset(out->along, 0, (size_t)count * sizeof *out->along);
    memset(out->across, 0, (size_t)count * sizeof *out->across);
}

/* Adds the holes of a slice's row, by their weight along p and its growth. */
static void add_slice(const hole_slice *resampled, int64_t slice, double weight,
                      double slope, hole_columns *out) {
    const snow_value_store *s = resampled->store;
    const int64_t *at = snow_value_at(s, slice) + out->row;
    const int32_t *ends =
        s->ends[slice * (s->rows + 2 * s->margin) + s->margin + out->row];
    int64_t from = resampled->first > ends[0] ? resampled->first : ends[0];
    int64_t end = resampled->first + resampled->count;
    end = end < ends[1] ? end : ends[1];
    const int16_t *values = s->values + *at;
    bool any = false;
    for (int64_t i = from; i < end; i++)
        any |= values[i] == SNOW_VALUE_HOLE;
    if (!any)
        return;
    if (!out->any)
        clear_columns(out, resampled->count);
    out->any = true;
    for (int64_t i = from, n = from - resampled->first; i < end; i++, n++) {
        const bool hole = values[i] == SNOW_VALUE_HOLE;
        out->some[n] |= hole;
        out->weight[n] += hole ? weight : 0;
        out->across[n] += hole ? slope : 0;
    }
}

/* The sums along p of a row of voxels. */
static const hole_columns *row_of(hole_slice *resampled, int64_t row) {
    const snow_value_store *s = resampled->store;
    const value_bell *w = &resampled->slices;
    hole_columns *out = &resampled->rows[row % TAPS];
    if (out->row == row)
        return out;
    out->row = row;
    out->any = false;
    for (int z = 0; z < w->taps; z++)
        if (w->weight[z] != 0 || w->slope[z] != 0)
            add_slice(resampled, clamp(w->at[z], s->slices), w->weight[z],
                      w->slope[z], out);
    return out;
}

/* Adds a row of voxels to a row of samples, by its weight along v and its
 * growth. */
static void add_row(const hole_columns *row, int64_t count, double weight,
                    double slope, hole_columns *out) {
    if (!row->any)
        return;
    if (!out->any)
        clear_columns(out, count);
    out->any = true;
    for (int64_t n = 0; n < count; n++) {
        out->some[n] |= row->some[n];
        out->weight[n] += weight * row->weight[n];
        out->along[n] += slope * row->weight[n];
        out->across[n] += weight * row->across[n];
    }
}

/* The sums for the row of samples that a spot is of.  Beyond a side all is as
 * the last voxels there. */
static void sum_rows(hole_slice *resampled, const value_spot *spot) {
    const int64_t rows = resampled->store->rows;
    const value_bell *v = bell_of(&resampled->v, spot->wv, rows);
    resampled->sums.any = false;
    for (int y = 0; y < v->taps; y++)
        add_row(row_of(resampled, clamp(spot->j + v->at[y], rows)),
                resampled->count, v->weight[y], v->slope[y], &resampled->sums);
}

/* Of a sample: twice the gradient of what is there, in steps of quantized
 * values; zeros are there. */
static void lean_of(hole_slice *resampled, const value_spot *spot,
                    int16_t out[3]) {
    const hole_columns *holes = &resampled->sums;
    const int64_t columns = resampled->store->columns;
    double sums[3] = {0, 0, 0};
    bool near = false;
    for (int x = 1 - BORDER_REACH; x <= BORDER_REACH; x++)
        near |= holes->some[clamp(spot->i + x, columns) - resampled->first];
    if (!near)
        return;
    const value_bell *u = bell_of(&resampled->u, spot->wu, columns);
    for (int x = 0; x < u->taps; x++) {
        int64_t n = clamp(spot->i + u->at[x], columns) - resampled->first;
        sums[0] += u->slope[x] * holes->weight[n];
        sums[1] += u->weight[x] * holes->along[n];
        sums[2] += u->weight[x] * holes->across[n];
    }
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (int16_t)floor(-2 * SNOW_VALUE_MOST * sums[axis] + 0.5);
}

/* A row of samples on an end of their slab. */
static void lean_row(hole_slice *resampled, value_sample at, uint32_t active,
                     int end, int16_t *const border[3]) {
    at.lane = __builtin_ctz(active);
    value_spot spot = value_spot_of(&at, end);
    sum_rows(resampled, &spot);
    for (int n = 0; resampled->sums.any && active; active &= active - 1, n++) {
        int16_t lean[3] = {0, 0, 0};
        at.lane = __builtin_ctz(active);
        spot = value_spot_of(&at, end);
        lean_of(resampled, &spot, lean);
        for (int axis = 0; axis < 3; axis++)
            border[axis][n] = lean[axis];
    }
}

/* Around the active samples of a phase on an end of its slab, of which there
 * are some. */
static void begin_resampled(value_sample at, const value_slab *slab, int end,
                            hole_slice *resampled) {
    const snow_value_store *s = at.splat->store;
    uint32_t lanes = 0;
    for (uint32_t rows = slab->rows; rows; rows &= rows - 1)
        lanes |= slab->active[__builtin_ctz(rows)];
    at.lane = __builtin_ctz(lanes);
    const value_spot first = value_spot_of(&at, end);
    at.lane = 31 - __builtin_clz(lanes);
    const value_spot last = value_spot_of(&at, end);
    double place[3];
    value_place_of(&first, place);
    resampled->store = s;
    resampled->first = clamp(first.i - BORDER_REACH + 1, s->columns);
    resampled->count =
        clamp(last.i + BORDER_REACH, s->columns) - resampled->first + 1;
    resampled->slices = value_bell_at(place[2], s->slices, BORDER_REACH);
    resampled->u.part = resampled->v.part = -1;
    for (int n = 0; n < TAPS; n++)
        resampled->rows[n].row = -1;
}

/* One end of a slab. */
static void lean_end(value_sample at, const value_slab *slab, int end,
                     value_queue *q, int count) {
    hole_slice resampled;
    bool begun = false;
    for (uint32_t rows = slab->rows; rows; rows &= rows - 1) {
        at.row = __builtin_ctz(rows);
        const uint32_t active = slab->active[at.row];
        int16_t *border[3];
        for (int axis = 0; axis < 3; axis++)
            border[axis] = q->border[3 * end + axis] + count;
        if (active && !begun)
            begin_resampled(at, slab, end, &resampled);
        begun |= active != 0;
        if (active)
            lean_row(&resampled, at, active, end, border);
        count += __builtin_popcount(active);
    }
}

void snow_value_lean(const value_sample *first, const value_slab *slab,
                     const bool holes[2], value_queue *q, int count) {
    int some = 0;
    for (uint32_t rows = slab->rows; rows; rows &= rows - 1)
        some += __builtin_popcount(slab->active[__builtin_ctz(rows)]);
    for (int end = 0; end < 2; end++) {
        for (int axis = 0; axis < 3; axis++)
            memset(q->border[3 * end + axis] + count, 0,
                   (size_t)some * sizeof **q->border);
        if (some && holes[end])
            lean_end(*first, slab, end, q, count);
    }
}
