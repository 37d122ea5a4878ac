/* splat/shear_warp/sample.tmpl.h - which samples of a slab can be seen, and the
 * values of its resampled slices there.  Include simd/select.h first. */

/* --- masks ---------------------------------------------------------------- */

/* Masks of 32 rows are 32 words: two rows of vectors. */
TARGET VALUE_LEAF void NAME(set_masks)(uint32_t *to, V(row) low, V(row) high) {
    V(row_store)((int16_t *)(void *)to, low);
    V(row_store)((int16_t *)(void *)(to + 16), high);
}

TARGET VALUE_LEAF void NAME(copy_masks)(uint32_t *to, const uint32_t *from) {
    NAME(set_masks)(to, V(row_load)((const int16_t *)(const void *)from),
                    V(row_load)((const int16_t *)(const void *)(from + 16)));
}

/* Ors the cells of a resampled slice under a tile that are not wholly within an
 * interval. */
TARGET VALUE_LEAF void NAME(add_cells)(const snow_value_store *s, int interval,
                                       const snow_resampled_slice *resampled,
                                       value_window w, uint32_t *out) {
    const uint32_t *masks = s->masks +
                            snow_value_mask_at(s, interval, resampled->slice) +
                            w.word * s->mask_rows + w.row;
    V(rows_window)(masks, masks + s->mask_rows, w.shift, out);
    if (resampled->between) {
        masks += s->mask_words * s->mask_rows;
        V(rows_window)(masks, masks + s->mask_rows, w.shift, out);
    }
}

/* The samples of a phase of slab `n`, between resampled slices n and n + 1,
 * that can be seen, but for cuts; returns their rows. */
