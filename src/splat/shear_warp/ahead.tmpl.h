/* splat/shear_warp/ahead.tmpl.h - slabs before their turn: which samples can be
 * seen, and what the cache is asked for.  Included by tile.tmpl.h. */

/* Whether some lanes have active samples. */
TARGET static inline bool NAME(any_of)(const value_slab *slab, uint32_t lanes) {
    uint32_t any = 0;
    for (int row = 0; row < SNOW_VALUE_ROWS; row++)
        any |= slab->active[row];
    return (any & lanes) != 0;
}

/* Leaves of the active samples of a phase of slab `n` those that are inside and
 * open. */
TARGET VALUE_INLINE void NAME(trim)(const snow_value_splat *p, int n, int phase,
                                    const int tile[2], const value_phase *state,
                                    value_slab *slab, const bool eye) {
    if (eye)
        NAME(cut_eye)(p, n, phase, tile, slab->cut);
    else
        NAME(cut_all)(p, n, phase, tile, slab->cut);
    uint32_t lanes = slab->cut[0].some;
    uint32_t rows = slab->cut[1].some;
    if (p->parted) {
        lanes &= snow_value_own_lanes(p, n, phase, tile, 0);
        rows &= snow_value_own_lanes(p, n, phase, tile, 1);
    }
    rows &= V(rows_and)(slab->active, state->open, lanes);
    slab->clip.cuts = false;
    if (p->clip_count && eye)
        NAME(clip_eye)(p, n, phase, tile, &slab->clip);
    else if (p->clip_count)
        NAME(clip_all)(p, n, phase, tile, &slab->clip);
    if (slab->clip.cuts)
        rows &= V(rows_and)(slab->active, slab->clip.some, ~UINT32_C(0));
    if (slab->cut[0].cuts && !NAME(any_of)(slab, slab->cut[0].parts))
        slab->cut[0].cuts = false; /* what it cuts cannot be seen */
    slab->cut[1].cuts &= (rows & slab->cut[1].parts) != 0;
    slab->rows = rows;
}

/* The samples of a phase of slab `n`, between resampled slices n and n + 1,
 * that can be seen. */
TARGET VALUE_INLINE void NAME(activate)(const snow_value_splat *p, int n,
                                        int phase, const int tile[2],
                                        const value_phase *state,
                                        value_cells cells[2], value_slab *slab,
                                        const bool eye) {
    slab->rows = 0;
    if (!state->alive)
        return;
    uint32_t rows =
        eye ? NAME(activate_eye)(p, n, phase, tile, state, cells, slab)
            : NAME(activate_all)(p, n, phase, tile, state, slab);
    if (rows)
        NAME(trim)(p, n, phase, tile, state, slab, eye);
}

/* Asks for rows of voxels of a resampled slice; a bit each, from row -1 on. */
static inline void NAME(ask)(const snow_value_splat *p, int n, int phase,
                             const int tile[2], uint64_t rows,
                             value_asked *asked) {
    const snow_value_store *s = p->store;
    const snow_resampled_slice *resampled = p->resampled_slices + n;
    const snow_value_place *place = p->places + n * p->phases + phase;
    int64_t column = value_tile_column(p, tile[0]) + place->whole[0];
    int64_t first = value_tile_row(p, tile[1]) + place->whole[1] - 1;
    if (resampled->slice < 0 ||
        resampled->slice + resampled->between >= s->slices)
        return; /* of another part */
    if (asked->resampled != n)
        *asked = (value_asked){.resampled = n};
    rows &= ~asked->rows;
    asked->rows |= rows;
    for (int on = 0; on <= resampled->between; on++)
        value_ask_rows(s, resampled->slice + on, first, column, rows);
}

/* Asks for the masks of the second resampled slice of slab `n`. */
static inline void NAME(ask_masks)(const snow_value_splat *p, int n, int phase,
                                   const int tile[2]) {
    const snow_value_store *s = p->store;
    const snow_value_place *place = p->places + (n + 1) * p->phases + phase;
    int64_t column = value_tile_column(p, tile[0]) + place->whole[0];
    int64_t row = value_tile_row(p, tile[1]) + place->whole[1];
    if (!value_meets(s, column, row))
        return;
    value_window w = value_window_of(s, column, row);
    for (int interval = 0; interval < s->interval_count; interval++) {
        const uint32_t *masks =
            s->masks +
            snow_value_mask_at(s, interval, p->resampled_slices[n + 1].slice) +
            w.word * s->mask_rows + w.row;
        for (int word = 0; word < 2; word++, masks += s->mask_rows) {
            __builtin_prefetch(masks);
            __builtin_prefetch(masks + 16);
            __builtin_prefetch(masks + SNOW_VALUE_ROWS - 1);
        }
    }
}

/* Finds what some phases of slab `n` will need, and asks the cache for it. */
TARGET VALUE_STAGE void NAME(look_ahead)(const snow_value_splat *p, int n,
                                         int first, int end, const int tile[2],
                                         value_scratch *scratch,
                                         value_slab *slabs, const bool sloped,
                                         const bool eye) {
    uint32_t any = 0;
    for (int phase = first; phase < end; phase++) {
        value_slab *slab = &slabs[phase - first];
        NAME(activate)(p, n, phase, tile, &scratch->phase[phase],
                       scratch->cells[phase], slab, eye);
        any |= slab->rows;
    }
    uint64_t here = (uint64_t)any << 1;
    int beside = sloped ? 1 + (p->resampled_slices[n].between |
                               p->resampled_slices[n + 1].between)
                        : 0;
    if (!any || !VALUE_ASKS)
        return;
    for (int m = n - beside; m <= n + 1 + beside; m++) {
        uint64_t rows = here;
        if (m < 0 || m >= p->resampled_count)
            continue;
        if (sloped && (m == n || m == n + 1))
            rows |= here << 1 | here >> 1;
        value_asked *asked = &scratch->asked[m % ASKED_RING];
        if (eye)
            NAME(ask_eye)(p, m, first, tile, rows, asked);
        else
            NAME(ask)(p, m, first, tile, rows | rows << 1, asked);
    }
}
