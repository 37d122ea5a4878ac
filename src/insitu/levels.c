/* insitu/levels.c - bricks whose cells are several voxels wide, as simulations
 * with levels of refinement have them.
 *
 *     coarse brick   |       |       |///////|///////|    /: covered by the
 * fine fine brick                     | | | | | | | | |       one, not read
 *     pieces         | | | | | | | | |                    refined to voxels
 *
 * What finer bricks of any rank leave of a brick are boxes of voxels, its
 * pieces, which are refined from its cells and its halo (snow_cells_refine).
 * From there on they are bricks like others. */
#include "insitu/internal.h"

#include <math.h>
#include <string.h>

/* What ranks tell one another of a brick. */
typedef struct told {
    snow_box box; /* of voxels; empty: there is none */
    int64_t cells[3];
} told;

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

/* Collective.  The bricks of all ranks; released by the caller. */
static snow_status share_bricks(snow_insitu *insitu, told **all,
                                int64_t *count) {
    const int ranks = snow_comm_size(insitu->comm);
    int64_t most = insitu->brick_count;
    INSITU_TRY(snow_comm_reduce_ints(insitu->comm, &most, 1, SNOW_REDUCE_MAX));
    snow_status status = snow_context_reserve(
        insitu->context, all, 0, (uint64_t)most * (uint64_t)(ranks + 1),
        sizeof **all);
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    told *mine = *all + most * ranks;
    for (int64_t n = 0; n < most; n++) {
        mine[n] = (told){.cells = {1, 1, 1}};
        if (n >= insitu->brick_count)
            continue;
        mine[n].box = insitu->bricks[n].box;
        memcpy(mine[n].cells, insitu->bricks[n].cells, sizeof mine[n].cells);
    }
    *count = most * ranks;
    return snow_comm_allgather(insitu->comm, mine, (size_t)most * sizeof *mine,
                               *all);
}

/* Whether a brick's cells are finer. */
static bool is_finer(const told *other, const int64_t cells[3]) {
    int64_t a = 1, b = 1;
    for (int i = 0; i < 3; i++) {
        a *= other->cells[i];
        b *= cells[i];
    }
    return a < b;
}

/* --- pieces --------------------------------------------------------------- */

