/* splat/values/rows.tmpl.h - rows of voxels as numbers: copied ones are loaded,
 * natives become numbers in registers, and so do those beyond the volume's
 * sides.  Included by sample.tmpl.h. */

/* The rows that a sheet is made of. */
typedef struct NAME(source) {
    const snow_value_store *store;
    const int16_t *values;
    const int64_t *slice, *after; /* places of rows; of the difference's end */
    int64_t next;                 /* places to the next slice */
    /* The same in place: of row 0 of both, to the next row, and slice. */
    int64_t begin[2], step, slices;
    bool in_place;
    const unsigned char *natives;
    snow_value_rule rule;
    int64_t column;
    bool twice; /* of a difference */
} NAME(source);

/* Sets the slices that are read; `after` may be the same. */
static inline void NAME(set_slices)(NAME(source) * s, int64_t slice,
                                    int64_t after) {
    const snow_value_store *store = s->store;
    s->begin[0] = slice * store->slice_step;
    s->begin[1] = after * store->slice_step;
    if (store->in_place)
        return;
    s->slice = snow_value_at(store, slice);
    s->after = snow_value_at(store, after);
}

static inline NAME(source)
    NAME(source_of)(const snow_value_store *store, int64_t slice) {
    NAME(source)
    s = {.store = store,
         .values = store->values,
         .next = store->rows + 2 * store->margin,
         .step = store->row_step,
         .slices = store->slice_step,
         .in_place = store->in_place,
         .natives = store->natives,
         .rule = store->rule};
    NAME(set_slices)(&s, slice, slice);
    return s;
}

/* Where a row of natives begins: of the slice, or of `after` where `end` is 1,
 * or of the next one of either where `half` is 1. */
TARGET VALUE_INLINE int64_t NAME(place_of)(const NAME(source) * s, int end,
                                           int half, int64_t row) {
    if (s->in_place)
        return s->begin[end] + half * s->slices + row * s->step;
    return (end ? s->after : s->slice)[row + half * s->next];
}

TARGET VALUE_INLINE V(row) NAME(load_natives)(const unsigned char *natives,
                                              int64_t place, const int kind) {
    if (kind == SNOW_VALUE_BYTES)
        return V(row_bytes)(natives + place);
    return V(row_load)((const int16_t *)(const void *)(natives + 2 * place));
}

TARGET VALUE_INLINE V(row)
    NAME(by_rule)(V(row) natives, const snow_value_rule *rule, const int kind) {
    V(row)
    t = V(row_add)(V(row_mul)(natives, V(row_set1)((int16_t)rule->factor)),
                   V(row_set1)((int16_t)rule->offset));
    if (kind == SNOW_VALUE_BYTES)
        return t;
    return V(row_mulhrs)(V(row_srl)(t, rule->shift), V(row_set1)(rule->weight));
}

/* --- sides ------------------------------------------------------------------
 */

/* -1 in lanes 0 .. n - 1; in the others. */
static const int16_t NAME(lanes)[96] = {
#define EIGHT -1, -1, -1, -1, -1, -1, -1, -1
    [32] = EIGHT, EIGHT, EIGHT, EIGHT
#undef EIGHT
};

TARGET VALUE_INLINE V(row) NAME(lanes_below)(int64_t n) {
    return V(row_load)(NAME(lanes) + 64 - (n < 0 ? 0 : n < 32 ? n : 32));
}

TARGET VALUE_INLINE V(row) NAME(lanes_from)(int64_t n) {
    return V(row_load)(NAME(lanes) + 32 - (n < 0 ? 0 : n < 32 ? n : 32));
}

/* 32 natives of which only some may be there to be read. */
TARGET static V(row) NAME(load_some)(const snow_value_store *s, int64_t place) {
    const int64_t size = s->kind == SNOW_VALUE_BYTES ? 1 : 2;
    int64_t first = place < 0 ? -place : 0, end = s->native_count - place;
    unsigned char natives[64] = {0};
    end = end < 32 ? end : 32;
    if (first < end)
        memcpy(natives + first * size, s->natives + (place + first) * size,
               (size_t)((end - first) * size));
    return size == 1 ? NAME(load_natives)(natives, 0, SNOW_VALUE_BYTES)
                     : NAME(load_natives)(natives, 0, SNOW_VALUE_WORDS);
}

