/* splat/shear_warp/tile.tmpl.h - a tile, slab by slab.  Include simd/select.h
 * first. */
#include "splat/shear_warp/sample.tmpl.h"

#include "splat/shear_warp/eye.tmpl.h"

#include "splat/shear_warp/color.tmpl.h"

#include "splat/shear_warp/faint.tmpl.h"

#include "splat/shear_warp/ahead.tmpl.h"

/* The values of a resampled slice in some rows of a tile, and the differences
 * across it in others, unless they are there. */
TARGET VALUE_INLINE void NAME(sample)(const snow_value_splat *p, int n,
                                      int phase, const int tile[2],
                                      uint64_t rows, uint32_t across,
                                      value_rows *out, const bool eye) {
    if (eye)
        NAME(sample_eye)(p, n, phase, tile, rows, across, out);
    else
        NAME(sample_all)(p, n, phase, tile, rows, across, out);
}

/* Leaves out the samples whose front and back are in one transparent interval.
 */
TARGET VALUE_INLINE uint32_t NAME(see)(const snow_value_table *table,
                                       V(row) front, V(row) back) {
    V(row) low = V(row_min)(front, back), high = V(row_max)(front, back);
    uint32_t seen = ~UINT32_C(0);
    for (int i = 0; i < table->interval_count; i++)
        seen &= V(row_gt)(V(row_set1)(table->intervals[i].first), low) |
                V(row_gt)(high, V(row_set1)(table->intervals[i].last));
    return seen;
}

/* Ends of the part of a slab that is inside; the lanes that have any. */
TARGET VALUE_INLINE uint32_t NAME(clip)(const value_cut cut[2],
                                        const value_clip *clip, int row,
                                        V(row) *from, V(row) *part) {
    V(row) to = V(row_set1)(INT16_MAX);
    *from = V(row_set1)(0);
    if (cut[0].cuts) {
        *from = V(row_load)(cut[0].from);
        to = V(row_load)(cut[0].to);
    }
    if (cut[1].cuts) {
        *from = V(row_max)(*from, V(row_set1)(cut[1].from[row]));
        to = V(row_min)(to, V(row_set1)(cut[1].to[row]));
    }
    if (clip->cuts) {
        *from = V(row_max)(*from, V(row_load)(clip->from[row]));
        to = V(row_min)(to, V(row_load)(clip->to[row]));
    }
    *part = V(row_subs)(to, *from);
    return V(row_gt)(to, *from);
}

/* Differences of the neighbours on both sides. */
TARGET VALUE_LEAF V(row) NAME(slope)(const int16_t *before, const int16_t *here,
                                     const int16_t *after, bool broken) {
    int16_t slopes[32];
    if (!broken)
        return V(row_subs)(V(row_load)(after), V(row_load)(before));
    snow_value_slopes(before, here, after, slopes);
    return V(row_load)(slopes);
}

/* The values at both ends of what is left of a slab in a row of a tile, and of
 * its active samples those that have them. */
TARGET VALUE_INLINE uint32_t NAME(ends)(const value_rows *f,
                                        const value_rows *b,
                                        const value_slab *slab, int row,
                                        bool cuts, V(row) *x, V(row) *y,
                                        V(row) *from, V(row) *part) {
    const V(row) zero = V(row_set1)(0), most = V(row_set1)(SNOW_VALUE_MOST);
    const V(row) none = V(row_set1)(SNOW_VALUE_HOLE);
    const bool holes = f->holes || b->holes;
    uint32_t mask = slab->active[row];
    *x = V(row_load)(f->values[row + 1]);
    *y = V(row_load)(b->values[row + 1]);
    if (holes)
        mask &= V(row_gt)(*x, none) & V(row_gt)(*y, none);
    if (cuts) {
        mask &= NAME(clip)(slab->cut, &slab->clip, row, from, part);
        V(row) first = *x;
        *x = NAME(mix)(first, *y, *from);
        *y = NAME(mix)(first, *y, V(row_add)(*from, *part));
    }
    if (cuts || holes) {
        *x = V(row_min)(V(row_max)(*x, zero), most);
        *y = V(row_min)(V(row_max)(*y, zero), most);
    }
    return mask;
}

