/* splat/shear_warp/rows.tmpl.h - rows of voxels as quantized values: copied
 * ones are loaded, stored values become quantized values in registers, and so
 * do those beyond the volume's sides.  Included by sample.tmpl.h. */

/* The rows that a resampled slice is made of. */
typedef struct NAME(source) {
    const snow_value_store *store;
    const int16_t *values;
    const int64_t *slice, *after; /* places of rows; of the difference's end */
    int64_t next;                 /* places to the next slice */
    int64_t begin[2];             /* in place: of row 0 of both */
    int64_t column;
    bool twice;     /* of a difference */
    int16_t toward; /* of what is between two slices: snow_resampled_slice */
} NAME(source);

/* Sets the slices that are read; `after` may be the same. */
static inline void NAME(set_slices)(NAME(source) *s, int64_t slice,
                                    int64_t after) {
    const snow_value_store *store = s->store;
    s->begin[0] = slice * store->slice_step;
    s->begin[1] = after * store->slice_step;
    if (store->in_place)
        return;
    s->slice = snow_value_at(store, slice);
    s->after = snow_value_at(store, after);
}

static inline NAME(source) NAME(source_of)(const snow_value_store *store,
                                           int64_t slice) {
    NAME(source) s = {.store = store,
                      .values = store->values,
                      .next = store->rows + 2 * store->margin};
    NAME(set_slices)(&s, slice, slice);
    return s;
}

/* Where a row of stored values begins: of the slice, or of `after` where `end`
 * is 1, or of the next one of either where `on` is 1. */
TARGET VALUE_LEAF int64_t NAME(place_of)(const NAME(source) *s, int end, int on,
                                         int64_t row) {
    const snow_value_store *store = s->store;
    if (store->in_place)
        return s->begin[end] + on * store->slice_step + row * store->row_step;
    return (end ? s->after : s->slice)[row + on * s->next];
}

TARGET VALUE_LEAF V(row) NAME(load_stored)(const unsigned char *stored,
                                           int64_t place, const int kind) {
    if (kind == SNOW_VALUE_BYTES)
        return V(row_bytes)(stored + place);
    return V(row_load)((const int16_t *)(const void *)(stored + 2 * place));
}

TARGET VALUE_LEAF V(row) NAME(quantize_fixed)(V(row) stored,
                                              const snow_fixed_quantizer *fixed,
                                              const int kind) {
    V(row) t =
        V(row_add)(V(row_mul)(stored, V(row_set1)((int16_t)fixed->factor)),
                   V(row_set1)((int16_t)fixed->offset));
    if (kind == SNOW_VALUE_BYTES)
        return t;
    return V(row_mulhrs)(V(row_srl)(t, fixed->shift),
                         V(row_set1)(fixed->weight));
}

/* --- sides ---------------------------------------------------------------- */

/* A bit for each of the first n of 32 lanes. */
static inline uint32_t NAME(first_lanes)(int64_t n) {
    return n < 1 ? 0 : n < 32 ? (UINT32_C(1) << n) - 1 : ~UINT32_C(0);
}

/* The number beyond the side at a voxel; the one inside is `step` on. */
static inline int16_t NAME(beyond)(const snow_value_store *s, int64_t place,
                                   int64_t step) {
    return snow_value_beyond(snow_value_of_native(s, place),
                             snow_value_of_native(s, place + step), false);
}

/* 32 stored values of which only some may be there to be read. */
TARGET static V(row) NAME(load_some)(const snow_value_store *s, int64_t place) {
    const int64_t size = s->kind == SNOW_VALUE_BYTES ? 1 : 2;
    int64_t first = place < 0 ? -place : 0, end = s->native_count - place;
    unsigned char stored[64] = {0};
    end = end < 32 ? end : 32;
    if (first < end)
        memcpy(stored + first * size, s->stored + (place + first) * size,
               (size_t)((end - first) * size));
    return size == 1 ? NAME(load_stored)(stored, 0, SNOW_VALUE_BYTES)
                     : NAME(load_stored)(stored, 0, SNOW_VALUE_SHORTS);
}

/* 32 quantized values of a row of the volume from `column` on, of which those
 * within its columns are right. */
TARGET VALUE_LEAF V(row) NAME(row_inside)(const snow_value_store *s,
                                          int64_t place, int64_t column,
                                          const int kind) {
    int64_t at = place + column;
    V(row) stored = at >= 0 && at + 32 <= s->native_count
                        ? NAME(load_stored)(s->stored, at, kind)
                        : NAME(load_some)(s, at);
    return NAME(quantize_fixed)(stored, &s->fixed, kind);
}

