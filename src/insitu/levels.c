/* insitu/levels.c - bricks whose cells are several voxels wide, as simulations
 * with levels of refinement have them.
 *
 *     coarse brick   |       |       |///////|///////|    /: covered by the
 * fine fine brick                     | | | | | | | | |       one, not read
 *     pieces         | | | | | | | | |                    refined to voxels
 *
 * What finer bricks of any rank leave of a brick are boxes of voxels, its
 * pieces.  All ranks know the bricks, and so the pieces, of all, and which
 * cells each rank needs (cells.c). */
#include "insitu/internal.h"

#include <string.h>

bool snow_insitu_is_even(const snow_insitu *insitu) {
    for (int id = 0; id < insitu->brick_count; id++)
        for (int i = 0; i < 3; i++)
            if (insitu->bricks[id].cells[i] > 1)
                return false;
    return true;
}

snow_status snow_insitu_set_cells(snow_insitu *insitu, int id,
                                  const int64_t cells[3]) {
    if (id < 0 || id >= insitu->brick_count)
        return snow_insitu_refuse(insitu,
                                  "there is no brick %d; call "
                                  "snow_insitu_set_brick first",
                                  id);
    snow_insitu_brick *brick = &insitu->bricks[id];
    for (int i = 0; i < 3; i++)
        if (cells[i] < 1 || cells[i] > 1024 || brick->box.first[i] % cells[i] ||
            brick->box.count[i] % cells[i])
            return snow_insitu_refuse(
                insitu,
                "brick %d has cells of %lld voxels along axis %d: must be 1 to "
                "1024, and the brick end where its cells do",
                id, (long long)cells[i], i);
    memcpy(brick->cells, cells, sizeof brick->cells);
    brick->voxels = NULL; /* strides depend on the cells */
    insitu->changed = true;
    return SNOW_STATUS_OK;
}

/* Collective.  The bricks of all ranks. */
static snow_status share_bricks(snow_insitu *insitu) {
    const int ranks = snow_comm_size(insitu->comm);
    snow_insitu_levels *levels = &insitu->levels;
    int64_t most = insitu->brick_count;
    INSITU_TRY(snow_comm_reduce_ints(insitu->comm, &most, 1, SNOW_REDUCE_MAX));
    snow_status status = snow_context_reserve(
        insitu->context, &levels->bricks, 0,
        (uint64_t)most * (uint64_t)(ranks + 1), sizeof *levels->bricks);
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    snow_level_brick *mine = levels->bricks + most * ranks;
    memset(mine, 0, (size_t)most * sizeof *mine);
    for (int n = 0; n < insitu->brick_count; n++) {
        mine[n].box = insitu->bricks[n].box;
        memcpy(mine[n].cells, insitu->bricks[n].cells, sizeof mine[n].cells);
    }
    levels->most = most;
    levels->count = most * ranks;
    return snow_comm_allgather(insitu->comm, mine, (size_t)most * sizeof *mine,
                               levels->bricks);
}

static int64_t volume_of(const int64_t cells[3]) {
    return cells[0] * cells[1] * cells[2];
}

/* The sizes of cells become levels, the widest first; voxels are the last. */
static void list_levels(snow_insitu_levels *levels) {
    int64_t last = INT64_MAX;
    for (int l = 0; l < SNOW_LEVELS_MOST && last > 1; l++) {
        const int64_t voxel[3] = {1, 1, 1}, *widest = voxel;
        for (int64_t n = 0; n < levels->count; n++)
            if (snow_box_voxels(&levels->bricks[n].box) &&
                volume_of(levels->bricks[n].cells) < last &&
                volume_of(levels->bricks[n].cells) > volume_of(widest))
                widest = levels->bricks[n].cells;
        memcpy(levels->sizes[l], widest, sizeof *levels->sizes);
        levels->finest = l;
        last = volume_of(widest);
    }
}

/* The cells of each level divide those of the one below. */
static snow_status check_level(snow_insitu *insitu, int level,
                               const int64_t cells[3], bool finer) {
    const int64_t *size = insitu->levels.sizes[level];
    for (int i = 0; i < 3; i++)
        if (finer ? size[i] % cells[i] : cells[i] % size[i])
            return snow_context_fail(
                insitu->context, SNOW_STATUS_BAD_USAGE,
                "there are cells of %lld and of %lld voxels along axis %d: "
                "the cells of each level must divide those of the coarser one",
                (long long)size[i], (long long)cells[i], i);
    return SNOW_STATUS_OK;
}

static snow_status find_levels(snow_insitu *insitu) {
    snow_insitu_levels *levels = &insitu->levels;
    list_levels(levels);
    for (int64_t n = 0; n < levels->count; n++) {
        snow_level_brick *brick = &levels->bricks[n];
        if (!snow_box_voxels(&brick->box))
            continue;
        while (volume_of(levels->sizes[brick->level]) > volume_of(brick->cells))
            brick->level++;
        for (int l = 0; l <= levels->finest; l++)
            INSITU_TRY(check_level(insitu, l, brick->cells, l <= brick->level));
    }
    return SNOW_STATUS_OK;
}