/* Whether all samples of a phase of a slab have values and are whole, and are
 * invisible up to a number. */
static inline bool NAME(is_plain)(const snow_value_splat *p,
                                  const value_rows *f, const value_rows *b,
                                  bool cuts, const bool eye) {
    return !eye && !cuts && !f->holes && !b->holes &&
           p->table->interval_count == 1 && p->table->intervals[0].first == 0;
}

/* Leaves of the active samples of such a phase those that are visible. */
TARGET VALUE_INLINE void NAME(see_plain)(const snow_value_splat *p,
                                         const value_rows *f,
                                         const value_rows *b,
                                         value_slab *slab) {
    const V(row) last = V(row_set1)(p->table->intervals[0].last);
    for (uint32_t rows = slab->rows; rows; rows &= rows - 1) {
        int row = __builtin_ctz(rows);
        slab->active[row] &=
            V(row_gt)(V(row_max)(V(row_load)(f->values[row + 1]),
                                 V(row_load)(b->values[row + 1])),
                      last);
        slab->rows ^= (uint32_t)(slab->active[row] == 0) << row;
    }
}

/* Packs the visible samples of a phase, from number `count` on; of a `plain`
 * one (is_plain) those that are active. */
TARGET VALUE_LEAF int NAME(collect_by)(const snow_value_splat *p,
                                       const value_rows *f, const value_rows *b,
                                       const value_beside beside[2],
                                       const value_phase *state,
                                       value_slab *slab, value_queue *q,
                                       int count, const bool sloped, bool cuts,
                                       const bool eye, const bool plain) {
    const V(row) zero = V(row_set1)(0);
    for (uint32_t rows = slab->rows; rows; rows &= rows - 1) {
        int row = __builtin_ctz(rows);
        const int16_t *front = f->values[row + 1], *back = b->values[row + 1];
        V(row) x, y, from = zero, part = zero;
        uint32_t mask = slab->active[row];
        if (plain) {
            x = V(row_load)(front);
            y = V(row_load)(back);
        } else {
            mask = NAME(ends)(f, b, slab, row, cuts, &x, &y, &from, &part);
            mask &= NAME(see)(p->table, x, y);
            slab->active[row] = mask;
        }
        if (!mask)
            continue;
        V(row_compress)(q->front + count, x, mask);
        V(row_compress)(q->back + count, y, mask);
        if (cuts && !plain) {
            V(row_compress)(q->from + count, from, mask);
            V(row_compress)(q->part + count, part, mask);
        }
        if (eye) {
            V(row_compress)(q->ray[0] + count, V(row_load)(state->columns),
                            mask);
            V(row_store)(
                q->ray[1] + count,
                V(row_set1)((int16_t)(state->line + row * state->lines)));
        }
        for (int side = 0; sloped && side < 2; side++) {
            const int16_t *at = side ? back : front;
            int16_t(*slopes)[QUEUE] = q->slopes + 3 * side;
            const value_beside own = {{at + 1, at - 1, at + 32, at - 32},
                                      !plain && (side ? b : f)->holes};
            const value_beside *by = eye ? &beside[side] : &own;
            const int on = eye ? 32 * row : 0;
            for (int axis = 0; axis < 2; axis++)
                V(row_compress)(slopes[axis] + count,
                                NAME(slope)(by->at[2 * axis + 1] + on, at,
                                            by->at[2 * axis] + on, by->holes),
                                mask);
            V(row_compress)(slopes[2] + count,
                            V(row_load)((side ? b : f)->across[row]), mask);
        }
        count += __builtin_popcount(mask);
    }
    return count;
}

