/* splat/shear_warp/holes.tmpl.h - resampled slices where voxels have no value:
 * the mean of what is there, where that is half of the weights and more.
 * Included by sample.tmpl.h. */

/* 32 voxels, 0 in holes, and their weights. */
typedef struct NAME(part) {
    V(row) value, weight;
} NAME(part);

TARGET VALUE_INLINE NAME(part) NAME(part_of)(V(row) voxels) {
    const V(row) zero = V(row_set1)(0);
    NAME(part) part;
    part.weight = V(row_adds)(voxels, V(row_set1)(INT16_MAX));
    part.weight =
        V(row_min)(V(row_max)(part.weight, zero), V(row_set1)(SNOW_VALUE_FULL));
    V(row) there = V(row_subs)(zero, V(row_srl)(part.weight, 14));
    part.value = V(row_and)(voxels, there);
    return part;
}

/* As NAME(pair) of a slice or between it and the next one, and weights. */
TARGET VALUE_INLINE NAME(part) NAME(parts)(const NAME(source) *s, int64_t row,
                                           int by, bool between) {
    const int16_t *values = s->values + s->column + by;
    NAME(part) here = NAME(part_of)(V(row_load)(values + s->slice[row]));
    if (between) {
        NAME(part) next =
            NAME(part_of)(V(row_load)(values + s->slice[row + s->next]));
        here.value = NAME(toward)(here.value, next.value, s->toward);
        here.weight = NAME(toward)(here.weight, next.weight, s->toward);
    }
    return here;
}

TARGET VALUE_INLINE NAME(part) NAME(parts_along)(const NAME(source) *s,
                                                 int64_t row, V(row) weight,
                                                 bool between) {
    NAME(part) a = NAME(parts)(s, row, 0, between);
    NAME(part) b = NAME(parts)(s, row, 1, between);
    return (NAME(part)){NAME(mix)(a.value, b.value, weight),
                        NAME(mix)(a.weight, b.weight, weight)};
}

/* A row of values from those above and below; returns a bit for each number
 * whose weights are not full. */
TARGET VALUE_INLINE uint32_t NAME(mix_parts)(NAME(part) above, NAME(part) below,
                                             V(row) v, int16_t out[32]) {
    V(row) weight = NAME(mix)(above.weight, below.weight, v);
    V(row_store)(out, NAME(mix)(above.value, below.value, v));
    uint32_t partial = V(row_gt)(V(row_set1)(SNOW_VALUE_FULL), weight);
    if (partial) {
        int16_t weights[32];
        V(row_store)(weights, weight);
        snow_value_weigh(out, weights, partial);
    }
    return partial;
}

/* As NAME(fill); a bit in `partial` for each number whose weights are not
 * full. */
TARGET static void NAME(fill_holes)(const NAME(source) *s, int64_t first,
                                    uint64_t rows,
                                    const snow_value_place *place,
                                    int16_t (*out)[32], uint32_t *partial,
                                    bool between) {
    const V(row) u = V(row_set1)(place->weight[0]);
    const V(row) v = V(row_set1)(place->weight[1]);
    for (; rows; rows &= rows - 1) {
        int row = __builtin_ctzll(rows);
        NAME(part) above = NAME(parts_along)(s, first + row, u, between);
        NAME(part) below = NAME(parts_along)(s, first + row + 1, u, between);
        partial[row] = NAME(mix_parts)(above, below, v, out[row]);
    }
}

#include "splat/shear_warp/cubic.tmpl.h"

/* Differences along P in the rows `across`, whose values are there: where holes
 * are, or with kernel bspline of all, those of the resampled slices beside. */
TARGET static void NAME(cross_holes)(const snow_value_splat *p, int n,
                                     NAME(source) from, int64_t row,
                                     uint32_t across,
                                     const snow_value_place *place,
                                     value_rows *out) {
    const snow_resampled_slice *resampled = p->resampled_slices + n;
    const int64_t slices[2] = {resampled->before, resampled->after};
    int16_t beside[2][SNOW_VALUE_ROWS][32];
    uint32_t partial[2][SNOW_VALUE_ROWS];
    for (int side = 0; side < 2; side++) {
        NAME(set_slices)(&from, slices[side], slices[side]);
        if (p->store->cubic)
            NAME(fill_cubic)(&from, row, across, place, beside[side],
                             out->holes, resampled->between_across);
        else
            NAME(fill_holes)(&from, row, across, place, beside[side],
                             partial[side], resampled->between_across);
    }
    for (; across; across &= across - 1) {
        int r = __builtin_ctz(across);
        uint32_t lanes = p->store->cubic
                             ? NAME(cross_cubic)(resampled, beside[0][r],
                                                 beside[1][r], out->across[r])
                             : partial[0][r] | partial[1][r];
        const value_sides sides = {
            .splat = p,
            .resampled = n,
            .column = from.column,
            .row = row + r,
            .weights = {place->weight[0], place->weight[1]},
            .at = place->at,
            .here = out->values[r + 1],
            .before = beside[0][r],
            .after = beside[1][r]};
        if (lanes)
            snow_value_bridge(&sides, lanes, out->across[r]);
    }
}