/* 32 quantized values of a row of the volume from `column` on, and from the
 * next one on; columns may be beyond the sides. */
TARGET VALUE_INLINE void NAME(pair_inside)(const snow_value_store *s,
                                           int64_t place, int64_t column,
                                           const int kind, V(row) out[2]) {
    const int64_t behind = s->columns - 1, step = behind > 0;
    for (int n = 0; n < 2; n++)
        out[n] = NAME(row_inside)(s, place, column + n, kind);
    if (column < 0) {
        V(row) beyond = V(row_set1)(NAME(beyond)(s, place, step));
        for (int n = 0; n < 2; n++)
            out[n] =
                V(row_choose)(NAME(first_lanes)(-column - n), beyond, out[n]);
    }
    if (column + 33 > s->columns) {
        V(row) beyond = V(row_set1)(NAME(beyond)(s, place + behind, -step));
        for (int n = 0; n < 2; n++)
            out[n] = V(row_choose)(NAME(first_lanes)(s->columns - column - n),
                                   out[n], beyond);
    }
}

/* The same of a row above the first or below the last one, which is odd within
 * the columns, and beyond them as the row at the side. */
TARGET static void NAME(pair_beyond)(const NAME(source) *from, int end, int on,
                                     int64_t row, int64_t column, int kind,
                                     V(row) out[2]) {
    const snow_value_store *s = from->store;
    const int64_t last = s->rows - 1;
    int64_t side = NAME(place_of)(from, end, on, row < 0 ? 0 : last);
    int64_t next = row < 0 ? 1 : last - 1;
    NAME(pair_inside)(s, side, column, kind, out);
    if (last == 0)
        return;
    next = NAME(place_of)(from, end, on, next);
    for (int n = 0; n < 2; n++) {
        V(row) inner = NAME(row_inside)(s, next, column + n, kind);
        V(row) odd = V(row_add)(out[n], V(row_subs)(out[n], inner));
        uint32_t within = NAME(first_lanes)(s->columns - column - n) &
                          ~NAME(first_lanes)(-column - n);
        out[n] = V(row_choose)(within, odd, out[n]);
    }
}

/* --- rows ----------------------------------------------------------------- */

/* 32 quantized values of a row from `column` on, and from the next one on,
 * wherever they are; `sided`: some may be beyond a side. */
TARGET VALUE_LEAF void NAME(pair)(const NAME(source) *s, int end, int on,
                                  int64_t row, int64_t column, const int kind,
                                  const bool sided, V(row) out[2]) {
    if (kind == SNOW_VALUE_QUANTIZED) {
        const int16_t *at = s->values +
                            (end ? s->after : s->slice)[row + on * s->next] +
                            column;
        out[0] = V(row_load)(at);
        out[1] = V(row_load)(at + 1);
    } else if (sided && (row < 0 || row >= s->store->rows)) {
        NAME(pair_beyond)(s, end, on, row, column, kind, out);
    } else if (sided) {
        NAME(pair_inside)(s->store, NAME(place_of)(s, end, on, row), column,
                          kind, out);
    } else {
        int64_t place = NAME(place_of)(s, end, on, row) + column;
        for (int n = 0; n < 2; n++)
            out[n] = NAME(quantize_fixed)(
                NAME(load_stored)(s->store->stored, place + n, kind),
                &s->store->fixed, kind);
    }
}

/* Quantized values of voxels that lanes of perspective may reach. */
#define LINE_VALUES (32 * SNOW_VALUE_SPREAD_MOST + 128)

/* `count` quantized values of a row from `column` on: where they are, or in
 * `scratch`. */
TARGET static const int16_t *NAME(line)(const NAME(source) *s, int end, int on,
                                        int64_t row, int64_t column, int count,
                                        int16_t *scratch) {
    const snow_value_kind kind = s->store->kind;
    if (kind == SNOW_VALUE_QUANTIZED)
        return s->values + (end ? s->after : s->slice)[row + on * s->next] +
               column;
    for (int n = 0; n < count; n += 32) {
        V(row) both[2];
        if (kind == SNOW_VALUE_BYTES)
            NAME(pair)(s, end, on, row, column + n, SNOW_VALUE_BYTES, true,
                       both);
        else
            NAME(pair)(s, end, on, row, column + n, SNOW_VALUE_SHORTS, true,
                       both);
        V(row_store)(scratch + n, both[0]);
    }
    return scratch;
}
