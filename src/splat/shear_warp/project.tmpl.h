/* splat/shear_warp/project.tmpl.h - projections: of each ray the largest or the
 * smallest value at the ends of its slabs, or their sum by the trapezoid rule.
 * Included by tile.tmpl.h.
 *
 * Slabs whose values are all in a transparent interval add nothing but that the
 * ray is there, and how long it is; where no voxel is a hole the geometry says
 * that. */

/* Twice the mean of a slab's ends, in the sums of a row. */
TARGET VALUE_INLINE void NAME(add_row)(float *sums, V(row) numbers,
                                       const float *lengths) {
    int16_t each[32];
    V(row_store)(each, numbers);
    for (int n = 0; n < 32; n += LANES) {
        V(vec) add = V(row_floats)(each + n);
        if (lengths)
            add = V(mul)(add, V(load)(lengths + n));
        V(store)(sums + n, V(add)(V(load)(sums + n), add));
    }
}

/* The lengths of parts of a slab, 0 where it is not `mask`'s. */
TARGET VALUE_INLINE void NAME(lengths_of)(V(row) part, uint32_t mask,
                                          float out[32]) {
    int16_t parts[32];
    V(row_store)(parts, V(row_choose)(mask, part, V(row_set1)(0)));
    for (int n = 0; n < 32; n++)
        out[n] = parts[n] == INT16_MAX ? 1 : (float)parts[n] / 32768;
}

/* --- the rays that there are ---------------------------------------------- */

/* Of a slab that has rows; cuts of others are not known. */
static inline bool NAME(is_cut)(const value_slab *slab) {
    return slab->cut[0].cuts || slab->cut[1].cuts || slab->clip.cuts;
}

/* The active samples of a row that are in a slab, and their parts of it. */
TARGET VALUE_INLINE uint32_t NAME(inside)(const value_slab *slab, int row,
                                          bool cuts, V(row) *part) {
    V(row) from;
    uint32_t mask = slab->active[row];
    *part = V(row_set1)(INT16_MAX);
    if (cuts)
        mask &= NAME(clip)(slab->cut, &slab->clip, row, &from, part);
    return mask;
}

/* Adds the lengths of a slab in a row to those in `to`. */
TARGET VALUE_INLINE void NAME(add_lengths)(const value_slab *slab, int row,
                                           bool cuts, float *to) {
    V(row) part;
    float lengths[32];
    uint32_t mask = NAME(inside)(slab, row, cuts, &part);
    NAME(lengths_of)(part, mask, lengths);
    for (int n = 0; n < 32; n++)
        to[n] += lengths[n];
}

/* Whether all open pixels of a phase are active in an uncut slab. */
static inline bool NAME(is_whole)(const value_phase *state,
                                  const value_slab *slab) {
    return slab->rows && slab->rows == state->alive && !NAME(is_cut)(slab) &&
           memcmp(slab->active, state->open, sizeof slab->active) == 0;
}

/* The lengths of a phase's rays. */
TARGET static bool NAME(measure_rays)(const snow_value_splat *p, int phase,
                                      const int tile[2],
                                      const value_phase *state,
                                      snow_value_faint_plane *plane,
                                      value_slab *slab, const bool eye) {
    float whole = 0;
    bool any = false;
    for (int n = p->slabs[0]; n < p->slabs[1]; n++) {
        memcpy(slab->active, state->open, sizeof slab->active);
        NAME(trim)(p, n, phase, tile, state, slab, eye);
        any |= slab->rows != 0;
        if (NAME(is_whole)(state, slab)) {
            whole += 1;
            continue;
        }
        for (uint32_t rows = slab->rows; rows; rows &= rows - 1) {
            int row = __builtin_ctz(rows);
            NAME(add_lengths)(slab, row, NAME(is_cut)(slab), (*plane)[3][row]);
        }
    }
    for (int row = 0; row < SNOW_VALUE_ROWS; row++)
        for (int n = 0; n < 32; n++)
            if (state->open[row] >> n & 1)
                (*plane)[3][row][n] += whole;
    return any;
}