static snow_status add_piece(snow_insitu *insitu, const snow_box *box) {
    const uint64_t count = (uint64_t)insitu->held_count;
    INSITU_TRY(snow_context_reserve(insitu->context, &insitu->held, count,
                                    count + 1, sizeof *insitu->held));
    insitu->held[insitu->held_count++] = *box;
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
static snow_status cut_out(snow_insitu *insitu, int first,
                           const snow_box *finer) {
    for (int n = first; n < insitu->held_count; n++) {
        const snow_box piece = insitu->held[n];
        snow_box hole;
        if (!snow_box_intersect(&piece, finer, &hole))
            continue;
        insitu->held[n--] = insitu->held[--insitu->held_count];
        INSITU_TRY(add_around(insitu, piece, &hole));
    }
    return SNOW_STATUS_OK;
}

/* A cell is covered as a whole, or not. */
static snow_status check_ends(const snow_insitu *insitu, int id,
                              const snow_box *finer) {
    const snow_insitu_brick *brick = &insitu->bricks[id];
    snow_box shared;
    if (!snow_box_intersect(&brick->box, finer, &shared))
        return SNOW_STATUS_OK;
    for (int i = 0; i < 3; i++)
        if (shared.first[i] % brick->cells[i] ||
            shared.count[i] % brick->cells[i])
            return snow_context_fail(
                insitu->context, SNOW_STATUS_BAD_USAGE,
                "a finer brick covers a part of a cell of brick %d along axis "
                "%d; let finer bricks end where coarser cells do",
                id, i);
    return SNOW_STATUS_OK;
}

static snow_status cut_brick(snow_insitu *insitu, int id, const told *all,
                             int64_t count) {
    snow_insitu_brick *brick = &insitu->bricks[id];
    brick->pieces[0] = insitu->held_count;
    if (snow_box_voxels(&brick->box))
        INSITU_TRY(add_piece(insitu, &brick->box));
    for (int64_t n = 0; n < count; n++) {
        if (!snow_box_voxels(&all[n].box) || !is_finer(&all[n], brick->cells))
            continue;
        INSITU_TRY(check_ends(insitu, id, &all[n].box));
        INSITU_TRY(cut_out(insitu, brick->pieces[0], &all[n].box));
    }
    brick->pieces[1] = insitu->held_count;
    return SNOW_STATUS_OK;
}

/* --- values --------------------------------------------------------------- */

/* Cells of a brick and its halo, within the grid. */
static snow_box cells_around(const snow_insitu *insitu,
                             const snow_insitu_brick *brick) {
    snow_box out;
    for (int i = 0; i < 3; i++) {
        const int64_t wide = brick->cells[i];
        const int64_t first = brick->box.first[i] / wide;
        const int64_t end = first + brick->box.count[i] / wide;
        const int64_t all = (insitu->whole.dims[i] + wide - 1) / wide;
        const int64_t low = brick->halo.low[i], high = brick->halo.high[i];
        out.first[i] = first > low ? first - low : 0;
        out.count[i] = (all - end > high ? end + high : all) - out.first[i];
    }
    return out;
}

static double value_at(const snow_insitu_brick *brick, int64_t at) {
    return brick->type == SNOW_TYPE_FLOAT32
               ? (double)((const float *)brick->voxels)[at]
               : ((const double *)brick->voxels)[at];
}

/* The place of a cell in a box. */
static int64_t place_in(const snow_box *box, int64_t x, int64_t y, int64_t z) {
    return ((z - box->first[2]) * box->count[1] + y - box->first[1]) *
               box->count[0] +
           x - box->first[0];
}

static void take_cells(const snow_insitu_brick *brick, const snow_box *box,
                       double *out) {
    int64_t from[3], at[3];
    for (int i = 0; i < 3; i++)
        from[i] = brick->box.first[i] / brick->cells[i] - box->first[i];
    for (at[2] = 0; at[2] < box->count[2]; at[2]++)
        for (at[1] = 0; at[1] < box->count[1]; at[1]++)
            for (at[0] = 0; at[0] < box->count[0]; at[0]++) {
                int64_t place = 0;
                for (int i = 0; i < 3; i++)
                    place += (at[i] - from[i]) * brick->stride[i];
                *out++ = value_at(brick, place);
            }
}

/* Forgets the cells that a finer brick covers. */
static void hide_cells(const snow_insitu_brick *brick, const snow_box *box,
                       const snow_box *finer, double *cells) {
    snow_box covered, shared;
    for (int i = 0; i < 3; i++) {
        const int64_t wide = brick->cells[i];
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

/* Where the voxels of a piece go. */
typedef struct piece_rows {
    snow_type type;
    const snow_box *box;
    char *voxels;
} piece_rows;

static bool take_row(void *user, int64_t y, int64_t z, const double *row) {
    const piece_rows *to = user;
    const int64_t place = place_in(to->box, to->box->first[0], y, z);
    for (int64_t x = 0; row && x < to->box->count[0]; x++)
        if (to->type == SNOW_TYPE_FLOAT32)
            ((float *)to->voxels)[place + x] = (float)row[x];
        else
            ((double *)to->voxels)[place + x] = row[x];
    return true;
}

static snow_status refine_pieces(snow_insitu *insitu,
                                 const snow_insitu_brick *brick,
                                 const snow_box *box, const double *cells,
                                 char **voxels) {
    for (int n = brick->pieces[0]; n < brick->pieces[1]; n++) {
        const snow_box *piece = &insitu->held[n];
        piece_rows rows = {brick->type, piece, *voxels};
        INSITU_TRY(snow_cells_refine(insitu->context, cells, box, brick->cells,
                                     piece, take_row, &rows));
        insitu->moved[n] = (snow_brick){
            .box = *piece,
            .voxels = *voxels,
            .stride = {1, piece->count[0], piece->count[0] * piece->count[1]}};
        *voxels += (size_t)snow_box_voxels(piece) * snow_type_size(brick->type);
    }
    return SNOW_STATUS_OK;
}

static snow_status refine_brick(snow_insitu *insitu,
                                const snow_insitu_brick *brick, const told *all,
                                int64_t count, char **voxels) {
    const snow_box box = cells_around(insitu, brick);
    double *cells = NULL;
    INSITU_TRY(snow_context_reserve(insitu->context, &cells, 0,
                                    (uint64_t)snow_box_voxels(&box),
                                    sizeof *cells));
    take_cells(brick, &box, cells);
    for (int64_t n = 0; n < count; n++)
        if (snow_box_voxels(&all[n].box) && is_finer(&all[n], brick->cells))
            hide_cells(brick, &box, &all[n].box, cells);
    snow_status status = refine_pieces(insitu, brick, &box, cells, voxels);
    snow_context_release(insitu->context, cells);
    return status;
}

/* --- all of it ------------------------------------------------------------ */

static bool is_fine(const snow_insitu_brick *brick) {
    return brick->cells[0] * brick->cells[1] * brick->cells[2] == 1;
}

/* Room for the voxels of pieces; those of bricks of voxels stay where they
 * are. */
static snow_status make_room(snow_insitu *insitu) {
    uint64_t voxels = 0;
    for (int id = 0; id < insitu->brick_count; id++) {
        const snow_insitu_brick *brick = &insitu->bricks[id];
        for (int n = brick->pieces[0]; n < brick->pieces[1]; n++)
            voxels += is_fine(brick)
                          ? 0
                          : (uint64_t)snow_box_voxels(&insitu->held[n]);
    }
    INSITU_TRY(snow_context_reserve(insitu->context, &insitu->moved, 0,
                                    (uint64_t)insitu->held_count,
                                    sizeof *insitu->moved));
    return snow_context_reserve(insitu->context, &insitu->refined, 0, voxels,
                                snow_type_size(insitu->type));
}

static snow_status refine_all(snow_insitu *insitu, const told *all,
                              int64_t count) {
    insitu->held_count = 0;
    if (insitu->type != SNOW_TYPE_FLOAT32 && insitu->type != SNOW_TYPE_FLOAT64)
        return snow_context_fail(insitu->context, SNOW_STATUS_BAD_USAGE,
                                 "voxels are %s, and cells of several sizes "
                                 "must be float32 or float64",
                                 snow_type_name(insitu->type));
    for (int id = 0; id < insitu->brick_count; id++)
        INSITU_TRY(cut_brick(insitu, id, all, count));
    INSITU_TRY(make_room(insitu));
    char *voxels = insitu->refined;
    for (int id = 0; id < insitu->brick_count; id++) {
        const snow_insitu_brick *brick = &insitu->bricks[id];
        if (brick->pieces[0] == brick->pieces[1])
            continue;
        if (!is_fine(brick))
            INSITU_TRY(refine_brick(insitu, brick, all, count, &voxels));
        else
            insitu->moved[brick->pieces[0]] =
                (snow_brick){.box = brick->box,
                             .voxels = brick->voxels,
                             .stride = {brick->stride[0], brick->stride[1],
                                        brick->stride[2]}};
    }
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_refine(snow_insitu *insitu) {
    told *all = NULL;
    int64_t count = 0;
    snow_status status = share_bricks(insitu, &all, &count);
    if (status == SNOW_STATUS_OK)
        status = snow_comm_agree_status(insitu->comm,
                                        refine_all(insitu, all, count));
    snow_context_release(insitu->context, all);
    return status;
}