TARGET VALUE_STAGE int NAME(collect)(const snow_value_splat *p,
                                     const value_rows *f, const value_rows *b,
                                     const value_beside beside[2],
                                     const value_phase *state, value_slab *slab,
                                     value_queue *q, int count,
                                     const bool sloped, bool cuts,
                                     const bool eye, bool plain) {
    if (plain)
        return NAME(collect_by)(p, f, b, beside, state, slab, q, count, sloped,
                                false, false, true);
    return NAME(collect_by)(p, f, b, beside, state, slab, q, count, sloped,
                            cuts, eye, false);
}

/* Behind what is in the planes; closes pixels that nothing shines through. */
TARGET VALUE_STAGE int NAME(blend)(snow_value_plane *plane, value_phase *state,
                                   const value_slab *slab, const value_queue *q,
                                   int count, int16_t end, const int channels) {
    const V(row) one = V(row_set1)(INT16_MAX);
    const V(row) closed = V(row_set1)(end);
    for (uint32_t rows = slab->rows; rows; rows &= rows - 1) {
        int row = __builtin_ctz(rows);
        uint32_t mask = slab->active[row];
        if (!mask)
            continue;
        V(row) alpha = V(row_load)((*plane)[3][row]);
        V(row) through = V(row_subs)(one, alpha);
        for (int c = 0; c < channels - 1; c++) {
            int16_t *at = (*plane)[c][row];
            V(row) color = V(row_expand)(q->color[c] + count, mask);
            V(row_store)(
                at, V(row_add)(V(row_load)(at), V(row_mulhrs)(through, color)));
        }
        alpha = V(row_add)(
            alpha,
            V(row_mulhrs)(through, V(row_expand)(q->color[3] + count, mask)));
        V(row_store)((*plane)[3][row], alpha);
        count += __builtin_popcount(mask);
        state->open[row] &= V(row_gt)(closed, alpha);
        if (!state->open[row])
            state->alive &= ~(UINT32_C(1) << row);
    }
    return count;
}

/* Zeros behind a queue of slab `n`. */
TARGET VALUE_INLINE void NAME(end_queue)(const snow_value_splat *p, int n,
                                         value_queue *q, int count,
                                         const bool eye) {
    const V(row) zero = V(row_set1)(0);
    V(row_store)(q->front + count, zero);
    V(row_store)(q->back + count, zero);
    for (int way = 0; p->leans && way < BORDERS; way++)
        V(row_store)(q->border[way] + count, zero);
    for (int way = 0; p->fade && way < 6; way++)
        V(row_store)(q->slopes[way] + count, zero);
    if (p->fade && p->labels) /* not of a table */
        V(row_store)(q->color[3] + count, zero);
    V(row_store)(q->from + count, zero);
    V(row_store)(q->part + count, zero);
    if (!eye)
        return;
    for (int side = 0; side < 2; side++) {
        V(row_store)(q->ray[side] + count, zero);
        memcpy(q->stretch[side], p->rays->resampled_slices[n + side].stretch,
               sizeof q->stretch[side]);
    }
}

