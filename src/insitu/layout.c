/* insitu/layout.c - which box each rank draws, and how its voxels come there
 * (data.c). */
#include "insitu/internal.h"

#include <string.h>

static snow_status add_brick(snow_insitu *insitu, int id) {
    const snow_insitu_brick *brick = &insitu->bricks[id];
    if (!brick->voxels)
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "brick %d has no voxels; call snow_insitu_set_voxels", id);
    if (insitu->type != SNOW_TYPE_NONE && insitu->type != brick->type)
        return snow_context_fail(
            insitu->context, SNOW_STATUS_BAD_USAGE,
            "brick %d is %s and another one is %s: all must have the same type",
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
    INSITU_TRY(snow_context_reserve(insitu->context, &insitu->held, 0, count,
                                    sizeof *insitu->held));
    INSITU_TRY(snow_context_reserve(insitu->context, &insitu->moved, 0, count,
                                    sizeof *insitu->moved));
    for (int id = 0; id < insitu->brick_count; id++)
        if (snow_box_voxels(&insitu->bricks[id].box))
            INSITU_TRY(add_brick(insitu, id));
    return SNOW_STATUS_OK;
}

/* The box around all bricks; whether they fill it.  Bricks that overlap are
 * found when a move is planned. */
static bool unite_bricks(const snow_insitu *insitu, snow_box *out) {
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

static snow_box recut_box(const snow_insitu *insitu,
                          const snow_insitu_layout *l, int rank) {
    const int64_t *dims = insitu->whole.dims;
    const int ranks = snow_comm_size(insitu->comm);
    const int axis = l->recut_axis;
    if (axis < 0)
        return cut_equal(dims, ranks, rank);
    snow_box slab = {{0, 0, 0}, {dims[0], dims[1], dims[2]}};
    snow_ranks_slab(dims[axis], ranks, rank, &slab.first[axis],
                    &slab.count[axis]);
    return slab;
}

snow_box snow_insitu_recut_box(const snow_insitu *insitu,
                               const snow_insitu_layout *l, int rank) {
    const snow_box owned = recut_box(insitu, l, rank);
    return snow_box_voxels(&owned)
               ? snow_insitu_grow_box(&owned, l->layers, l->layers,
                                      insitu->whole.dims)
               : owned;
}

/* The owned box, and the stored one around it: one voxel where nothing is
 * owned, since a volume has at least one. */
static void place_boxes(const snow_insitu *insitu, snow_insitu_layout *l,
                        const snow_box *united) {
    const int64_t *dims = insitu->whole.dims;
    l->owned =
        l->recut ? recut_box(insitu, l, snow_comm_rank(insitu->comm)) : *united;
    if (snow_box_voxels(&l->owned))
        l->stored = snow_insitu_grow_box(&l->owned, l->layers, l->layers, dims);
    else {
        l->owned = (snow_box){{0, 0, 0}, {0, 0, 0}};
        l->stored = (snow_box){{0, 0, 0}, {1, 1, 1}};
    }
}

/* Collective.  Bricks are known not to overlap, so their number of voxels
 * shows whether they fill the grid. */
static snow_status check_whole(const snow_insitu *insitu) {
    const int64_t *dims = insitu->whole.dims;
    int64_t held = 0, all = dims[0] * dims[1] * dims[2];
    for (int n = 0; n < insitu->held_count; n++)
        held += snow_box_voxels(&insitu->held[n]);
    INSITU_TRY(snow_comm_reduce_ints(insitu->comm, &held, 1, SNOW_REDUCE_SUM));
    if (held == all)
        return SNOW_STATUS_OK;
    return snow_context_fail(insitu->context, SNOW_STATUS_BAD_USAGE,
                             "no rank holds %lld of the %lld voxels of the "
                             "grid: every voxel must belong to a brick",
                             (long long)(all - held), (long long)all);
}

/* Collective.  A new layout, and the plan of its exchange; one of nothing finds
 * bricks that overlap as well. */
static snow_status plan_layout(snow_insitu *insitu,
                               const snow_insitu_layout *wanted,
                               const snow_box *united,
                               const int64_t facts[SNOW_INSITU_FACTS]) {
    snow_insitu_layout l = *wanted;
    static const snow_box nothing;
    place_boxes(insitu, &l, united);
    l.exchanged = l.recut || !facts[SNOW_FACT_HALOS];
    if (insitu->ghosts == SNOW_GHOSTS_NONE)
        l.exchanged = l.recut;
    insitu->layout.planned = false;
    if (l.uneven)
        INSITU_TRY(snow_insitu_cut_levels(insitu));
    bool moves = l.exchanged && !l.uneven && snow_box_voxels(&l.owned);
    INSITU_TRY(snow_voxels_plan(insitu->voxels, insitu->held,
                                insitu->held_count,
                                moves ? &l.stored : &nothing));
    INSITU_TRY(check_whole(insitu));
    if (l.uneven)
        INSITU_TRY(snow_insitu_plan_cells(insitu, &l));
    l.planned = true;
    insitu->layout = l;
    insitu->changed = false;
    return SNOW_STATUS_OK;
}

/* Collective.  Every rank's united bricks, when they are not known. */
static snow_status share_boxes(snow_insitu *insitu, const snow_box *united) {
    const uint64_t ranks = (uint64_t)snow_comm_size(insitu->comm);
    INSITU_TRY(snow_comm_agree_status(
        insitu->comm, snow_context_reserve(insitu->context, &insitu->boxes, 0,
                                           ranks, sizeof *insitu->boxes)));
    INSITU_TRY(snow_comm_allgather(insitu->comm, united, sizeof *united,
                                   insitu->boxes));
    insitu->boxes_known = true;
    return SNOW_STATUS_OK;
}

/* Collective.  Whether the work is done where the voxels are not. */
static snow_status decide_recut(snow_insitu *insitu, const snow_view *view,
                                int slice_axis, const snow_box *united,
                                const int64_t facts[SNOW_INSITU_FACTS],
                                bool *out) {
    bool ordered = true;
    *out = true;
    if (insitu->balance == SNOW_BALANCE_REPARTITION ||
        !facts[SNOW_FACT_UNITED] || !facts[SNOW_FACT_EVEN] ||
        slab_axis(insitu, slice_axis) >= 0)
        return SNOW_STATUS_OK;
    if (!facts[SNOW_FACT_BOXES])
        INSITU_TRY(share_boxes(insitu, united));
    snow_status status = snow_ranks_have_order(
        insitu->context, &insitu->whole, view, insitu->boxes,
        snow_comm_size(insitu->comm), &ordered);
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    *out = !ordered;
    return SNOW_STATUS_OK;
}

/* Of values that are refined, which are alike on all ranks. */
static snow_status check_type(snow_insitu *insitu) {
    if (insitu->type == SNOW_TYPE_FLOAT32 || insitu->type == SNOW_TYPE_FLOAT64)
        return SNOW_STATUS_OK;
    return snow_context_fail(insitu->context, SNOW_STATUS_BAD_USAGE,
                             "voxels are %s, and cells of several sizes must "
                             "be float32 or float64",
                             snow_type_name(insitu->type));
}

snow_status snow_insitu_lay_out(snow_insitu *insitu) {
    snow_view view = snow_insitu_view(insitu), lowered;
    snow_settings settings;
    insitu->layout.lowering = insitu->lowering;
    snow_insitu_layout l = {.lowering = insitu->lowering};
    snow_box united = {{0, 0, 0}, {0, 0, 0}};
    snow_ranks_needs needs = {.size = sizeof needs};
    int64_t facts[SNOW_INSITU_FACTS];
    snow_insitu_lowered(insitu, &lowered, &settings);
    /* What this rank finds out by itself: its bricks, how the view lies, how
     * wide ghosts must be, which grow as pictures get smaller. */
    snow_status status = list_bricks(insitu);
    if (status == SNOW_STATUS_OK)
        status =
            snow_ranks_find_needs(insitu->context, &insitu->whole, &lowered,
                                  &settings, &insitu->look.look, &needs);
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    memcpy(l.layers, needs.layers, sizeof l.layers);
    bool is_united = unite_bricks(insitu, &united);
    INSITU_TRY(
        snow_insitu_share_facts(insitu, &view, l.layers, is_united, facts));
    l.uneven = !facts[SNOW_FACT_EVEN];
    if (l.uneven)
        INSITU_TRY(check_type(insitu));
    INSITU_TRY(decide_recut(insitu, &lowered, needs.slice_axis, &united, facts,
                            &l.recut));
    l.recut_axis = slab_axis(insitu, needs.slice_axis);
    if (facts[SNOW_FACT_UNCHANGED] && l.recut == insitu->layout.recut &&
        l.recut_axis == insitu->layout.recut_axis)
        return SNOW_STATUS_OK;
    return plan_layout(insitu, &l, &united, facts);
}