/* 32 numbers of a row of the volume from `column` on, of which those within its
 * columns are right. */
TARGET VALUE_INLINE V(row)
    NAME(row_inside)(const snow_value_store *s, int64_t place, int64_t column,
                     const int kind) {
    int64_t at = place + column;
    V(row)
    natives = at >= 0 && at + 32 <= s->native_count
                  ? NAME(load_natives)(s->natives, at, kind)
                  : NAME(load_some)(s, at);
    return NAME(by_rule)(natives, &s->rule, kind);
}

/* 32 numbers of a row of natives, which may be beyond any side. */
TARGET static V(row)
    NAME(row_beyond)(const NAME(source) * from, int end, int half, int64_t row,
                     int64_t column, int kind) {
    const snow_value_store *s = from->store;
    const int64_t last = s->rows - 1, behind = s->columns - 1;
    int64_t border = row < 0 ? 0 : row < last ? row : last;
    int64_t place = NAME(place_of)(from, end, half, border);
    V(row) here = NAME(row_inside)(s, place, column, kind);
    if (border != row && last > 0) {
        int64_t next = NAME(place_of)(from, end, half, row < 0 ? 1 : last - 1);
        V(row) inner = NAME(row_inside)(s, next, column, kind);
        here = V(row_add)(here, V(row_subs)(here, inner));
    }
    if (column >= 0 && column + 32 <= s->columns)
        return here;
    int step = behind > 0;
    int16_t before =
        snow_value_beyond(snow_value_of_native(s, place),
                          snow_value_of_native(s, place + step), false);
    int16_t after = snow_value_beyond(
        snow_value_of_native(s, place + behind),
        snow_value_of_native(s, place + behind - step), false);
    here = V(row_and)(here, V(row_and)(NAME(lanes_from)(-column),
                                       NAME(lanes_below)(s->columns - column)));
    here = V(row_or)(
        here, V(row_and)(V(row_set1)(before), NAME(lanes_below)(-column)));
    return V(row_or)(here, V(row_and)(V(row_set1)(after),
                                      NAME(lanes_from)(s->columns - column)));
}

/* Whether 32 natives of a row have one that is beyond a side. */
static inline bool NAME(is_beyond)(const snow_value_store *s, int64_t row,
                                   int64_t column) {
    return column < 0 || column + 32 > s->columns || row < 0 || row >= s->rows;
}

/* --- rows -------------------------------------------------------------------
 */

/* 32 numbers of a row from `column` on, wherever they are; `sided`: some may be
 * beyond a side. */
TARGET VALUE_INLINE V(row)
    NAME(numbers)(const NAME(source) * s, int end, int half, int64_t row,
                  int64_t column, const int kind, const bool sided) {
    int64_t place;
    if (kind != SNOW_VALUE_NUMBERS && sided &&
        NAME(is_beyond)(s->store, row, column))
        return NAME(row_beyond)(s, end, half, row, column, kind);
    if (kind == SNOW_VALUE_NUMBERS)
        return V(row_load)(s->values +
                           (end ? s->after : s->slice)[row + half * s->next] +
                           column);
    place = NAME(place_of)(s, end, half, row) + column;
    return NAME(by_rule)(NAME(load_natives)(s->natives, place, kind), &s->rule,
                         kind);
}

/* Numbers of voxels that lanes of perspective may reach. */
#define LINE_NUMBERS (32 * SNOW_VALUE_SPREAD_MOST + 128)

/* `count` numbers of a row from `column` on: where they are, or in `room`. */
TARGET static const int16_t *NAME(line)(const NAME(source) * s, int end,
                                        int half, int64_t row, int64_t column,
                                        int count, int16_t *room) {
    const int kind = s->store->kind;
    if (kind == SNOW_VALUE_NUMBERS)
        return s->values + (end ? s->after : s->slice)[row + half * s->next] +
               column;
    for (int n = 0; n < count; n += 32)
        if (kind == SNOW_VALUE_BYTES)
            V(row_store)
    (room + n,
     NAME(numbers)(s, end, half, row, column + n, SNOW_VALUE_BYTES, true));
    else V(row_store)(room + n, NAME(numbers)(s, end, half, row, column + n,
                                              SNOW_VALUE_WORDS, true));
    return room;
}
