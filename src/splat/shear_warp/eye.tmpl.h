/* splat/shear_warp/eye.tmpl.h - the resampled slices' samples in perspective,
 * which are a voxel and more apart.  Include simd/select.h first. */

/* --- masks ---------------------------------------------------------------- */

/* Ors the cells of a plane of masks under some rows of lanes; lane 0 of v is
 * the plane's row at `masks`. */
TARGET VALUE_INLINE void NAME(pick_cells)(const snow_value_store *s,
                                          const uint32_t *masks,
                                          const snow_value_lanes *u,
                                          const snow_value_lanes *v,
                                          uint32_t rows, uint32_t *out) {
    int taken = 0;
    for (int n = 0; taken < 32; n++) {
        const uint32_t select = u->select[n];
        int64_t word = u->word + n;
        if (select && word >= 0 && word < (int64_t)s->mask_words) {
            const uint32_t *column = masks + word * (int64_t)s->mask_rows;
            for (uint32_t left = rows; left; left &= left - 1) {
                int row = __builtin_ctz(left);
                out[row] |= V(pick_bits)(column[v->at[row + 1]], select)
                            << taken;
            }
        }
        taken += __builtin_popcount(select);
    }
}

/* Whether the coarse mask of an interval has anything between two rows, in the
 * columns under the lanes. */
static inline bool NAME(any_cells)(const snow_value_store *s, int interval,
                                   int64_t slice, const snow_value_lanes *u,
                                   int64_t top, int64_t bottom) {
    int64_t low = u->word, high = low + (u->at[31] + 31) / 32 + 1;
    int64_t words = (int64_t)s->mask_words, rows = (int64_t)s->mask_rows;
    low = low < 0 ? 0 : low;
    high = high < words ? high : words - 1;
    top = (top < 0 ? 0 : top) / SNOW_VALUE_COARSE;
    bottom = (bottom < rows ? bottom : rows - 1) / SNOW_VALUE_COARSE;
    uint64_t any = 0;
    for (int64_t word = low; word <= high; word++) {
        const uint64_t *coarse =
            s->coarse + snow_value_coarse_at(s, interval, (size_t)word, slice);
        for (int64_t row = top; row <= bottom; row++)
            any |= coarse[row / 64] >> row % 64;
    }
    return any & 1;
}

/* The row of masks under lane 0 of v. */
static inline int64_t NAME(mask_row)(const snow_value_store *s,
                                     const snow_value_lanes *v) {
    return (int64_t)v->first + s->margin + SNOW_VALUE_ROWS;
}

/* The cells of a resampled slice under some rows of a tile that are not wholly
 * within an interval, for each interval. */
TARGET static void NAME(find_cells)(const snow_value_store *s,
                                    const snow_resampled_slice *resampled,
                                    const snow_value_lanes *u,
                                    const snow_value_lanes *v, uint32_t alive,
                                    value_cells *out) {
    int64_t first = NAME(mask_row)(s, v), rows = (int64_t)s->mask_rows;
    int from = 0, to = SNOW_VALUE_ROWS;
    while (from < to && first + v->at[from + 1] < 0)
        from++;
    while (from < to && first + v->at[to] >= rows)
        to--;
    uint64_t within = (UINT64_C(1) << to) - (UINT64_C(1) << from);
    for (int interval = 0; interval < s->interval_count; interval++) {
        out->any[interval] = false;
        for (int n = 0; n <= resampled->between && from < to; n++) {
            if (!NAME(any_cells)(s, interval, resampled->slice + n, u,
                                 first + v->at[from + 1], first + v->at[to]))
                continue;
            if (!out->any[interval])
                memset(out->cells[interval], 0, sizeof out->cells[interval]);
            out->any[interval] = true;
            NAME(pick_cells)(
                s,
                s->masks +
                    snow_value_mask_at(s, interval, resampled->slice + n) +
                    first,
                u, v, alive & (uint32_t)within, out->cells[interval]);
        }
    }
}

/* Of a phase: its lanes on both resampled slices of a slab, along u and v. */
static inline void NAME(slab_lanes)(const snow_value_splat *p, int n, int phase,
                                    const int tile[2],
                                    const snow_value_lanes *out[2][2]) {
    for (int side = 0; side < 2; side++)
        for (int axis = 0; axis < 2; axis++)
            out[side][axis] =
                value_lanes_of(p->rays, n + side, phase, axis, tile[axis]);
}

