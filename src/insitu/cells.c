/* insitu/cells.c - the cells that each rank's voxels come from.
 *
 *     a brick's cells    |       |       |       |       |       |
 *     voxels of a rank                   | | | | | |
 *     a block            |.......|.......|:::::::|:::::::|.......|
 *
 * Cells travel, and are refined where the voxels are wanted: a block has those
 * (:) around the voxels that a rank wants of a piece, and as many on all sides
 * (.) as these are blended from, if the brick or its halo has them.  The blocks
 * of all messages lie one behind another in a grid of one row: so they are
 * moved as any bricks are (decompose/redistribute.c). */
#include "insitu/internal.h"

#include <math.h>
#include <string.h>

#define REACH 3                      /* of snow_cells_refine */
#define RANK_ROOM (INT64_C(1) << 40) /* cells of the row for one rank */

static bool is_fine(const snow_level_brick *brick) {
    return brick->cells[0] * brick->cells[1] * brick->cells[2] == 1;
}

static int64_t larger(int64_t a, int64_t b) {
    return a > b ? a : b;
}

static int64_t smaller(int64_t a, int64_t b) {
    return a < b ? a : b;
}

/* The cells that voxels of a brick come from, as far as it has them within the
 * grid. */
static snow_box cells_of(const snow_level_brick *brick, const snow_box *voxels,
                         const int64_t dims[3]) {
    const int64_t reach = is_fine(brick) ? 0 : REACH;
    snow_box out;
    for (int i = 0; i < 3; i++) {
        const int64_t wide = brick->cells[i], last = (dims[i] - 1) / wide;
        const int64_t own = brick->box.first[i] / wide;
        const int64_t own_last = own + brick->box.count[i] / wide - 1;
        const int64_t end = voxels->first[i] + voxels->count[i] - 1;
        out.first[i] = larger(0, larger(own - brick->halo.low[i],
                                        voxels->first[i] / wide - reach));
        out.count[i] = smaller(last, smaller(own_last + brick->halo.high[i],
                                             end / wide + reach)) -
                       out.first[i] + 1;
    }
    return out;
}

/* --- planning ------------------------------------------------------------- */

static snow_status add_block(snow_context *context, snow_level_blocks *list,
                             const snow_level_block *block) {
    const uint64_t count = (uint64_t)list->count;
    INSITU_TRY(snow_context_reserve(context, &list->blocks, count, count + 1,
                                    sizeof *list->blocks));
    list->blocks[list->count++] = *block;
    list->cells += snow_box_voxels(&block->cells);
    return SNOW_STATUS_OK;
}

/* Where the next block that is sent lies in the row. */
static snow_status add_place(snow_insitu *insitu, int64_t first,
                             int64_t cells) {
    snow_insitu_levels *levels = &insitu->levels;
    const uint64_t count = (uint64_t)levels->sent.count;
    INSITU_TRY(snow_context_reserve(insitu->context, &levels->places, count,
                                    count + 1, sizeof *levels->places));
    levels->places[count] = (snow_box){{first, 0, 0}, {cells, 1, 1}};
    return SNOW_STATUS_OK;
}

/* A block to a rank, `place` in the row; others than those from or to this rank
 * only take their place. */
static snow_status list_block(snow_insitu *insitu, int to, int64_t *place,
                              const snow_level_block *block) {
    snow_insitu_levels *levels = &insitu->levels;
    const int me = snow_comm_rank(insitu->comm);
    const int64_t number = block->brick - levels->bricks;
    const int64_t cells = snow_box_voxels(&block->cells);
    if (number / levels->most == me) {
        INSITU_TRY(add_place(insitu, *place, cells));
        INSITU_TRY(add_block(insitu->context, &levels->sent, block));
    }
    if (to == me)
        INSITU_TRY(add_block(insitu->context, &levels->received, block));
    *place += cells;
    return SNOW_STATUS_OK;
}

static snow_status list_blocks_to(snow_insitu *insitu,
                                  const snow_insitu_layout *layout, int to) {
    const snow_insitu_levels *levels = &insitu->levels;
    const snow_box wanted = snow_insitu_recut_box(insitu, layout, to);
    int64_t place = to * RANK_ROOM;
    for (int64_t n = 0; n < levels->count; n++) {
        snow_level_block block = {.brick = &levels->bricks[n]};
        for (int64_t p = block.brick->pieces[0]; p < block.brick->pieces[1];
             p++) {
            if (!snow_box_intersect(&levels->pieces[p], &wanted, &block.voxels))
                continue;
            block.cells =
                cells_of(block.brick, &block.voxels, insitu->whole.dims);
            INSITU_TRY(list_block(insitu, to, &place, &block));
        }
    }
    return SNOW_STATUS_OK;
}

static snow_status list_blocks(snow_insitu *insitu,
                               const snow_insitu_layout *layout) {
    snow_insitu_levels *levels = &insitu->levels;
    levels->sent.count = levels->received.count = 0;
    levels->sent.cells = levels->received.cells = 0;
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
    const snow_box wanted = {{snow_comm_rank(insitu->comm) * RANK_ROOM, 0, 0},
                             {levels->received.cells,
                              levels->received.cells > 0,
                              levels->received.cells > 0}};
    return snow_voxels_plan(insitu->voxels, levels->places, levels->sent.count,
                            &wanted);
}

/* --- values --------------------------------------------------------------- */