static snow_status add_piece(snow_insitu *insitu, const snow_box *box) {
    snow_insitu_levels *levels = &insitu->levels;
    const uint64_t count = (uint64_t)levels->piece_count;
    INSITU_TRY(snow_context_reserve(insitu->context, &levels->pieces, count,
                                    count + 1, sizeof *levels->pieces));
    levels->pieces[levels->piece_count++] = *box;
    return SNOW_STATUS_OK;
}

/* Adds what is left of `piece` around `hole`, which lies in it. */
static snow_status add_around(snow_insitu *insitu, snow_box piece,
                              const snow_box *hole) {
    for (int i = 0; i < 3; i++) {
        snow_box side = piece;
        const int64_t end = piece.first[i] + piece.count[i];
        const int64_t hole_end = hole->first[i] + hole->count[i];
        side.count[i] = hole->first[i] - piece.first[i];
        if (side.count[i] > 0)
            INSITU_TRY(add_piece(insitu, &side));
        side.first[i] = hole_end;
        side.count[i] = end - hole_end;
        if (side.count[i] > 0)
            INSITU_TRY(add_piece(insitu, &side));
        piece.first[i] = hole->first[i];
        piece.count[i] = hole->count[i];
    }
    return SNOW_STATUS_OK;
}

/* Takes a finer brick out of the pieces from `first` on. */
static snow_status cut_out(snow_insitu *insitu, int64_t first,
                           const snow_box *finer) {
    snow_insitu_levels *levels = &insitu->levels;
    for (int64_t n = first; n < levels->piece_count; n++) {
        const snow_box piece = levels->pieces[n];
        snow_box hole;
        if (!snow_box_intersect(&piece, finer, &hole))
            continue;
        levels->pieces[n--] = levels->pieces[--levels->piece_count];
        INSITU_TRY(add_around(insitu, piece, &hole));
    }
    return SNOW_STATUS_OK;
}

/* A cell is covered as a whole, or not. */
static snow_status check_ends(snow_insitu *insitu, int64_t number,
                              const snow_box *finer) {
    const snow_insitu_levels *levels = &insitu->levels;
    const snow_level_brick *brick = &levels->bricks[number];
    snow_box shared;
    if (!snow_box_intersect(&brick->box, finer, &shared))
        return SNOW_STATUS_OK;
    for (int i = 0; i < 3; i++)
        if (shared.first[i] % brick->cells[i] ||
            shared.count[i] % brick->cells[i])
            return snow_context_fail(
                insitu->context, SNOW_STATUS_BAD_USAGE,
                "a finer brick covers a part of a cell of brick %lld of rank "
                "%lld along axis %d; let finer bricks end where coarser cells "
                "do",
                (long long)(number % levels->most),
                (long long)(number / levels->most), i);
    return SNOW_STATUS_OK;
}

static snow_status cut_brick(snow_insitu *insitu, int64_t number) {
    const snow_insitu_levels *levels = &insitu->levels;
    snow_level_brick *brick = &levels->bricks[number];
    brick->pieces[0] = levels->piece_count;
    if (snow_box_voxels(&brick->box))
        INSITU_TRY(add_piece(insitu, &brick->box));
    for (int64_t n = 0; n < levels->count; n++) {
        const snow_level_brick *other = &levels->bricks[n];
        if (!snow_box_voxels(&other->box) || other->level <= brick->level)
            continue;
        INSITU_TRY(check_ends(insitu, number, &other->box));
        INSITU_TRY(cut_out(insitu, brick->pieces[0], &other->box));
    }
    brick->pieces[1] = levels->piece_count;
    return SNOW_STATUS_OK;
}

static snow_status cut_all(snow_insitu *insitu) {
    snow_insitu_levels *levels = &insitu->levels;
    const int64_t own = levels->most * snow_comm_rank(insitu->comm);
    levels->piece_count = 0;
    INSITU_TRY(find_levels(insitu));
    for (int64_t n = 0; n < levels->count; n++)
        INSITU_TRY(cut_brick(insitu, n));
    const int64_t first = levels->bricks[own].pieces[0];
    const int64_t end = levels->bricks[own + levels->most - 1].pieces[1];
    INSITU_TRY(snow_context_reserve(insitu->context, &insitu->held, 0,
                                    (uint64_t)(end - first),
                                    sizeof *insitu->held));
    insitu->held_count = (int)(end - first);
    memcpy(insitu->held, levels->pieces + first,
           (size_t)(end - first) * sizeof *insitu->held);
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_cut_levels(snow_insitu *insitu) {
    INSITU_TRY(share_bricks(insitu));
    return snow_comm_agree_status(insitu->comm, cut_all(insitu));
}