/* Samples of some phases of slab `n`, packed; returns how many. */
TARGET VALUE_STAGE int NAME(gather)(const snow_value_splat *p, int n, int first,
                                    int end, const int tile[2],
                                    value_scratch *scratch, value_slab *slabs,
                                    bool cuts, const bool sloped,
                                    const bool eye) {
    int count = 0;
    for (int phase = first; phase < end; phase++) {
        const value_phase *state = &scratch->phase[phase];
        value_slab *slab = &slabs[phase - first];
        value_rows *f = &scratch->rows[phase][n & 1];
        value_rows *b = &scratch->rows[phase][~n & 1];
        value_beside beside[2];
        if (slab->rows)
            slab->rows &= V(rows_and)(slab->active, state->open, ~UINT32_C(0));
        uint64_t here = (uint64_t)slab->rows << 1;
        if (!here)
            continue;
        if (p->labels) {
            count =
                snow_value_collect_labels(p, n, phase, tile, scratch->slope,
                                          slab, &scratch->queue, count, sloped);
            continue;
        }
        if (sloped && !eye)
            here |= here << 1 | here >> 1;
        NAME(sample)(p, n, phase, tile, here, 0, f, eye);
        NAME(sample)(p, n + 1, phase, tile, here, 0, b, eye);
        const bool plain = NAME(is_plain)(p, f, b, cuts, eye);
        if (plain)
            NAME(see_plain)(p, f, b, slab);
        if (sloped && slab->rows) {
            NAME(sample)(p, n, phase, tile, 0, slab->rows, f, eye);
            NAME(sample)(p, n + 1, phase, tile, 0, slab->rows, b, eye);
        }
        for (int side = 0; sloped && eye && side < 2; side++)
            NAME(sample_beside)(p, n + side, phase, tile, slab->rows,
                                scratch->rows, &beside[side]);
        const int begin = count;
        count = NAME(collect)(p, f, b, beside, state, slab, &scratch->queue,
                              count, sloped, cuts, eye, plain);
        if (sloped && p->leans) {
            const value_sample at = {p, n, phase, 0, 0, tile};
            const bool holes[2] = {f->holes, b->holes};
            snow_value_lean(&at, slab, holes, &scratch->queue, begin);
        }
    }
    return count;
}

/* Some phases of slab `n`; of each kind of tile there is one such function. */
TARGET VALUE_INLINE bool NAME(slab)(const snow_value_splat *p, int n, int first,
                                    int end, const int tile[2],
                                    snow_value_plane *planes,
                                    value_scratch *scratch, value_slab *slabs,
                                    const int channels, const bool sloped,
                                    const bool eye) {
    value_queue *q = &scratch->queue;
    bool cuts = false;
    for (int at = 0; at < end - first; at++)
        cuts |=
            slabs[at].rows && (slabs[at].cut[0].cuts || slabs[at].cut[1].cuts ||
                               slabs[at].clip.cuts);
    int count =
        NAME(gather)(p, n, first, end, tile, scratch, slabs, cuts, sloped, eye);
    if (!count)
        return false;
    NAME(end_queue)(p, n, q, count, eye);
    NAME(color)(p, scratch->slope, slabs, end - first, q, count, channels,
                sloped, cuts, eye);
    count = 0;
    for (int phase = first; phase < end; phase++)
        if (p->floats)
            count = NAME(blend_faint)(
                p, (snow_value_faint_plane *)(void *)planes + phase,
                &scratch->phase[phase], &slabs[phase - first], q, count,
                channels);
        else
            count = NAME(blend)(&planes[phase], &scratch->phase[phase],
                                &slabs[phase - first], q, count, p->closed,
                                channels);
    return true;
}

/* Where the rays of a tile and its phases are. */
static void NAME(aim)(const snow_value_splat *p, const int tile[2],
                      value_scratch *scratch) {
    const snow_value_rays *rays = p->rays;
    const int64_t first[2] = {value_tile_column(p, tile[0]) - p->first[0],
                              value_tile_row(p, tile[1]) - p->first[1]};
    for (int axis = 0; axis < 2; axis++) {
        double on = (double)(first[axis] * rays->phases[axis]);
        scratch->slope[axis][0] =
            (float)(rays->slope[axis][0] + on * rays->slope[axis][1]);
        scratch->slope[axis][1] = (float)rays->slope[axis][1];
    }
    for (int phase = 0; phase < p->phases; phase++) {
        value_phase *state = &scratch->phase[phase];
        for (int lane = 0; lane < 32; lane++)
            state->columns[lane] =
                (int16_t)(lane * rays->phases[0] + rays->spot[phase][0]);
        state->line = rays->spot[phase][1];
        state->lines = (int16_t)rays->phases[1];
        scratch->cells[phase][0].resampled =
            scratch->cells[phase][1].resampled = -1;
    }
}

