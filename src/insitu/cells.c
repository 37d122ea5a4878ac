/* insitu/cells.c - the cells that each rank's voxels come from.
 *
 *     a coarse level     |.......|.......|.......|.......|.......|
 *     a fine one                         |:::|:::|
 *     voxels of a rank                   | | | | | |
 *
 * A rank needs of each level the cells that its voxels are refined from, up to
 * three beyond them: those of the level itself (.), and means where finer ones
 * (:) cover it.  They travel as blocks, each of one brick, and the voxels are
 * refined where they are wanted, from level to level, as those of files
 * (formats/amr/gather.c).  The blocks of all messages lie one behind another in
 * a grid of one row: so they are moved as any bricks are
 * (decompose/redistribute.c). */
#include "insitu/internal.h"

#include <math.h>
#include <string.h>

#define RANK_ROOM (INT64_C(1) << 40) /* values of the row for one rank */

/* --- planning ------------------------------------------------------------- */

/* Values that a block takes in the row: a mean is a double. */
static int64_t count_values(const snow_insitu *insitu,
                            const snow_level_block *block) {
    const bool own = block->level == block->brick->level;
    const int64_t wide =
        (int64_t)(sizeof(double) / snow_type_size(insitu->type));
    return snow_box_voxels(&block->cells) * (own ? 1 : wide);
}

static snow_status add_block(const snow_insitu *insitu, snow_level_blocks *list,
                             const snow_level_block *block) {
    const uint64_t count = (uint64_t)list->count;
    INSITU_TRY(snow_context_reserve(insitu->context, &list->blocks, count,
                                    count + 1, sizeof *list->blocks));
    list->blocks[list->count++] = *block;
    list->value_count += count_values(insitu, block);
    return SNOW_STATUS_OK;
}

/* Where the next block that is sent lies in the row. */
static snow_status add_place(snow_insitu *insitu, int64_t first,
                             int64_t values) {
    snow_insitu_levels *levels = &insitu->levels;
    const uint64_t count = (uint64_t)levels->sent.count;
    INSITU_TRY(snow_context_reserve(insitu->context, &levels->places, count,
                                    count + 1, sizeof *levels->places));
    levels->places[count] = (snow_box){{first, 0, 0}, {values, 1, 1}};
    return SNOW_STATUS_OK;
}

/* A block to a rank, `place` in the row; others than those from or to this rank
 * only take their place. */
static snow_status list_block(snow_insitu *insitu, int to, int64_t *place,
                              const snow_level_block *block) {
    snow_insitu_levels *levels = &insitu->levels;
    const int me = snow_comm_rank(insitu->comm);
    const int64_t number = block->brick - levels->bricks;
    const int64_t values = count_values(insitu, block);
    if (number / levels->most == me) {
        INSITU_TRY(add_place(insitu, *place, values));
        INSITU_TRY(add_block(insitu, &levels->sent, block));
    }
    if (to == me)
        INSITU_TRY(add_block(insitu, &levels->received, block));
    *place += values;
    return SNOW_STATUS_OK;
}

/* The blocks of a piece of a brick: its own cells, and their means. */
static snow_status list_piece(snow_insitu *insitu, int to, int64_t *place,
                              const snow_level_brick *brick,
                              const snow_box *piece,
                              const snow_level_needs *needs) {
    snow_level_block block = {.brick = brick};
    for (block.level = brick->level; block.level >= 0; block.level--) {
        const snow_box cells =
            snow_level_cells_in(piece, insitu->levels.sizes[block.level]);
        if (snow_box_intersect(&cells, &needs->cells[block.level],
                               &block.cells))
            INSITU_TRY(list_block(insitu, to, place, &block));
    }
    return SNOW_STATUS_OK;
}

static snow_status list_blocks_to(snow_insitu *insitu,
                                  const snow_insitu_layout *layout, int to) {
    const snow_insitu_levels *levels = &insitu->levels;
    const snow_box wanted = snow_insitu_recut_box(insitu, layout, to);
    snow_level_needs needs;
    int64_t place = to * RANK_ROOM;
    snow_insitu_find_needs(insitu, &wanted, &needs);
    for (int64_t n = 0; n < levels->count; n++) {
        const snow_level_brick *brick = &levels->bricks[n];
        for (int64_t p = brick->pieces[0]; p < brick->pieces[1]; p++)
            INSITU_TRY(list_piece(insitu, to, &place, brick, &levels->pieces[p],
                                  &needs));
    }
    return SNOW_STATUS_OK;
}

