/* insitu/data.c - a simulation's voxels as the parts of a volume.
 *
 * A picture wants one box of voxels from each rank, with ghost voxels around
 * it.  Where every rank's bricks are one box together, work stays where the
 * voxels are; else boxes are cut anew.  From the cheapest on:
 *
 *   shared     one brick that lies in memory as wanted: its voxels are used
 *              where they are
 *   copied     bricks with halos: into one dense box, without a message
 *   exchanged  ghost voxels come from their owners (decompose/redistribute.c)
 *   recut      all voxels do
 *
 * All ranks decide alike, from one reduction of a few numbers; only whether a
 * brick is shared or copied is a rank's own affair. */
#include "insitu/internal.h"

#include <string.h>

/* What ranks tell each other before voxels are taken; reduced to the least. */
enum {
    FACT_TYPE,       /* of the voxels; the greatest number where none */
    FACT_TYPE_MOST,  /* minus the type; 0 where none */
    FACT_PRINT,      /* of all that must be the same on all ranks */
    FACT_PRINT_MOST, /* minus that */
    FACT_UNCHANGED,  /* 1: what was planned still holds */
    FACT_UNITED,     /* 1: the bricks are one box together, or none */
    FACT_HALOS,      /* 1: halos are as wide as the layers */
    FACT_BOXES,      /* 1: every rank's bricks united are known */
    FACTS
};

/* --- what the picture is made with -----------------------------------------
 */

static int shrink(int side, snow_degradation lowering) {
    int by = lowering == SNOW_DEGRADATION_HALF      ? 2
             : lowering == SNOW_DEGRADATION_QUARTER ? 4
                                                    : 1;
    return (side + by - 1) / by;
}

void snow_insitu_lowered(const snow_insitu *insitu, snow_view *view,
                         snow_settings *settings) {
    snow_degradation lowering = insitu->layout.lowering;
    *view = snow_insitu_view(insitu);
    *settings = insitu->settings;
    view->width = shrink(view->width, lowering);
    view->height = shrink(view->height, lowering);
    if (lowering != SNOW_DEGRADATION_NONE)
        settings->quality = SNOW_QUALITY_DRAFT;
}

/* --- this rank's bricks --------------------------------------------------- */

static snow_status add_brick(snow_insitu *insitu, int id) {
    const snow_insitu_brick *brick = &insitu->bricks[id];
    if (!brick->voxels)
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "brick %d has no voxels; call snow_insitu_set_voxels", id);
    if (insitu->type != SNOW_TYPE_NONE && insitu->type != brick->type)
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "brick %d is %s and another one %s; give all the same "
            "type",
            id, snow_type_name(brick->type), snow_type_name(insitu->type));
    insitu->type = brick->type;
    int n = insitu->held_count++;
    insitu->held[n] = brick->box;
    insitu->moved[n] = (snow_brick){.box = brick->box, .voxels = brick->voxels};
    memcpy(insitu->moved[n].stride, brick->stride, sizeof brick->stride);
    return SNOW_STATUS_OK;
}

/* Lists the bricks that are not empty. */
static snow_status list_bricks(snow_insitu *insitu) {
    size_t count = (size_t)insitu->brick_count;
    insitu->held_count = 0;
    insitu->type = SNOW_TYPE_NONE;
    if (!insitu->whole.dims[0])
        return snow_context_fail(insitu->context, SNOW_STATUS_BAD_USAGE,
                                 "there is no grid; call snow_insitu_set_grid");
    INSITU_TRY(snow_insitu_reserve(insitu, &insitu->held, &insitu->held_bytes,
                                   0, count * sizeof *insitu->held));
    INSITU_TRY(snow_insitu_reserve(insitu, &insitu->moved, &insitu->moved_bytes,
                                   0, count * sizeof *insitu->moved));
    for (int id = 0; id < insitu->brick_count; id++)
        if (snow_box_voxels(&insitu->bricks[id].box))
            INSITU_TRY(add_brick(insitu, id));
    return SNOW_STATUS_OK;
}

/* The box around all bricks; whether they fill it.  Bricks that overlap are
 * found when a move is planned. */
