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

#include "splat/values/rows.tmpl.h"

/* One row of voxels, mixed along u: of a slice or half way to the next one; or
 * the difference of two of them. */
TARGET VALUE_INLINE V(row)
    NAME(along)(const NAME(source) * s, int64_t row, V(row) weight,
                const bool half, const bool difference, const int kind,
                const bool sided) {
    V(row) ends[2][2], next[2];
    for (int end = 0; end <= difference; end++) {
        NAME(pair)(s, end, 0, row, s->column, kind, sided, ends[end]);
        if (!half)
            continue;
        NAME(pair)(s, end, 1, row, s->column, kind, sided, next);
        for (int n = 0; n < 2; n++)
            ends[end][n] = V(row_avg)(ends[end][n], next[n]);
    }
    for (int n = 0; n < 2 && difference; n++) {
        ends[0][n] = V(row_subs)(ends[1][n], ends[0][n]);
        if (s->twice)
            ends[0][n] = V(row_adds)(ends[0][n], ends[0][n]);
    }
    return NAME(mix)(ends[0][0], ends[0][1], weight);
}

TARGET VALUE_INLINE void NAME(fill_rows)(const NAME(source) * from,
                                         int64_t first, uint64_t rows,
                                         const snow_value_place *place,
                                         int16_t (*out)[32], const bool half,
                                         const bool difference, const int kind,
                                         const bool sided) {
    const NAME(source) s = *from;
    const V(row) u = V(row_set1)(place->weight[0]);
    const V(row) v = V(row_set1)(place->weight[1]);
    while (rows) {
        int row = __builtin_ctzll(rows);
        V(row)
        above = NAME(along)(&s, first + row, u, half, difference, kind, sided);
        for (; rows >> row & 1; row++) {
            V(row)
            below = NAME(along)(&s, first + row + 1, u, half, difference, kind,
                                sided);
            V(row_store)(out[row], NAME(mix)(above, below, v));
            above = below;
            rows &= rows - 1;
        }
    }
}

/* A row of bytes mixed along u, or the difference to that which is `apart`
 * behind: numbers are sums and products, and so are differences of them. */
TARGET VALUE_INLINE V(row)
    NAME(along_bytes)(const unsigned char *at, ptrdiff_t apart, V(row) factor,
                      V(row) offset, V(row) weight, const bool difference) {
    V(row) a = V(row_bytes)(at), b = V(row_bytes)(at + 1);
    if (difference) {
        a = V(row_subs)(V(row_bytes)(at + apart), a);
        b = V(row_subs)(V(row_bytes)(at + apart + 1), b);
    }
    V(row) number = V(row_mul)(a, factor);
    if (!difference)
        number = V(row_add)(number, offset);
    V(row) step = V(row_mul)(V(row_subs)(b, a), factor);
    return V(row_add)(number, V(row_mulhrs)(step, weight));
}

/* Rows of bytes in place, none beyond a side. */
TARGET VALUE_INLINE void NAME(fill_bytes_by)(const NAME(source) * s,
                                             int64_t first, uint64_t rows,
                                             const snow_value_place *place,
                                             int16_t (*out)[32],
                                             const bool difference) {
    const snow_value_store *store = s->store;
    const V(row) factor = V(row_set1)((int16_t)store->rule.factor);
    const V(row) offset = V(row_set1)((int16_t)store->rule.offset);
    const V(row) u = V(row_set1)(place->weight[0]);
    const V(row) v = V(row_set1)(place->weight[1]);
    const ptrdiff_t step = store->row_step, apart = s->begin[1] - s->begin[0];
    const unsigned char *natives =
        store->natives + s->begin[0] + first * step + s->column;
    while (rows) {
        int row = __builtin_ctzll(rows);
        const unsigned char *at = natives + row * step;
        V(row)
        above = NAME(along_bytes)(at, apart, factor, offset, u, difference);
        for (; rows >> row & 1; row++) {
            at += step;
            V(row)
            below = NAME(along_bytes)(at, apart, factor, offset, u, difference);
            V(row_store)(out[row], NAME(mix)(above, below, v));
            above = below;
            rows &= rows - 1;
        }
    }
}