/* A brick of this rank, whose voxels are its cells. */
static snow_brick brick_of_cells(const snow_insitu *insitu,
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

static void pack_blocks(snow_insitu *insitu, size_t value) {
    snow_insitu_levels *levels = &insitu->levels;
    char *at = levels->sent.values;
    for (int n = 0; n < levels->sent.count; n++) {
        const snow_level_block *block = &levels->sent.blocks[n];
        const snow_brick from = brick_of_cells(insitu, block->brick);
        snow_brick_copy(&from, value, &block->cells, &block->cells, at);
        levels->moved[n] = (snow_brick){levels->places[n], at, {1, 1, 1}};
        at += (size_t)snow_box_voxels(&block->cells) * value;
    }
}

/* The place of a cell or voxel in a box. */
static int64_t place_in(const snow_box *box, int64_t x, int64_t y, int64_t z) {
    return ((z - box->first[2]) * box->count[1] + y - box->first[1]) *
               box->count[0] +
           x - box->first[0];
}

/* Forgets the cells that a finer brick covers. */
static void hide_cells(const snow_level_block *block, const snow_box *finer,
                       double *cells) {
    const snow_box *box = &block->cells;
    snow_box covered, shared;
    for (int i = 0; i < 3; i++) {
        const int64_t wide = block->brick->cells[i];
        covered.first[i] = (finer->first[i] + wide - 1) / wide;
        covered.count[i] =
            (finer->first[i] + finer->count[i]) / wide - covered.first[i];
        if (covered.count[i] < 1)
            return;
    }
    if (!snow_box_intersect(&covered, box, &shared))
        return;
    for (int64_t z = 0; z < shared.count[2]; z++)
        for (int64_t y = 0; y < shared.count[1]; y++)
            for (int64_t x = 0; x < shared.count[0]; x++)
                cells[place_in(box, shared.first[0] + x, shared.first[1] + y,
                               shared.first[2] + z)] = NAN;
}

/* The cells of a block that has arrived; NaN where finer ones are. */
static void take_cells(const snow_insitu *insitu, const snow_level_block *block,
                       const char *values, double *cells) {
    const snow_insitu_levels *levels = &insitu->levels;
    const int64_t count = snow_box_voxels(&block->cells);
    for (int64_t i = 0; i < count; i++)
        cells[i] = insitu->type == SNOW_TYPE_FLOAT32
                       ? (double)((const float *)(const void *)values)[i]
                       : ((const double *)(const void *)values)[i];
    for (int64_t n = 0; n < levels->count; n++)
        if (snow_box_voxels(&levels->bricks[n].box) &&
            snow_level_is_finer(&levels->bricks[n], block->brick->cells))
            hide_cells(block, &levels->bricks[n].box, cells);
}

/* Where the voxels of a block go. */
typedef struct block_rows {
    const snow_insitu *insitu;
    const snow_box *voxels;
} block_rows;

static bool take_row(void *user, int64_t y, int64_t z, const double *row) {
    const block_rows *to = user;
    const snow_insitu *insitu = to->insitu;
    const int64_t place =
        place_in(&insitu->layout.stored, to->voxels->first[0], y, z);
    for (int64_t x = 0; row && x < to->voxels->count[0]; x++)
        if (insitu->type == SNOW_TYPE_FLOAT32)
            ((float *)(void *)insitu->dense)[place + x] = (float)row[x];
        else
            ((double *)(void *)insitu->dense)[place + x] = row[x];
    return true;
}

static snow_status refine_block(snow_insitu *insitu,
                                const snow_level_block *block, size_t value,
                                const char *values, double **cells) {
    const snow_box *box = &block->cells;
    if (is_fine(block->brick)) {
        const snow_brick from = {
            *box, values, {1, box->count[0], box->count[0] * box->count[1]}};
        snow_brick_copy(&from, value, &block->voxels, &insitu->layout.stored,
                        insitu->dense);
        return SNOW_STATUS_OK;
    }
    block_rows rows = {insitu, &block->voxels};
    INSITU_TRY(snow_context_reserve(insitu->context, cells, 0,
                                    (uint64_t)snow_box_voxels(box),
                                    sizeof **cells));
    take_cells(insitu, block, values, *cells);
    return snow_cells_refine(insitu->context, *cells, box, block->brick->cells,
                             &block->voxels, take_row, &rows);
}

static snow_status refine_blocks(snow_insitu *insitu, size_t value) {
    const snow_level_blocks *list = &insitu->levels.received;
    const char *at = list->values;
    snow_status status = SNOW_STATUS_OK;
    double *cells = NULL;
    for (int n = 0; n < list->count && status == SNOW_STATUS_OK; n++) {
        status = refine_block(insitu, &list->blocks[n], value, at, &cells);
        at += (size_t)snow_box_voxels(&list->blocks[n].cells) * value;
    }
    snow_context_release(insitu->context, cells);
    return status;
}

snow_status snow_insitu_move_cells(snow_insitu *insitu, size_t value) {
    snow_insitu_levels *levels = &insitu->levels;
    snow_level_blocks *const lists[2] = {&levels->sent, &levels->received};
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; i < 2 && status == SNOW_STATUS_OK; i++)
        status = snow_context_reserve(insitu->context, &lists[i]->values, 0,
                                      (uint64_t)lists[i]->cells, value);
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    pack_blocks(insitu, value);
    INSITU_TRY(snow_voxels_move(insitu->voxels, levels->moved, value,
                                levels->received.values));
    return snow_comm_agree_status(insitu->comm, refine_blocks(insitu, value));
}