static bool unite(const snow_insitu *insitu, snow_box *out) {
    snow_box around = {{0, 0, 0}, {0, 0, 0}};
    int64_t voxels = 0;
    for (int n = 0; n < insitu->held_count; n++) {
        const snow_box *box = &insitu->held[n];
        voxels += snow_box_voxels(box);
        for (int i = 0; i < 3; i++) {
            int64_t end = box->first[i] + box->count[i];
            int64_t last = around.first[i] + around.count[i];
            if (n == 0 || box->first[i] < around.first[i])
                around.first[i] = box->first[i];
            if (n == 0 || end > last)
                last = end;
            around.count[i] = last - around.first[i];
        }
    }
    *out = around;
    return voxels == snow_box_voxels(&around);
}

/* A box with so many layers more on all sides, as far as the grid goes. */
static snow_box grow(const snow_box *box, const int64_t low[3],
                     const int64_t high[3], const int64_t dims[3]) {
    snow_box out;
    for (int i = 0; i < 3; i++) {
        int64_t end = box->first[i] + box->count[i];
        int64_t to_end = dims[i] - end;
        out.first[i] = box->first[i] > low[i] ? box->first[i] - low[i] : 0;
        out.count[i] =
            end + (high[i] < to_end ? high[i] : to_end) - out.first[i];
    }
    return out;
}

static bool holds(const snow_box *outer, const snow_box *inner) {
    for (int i = 0; i < 3; i++)
        if (inner->first[i] < outer->first[i] ||
            inner->first[i] + inner->count[i] >
                outer->first[i] + outer->count[i])
            return false;
    return true;
}

/* Whether each brick's halo has all layers that lie within the grid. */
static bool halos_suffice(const snow_insitu *insitu, const int64_t layers[3]) {
    for (int id = 0; id < insitu->brick_count; id++) {
        const snow_insitu_brick *brick = &insitu->bricks[id];
        if (!snow_box_voxels(&brick->box))
            continue;
        snow_box has = grow(&brick->box, brick->halo.low, brick->halo.high,
                            insitu->whole.dims);
        snow_box needs = grow(&brick->box, layers, layers, insitu->whole.dims);
        if (!holds(&has, &needs))
            return false;
    }
    return true;
}

/* --- what all ranks know -------------------------------------------------- */

/* FNV-1a over bytes. */
static uint64_t add_print(uint64_t print, const void *bytes, size_t count) {
    const unsigned char *at = bytes;
    for (size_t i = 0; i < count; i++)
        print = (print ^ at[i]) * UINT64_C(0x100000001b3);
    return print;
}

/* Points that place the camera, where there are any. */
static uint64_t add_points(uint64_t print, const snow_view *view) {
    const bool has[] = {view->has_position, view->has_target, view->has_up};
    const double *points[] = {view->position, view->target, view->upward};
    for (int n = 0; n < 3; n++)
        if (has[n])
            print = add_print(add_print(print, &n, sizeof n), points[n],
                              sizeof view->position);
    return print;
}

/* A print of what must be the same everywhere, as numbers, since records have
 * gaps between their fields. */
static int64_t print_of(const snow_insitu *insitu, const snow_view *view) {
    const snow_settings *s = &insitu->settings;
    const double reals[] = {
        view->back[0],     view->back[1],        view->back[2], view->up[0],
        view->up[1],       view->up[2],          view->azimuth, view->elevation,
        view->roll,        view->zoom,           view->fov,     s->threshold,
        s->opacity_length, insitu->limit_seconds};
    const int64_t wholes[] = {view->width,
                              view->height,
                              (int64_t)s->method,
                              (int64_t)s->kernel,
                              s->footprint,
                              (int64_t)s->quality,
                              s->deterministic,
                              (int64_t)insitu->limit_bytes,
                              (int64_t)insitu->ghosts,
                              (int64_t)insitu->balance,
                              insitu->pattern != NULL,
                              insitu->transfer != NULL};
    uint64_t print = UINT64_C(0xcbf29ce484222325);
    print = add_print(print, reals, sizeof reals);
    print = add_print(print, wholes, sizeof wholes);
    print = add_points(print, view);
    print = add_print(print, insitu->whole.dims, sizeof insitu->whole.dims);
    print = add_print(print, insitu->whole.matrix, sizeof insitu->whole.matrix);
    return (int64_t)(print >> 2);
}