static snow_status list_blocks(snow_insitu *insitu,
                               const snow_insitu_layout *layout) {
    snow_insitu_levels *levels = &insitu->levels;
    levels->sent.count = levels->received.count = 0;
    levels->sent.value_count = levels->received.value_count = 0;
    for (int to = 0; to < snow_comm_size(insitu->comm); to++)
        INSITU_TRY(list_blocks_to(insitu, layout, to));
    return snow_context_reserve(insitu->context, &levels->moved, 0,
                                (uint64_t)levels->sent.count,
                                sizeof *levels->moved);
}

snow_status snow_insitu_plan_cells(snow_insitu *insitu,
                                   const snow_insitu_layout *layout) {
    const snow_insitu_levels *levels = &insitu->levels;
    snow_status status = list_blocks(insitu, layout);
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    const int64_t count = levels->received.value_count;
    const snow_box wanted = {{snow_comm_rank(insitu->comm) * RANK_ROOM, 0, 0},
                             {count, count > 0, count > 0}};
    return snow_voxels_plan(insitu->voxels, levels->places, levels->sent.count,
                            &wanted);
}

/* --- values that are sent ------------------------------------------------- */

snow_brick snow_insitu_cells_of(const snow_insitu *insitu,
                                const snow_level_brick *of) {
    const snow_insitu_levels *levels = &insitu->levels;
    const snow_insitu_brick *brick =
        &insitu->bricks[(of - levels->bricks) % levels->most];
    snow_brick out = {.voxels = brick->voxels};
    memcpy(out.stride, brick->stride, sizeof out.stride);
    for (int i = 0; i < 3; i++) {
        out.box.first[i] = brick->box.first[i] / brick->cells[i];
        out.box.count[i] = brick->box.count[i] / brick->cells[i];
    }
    return out;
}

static snow_status pack_blocks(snow_insitu *insitu, size_t value) {
    snow_insitu_levels *levels = &insitu->levels;
    snow_status status = SNOW_STATUS_OK;
    char *at = levels->sent.values;
    for (int n = 0; n < levels->sent.count && status == SNOW_STATUS_OK; n++) {
        const snow_level_block *block = &levels->sent.blocks[n];
        const snow_brick from = snow_insitu_cells_of(insitu, block->brick);
        if (block->level == block->brick->level)
            snow_brick_copy(&from, value, &block->cells, &block->cells, at);
        else
            status = snow_insitu_mean_cells(insitu, block, at);
        levels->moved[n] = (snow_brick){levels->places[n], at, {1, 1, 1}};
        at += (size_t)count_values(insitu, block) * value;
    }
    return status;
}

/* --- and taken ------------------------------------------------------------ */

/* The cells of a level that this rank needs, or its voxels. */
typedef struct level_cells {
    const snow_insitu *insitu; /* whose dense box has the values; NULL: */
    double *values;
    snow_box box, refined;
    unsigned char *there; /* 1: is not to be refined */
} level_cells;

static int64_t place_in(const snow_box *box, int64_t x, int64_t y, int64_t z) {
    return ((z - box->first[2]) * box->count[1] + y - box->first[1]) *
               box->count[0] +
           x - box->first[0];
}

static double value_at(const char *values, snow_type type, int64_t at) {
    float narrow;
    double wide;
    if (type == SNOW_TYPE_FLOAT32) {
        memcpy(&narrow, values + 4 * at, sizeof narrow);
        return (double)narrow;
    }
    memcpy(&wide, values + 8 * at, sizeof wide);
    return wide;
}

/* Of cells that are not finite there is no value for others to be blended with.
 */
static void store(const level_cells *to, int64_t place, double value) {
    if (!to->insitu)
        to->values[place] = isfinite(value) ? value : NAN;
    else if (to->insitu->type == SNOW_TYPE_FLOAT32)
        ((float *)(void *)to->insitu->dense)[place] = (float)value;
    else
        ((double *)(void *)to->insitu->dense)[place] = value;
}