TARGET static void NAME(fill_bytes)(const NAME(source) * s, int64_t first,
                                    uint64_t rows,
                                    const snow_value_place *place,
                                    int16_t (*out)[32], bool difference) {
    if (difference)
        NAME(fill_bytes_by)(s, first, rows, place, out, true);
    else
        NAME(fill_bytes_by)(s, first, rows, place, out, false);
}

/* Of each kind of rows. */
#define VALUE_FILL(word, kind, sides)                                        \
    TARGET static void NAME(fill_##word)(                                    \
        const NAME(source) * s, int64_t first, uint64_t rows,                \
        const snow_value_place *place, int16_t(*out)[32], bool half,         \
        bool difference) {                                                   \
        if (half && difference)                                              \
            NAME(fill_rows)                                                  \
        (s, first, rows, place, out, true, true, kind, sides);               \
        else if (half) NAME(fill_rows)(s, first, rows, place, out, true,     \
                                       false, kind, sides);                  \
        else if (difference) NAME(fill_rows)(s, first, rows, place, out,     \
                                             false, true, kind, sides);      \
        else NAME(fill_rows)(s, first, rows, place, out, false, false, kind, \
                             sides);                                         \
    }
VALUE_FILL(numbers, SNOW_VALUE_NUMBERS, false)
VALUE_FILL(any_bytes, SNOW_VALUE_BYTES, false)
VALUE_FILL(sided_bytes, SNOW_VALUE_BYTES, true)
VALUE_FILL(words, SNOW_VALUE_WORDS, false)
VALUE_FILL(sided_words, SNOW_VALUE_WORDS, true)
#undef VALUE_FILL

/* Of rows first .. those that need none beyond the volume's, nor does the one
 * below. */
static inline uint64_t NAME(rows_inside)(const snow_value_store *s,
                                         int64_t first) {
    int64_t low = first < 0 ? -first : 0, end = s->rows - 1 - first;
    if (low > 63 || end <= low)
        return 0;
    return (end > 63 ? ~UINT64_C(0) : (UINT64_C(1) << end) - 1) & ~UINT64_C(0)
                                                                      << low;
}

/* Rows of a sheet, a bit each from row `first` on, into `out`. */
TARGET static void NAME(fill)(const NAME(source) * s, int64_t first,
                              uint64_t rows, const snow_value_place *place,
                              int16_t (*out)[32], bool half, bool difference) {
    const snow_value_store *store = s->store;
    const bool bytes = store->kind == SNOW_VALUE_BYTES;
    if (store->kind == SNOW_VALUE_NUMBERS) {
        NAME(fill_numbers)(s, first, rows, place, out, half, difference);
        return;
    }
    uint64_t inside = 0;
    if (s->column >= 0 && s->column + 33 <= store->columns)
        inside = rows & NAME(rows_inside)(store, first);
    if (inside && bytes && store->in_place && !half && !s->twice)
        NAME(fill_bytes)(s, first, inside, place, out, difference);
    else if (inside)
        (bytes ? NAME(fill_any_bytes) : NAME(fill_words))(
            s, first, inside, place, out, half, difference);
    if (rows != inside)
        (bytes ? NAME(fill_sided_bytes) : NAME(fill_sided_words))(
            s, first, rows & ~inside, place, out, half, difference);
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
    *from = NAME(source_of)(s, sheet->slice);
}

TARGET VALUE_INLINE void NAME(begin_across)(const snow_value_sheet *sheet,
                                            NAME(source) * from) {
    NAME(set_slices)(from, sheet->before, sheet->after);
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
    if (!(rows & ~out->has) && !(across & ~out->has_across))
        return;
    NAME(source) from;
    NAME(begin)(s, sheet, &rows, &across, out, &from);
    from.column = column;
    uint32_t partial[SHEET_ROWS];
    if (s->cubic)
        NAME(fill_cubic)
    (&from, first - 1, rows, place, out->values, out->holes, sheet->half);
    else if (out->holes) NAME(fill_holes)(&from, first - 1, rows, place,
                                          out->values, partial, sheet->half);
    else NAME(fill)(&from, first - 1, rows, place, out->values, sheet->half,
                    false);
    if (!across)
        return;
    NAME(begin_across)(sheet, &from);
    if (!s->cubic)
        NAME(fill)
    (&from, first, across, place, out->across, sheet->half_across, true);
    if (out->holes || s->cubic)
        NAME(cross_holes)(p, n, from, first, across, place, out);
}