static snow_status check_prints(snow_insitu *insitu, int64_t least,
                                int64_t most) {
    if (least == most)
        return SNOW_STATUS_OK;
    return snow_context_fail(
        insitu->context, SNOW_STATUS_BAD_USAGE,
        "ranks were told different grids, views, settings or "
        "limits; call the setters alike on all of them");
}

snow_status snow_insitu_check(snow_insitu *insitu) {
    snow_view view = snow_insitu_view(insitu);
    int64_t print = print_of(insitu, &view), prints[2] = {print, -print};
    INSITU_TRY(snow_comm_reduce_ints(insitu->comm, prints, 2, SNOW_MIN));
    return check_prints(insitu, prints[0], -prints[1]);
}

static snow_status check_facts(snow_insitu *insitu, const int64_t *facts) {
    INSITU_TRY(
        check_prints(insitu, facts[FACT_PRINT], -facts[FACT_PRINT_MOST]));
    if (facts[FACT_TYPE] == INT64_MAX)
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "no rank has a brick; call snow_insitu_set_brick");
    if (facts[FACT_TYPE] != -facts[FACT_TYPE_MOST])
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "voxels are %s on one rank and %s on another; give "
            "all the same type",
            snow_type_name((snow_type)facts[FACT_TYPE]),
            snow_type_name((snow_type)-facts[FACT_TYPE_MOST]));
    return SNOW_STATUS_OK;
}

/* Collective.  What is found here is the same everywhere, failures too. */
static snow_status share_facts(snow_insitu *insitu, const snow_view *view,
                               const int64_t layers[3], bool united,
                               int64_t facts[FACTS]) {
    bool same = insitu->layout.planned && !insitu->changed &&
                memcmp(layers, insitu->layout.layers, 3 * sizeof *layers) == 0;
    insitu->boxes_known &= !insitu->changed;
    int64_t type = (int64_t)insitu->type;
    facts[FACT_TYPE] = type ? type : INT64_MAX;
    facts[FACT_TYPE_MOST] = -type;
    facts[FACT_PRINT] = print_of(insitu, view);
    facts[FACT_PRINT_MOST] = -facts[FACT_PRINT];
    facts[FACT_UNCHANGED] = same;
    facts[FACT_UNITED] = united;
    facts[FACT_HALOS] = halos_suffice(insitu, layers);
    facts[FACT_BOXES] = insitu->boxes_known;
    INSITU_TRY(snow_comm_reduce_ints(insitu->comm, facts, FACTS, SNOW_MIN));
    INSITU_TRY(check_facts(insitu, facts));
    insitu->type = (snow_type)facts[FACT_TYPE];
    return SNOW_STATUS_OK;
}

/* --- who draws what ------------------------------------------------------- */

/* A picture that is the same bit for bit however many ranks make it is made of
 * slabs across the view's slices, whose axis is answered; -1 where any boxes
 * will do. */
static int slab_axis(const snow_insitu *insitu, int slice_axis) {
    bool any =
        !insitu->settings.deterministic || snow_comm_size(insitu->comm) == 1;
    return any ? -1 : slice_axis;
}

/* Equal boxes: ranks are halved, and the longest side with them. */
static snow_box cut_equal(const int64_t dims[3], int ranks, int rank) {
    snow_box box = {{0, 0, 0}, {dims[0], dims[1], dims[2]}};
    while (ranks > 1) {
        int low = ranks / 2, axis = 0;
        for (int i = 1; i < 3; i++)
            if (box.count[i] >= box.count[axis])
                axis = i;
        int64_t cut = box.count[axis] * low / ranks;
        if (rank < low) {
            box.count[axis] = cut;
            ranks = low;
        } else {
            box.first[axis] += cut;
            box.count[axis] -= cut;
            ranks -= low;
            rank -= low;
        }
    }
    return box;
}

static snow_box cut_slab(const int64_t dims[3], int axis, int ranks, int rank) {
    snow_box box = {{0, 0, 0}, {dims[0], dims[1], dims[2]}};
    snow_ranks_slab(dims[axis], ranks, rank, &box.first[axis],
                    &box.count[axis]);
    return box;
}