/* All pixels that are the lattice's are open. */
static void NAME(open)(const snow_value_splat *p, int x, int y,
                       value_scratch *scratch) {
    int64_t columns = p->cells[0] - (int64_t)x * SNOW_VALUE_COLUMNS;
    int64_t rows = p->cells[1] - (int64_t)y * SNOW_VALUE_ROWS;
    columns = columns < SNOW_VALUE_COLUMNS ? columns : SNOW_VALUE_COLUMNS;
    rows = rows < SNOW_VALUE_ROWS ? rows : SNOW_VALUE_ROWS;
    uint32_t lanes = ((UINT32_C(1) << columns) - 1) << 1;
    for (int phase = 0; phase < p->phases; phase++) {
        value_phase *state = &scratch->phase[phase];
        for (int row = 0; row < SNOW_VALUE_ROWS; row++)
            state->open[row] = row < rows ? lanes : 0;
        state->alive = rows == 32 ? ~UINT32_C(0) : (UINT32_C(1) << rows) - 1;
        scratch->rows[phase][0].resampled = scratch->rows[phase][1].resampled =
            -1;
    }
}

/* Alphas of a row of a plane. */
TARGET static inline V(row) NAME(alphas)(const snow_value_splat *p,
                                         const void *planes, int phase,
                                         int row) {
    const snow_value_plane *words = (const snow_value_plane *)planes + phase;
    const snow_value_faint_plane *floats =
        (const snow_value_faint_plane *)planes + phase;
    int16_t alphas[32];
    if (!p->floats)
        return V(row_load)((*words)[3][row]);
    for (int n = 0; n < 32; n += LANES)
        V(row_round)(alphas + n, V(mul)(V(load)((*floats)[3][row] + n),
                                        V(set1)(INT16_MAX)));
    return V(row_load)(alphas);
}

/* Closes the pixels that nothing shines through, of planes that hold some. */
TARGET static void NAME(resume)(const snow_value_splat *p, const void *planes,
                                value_scratch *scratch) {
    const V(row) closed = V(row_set1)(p->closed);
    for (int phase = 0; phase < p->phases; phase++) {
        value_phase *state = &scratch->phase[phase];
        for (int row = 0; row < SNOW_VALUE_ROWS; row++) {
            state->open[row] &=
                V(row_gt)(closed, NAME(alphas)(p, planes, phase, row));
            if (!state->open[row])
                state->alive &= ~(UINT32_C(1) << row);
        }
    }
}

/* Whether some phases have open pixels. */
static inline bool NAME(alive)(const value_scratch *scratch, int first,
                               int end) {
    uint32_t alive = 0;
    for (int phase = first; phase < end; phase++)
        alive |= scratch->phase[phase].alive;
    return alive != 0;
}

/* Some phases of a tile over the whole depth.  Slabs are looked at before their
 * turn. */
TARGET VALUE_INLINE bool
NAME(phases)(const snow_value_splat *p, int first, int end, const int tile[2],
             snow_value_plane *planes, value_scratch *scratch,
             value_slab_fn *draw, const bool sloped, const bool eye) {
    value_list list =
        value_list_begin(p, first, end, tile, value_slabs(p, scratch));
    const int32_t *slabs = list.slabs;
    bool drawn = false;
    for (int n = 0; n < ASKED_RING; n++)
        scratch->asked[n].resampled = -1;
    for (int turn = 0, seen = 0;; turn++) {
        value_list_find(&list, turn + AHEAD + 3);
        if (turn >= list.count)
            break;
        for (; seen < list.count && seen <= turn + AHEAD; seen++) {
            const bool asks = VALUE_ASKS && seen + 2 < list.count;
            if (asks && eye)
                NAME(ask_masks_eye)(p, slabs[seen + 2], first, tile);
            else if (asks)
                NAME(ask_masks)(p, slabs[seen + 2], first, tile);
            NAME(look_ahead)(p, slabs[seen], first, end, tile, scratch,
                             scratch->slab[seen % AHEAD_RING], sloped, eye);
        }
        drawn |= draw(p, slabs[turn], first, end, tile, planes, scratch,
                      scratch->slab[turn % AHEAD_RING]);
        if (!NAME(alive)(scratch, first, end))
            break;
    }
    return drawn;
}