/* Zeros for a phase's rays that meet the volume. */
TARGET static bool NAME(find_rays)(const snow_value_splat *p, int phase,
                                   const int tile[2], const value_phase *state,
                                   snow_value_plane *plane, value_slab *slab,
                                   const bool eye) {
    const V(row) zero = V(row_set1)(0);
    uint32_t left[SNOW_VALUE_ROWS], some = ~UINT32_C(0);
    bool any = false;
    memcpy(left, state->open, sizeof left);
    for (int n = p->slabs[0]; n < p->slabs[1] && some; n++) {
        some = 0;
        memcpy(slab->active, left, sizeof slab->active);
        NAME(trim)(p, n, phase, tile, state, slab, eye);
        for (int row = 0; row < SNOW_VALUE_ROWS; row++) {
            int16_t *at = (*plane)[0][row];
            V(row) part;
            uint32_t here =
                slab->rows >> row & 1
                    ? NAME(inside)(slab, row, NAME(is_cut)(slab), &part)
                    : 0;
            V(row_store)(at, V(row_choose)(here, zero, V(row_load)(at)));
            left[row] &= ~here;
            some |= left[row];
            any |= here != 0;
        }
    }
    return any;
}

/* --- slabs ---------------------------------------------------------------- */

/* The better ones of a row's pixels and both ends of a slab. */
TARGET VALUE_INLINE void NAME(keep_best)(int16_t *pixels, V(row) x, V(row) y,
                                         uint32_t mask, const bool least) {
    V(row) here = V(row_load)(pixels);
    V(row) best =
        least ? V(row_subs)(V(row_set1)(SNOW_VALUE_MOST), V(row_min)(x, y))
              : V(row_max)(x, y);
    V(row_store)(pixels, V(row_choose)(mask, V(row_max)(best, here), here));
}

/* Adds a row of a slab to the sums of its rays and, with holes, to their
 * lengths. */
TARGET VALUE_INLINE void NAME(keep_sum)(snow_value_faint_plane *plane, int row,
                                        V(row) x, V(row) y, V(row) part,
                                        uint32_t mask, bool cuts, bool holes) {
    V(row) both = V(row_choose)(mask, V(row_add)(x, y), V(row_set1)(0));
    float lengths[32];
    if (cuts || holes)
        NAME(lengths_of)(part, mask, lengths);
    NAME(add_row)((*plane)[0][row], both, cuts ? lengths : NULL);
    for (int n = 0; holes && n < 32; n += LANES) {
        float *to = (*plane)[3][row] + n;
        V(store)(to, V(add)(V(load)(to), V(load)(lengths + n)));
    }
}

/* Closes the pixels of a row that nothing is better than. */
TARGET VALUE_INLINE void NAME(close_best)(const int16_t *pixels, int row,
                                          value_phase *state) {
    state->open[row] &=
        V(row_gt)(V(row_set1)(SNOW_VALUE_MOST), V(row_load)(pixels));
    if (!state->open[row])
        state->alive &= ~(UINT32_C(1) << row);
}

/* A phase of slab `n`; whether it has anything. */
TARGET VALUE_INLINE bool
NAME(project)(const snow_value_splat *p, int n, int phase, const int tile[2],
              void *planes, value_scratch *scratch, value_slab *slab,
              const snow_value_reduction reduction, const bool eye) {
    value_phase *state = &scratch->phase[phase];
    if (slab->rows && reduction != SNOW_VALUE_SUM)
        slab->rows &= V(rows_and)(slab->active, state->open, ~UINT32_C(0));
    const uint64_t here = (uint64_t)slab->rows << 1;
    const bool cuts = here && NAME(is_cut)(slab);
    value_rows *f = &scratch->rows[phase][n & 1];
    value_rows *b = &scratch->rows[phase][~n & 1];
    uint32_t any = 0;
    if (!here)
        return false;
    NAME(sample)(p, n, phase, tile, here, 0, f, eye);
    NAME(sample)(p, n + 1, phase, tile, here, 0, b, eye);
    for (uint32_t rows = slab->rows; rows; rows &= rows - 1) {
        int row = __builtin_ctz(rows);
        V(row) x, y, from, part = V(row_set1)(INT16_MAX);
        uint32_t mask = NAME(ends)(f, b, slab, row, cuts, &x, &y, &from, &part);
        any |= mask;
        if (reduction == SNOW_VALUE_SUM) {
            NAME(keep_sum)((snow_value_faint_plane *)planes + phase, row, x, y,
                           part, mask, cuts, p->store->holes);
        } else {
            int16_t *pixels = ((snow_value_plane *)planes)[phase][0][row];
            NAME(keep_best)(pixels, x, y, mask,
                            reduction == SNOW_VALUE_SMALLEST);
            NAME(close_best)(pixels, row, state);
        }
    }
    return any != 0;
}