/* The owned box, and the stored one around it: one voxel where nothing is
 * owned, since a volume has at least one. */
static void place_boxes(const snow_insitu *insitu, snow_insitu_layout *l,
                        const snow_box *united) {
    int ranks = snow_comm_size(insitu->comm);
    int rank = snow_comm_rank(insitu->comm);
    const int64_t *dims = insitu->whole.dims;
    if (!l->recut)
        l->owned = *united;
    else if (l->recut_axis >= 0)
        l->owned = cut_slab(dims, l->recut_axis, ranks, rank);
    else
        l->owned = cut_equal(dims, ranks, rank);
    if (snow_box_voxels(&l->owned))
        l->stored = grow(&l->owned, l->layers, l->layers, dims);
    else {
        l->owned = (snow_box){{0, 0, 0}, {0, 0, 0}};
        l->stored = (snow_box){{0, 0, 0}, {1, 1, 1}};
    }
}

/* Collective.  Bricks do not overlap, as is known by then: counting tells
 * whether they are the whole grid. */
static snow_status check_whole(const snow_insitu *insitu) {
    const int64_t *dims = insitu->whole.dims;
    int64_t held = 0, all = dims[0] * dims[1] * dims[2];
    for (int n = 0; n < insitu->held_count; n++)
        held += snow_box_voxels(&insitu->held[n]);
    INSITU_TRY(snow_comm_reduce_ints(insitu->comm, &held, 1, SNOW_SUM));
    if (held == all)
        return SNOW_STATUS_OK;
    return snow_context_fail(
        insitu->context, SNOW_STATUS_BAD_USAGE,
        "no rank holds %lld of the %lld voxels of the grid; give "
        "each to a brick",
        (long long)(all - held), (long long)all);
}

/* Collective.  A new layout, and the plan of its exchange; one of nothing finds
 * bricks that overlap as well. */
static snow_status plan(snow_insitu *insitu, const snow_insitu_layout *wanted,
                        const snow_box *united, const int64_t facts[FACTS]) {
    snow_insitu_layout l = *wanted;
    static const snow_box nothing;
    place_boxes(insitu, &l, united);
    l.exchanged = l.recut || !facts[FACT_HALOS];
    if (insitu->ghosts == SNOW_GHOSTS_NONE)
        l.exchanged = l.recut;
    insitu->layout.planned = false;
    bool moves = l.exchanged && snow_box_voxels(&l.owned);
    INSITU_TRY(snow_voxels_plan(insitu->voxels, insitu->held,
                                insitu->held_count,
                                moves ? &l.stored : &nothing));
    INSITU_TRY(check_whole(insitu));
    l.planned = true;
    insitu->layout = l;
    insitu->changed = false;
    return SNOW_STATUS_OK;
}

/* What this rank finds out by itself: its bricks, how the view lies, how wide
 * ghosts must be, which grow as pictures get smaller. */
static snow_status look_around(snow_insitu *insitu, const snow_view *view,
                               const snow_settings *settings,
                               snow_ranks_needs *needs) {
    INSITU_TRY(list_bricks(insitu));
    return snow_ranks_find_needs(insitu->context, &insitu->whole, view,
                                 settings, &insitu->look.look, needs);
}

/* Collective.  Every rank's united bricks, when they are not known. */
static snow_status share_boxes(snow_insitu *insitu, const snow_box *united) {
    size_t ranks = (size_t)snow_comm_size(insitu->comm);
    INSITU_TRY(snow_comm_agree_status(
        insitu->comm,
        snow_insitu_reserve(insitu, &insitu->boxes, &insitu->boxes_bytes, 0,
                            ranks * sizeof *insitu->boxes)));
    INSITU_TRY(snow_comm_allgather(insitu->comm, united, sizeof *united,
                                   insitu->boxes));
    insitu->boxes_known = true;
    return SNOW_STATUS_OK;
}