/* As NAME(activate_all). */
TARGET static uint32_t NAME(activate_eye)(const snow_value_splat *p, int n,
                                          int phase, const int tile[2],
                                          const value_phase *state,
                                          value_cells cells[2],
                                          value_slab *slab) {
    const snow_value_store *s = p->store;
    uint32_t left = ~UINT32_C(0);
    for (int side = 0; side < 2; side++) {
        value_cells *of = &cells[(n + side) & 1];
        if (of->resampled == n + side)
            continue;
        of->resampled = n + side;
        NAME(find_cells)(s, p->resampled_slices + n + side,
                         value_lanes_of(p->rays, n + side, phase, 0, tile[0]),
                         value_lanes_of(p->rays, n + side, phase, 1, tile[1]),
                         state->alive, of);
    }
    for (int interval = 0; interval < s->interval_count; interval++)
        if (!cells[0].any[interval] && !cells[1].any[interval])
            return 0;
    memcpy(slab->active, state->open, sizeof slab->active);
    for (int interval = 0; interval < s->interval_count && left; interval++) {
        uint32_t both[SNOW_VALUE_ROWS] = {0};
        for (int side = 0; side < 2; side++)
            for (int row = 0; cells[side].any[interval] && row < 32; row++)
                both[row] |= cells[side].cells[interval][row];
        left = V(rows_and)(slab->active, both, ~UINT32_C(0));
    }
    return left;
}

/* The parts of the slab's rays that are inside. */
static inline void NAME(cut_eye)(const snow_value_splat *p, int n, int phase,
                                 const int tile[2], value_cut cut[2]) {
    const snow_value_lanes *lanes[2][2];
    NAME(slab_lanes)(p, n, phase, tile, lanes);
    for (int axis = 0; axis < 2; axis++) {
        double ends[2][2];
        for (int side = 0; side < 2; side++) {
            double step = p->rays->resampled_slices[n + side].step;
            ends[side][0] = lanes[side][axis]->start + (axis ? step : 0);
            ends[side][1] = step;
        }
        snow_value_cut(ends[0], ends[1], p->low[axis], p->high[axis],
                       &cut[axis]);
    }
}

/* The same within all clip planes. */
static inline void NAME(clip_eye)(const snow_value_splat *p, int n, int phase,
                                  const int tile[2], value_clip *clip) {
    const snow_value_lanes *lanes[2][2];
    double ends[2][4];
    NAME(slab_lanes)(p, n, phase, tile, lanes);
    for (int side = 0; side < 2; side++) {
        double step = p->rays->resampled_slices[n + side].step;
        ends[side][0] = lanes[side][0]->start;
        ends[side][1] = lanes[side][1]->start + step;
        ends[side][2] = p->resampled_slices[n + side].at;
        ends[side][3] = step;
    }
    snow_value_clip(p, ends[0], ends[1], clip);
}

/* --- resampled slices ----------------------------------------------------- */

/* Voxels of a row on both sides of the lanes: of a slice, between it and the
 * next one, or the difference of two of them. */
TARGET VALUE_INLINE void NAME(voxels_under)(const NAME(source) *s,
                                            const snow_value_lanes *u,
                                            int64_t row, const bool between,
                                            const bool difference,
                                            V(row) out[2]) {
    int16_t scratch[LINE_VALUES];
    int span = u->at[31] + 2;
    for (int end = 0; end <= difference; end++) {
        V(row) here[2], next[2];
        V(row_pairs)(NAME(line)(s, end, 0, row, u->first, span, scratch), u->at,
                     span, here);
        if (between) {
            V(row_pairs)(NAME(line)(s, end, 1, row, u->first, span, scratch),
                         u->at, span, next);
            here[0] = NAME(toward)(here[0], next[0], s->toward);
            here[1] = NAME(toward)(here[1], next[1], s->toward);
        }
        for (int n = 0; n < 2; n++)
            out[n] = end ? V(row_subs)(here[n], out[n]) : here[n];
    }
    if (difference && s->twice)
        for (int n = 0; n < 2; n++)
            out[n] = V(row_adds)(out[n], out[n]);
}

TARGET VALUE_INLINE V(row) NAME(along_lanes)(const NAME(source) *s,
                                             const snow_value_lanes *u,
                                             int64_t row, const bool between,
                                             const bool difference) {
    V(row) ends[2];
    NAME(voxels_under)(s, u, row, between, difference, ends);
    return NAME(mix)(ends[0], ends[1], V(row_load)(u->weight));
}

/* The row of voxels above a lane of v, which the store has. */
static inline int64_t NAME(voxel_row)(const snow_value_store *s,
                                      const snow_value_lanes *v, int lane) {
    int64_t low = -s->margin, high = s->rows + s->margin - 2;
    int64_t row = v->first + v->at[lane];
    return row < low ? low : row > high ? high : row;
}