/* Some phases of a tile over the whole depth. */
TARGET VALUE_INLINE bool
NAME(project_phases)(const snow_value_splat *p, int first, int end,
                     const int tile[2], void *planes, value_scratch *scratch,
                     const snow_value_reduction reduction, const bool eye) {
    value_list list =
        value_list_begin(p, first, end, tile, value_slabs(p, scratch));
    bool drawn = false;
    for (int n = 0; n < ASKED_RING; n++)
        scratch->asked[n].resampled = -1;
    for (int turn = 0, seen = 0;; turn++) {
        value_list_find(&list, turn + AHEAD + 1);
        if (turn >= list.count)
            break;
        for (; seen < list.count && seen <= turn + AHEAD; seen++)
            NAME(look_ahead)(p, list.slabs[seen], first, end, tile, scratch,
                             scratch->slab[seen % AHEAD_RING], false, eye);
        for (int phase = first; phase < end; phase++)
            drawn |=
                NAME(project)(p, list.slabs[turn], phase, tile, planes, scratch,
                              &scratch->slab[turn % AHEAD_RING][phase - first],
                              reduction, eye);
        if (!NAME(alive)(scratch, first, end))
            break;
    }
    return drawn;
}

/* In perspective each ray's slabs are longer than the table's. */
TARGET static void NAME(lengthen_sums)(const snow_value_splat *p,
                                       value_scratch *scratch, int phase,
                                       snow_value_faint_plane *plane) {
    const value_phase *state = &scratch->phase[phase];
    for (int row = 0; row < SNOW_VALUE_ROWS; row++) {
        int16_t lines[32];
        V(row_store)(lines,
                     V(row_set1)((int16_t)(state->line + row * state->lines)));
        for (int n = 0; n < 32; n += LANES) {
            V(vec) way = V(sqrt)(NAME(square_of)(
                p->rays->metric,
                NAME(ways_of)(scratch->slope[0],
                              V(row_floats)(state->columns + n)),
                NAME(ways_of)(scratch->slope[1], V(row_floats)(lines + n))));
            way = V(mul)(way, V(set1)(p->rays->usual));
            for (int c = 0; c < 4; c += 3) {
                float *at = (*plane)[c][row] + n;
                V(store)(at, V(mul)(V(load)(at), way));
            }
        }
    }
}

TARGET VALUE_INLINE bool
NAME(project_tile)(const snow_value_splat *p, int x, int y, void *memory,
                   const snow_value_reduction reduction, const bool eye) {
    const bool sums = reduction == SNOW_VALUE_SUM;
    value_scratch *scratch =
        (value_scratch *)(void *)((char *)memory + snow_value_planes_bytes(p));
    const int tile[2] = {x, y};
    bool drawn = false;
    NAME(open)(p, x, y, scratch);
    memset(memory, sums ? 0 : -1, snow_value_planes_bytes(p));
    if (eye)
        NAME(aim)(p, tile, scratch);
    for (int phase = 0; phase < p->phases && !p->store->holes; phase++)
        drawn |=
            sums ? NAME(measure_rays)(p, phase, tile, &scratch->phase[phase],
                                      (snow_value_faint_plane *)memory + phase,
                                      scratch->slab[0], eye)
                 : NAME(find_rays)(p, phase, tile, &scratch->phase[phase],
                                   (snow_value_plane *)memory + phase,
                                   scratch->slab[0], eye);
    for (int first = 0; first < p->phases; first += TOGETHER) {
        int end = first + TOGETHER < p->phases ? first + TOGETHER : p->phases;
        drawn |= NAME(project_phases)(p, first, end, tile, memory, scratch,
                                      reduction, eye);
    }
    for (int phase = 0; phase < p->phases && sums && eye; phase++)
        NAME(lengthen_sums)(p, scratch, phase,
                            (snow_value_faint_plane *)memory + phase);
    return drawn;
}

#define VALUE_PROJECTION(kind, reduction, eye)                             \
    TARGET static bool NAME(tile_##kind)(const snow_value_splat *p, int x, \
                                         int y, void *room) {              \
        return NAME(project_tile)(p, x, y, room, reduction, eye);          \
    }
VALUE_PROJECTION(largest, SNOW_VALUE_LARGEST, false)
VALUE_PROJECTION(largest_eye, SNOW_VALUE_LARGEST, true)
VALUE_PROJECTION(smallest, SNOW_VALUE_SMALLEST, false)
VALUE_PROJECTION(smallest_eye, SNOW_VALUE_SMALLEST, true)
VALUE_PROJECTION(sum, SNOW_VALUE_SUM, false)
VALUE_PROJECTION(sum_eye, SNOW_VALUE_SUM, true)
#undef VALUE_PROJECTION

snow_value_tile_fn *const NAME(snow_value_projections)[3][2] = {
    {NAME(tile_largest), NAME(tile_largest_eye)},
    {NAME(tile_smallest), NAME(tile_smallest_eye)},
    {NAME(tile_sum), NAME(tile_sum_eye)},
};