/* Collective.  Whether the work is done where the voxels are not. */
static snow_status decide_recut(snow_insitu *insitu, const snow_view *view,
                                int slice_axis, const snow_box *united,
                                const int64_t facts[FACTS], bool *out) {
    bool ordered = true;
    *out = true;
    if (insitu->balance == SNOW_BALANCE_REPARTITION || !facts[FACT_UNITED] ||
        slab_axis(insitu, slice_axis) >= 0)
        return SNOW_STATUS_OK;
    if (!facts[FACT_BOXES])
        INSITU_TRY(share_boxes(insitu, united));
    snow_status status = snow_ranks_have_order(
        insitu->context, &insitu->whole, view, insitu->boxes,
        snow_comm_size(insitu->comm), &ordered);
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    *out = !ordered;
    return SNOW_STATUS_OK;
}

/* Collective.  Looks whether the plan still holds, and makes a new one where it
 * does not. */
static snow_status lay_out(snow_insitu *insitu) {
    snow_view view = snow_insitu_view(insitu), lowered;
    snow_settings settings;
    insitu->layout.lowering = insitu->lowering;
    snow_insitu_layout l = {.lowering = insitu->lowering};
    snow_box united = {{0, 0, 0}, {0, 0, 0}};
    snow_ranks_needs needs = {.size = sizeof needs};
    int64_t facts[FACTS];
    snow_insitu_lowered(insitu, &lowered, &settings);
    snow_status status = look_around(insitu, &lowered, &settings, &needs);
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    memcpy(l.layers, needs.layers, sizeof l.layers);
    bool is_united = unite(insitu, &united);
    INSITU_TRY(share_facts(insitu, &view, l.layers, is_united, facts));
    INSITU_TRY(decide_recut(insitu, &lowered, needs.slice_axis, &united, facts,
                            &l.recut));
    l.recut_axis = slab_axis(insitu, needs.slice_axis);
    if (facts[FACT_UNCHANGED] && l.recut == insitu->layout.recut &&
        l.recut_axis == insitu->layout.recut_axis)
        return SNOW_STATUS_OK;
    return plan(insitu, &l, &united, facts);
}

/* --- taking --------------------------------------------------------------- */

/* The only brick's voxels where they lie, where that is how a volume wants
 * them: dense, halo included, all of it within the grid. */
static const void *in_place(const snow_insitu *insitu, snow_box *memory) {
    const snow_insitu_brick *brick = NULL;
    for (int id = 0; id < insitu->brick_count; id++)
        if (snow_box_voxels(&insitu->bricks[id].box))
            brick = &insitu->bricks[id];
    if (insitu->layout.exchanged || insitu->held_count != 1 ||
        insitu->ghosts == SNOW_GHOSTS_NONE)
        return NULL;
    int64_t step = 1, back = 0;
    for (int i = 0; i < 3; i++) {
        memory->first[i] = brick->box.first[i] - brick->halo.low[i];
        memory->count[i] =
            brick->halo.low[i] + brick->box.count[i] + brick->halo.high[i];
        if (brick->stride[i] != step || memory->first[i] < 0 ||
            memory->first[i] + memory->count[i] > insitu->whole.dims[i])
            return NULL;
        back += brick->halo.low[i] * step;
        step *= memory->count[i];
    }
    if (!holds(memory, &insitu->layout.stored))
        return NULL;
    return (const char *)brick->voxels -
           (size_t)back * snow_type_size(insitu->type);
}

/* Repeats the outermost own voxels of the dense box in place of its ghosts. */
static void repeat_border(const snow_insitu *insitu, size_t value) {
    const snow_box *own = &insitu->layout.owned,
                   *stored = &insitu->layout.stored;
    int64_t low[3], high[3];
    for (int i = 0; i < 3; i++) {
        low[i] = own->first[i] - stored->first[i];
        high[i] = low[i] + own->count[i] - 1;
    }
    size_t row = (size_t)stored->count[0] * value;
    for (int64_t z = 0; z < stored->count[2]; z++)
        for (int64_t y = 0; y < stored->count[1]; y++) {
            char *to = insitu->dense + (size_t)(z * stored->count[1] + y) * row;
            int64_t near_z = z < low[2] ? low[2] : z > high[2] ? high[2] : z;
            int64_t near_y = y < low[1] ? low[1] : y > high[1] ? high[1] : y;
            const char *from =
                insitu->dense +
                (size_t)(near_z * stored->count[1] + near_y) * row;
            for (int64_t x = 0; x < stored->count[0]; x++) {
                int64_t near = x < low[0] ? low[0] : x > high[0] ? high[0] : x;
                if (near != x || from != to)
                    memcpy(to + (size_t)x * value, from + (size_t)near * value,
                           value);
            }
        }
}