/* Rows of a resampled slice, a bit each, into `out`; bit 0 is lane `first` of
 * v. */
TARGET VALUE_INLINE void
NAME(fill_eye)(const NAME(source) *s, const snow_value_store *store,
               const snow_value_lanes *u, const snow_value_lanes *v, int first,
               uint64_t rows, int16_t (*out)[32], const bool between,
               const bool difference) {
    int64_t last = INT64_MIN;
    V(row) below = V(row_set1)(0);
    for (; rows; rows &= rows - 1) {
        int n = __builtin_ctzll(rows);
        int64_t row = NAME(voxel_row)(store, v, first + n);
        V(row) above = row == last + 1
                           ? below
                           : NAME(along_lanes)(s, u, row, between, difference);
        below = NAME(along_lanes)(s, u, row + 1, between, difference);
        V(row_store)(
            out[n], NAME(mix)(above, below, V(row_set1)(v->weight[first + n])));
        last = row;
    }
}

/* --- holes ---------------------------------------------------------------- */

/* As NAME(near_holes). */
static inline bool NAME(near_holes_eye)(const snow_value_store *s,
                                        const snow_resampled_slice *resampled,
                                        const snow_value_lanes *u,
                                        const snow_value_lanes *v) {
    const int64_t slices[5] = {resampled->slice,
                               resampled->slice + resampled->between,
                               resampled->before, resampled->after,
                               resampled->after + resampled->between_across};
    int64_t first = NAME(mask_row)(s, v);
    bool any = false;
    for (int n = 0; s->holes && !any && n < 5; n++)
        any = slices[n] < s->slices &&
              NAME(any_cells)(s, s->interval_count, slices[n], u, first,
                              first + v->at[SNOW_VALUE_LANES - 1]);
    return any;
}

/* As NAME(parts_along). */
TARGET VALUE_INLINE NAME(part) NAME(parts_under)(const NAME(source) *s,
                                                 const snow_value_lanes *u,
                                                 int64_t row, bool between) {
    const int16_t *values = s->values + u->first;
    V(row) here[2], next[2], weight = V(row_load)(u->weight);
    NAME(part) ends[2];
    V(row_pairs)(values + s->slice[row], u->at, u->at[31] + 2, here);
    if (between)
        V(row_pairs)(values + s->slice[row + s->next], u->at, u->at[31] + 2,
                     next);
    for (int n = 0; n < 2; n++) {
        ends[n] = NAME(part_of)(here[n]);
        if (!between)
            continue;
        NAME(part) on = NAME(part_of)(next[n]);
        ends[n].value = NAME(toward)(ends[n].value, on.value, s->toward);
        ends[n].weight = NAME(toward)(ends[n].weight, on.weight, s->toward);
    }
    return (NAME(part)){NAME(mix)(ends[0].value, ends[1].value, weight),
                        NAME(mix)(ends[0].weight, ends[1].weight, weight)};
}

/* As NAME(fill_holes); bit 0 of `rows` is lane `first` of v. */
TARGET static void NAME(fill_holes_eye)(const NAME(source) *s,
                                        const snow_value_store *store,
                                        const snow_value_lanes *u,
                                        const snow_value_lanes *v, int first,
                                        uint64_t rows, int16_t (*out)[32],
                                        uint32_t *partial, bool between) {
    for (; rows; rows &= rows - 1) {
        int n = __builtin_ctzll(rows);
        int64_t row = NAME(voxel_row)(store, v, first + n);
        partial[n] = NAME(mix_parts)(NAME(parts_under)(s, u, row, between),
                                     NAME(parts_under)(s, u, row + 1, between),
                                     V(row_set1)(v->weight[first + n]), out[n]);
    }
}

/* --- kernel bspline ------------------------------------------------------- */

/* As NAME(mix_line). */
TARGET VALUE_INLINE void NAME(mix_line_eye)(const NAME(source) *s,
                                            const snow_value_lanes *lanes,
                                            int64_t row, float (*u)[32],
                                            bool weigh, const bool between,
                                            NAME(lines) *out) {
    const int16_t *values = s->values + lanes->first - 1;
    int span = lanes->at[31] + 2, at = (int)(row & 3);
    NAME(part) parts[4];
    V(row) here[4], next[4];
    if (out->row[at] == row)
        return;
    out->row[at] = row;
    for (int x = 0; x < 4; x += 2) {
        V(row_pairs)(values + s->slice[row] + x, lanes->at, span, here + x);
        if (between)
            V(row_pairs)(values + s->slice[row + s->next] + x, lanes->at, span,
                         next + x);
    }
    for (int x = 0; x < 4; x++) {
        parts[x] = NAME(part_of)(here[x]);
        if (!between)
            continue;
        NAME(part) on = NAME(part_of)(next[x]);
        parts[x].value = NAME(toward)(parts[x].value, on.value, s->toward);
        parts[x].weight = NAME(toward)(parts[x].weight, on.weight, s->toward);
    }
    NAME(mix_parts_along)(parts, u, weigh, at, out);
}

