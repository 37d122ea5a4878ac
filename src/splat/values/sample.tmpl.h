/* splat/values/sample.tmpl.h - which samples of a slab can be seen, and the
 * values of its sheets there.  Include simd/select.h first. */

/* --- masks ------------------------------------------------------------------
 */

/* Ors the cells of a sheet under a tile that are not wholly within a run. */
TARGET VALUE_INLINE void NAME(add_cells)(const snow_value_store *s, int run,
                                         const snow_value_sheet *sheet,
                                         value_window w, uint32_t *out) {
    const uint32_t *masks = s->masks +
                            snow_value_mask_at(s, run, sheet->slice) +
                            w.word * s->mask_rows + w.row;
    V(rows_window)(masks, masks + s->mask_rows, w.shift, out);
    if (sheet->half) {
        masks += s->mask_words * s->mask_rows;
        V(rows_window)(masks, masks + s->mask_rows, w.shift, out);
    }
}

/* The samples of a phase of slab `n`, between sheets n and n + 1, that can be
 * seen, but for cuts; returns their rows. */
TARGET static uint32_t NAME(activate_all)(const snow_value_splat *p, int n,
                                          int phase, const int tile[2],
                                          const value_phase *state,
                                          value_slab *slab) {
    const snow_value_store *s = p->store;
    const snow_value_sheet *sheet = p->sheets + n;
    const snow_value_place *place = p->places + n * p->phases + phase;
    const snow_value_place *next = place + p->phases;
    int64_t column = value_tile_column(p, tile[0]);
    int64_t row = value_tile_row(p, tile[1]);
    value_window front, back;
    if (!value_meets(s, column + place->whole[0], row + place->whole[1]) ||
        !value_meets(s, column + next->whole[0], row + next->whole[1]))
        return 0;
    front = value_window_of(s, column + place->whole[0], row + place->whole[1]);
    back = value_window_of(s, column + next->whole[0], row + next->whole[1]);
    uint32_t rows = ~UINT32_C(0);
    memcpy(slab->active, state->open, sizeof slab->active);
    for (int run = 0; run < s->run_count; run++) {
        uint32_t cells[SNOW_VALUE_ROWS] = {0};
        NAME(add_cells)(s, run, sheet, front, cells);
        NAME(add_cells)(s, run, sheet + 1, back, cells);
        rows &= V(rows_and)(slab->active, cells, ~UINT32_C(0));
        if (!rows)
            return 0;
    }
    return rows;
}

/* The parts of the slab's rays that are inside. */
static inline void NAME(cut_all)(const snow_value_splat *p, int n, int phase,
                                 const int tile[2], value_cut cut[2]) {
    const snow_value_place *place = p->places + n * p->phases + phase;
    const snow_value_place *next = place + p->phases;
    const double first[2] = {(double)value_tile_column(p, tile[0]),
                             (double)value_tile_row(p, tile[1])};
    for (int axis = 0; axis < 2; axis++) {
        const double ends[2][2] = {{first[axis] + place->at[axis], 1},
                                   {first[axis] + next->at[axis], 1}};
        snow_value_cut(ends[0], ends[1], p->low[axis], p->high[axis],
                       &cut[axis]);
    }
}

/* The parts of the slab's rays that clip planes leave. */
static inline void NAME(clip_all)(const snow_value_splat *p, int n, int phase,
                                  const int tile[2], value_clip *clip) {
    const snow_value_sheet *sheet = p->sheets + n;
    const snow_value_place *place = p->places + n * p->phases + phase;
    const snow_value_place *next = place + p->phases;
    const double u = (double)value_tile_column(p, tile[0]);
    const double v = (double)value_tile_row(p, tile[1]);
    snow_value_clip(
        p, (double[]){u + place->at[0], v + place->at[1], sheet->at, 1},
        (double[]){u + next->at[0], v + next->at[1], sheet[1].at, 1}, clip);
}

/* --- sheets -----------------------------------------------------------------
 */

TARGET VALUE_INLINE V(row) NAME(mix)(V(row) a, V(row) b, V(row) weight) {
    return V(row_add)(a, V(row_mulhrs)(V(row_subs)(b, a), weight));
}

/* The rows that a sheet is made of. */
typedef struct NAME(source) {
    const int16_t *values;
    const int64_t *slice, *after; /* places of rows; of the difference's end */
    int64_t next;                 /* places to the next slice */
    int64_t column;
    bool twice; /* of a difference */
} NAME(source);

/* 32 voxels of row `row` from `column` + `by` on: of a slice or half way to the
 * next one; or the difference of two of them. */
TARGET VALUE_INLINE V(row)
    NAME(voxels)(const NAME(source) * s, int64_t row, int by, const bool half,
                 const bool difference) {
    const int16_t *values = s->values + s->column + by;
    V(row) here = V(row_load)(values + s->slice[row]);
    if (half)
        here = V(row_avg)(here, V(row_load)(values + s->slice[row + s->next]));
    if (!difference)
        return here;
    V(row) there = V(row_load)(values + s->after[row]);
    if (half)
        there =
            V(row_avg)(there, V(row_load)(values + s->after[row + s->next]));
    there = V(row_subs)(there, here);
    return s->twice ? V(row_adds)(there, there) : there;
}