/* The bricks and, where they count, their halos, into the dense box. */
static void copy_bricks(const snow_insitu *insitu, size_t value) {
    static const snow_halo none;
    const snow_box *stored = &insitu->layout.stored;
    bool haloes = insitu->ghosts != SNOW_GHOSTS_NONE;
    for (int id = 0; id < insitu->brick_count; id++) {
        const snow_insitu_brick *brick = &insitu->bricks[id];
        if (!snow_box_voxels(&brick->box))
            continue;
        const snow_halo *halo = haloes ? &brick->halo : &none;
        snow_box has =
            grow(&brick->box, halo->low, halo->high, insitu->whole.dims);
        snow_brick from = {.box = brick->box, .voxels = brick->voxels};
        memcpy(from.stride, brick->stride, sizeof from.stride);
        snow_box box;
        if (snow_box_intersect(&has, stored, &box))
            snow_brick_copy(&from, value, &box, stored, insitu->dense);
    }
    if (!haloes && snow_box_voxels(&insitu->layout.owned))
        repeat_border(insitu, value);
}

/* Room for the dense box. */
static snow_status reserve_dense(snow_insitu *insitu, size_t value) {
    const int64_t *count = insitu->layout.stored.count;
    double bytes =
        (double)count[0] * (double)count[1] * (double)count[2] * (double)value;
    size_t exact = bytes < 0x1p62
                       ? (size_t)(count[0] * count[1] * count[2]) * value
                       : SIZE_MAX;
    INSITU_TRY(snow_insitu_reserve(insitu, &insitu->dense, &insitu->dense_bytes,
                                   0, exact));
    if (!snow_box_voxels(&insitu->layout.owned))
        memset(insitu->dense, 0, value);
    return SNOW_STATUS_OK;
}

/* A volume over voxels that lie in `memory`: the rank's part of the whole. */
static snow_status wrap(snow_insitu *insitu, const void *voxels,
                        const snow_box *memory) {
    snow_volume_info info = insitu->whole;
    snow_extent part = {.size = sizeof part};
    info.type = insitu->type;
    memcpy(info.dims, memory->count, sizeof info.dims);
    for (int i = 0; i < 3; i++) {
        info.matrix[i][3] += info.matrix[i][i] * (double)memory->first[i];
        part.dims[i] = insitu->whole.dims[i];
        part.stored[i] = memory->first[i];
        part.first[i] = insitu->layout.owned.first[i];
        part.count[i] = insitu->layout.owned.count[i];
    }
    snow_volume_close(insitu->volume);
    insitu->volume = NULL;
    INSITU_TRY(
        snow_volume_wrap(insitu->context, &info, voxels, &insitu->volume));
    INSITU_TRY(snow_volume_set_extent(insitu->volume, &part));
    INSITU_TRY(snow_volume_set_whole(insitu->volume, &insitu->whole));
    snow_volume_freeze(insitu->volume); /* until the next update */
    return SNOW_STATUS_OK;
}

/* Collective.  The voxels, from wherever they are. */
static snow_status gather(snow_insitu *insitu) {
    snow_box memory;
    size_t value = snow_type_size(insitu->type);
    const void *shared = in_place(insitu, &memory);
    snow_status status = SNOW_STATUS_OK;
    insitu->copied = !shared;
    if (!shared) {
        memory = insitu->layout.stored;
        status = reserve_dense(insitu, value);
    }
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    if (insitu->layout.exchanged)
        INSITU_TRY(snow_voxels_move(insitu->voxels, insitu->moved, value,
                                    insitu->dense));
    else if (!shared)
        copy_bricks(insitu, value);
    status = wrap(insitu, shared ? shared : insitu->dense, &memory);
    return snow_comm_agree_status(insitu->comm, status);
}

snow_status snow_insitu_take(snow_insitu *insitu) {
    insitu->taken = false;
    INSITU_TRY(lay_out(insitu));
    INSITU_TRY(gather(insitu));
    insitu->taken = true;
    return SNOW_STATUS_OK;
}