/* As NAME(fill_cubic); bit 0 of `rows` is lane `first` of v. */
TARGET static void NAME(fill_cubic_eye)(
    const NAME(source) *s, const snow_value_store *store,
    const snow_value_lanes *across, const snow_value_lanes *down, double step,
    int first, uint64_t rows, int16_t (*out)[32], bool weigh, bool between) {
    NAME(lines) lines;
    const int64_t low = 1 - store->margin;
    const int64_t high = store->rows + store->margin - 3;
    float u[4][32], v[4];
    for (int n = 0; n < 4; n++)
        lines.row[n] = INT64_MIN;
    for (int lane = 0; lane < 32; lane++) {
        NAME(spline)(value_lane_part(across, step, lane), v);
        for (int n = 0; n < 4; n++)
            u[n][lane] = v[n];
    }
    for (; rows; rows &= rows - 1) {
        int n = __builtin_ctzll(rows);
        int64_t row = NAME(voxel_row)(store, down, first + n);
        row = row > low ? row : low;
        row = row < high ? row : high;
        for (int y = -1; y < 3; y++)
            NAME(mix_line_eye)(s, across, row + y, u, weigh, between, &lines);
        NAME(spline)(value_lane_part(down, step, first + n), v);
        NAME(mix_row)(&lines, row, v, weigh, out[n]);
    }
}

/* As NAME(cross_holes). */
TARGET static void NAME(cross_holes_eye)(const snow_value_splat *p, int n,
                                         NAME(source) from,
                                         const snow_value_lanes *u,
                                         const snow_value_lanes *v,
                                         uint32_t across, value_rows *out) {
    const snow_value_store *s = p->store;
    const snow_resampled_slice *resampled = p->resampled_slices + n;
    const int64_t slices[2] = {resampled->before, resampled->after};
    const double step = p->rays->resampled_slices[n].step;
    int16_t beside[2][SNOW_VALUE_ROWS][32];
    uint32_t partial[2][SNOW_VALUE_ROWS];
    for (int side = 0; side < 2; side++) {
        NAME(set_slices)(&from, slices[side], slices[side]);
        if (s->cubic)
            NAME(fill_cubic_eye)(&from, s, u, v, step, 1, across, beside[side],
                                 out->holes, resampled->between_across);
        else
            NAME(fill_holes_eye)(&from, s, u, v, 1, across, beside[side],
                                 partial[side], resampled->between_across);
    }
    for (; across; across &= across - 1) {
        int r = __builtin_ctz(across);
        uint32_t lanes = s->cubic
                             ? NAME(cross_cubic)(resampled, beside[0][r],
                                                 beside[1][r], out->across[r])
                             : partial[0][r] | partial[1][r];
        const double place[2] = {0, value_lane_part(v, step, 1 + r)};
        const value_sides sides = {.at = place,
                                   .step = step,
                                   .splat = p,
                                   .resampled = n,
                                   .column = u->first,
                                   .row = NAME(voxel_row)(s, v, 1 + r),
                                   .weights = {0, v->weight[1 + r]},
                                   .lanes = u,
                                   .here = out->values[r + 1],
                                   .before = beside[0][r],
                                   .after = beside[1][r]};
        if (lanes)
            snow_value_bridge(&sides, lanes, out->across[r]);
    }
}