/* A block that has arrived. */
static void take_block(const level_cells *to, const snow_level_block *block,
                       snow_type type, const char *values) {
    const snow_box *box = &block->cells;
    const bool own = block->level == block->brick->level;
    int64_t at = 0;
    for (int64_t n = 0; n < box->count[1] * box->count[2]; n++) {
        const int64_t place =
            place_in(&to->box, box->first[0], box->first[1] + n % box->count[1],
                     box->first[2] + n / box->count[1]);
        memset(to->there + place, 1, (size_t)box->count[0]);
        for (int64_t x = 0; x < box->count[0]; x++, at++)
            store(to, place + x,
                  value_at(values, own ? type : SNOW_TYPE_FLOAT64, at));
    }
}

static bool fill_row(void *user, int64_t y, int64_t z, const double *row) {
    const level_cells *to = user;
    const int64_t place = place_in(&to->box, to->refined.first[0], y, z);
    for (int64_t x = 0; x < to->refined.count[0]; x++) {
        if (to->there[place + x])
            continue;
        if (!row)
            return true;
        store(to, place + x, row[x]);
    }
    return false;
}

static snow_status reserve_level(snow_context *context, level_cells *level) {
    const uint64_t count = (uint64_t)snow_box_voxels(&level->box);
    INSITU_TRY(snow_context_reserve(context, &level->there, 0, count,
                                    sizeof *level->there));
    if (count)
        memset(level->there, 0, count);
    if (level->insitu)
        return SNOW_STATUS_OK;
    INSITU_TRY(snow_context_reserve(context, &level->values, 0, count,
                                    sizeof *level->values));
    for (uint64_t i = 0; i < count; i++)
        level->values[i] = NAN;
    return SNOW_STATUS_OK;
}

/* Voxels from the cells of all levels, the coarsest first. */
static snow_status refine_levels(const snow_insitu *insitu,
                                 level_cells *levels) {
    for (int l = 1; l <= insitu->levels.finest; l++) {
        const int64_t *size = insitu->levels.sizes[l];
        const int64_t *below = insitu->levels.sizes[l - 1];
        const int64_t ratio[3] = {below[0] / size[0], below[1] / size[1],
                                  below[2] / size[2]};
        if (snow_box_voxels(&levels[l].refined))
            INSITU_TRY(snow_cells_refine(
                insitu->context, levels[l - 1].values, &levels[l - 1].box,
                ratio, &levels[l].refined, fill_row, &levels[l]));
    }
    return SNOW_STATUS_OK;
}

static snow_status take_all(const snow_insitu *insitu, size_t value,
                            level_cells *levels) {
    const snow_level_blocks *list = &insitu->levels.received;
    const char *at = list->values;
    snow_level_needs needs;
    snow_insitu_find_needs(insitu, &insitu->layout.stored, &needs);
    for (int l = 0; l <= insitu->levels.finest; l++) {
        levels[l].insitu = l == insitu->levels.finest ? insitu : NULL;
        levels[l].box = needs.cells[l];
        levels[l].refined = needs.refined[l];
        INSITU_TRY(reserve_level(insitu->context, &levels[l]));
    }
    for (int n = 0; n < list->count; n++) {
        const snow_level_block *block = &list->blocks[n];
        take_block(&levels[block->level], block, insitu->type, at);
        at += (size_t)count_values(insitu, block) * value;
    }
    return refine_levels(insitu, levels);
}

static snow_status take_blocks(const snow_insitu *insitu, size_t value) {
    level_cells levels[SNOW_LEVELS_MOST] = {{.values = NULL}};
    if (!snow_box_voxels(&insitu->layout.owned))
        return SNOW_STATUS_OK;
    snow_status status = take_all(insitu, value, levels);
    for (int l = 0; l <= insitu->levels.finest; l++) {
        snow_context_release(insitu->context, levels[l].values);
        snow_context_release(insitu->context, levels[l].there);
    }
    return status;
}

snow_status snow_insitu_move_cells(snow_insitu *insitu, size_t value) {
    snow_insitu_levels *levels = &insitu->levels;
    snow_level_blocks *const lists[2] = {&levels->sent, &levels->received};
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; i < 2 && status == SNOW_STATUS_OK; i++)
        status = snow_context_reserve(insitu->context, &lists[i]->values, 0,
                                      (uint64_t)lists[i]->value_count, value);
    if (status == SNOW_STATUS_OK)
        status = pack_blocks(insitu, value);
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    INSITU_TRY(snow_voxels_move(insitu->voxels, levels->moved, value,
                                levels->received.values));
    return snow_comm_agree_status(insitu->comm, take_blocks(insitu, value));
}