TARGET static uint32_t NAME(activate_all)(const snow_value_splat *p, int n,
                                          int phase, const int tile[2],
                                          const value_phase *state,
                                          value_slab *slab) {
    const snow_value_store *s = p->store;
    const snow_resampled_slice *resampled = p->resampled_slices + n;
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
    const V(row) zero = V(row_set1)(0);
    NAME(copy_masks)(slab->active, state->open);
    for (int interval = 0; interval < s->interval_count; interval++) {
        uint32_t cells[SNOW_VALUE_ROWS];
        NAME(set_masks)(cells, zero, zero);
        NAME(add_cells)(s, interval, resampled, front, cells);
        NAME(add_cells)(s, interval, resampled + 1, back, cells);
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
    const snow_resampled_slice *resampled = p->resampled_slices + n;
    const snow_value_place *place = p->places + n * p->phases + phase;
    const snow_value_place *next = place + p->phases;
    const double u = (double)value_tile_column(p, tile[0]);
    const double v = (double)value_tile_row(p, tile[1]);
    snow_value_clip(
        p, (double[]){u + place->at[0], v + place->at[1], resampled->at, 1},
        (double[]){u + next->at[0], v + next->at[1], resampled[1].at, 1}, clip);
}

/* --- resampled slices ----------------------------------------------------- */

TARGET VALUE_LEAF V(row) NAME(mix)(V(row) a, V(row) b, V(row) weight) {
    return V(row_add)(a, V(row_mulhrs)(V(row_subs)(b, a), weight));
}

/* As value_toward. */
TARGET VALUE_LEAF V(row) NAME(toward)(V(row) a, V(row) b, int16_t toward) {
    V(row) middle = V(row_avg)(a, b);
    if (!toward)
        return middle;
    return NAME(mix)(middle, toward > 0 ? b : a,
                     V(row_set1)((int16_t)abs(toward)));
}

#include "splat/shear_warp/rows.tmpl.h"

/* One row of voxels, mixed along u: of a slice or between it and the next one;
 * or the difference of two of them. */
TARGET VALUE_LEAF V(row) NAME(along)(const NAME(source) *s, int64_t row,
                                     V(row) weight, const bool between,
                                     const bool difference, const int kind,
                                     const bool sided) {
    V(row) ends[2][2], next[2];
    for (int end = 0; end <= difference; end++) {
        NAME(pair)(s, end, 0, row, s->column, kind, sided, ends[end]);
        if (!between)
            continue;
        NAME(pair)(s, end, 1, row, s->column, kind, sided, next);
        for (int n = 0; n < 2; n++)
            ends[end][n] = NAME(toward)(ends[end][n], next[n], s->toward);
    }
    for (int n = 0; n < 2 && difference; n++) {
        ends[0][n] = V(row_subs)(ends[1][n], ends[0][n]);
        if (s->twice)
            ends[0][n] = V(row_adds)(ends[0][n], ends[0][n]);
    }
    return NAME(mix)(ends[0][0], ends[0][1], weight);
}

TARGET VALUE_LEAF void
NAME(fill_rows_of)(const NAME(source) *from, int64_t first, uint64_t rows,
                   const snow_value_place *place, int16_t (*out)[32],
                   const bool between, const bool difference, const int kind,
                   const bool sided) {
    const NAME(source) s = *from;
    const V(row) u = V(row_set1)(place->weight[0]);
    const V(row) v = V(row_set1)(place->weight[1]);
    /* Of each stretch: the row above its first one, then those below. */
    while (rows) {
        const int begin = __builtin_ctzll(rows);
        V(row) above = V(row_set1)(0);
        for (int row = begin;; row++) {
            V(row) here = NAME(along)(&s, first + row, u, between, difference,
                                      kind, sided);
            if (row > begin)
                V(row_store)(out[row - 1], NAME(mix)(above, here, v));
            above = here;
            if (!(rows >> row & 1))
                break;
            rows &= rows - 1;
        }
    }
}

/* The same as a function of its own, where all kinds would be a lot of code. */
TARGET VALUE_INLINE void NAME(fill_rows)(const NAME(source) *from,
                                         int64_t first, uint64_t rows,
                                         const snow_value_place *place,
                                         int16_t (*out)[32], const bool between,
                                         const bool difference, const int kind,
                                         const bool sided) {
    NAME(fill_rows_of)(from, first, rows, place, out, between, difference, kind,
                       sided);
}

/* Rows of bytes in place, and which lanes are beyond their ends: of the 32
 * voxels from the column on, and from the next one on. */
typedef struct NAME(bytes) {
    snow_fixed_quantizer fixed;
    ptrdiff_t apart;       /* of a difference: to the other row */
    ptrdiff_t ends[2];     /* from the column to the first voxel, to the last */
    ptrdiff_t inside;      /* from the first to the second */
    uint32_t beyond[2][2]; /* lanes: [end][voxel or next] */
} NAME(bytes);

static inline NAME(bytes) NAME(bytes_of)(const NAME(source) *s) {
    const int64_t columns = s->store->columns;
    NAME(bytes) r = {.fixed = s->store->fixed,
                     .apart = s->begin[1] - s->begin[0],
                     .ends = {-s->column, columns - 1 - s->column},
                     .inside = columns > 1};
    for (int n = 0; n < 2; n++) {
        r.beyond[0][n] = NAME(first_lanes)(-s->column - n);
        r.beyond[1][n] = ~NAME(first_lanes)(columns - s->column - n);
    }
    return r;
}

/* The number beyond an end of a row, from the two voxels there. */
static inline int NAME(byte_beyond)(const NAME(bytes) *r,
                                    const unsigned char *end,
                                    ptrdiff_t inside) {
    return snow_value_beyond(snow_quantize_fixed(&r->fixed, end[0]),
                             snow_quantize_fixed(&r->fixed, end[inside]),
                             false);
}

/* Quantized values from `at` on, and from the next voxel on, or differences to
 * those `apart` behind, where lanes are beyond the row's ends. */
TARGET VALUE_INLINE void NAME(end_bytes)(const NAME(bytes) *r,
                                         const unsigned char *at,
                                         V(row) values[2],
                                         const bool difference) {
    for (int end = 0; end < 2; end++) {
        const unsigned char *voxel = at + r->ends[end];
        const ptrdiff_t inside = end ? -r->inside : r->inside;
        if (!(r->beyond[end][0] | r->beyond[end][1]))
            continue;
        int number = NAME(byte_beyond)(r, voxel, inside);
        if (difference)
            number = value_saturate(
                NAME(byte_beyond)(r, voxel + r->apart, inside) - number);
        for (int n = 0; n < 2; n++)
            values[n] = V(row_choose)(r->beyond[end][n],
                                      V(row_set1)((int16_t)number), values[n]);
    }
}

/* A row of bytes mixed along u, or the difference to that which is `apart`
 * behind: quantized values are sums and products, and so are differences of
 * them. */
TARGET VALUE_LEAF V(row) NAME(along_bytes)(const NAME(bytes) *r,
                                           const unsigned char *at,
                                           V(row) weight, const bool difference,
                                           const bool sided) {
    const V(row) factor = V(row_set1)((int16_t)r->fixed.factor);
    V(row) n[2];
    for (int k = 0; k < 2; k++) {
        n[k] = V(row_bytes)(at + k);
        if (difference)
            n[k] = V(row_subs)(V(row_bytes)(at + r->apart + k), n[k]);
        n[k] = V(row_mul)(n[k], factor);
    }
    for (int k = 0; k < 2 && !difference; k++)
        n[k] = V(row_add)(n[k], V(row_set1)((int16_t)r->fixed.offset));
    if (sided)
        NAME(end_bytes)(r, at, n, difference);
    return NAME(mix)(n[0], n[1], weight);
}

/* Rows of bytes in place, none beyond the first or last. */
TARGET VALUE_INLINE void
NAME(fill_bytes_by)(const NAME(source) *s, int64_t first, uint64_t rows,
                    const snow_value_place *place, int16_t (*out)[32],
                    const bool difference, const bool sided) {
    const NAME(bytes) r = NAME(bytes_of)(s);
    const V(row) u = V(row_set1)(place->weight[0]);
    const V(row) v = V(row_set1)(place->weight[1]);
    const ptrdiff_t step = s->store->row_step;
    const unsigned char *stored =
        s->store->stored + s->begin[0] + first * step + s->column;
    while (rows) {
        int row = __builtin_ctzll(rows);
        const unsigned char *at = stored + row * step;
        V(row) above = NAME(along_bytes)(&r, at, u, difference, sided);
        for (; rows >> row & 1; row++) {
            at += step;
            V(row) below = NAME(along_bytes)(&r, at, u, difference, sided);
            V(row_store)(out[row], NAME(mix)(above, below, v));
            above = below;
            rows &= rows - 1;
        }
    }
}

#define VALUE_FILL_BYTES(word, difference, sided)                           \
    TARGET static void NAME(fill_##word)(                                   \
        const NAME(source) * s, int64_t first, uint64_t rows,               \
        const snow_value_place *place, int16_t(*out)[32]) {                 \
        NAME(fill_bytes_by)(s, first, rows, place, out, difference, sided); \
    }
VALUE_FILL_BYTES(bytes, false, false)
VALUE_FILL_BYTES(difference, true, false)
VALUE_FILL_BYTES(bytes_sided, false, true)
VALUE_FILL_BYTES(difference_sided, true, true)
#undef VALUE_FILL_BYTES

/* Whether 33 bytes from the column on may be read in all rows from `first` on
 * that are set, and in the one behind. */
static inline bool NAME(readable)(const NAME(source) *s, int64_t first,
                                  uint64_t rows) {
    const snow_value_store *store = s->store;
    const int64_t low = first + __builtin_ctzll(rows);
    const int64_t high = first + 64 - __builtin_clzll(rows);
    const bool falls = s->begin[1] < s->begin[0];
    return s->begin[falls] + low * store->row_step + s->column >= 0 &&
           s->begin[!falls] + high * store->row_step + s->column + 33 <=
               store->native_count;
}

/* Of each kind of rows; those of most volumes of bytes are the fastest. */
#define VALUE_FILL(word, rows_by, kind, sides)                                \
    TARGET static void NAME(fill_##word)(                                     \
        const NAME(source) * s, int64_t first, uint64_t rows,                 \
        const snow_value_place *place, int16_t(*out)[32], bool between,       \
        bool difference) {                                                    \
        if (between && difference)                                            \
            NAME(rows_by)                                                     \
        (s, first, rows, place, out, true, true, kind, sides);                \
        else if (between) NAME(rows_by)(s, first, rows, place, out, true,     \
                                        false, kind, sides);                  \
        else if (difference) NAME(rows_by)(s, first, rows, place, out, false, \
                                           true, kind, sides);                \
        else NAME(rows_by)(s, first, rows, place, out, false, false, kind,    \
                           sides);                                            \
    }
VALUE_FILL(quantized, fill_rows, SNOW_VALUE_QUANTIZED, false)
VALUE_FILL(any_bytes, fill_rows_of, SNOW_VALUE_BYTES, false)
VALUE_FILL(sided_bytes, fill_rows, SNOW_VALUE_BYTES, true)
VALUE_FILL(words, fill_rows, SNOW_VALUE_SHORTS, false)
VALUE_FILL(sided_words, fill_rows, SNOW_VALUE_SHORTS, true)
#undef VALUE_FILL

/* Rows of a resampled slice, a bit each from row `first` on, into `out`. */
TARGET static void NAME(fill)(const NAME(source) *s, int64_t first,
                              uint64_t rows, const snow_value_place *place,
                              int16_t (*out)[32], bool between,
                              bool difference) {
    const snow_value_store *store = s->store;
    const bool bytes = store->kind == SNOW_VALUE_BYTES;
    if (store->kind == SNOW_VALUE_QUANTIZED) {
        NAME(fill_quantized)(s, first, rows, place, out, between, difference);
        return;
    }
    const bool within = s->column >= 0 && s->column + 33 <= store->columns;
    uint64_t inside = rows & value_rows_within(first, store->rows - 1);
    if (inside && bytes && store->in_place && !between && !s->twice &&
        (within || NAME(readable)(s, first, inside)))
        (within ? (difference ? NAME(fill_difference) : NAME(fill_bytes))
                : (difference ? NAME(fill_difference_sided)
                              : NAME(fill_bytes_sided)))(s, first, inside,
                                                         place, out);
    else if (within && inside)
        (bytes ? NAME(fill_any_bytes) : NAME(fill_words))(
            s, first, inside, place, out, between, difference);
    else
        inside = 0;
    if (rows != inside)
        (bytes ? NAME(fill_sided_bytes) : NAME(fill_sided_words))(
            s, first, rows & ~inside, place, out, between, difference);
}

#include "splat/shear_warp/holes.tmpl.h"

/* Whether a resampled slice, or those beside it along P, have holes under a
 * tile. */
static inline bool NAME(near_holes)(const snow_value_store *s,
                                    const snow_resampled_slice *resampled,
                                    int64_t column, int64_t row) {
    if (!s->holes)
        return false;
    value_window w = value_window_of(s, column, row);
    return value_has_holes(s, resampled->slice, w) ||
           value_has_holes(s, resampled->slice + resampled->between, w) ||
           value_has_holes(s, resampled->before, w) ||
           value_has_holes(s, resampled->after, w) ||
           value_has_holes(s, resampled->after + resampled->between_across, w);
}

/* What of a resampled slice's rows is not there yet, and what it is made of. */
TARGET VALUE_INLINE void NAME(begin)(const snow_value_store *s,
                                     const snow_resampled_slice *resampled,
                                     uint64_t *rows, uint32_t *across,
                                     value_rows *out, NAME(source) *from) {
    *rows &= ~out->has;
    *across &= ~out->has_across;
    out->has |= *rows;
    out->has_across |= *across;
    *from = NAME(source_of)(s, resampled->slice);
    from->toward = resampled->toward;
}

TARGET VALUE_INLINE void
NAME(begin_across)(const snow_resampled_slice *resampled, NAME(source) *from) {
    NAME(set_slices)(from, resampled->before, resampled->after);
    from->twice = resampled->one_sided;
}

/* The values of a resampled slice in some rows of a tile, and the differences
 * across it in others, unless they are there. */
TARGET VALUE_ONCE void NAME(sample_all)(const snow_value_splat *p, int n,
                                        int phase, const int tile[2],
                                        uint64_t rows, uint32_t across,
                                        value_rows *out) {
    const snow_value_store *s = p->store;
    const snow_resampled_slice *resampled = p->resampled_slices + n;
    const snow_value_place *place = p->places + n * p->phases + phase;
    int64_t column = value_tile_column(p, tile[0]) + place->whole[0];
    int64_t first = value_tile_row(p, tile[1]) + place->whole[1];
    if (out->resampled != n) {
        out->resampled = n;
        out->has = out->has_across = 0;
        out->holes = NAME(near_holes)(s, resampled, column, first);
    }
    if (!(rows & ~out->has) && !(across & ~out->has_across))
        return;
    NAME(source) from;
    NAME(begin)(s, resampled, &rows, &across, out, &from);
    from.column = column;
    uint32_t partial[RESAMPLED_ROWS];
    if (s->cubic)
        NAME(fill_cubic)(&from, first - 1, rows, place, out->values, out->holes,
                         resampled->between);
    else if (out->holes)
        NAME(fill_holes)(&from, first - 1, rows, place, out->values, partial,
                         resampled->between);
    else
        NAME(fill)(&from, first - 1, rows, place, out->values,
                   resampled->between, false);
    if (!across)
        return;
    NAME(begin_across)(resampled, &from);
    if (!s->cubic)
        NAME(fill)(&from, first, across, place, out->across,
                   resampled->between_across, true);
    if (out->holes || s->cubic)
        NAME(cross_holes)(p, n, from, first, across, place, out);
}