/* As NAME(sample). */
TARGET VALUE_ONCE void NAME(sample_eye)(const snow_value_splat *p, int n,
                                        int phase, const int tile[2],
                                        uint64_t rows, uint32_t across,
                                        value_rows *out) {
    const snow_value_store *s = p->store;
    const snow_resampled_slice *resampled = p->resampled_slices + n;
    const snow_value_lanes *u = value_lanes_of(p->rays, n, phase, 0, tile[0]);
    const snow_value_lanes *v = value_lanes_of(p->rays, n, phase, 1, tile[1]);
    NAME(source) from;
    if (out->resampled != n) {
        out->resampled = n;
        out->has = out->has_across = 0;
        out->holes = NAME(near_holes_eye)(s, resampled, u, v);
    }
    NAME(begin)(s, resampled, &rows, &across, out, &from);
    uint32_t partial[RESAMPLED_ROWS];
    if (s->cubic)
        NAME(fill_cubic_eye)(&from, s, u, v, p->rays->resampled_slices[n].step,
                             0, rows, out->values, out->holes,
                             resampled->between);
    else if (out->holes)
        NAME(fill_holes_eye)(&from, s, u, v, 0, rows, out->values, partial,
                             resampled->between);
    else if (resampled->between)
        NAME(fill_eye)(&from, s, u, v, 0, rows, out->values, true, false);
    else
        NAME(fill_eye)(&from, s, u, v, 0, rows, out->values, false, false);
    if (!across)
        return;
    NAME(begin_across)(resampled, &from);
    if (s->cubic)
        ;
    else if (resampled->between_across)
        NAME(fill_eye)(&from, s, u, v, 1, across, out->across, true, true);
    else
        NAME(fill_eye)(&from, s, u, v, 1, across, out->across, false, true);
    if (out->holes || s->cubic)
        NAME(cross_holes_eye)(p, n, from, u, v, across, out);
}

/* Samples the neighbours of a phase's samples on a resampled slice, and says
 * where they are. */
TARGET VALUE_ONCE void NAME(sample_beside)(const snow_value_splat *p, int n,
                                           int phase, const int tile[2],
                                           uint32_t rows,
                                           value_rows (*scratch)[2],
                                           value_beside *out) {
    out->holes = scratch[phase][n & 1].holes;
    for (int way = 0; way < 4; way++) {
        int axis = way / 2, by = p->rays->resampled_slices[n].apart[axis],
            cells;
        int to = value_phase_beside(p->rays, phase, axis, way & 1 ? -by : by,
                                    &cells);
        uint64_t here = (uint64_t)rows << 1;
        if (axis == 1)
            here = cells > 0 ? here << 1 : here >> -cells;
        value_rows *of = &scratch[to][n & 1];
        NAME(sample_eye)(p, n, to, tile, here, 0, of);
        out->holes |= of->holes;
        out->at[way] =
            of->values[axis == 1 ? 1 + cells : 1] + (axis == 1 ? 0 : cells);
    }
}

/* --- what is needed soon -------------------------------------------------- */

/* As NAME(ask). */
static inline void NAME(ask_eye)(const snow_value_splat *p, int n, int phase,
                                 const int tile[2], uint64_t rows,
                                 value_asked *asked) {
    const snow_value_store *s = p->store;
    const snow_value_lanes *u = value_lanes_of(p->rays, n, phase, 0, tile[0]);
    const snow_value_lanes *v = value_lanes_of(p->rays, n, phase, 1, tile[1]);
    const snow_resampled_slice *resampled = p->resampled_slices + n;
    if (resampled->slice < 0 ||
        resampled->slice + resampled->between >= s->slices)
        return; /* of another part */
    if (asked->resampled != n)
        *asked = (value_asked){.resampled = n};
    rows &= ~asked->rows;
    asked->rows |= rows;
    for (; rows; rows &= rows - 1) {
        int64_t row = NAME(voxel_row)(s, v, __builtin_ctzll(rows));
        for (int on = 0; on <= resampled->between; on++)
            for (int at = 0; at < u->at[31] + 32; at += 64)
                value_ask_rows(s, resampled->slice + on, row, u->first + at, 3);
    }
}

/* As NAME(ask_masks). */
static inline void NAME(ask_masks_eye)(const snow_value_splat *p, int n,
                                       int phase, const int tile[2]) {
    const snow_value_store *s = p->store;
    const snow_value_lanes *u =
        value_lanes_of(p->rays, n + 1, phase, 0, tile[0]);
    const snow_value_lanes *v =
        value_lanes_of(p->rays, n + 1, phase, 1, tile[1]);
    int64_t first = NAME(mask_row)(s, v), rows = v->at[32] + 1;
    int64_t words = (u->at[31] + 31) / 32 + 2;
    if (first < 0 || first + rows > (int64_t)s->mask_rows || u->word < 0 ||
        u->word + words > (int64_t)s->mask_words)
        return;
    for (int interval = 0; interval < s->interval_count; interval++) {
        const uint32_t *masks =
            s->masks +
            snow_value_mask_at(s, interval, p->resampled_slices[n + 1].slice) +
            u->word * (int64_t)s->mask_rows + first;
        for (int64_t word = 0; word < words; word++, masks += s->mask_rows)
            for (int64_t row = 0; row < rows + 15; row += 16)
                __builtin_prefetch(masks + row);
    }
}