/* The same of many phases in perspective, slab by slab: their samples'
 * neighbours are of other phases. */
TARGET VALUE_INLINE bool
NAME(phases_eye)(const snow_value_splat *p, const int tile[2],
                 snow_value_plane *planes, value_scratch *scratch,
                 value_slab_fn *draw, const bool sloped) {
    value_list list =
        value_list_begin(p, 0, p->phases, tile, value_slabs(p, scratch));
    bool drawn = false;
    for (int turn = 0; NAME(alive)(scratch, 0, p->phases); turn++) {
        value_list_find(&list, turn + 1);
        if (turn >= list.count)
            break;
        for (int first = 0; first < p->phases; first += TOGETHER) {
            int end =
                first + TOGETHER < p->phases ? first + TOGETHER : p->phases;
            for (int n = 0; n < ASKED_RING; n++)
                scratch->asked[n].resampled = -1;
            NAME(look_ahead)(p, list.slabs[turn], first, end, tile, scratch,
                             scratch->slab[0], sloped, true);
            drawn |= draw(p, list.slabs[turn], first, end, tile, planes,
                          scratch, scratch->slab[0]);
        }
    }
    return drawn;
}

TARGET VALUE_INLINE bool NAME(tile)(const snow_value_splat *p, int x, int y,
                                    void *memory, value_slab_fn *draw,
                                    const bool sloped, const bool eye) {
    snow_value_plane *planes = memory;
    value_scratch *scratch =
        (value_scratch *)(void *)((char *)memory + snow_value_planes_bytes(p));
    const int tile[2] = {x, y};
    bool drawn = false;
    scratch->queue.border = value_borders(p, scratch);
    NAME(open)(p, x, y, scratch);
    if (p->resumes)
        NAME(resume)(p, planes, scratch);
    else
        memset(planes, 0, snow_value_planes_bytes(p));
    if (eye)
        NAME(aim)(p, tile, scratch);
    if (eye && p->phases > TOGETHER)
        return NAME(phases_eye)(p, tile, planes, scratch, draw, sloped);
    for (int first = 0; first < p->phases; first += TOGETHER) {
        int end = first + TOGETHER < p->phases ? first + TOGETHER : p->phases;
        drawn |= NAME(phases)(p, first, end, tile, planes, scratch, draw,
                              sloped, eye);
    }
    return drawn;
}

#define VALUE_TILE(kind, channels, sloped, eye)                            \
    TARGET VALUE_ONCE bool NAME(slab_##kind)(                              \
        const snow_value_splat *p, int n, int first, int end,              \
        const int tile[2], snow_value_plane *planes, value_scratch *room,  \
        value_slab *slabs) {                                               \
        return NAME(slab)(p, n, first, end, tile, planes, room, slabs,     \
                          channels, sloped, eye);                          \
    }                                                                      \
    TARGET static bool NAME(tile_##kind)(const snow_value_splat *p, int x, \
                                         int y, void *room) {              \
        return NAME(tile)(p, x, y, room, NAME(slab_##kind), sloped, eye);  \
    }
VALUE_TILE(grey, 2, false, false)
VALUE_TILE(color, 4, false, false)
VALUE_TILE(grey_lit, 2, true, false)
VALUE_TILE(color_lit, 4, true, false)
VALUE_TILE(grey_eye, 2, false, true)
VALUE_TILE(color_eye, 4, false, true)
VALUE_TILE(grey_lit_eye, 2, true, true)
VALUE_TILE(color_lit_eye, 4, true, true)
#undef VALUE_TILE

snow_value_tile_fn *const NAME(snow_value_tiles)[2][2][2] = {
    {{NAME(tile_grey), NAME(tile_grey_eye)},
     {NAME(tile_grey_lit), NAME(tile_grey_lit_eye)}},
    {{NAME(tile_color), NAME(tile_color_eye)},
     {NAME(tile_color_lit), NAME(tile_color_lit_eye)}},
};

#include "splat/shear_warp/project.tmpl.h"