/* One row of voxels, mixed along u. */
TARGET VALUE_INLINE V(row)
    NAME(along)(const NAME(source) * s, int64_t row, V(row) weight,
                const bool half, const bool difference) {
    return NAME(mix)(NAME(voxels)(s, row, 0, half, difference),
                     NAME(voxels)(s, row, 1, half, difference), weight);
}

/* Rows of a sheet, a bit each from row `first` on, into `out`. */
TARGET VALUE_INLINE void NAME(fill)(const NAME(source) * s, int64_t first,
                                    uint64_t rows,
                                    const snow_value_place *place,
                                    int16_t (*out)[32], const bool half,
                                    const bool difference) {
    const V(row) u = V(row_set1)(place->weight[0]);
    const V(row) v = V(row_set1)(place->weight[1]);
    while (rows) {
        int row = __builtin_ctzll(rows);
        V(row) above = NAME(along)(s, first + row, u, half, difference);
        for (; rows >> row & 1; row++) {
            V(row) below = NAME(along)(s, first + row + 1, u, half, difference);
            V(row_store)(out[row], NAME(mix)(above, below, v));
            above = below;
            rows &= rows - 1;
        }
    }
}

#include "splat/values/holes.tmpl.h"

/* Whether a sheet, or those beside it along P, have holes under a tile. */
static inline bool NAME(near_holes)(const snow_value_store *s,
                                    const snow_value_sheet *sheet,
                                    int64_t column, int64_t row) {
    if (!s->holes)
        return false;
    value_window w = value_window_of(s, column, row);
    return value_has_holes(s, sheet->slice, w) ||
           value_has_holes(s, sheet->slice + sheet->half, w) ||
           value_has_holes(s, sheet->before, w) ||
           value_has_holes(s, sheet->after, w) ||
           value_has_holes(s, sheet->after + sheet->half_across, w);
}

/* What of a sheet's rows is not there yet, and what it is made of. */
TARGET VALUE_INLINE void NAME(begin)(const snow_value_store *s,
                                     const snow_value_sheet *sheet,
                                     uint64_t *rows, uint32_t *across,
                                     value_rows *out, NAME(source) * from) {
    *rows &= ~out->has;
    *across &= ~out->has_across;
    out->has |= *rows;
    out->has_across |= *across;
    *from = (NAME(source)){.values = s->values,
                           .slice = snow_value_at(s, sheet->slice),
                           .next = s->rows + 2 * s->margin};
}

TARGET VALUE_INLINE void NAME(begin_across)(const snow_value_store *s,
                                            const snow_value_sheet *sheet,
                                            NAME(source) * from) {
    from->slice = snow_value_at(s, sheet->before);
    from->after = snow_value_at(s, sheet->after);
    from->twice = sheet->one_sided;
}

/* The values of a sheet in some rows of a tile, and the differences across it
 * in others, unless they are there. */
TARGET VALUE_INLINE void NAME(sample_all)(const snow_value_splat *p, int n,
                                          int phase, const int tile[2],
                                          uint64_t rows, uint32_t across,
                                          value_rows *out) {
    const snow_value_store *s = p->store;
    const snow_value_sheet *sheet = p->sheets + n;
    const snow_value_place *place = p->places + n * p->phases + phase;
    int64_t column = value_tile_column(p, tile[0]) + place->whole[0];
    int64_t first = value_tile_row(p, tile[1]) + place->whole[1];
    if (out->sheet != n) {
        out->sheet = n;
        out->has = out->has_across = 0;
        out->holes = NAME(near_holes)(s, sheet, column, first);
    }
    NAME(source) from;
    NAME(begin)(s, sheet, &rows, &across, out, &from);
    from.column = column;
    uint32_t partial[SHEET_ROWS];
    if (s->cubic)
        NAME(fill_cubic)
    (&from, first - 1, rows, place, out->values, out->holes, sheet->half);
    else if (out->holes) NAME(fill_holes)(&from, first - 1, rows, place,
                                          out->values, partial, sheet->half);
    else if (sheet->half)
        NAME(fill)(&from, first - 1, rows, place, out->values, true, false);
    else NAME(fill)(&from, first - 1, rows, place, out->values, false, false);
    if (!across)
        return;
    NAME(begin_across)(s, sheet, &from);
    if (s->cubic)
        ;
    else if (sheet->half_across)
        NAME(fill)(&from, first, across, place, out->across, true, true);
    else
        NAME(fill)(&from, first, across, place, out->across, false, true);
    if (out->holes || s->cubic)
        NAME(cross_holes)(p, n, from, first, across, place, out);
}
