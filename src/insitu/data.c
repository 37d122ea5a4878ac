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

/* --- taking --------------------------------------------------------------- */

/* The only brick's voxels where they lie, with the part of its halo that is
 * within the grid. */
static const void *in_place(const snow_insitu *insitu, snow_box *memory,
                            int64_t pitch[2]) {
    const snow_insitu_brick *brick = NULL;
    for (int id = 0; id < insitu->brick_count; id++)
        if (snow_box_voxels(&insitu->bricks[id].box))
            brick = &insitu->bricks[id];
    if (insitu->layout.exchanged || insitu->held_count != 1 ||
        insitu->ghosts == SNOW_GHOSTS_NONE)
        return NULL;
    int64_t back = 0;
    *memory = snow_insitu_grow_box(&brick->box, brick->halo.low,
                                   brick->halo.high, insitu->whole.dims);
    const int64_t *stride = brick->stride;
    if (!(stride[0] == 1 && stride[1] > 0 && stride[2] > 0) ||
        !snow_insitu_box_holds(memory, &insitu->layout.stored))
        return NULL;
    for (int i = 0; i < 3; i++)
        back += (brick->box.first[i] - memory->first[i]) * brick->stride[i];
    memcpy(pitch, brick->stride + 1, 2 * sizeof *pitch);
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
        snow_box has = snow_insitu_grow_box(&brick->box, halo->low, halo->high,
                                            insitu->whole.dims);
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
    double voxels = (double)count[0] * (double)count[1] * (double)count[2];
    uint64_t exact = voxels < 0x1p62
                         ? (uint64_t)(count[0] * count[1] * count[2])
                         : UINT64_MAX;
    INSITU_TRY(
        snow_context_reserve(insitu->context, &insitu->dense, 0, exact, value));
    if (!snow_box_voxels(&insitu->layout.owned))
        memset(insitu->dense, 0, value);
    return SNOW_STATUS_OK;
}

/* Another volume, which has no values beyond the planes. */
static snow_status clip_voxels(snow_insitu *insitu) {
    const size_t count = (size_t)insitu->clip_count;
    snow_volume *cut;
    if (!count)
        return SNOW_STATUS_OK;
    INSITU_TRY(snow_volume_clip(insitu->volume, insitu->clips[0], count, &cut));
    snow_volume_close(insitu->volume);
    insitu->volume = cut;
    const int64_t *dims = snow_volume_get_info(cut)->dims;
    insitu->pitch[0] = dims[0];
    insitu->pitch[1] = dims[0] * dims[1];
    insitu->copied = true;
    return SNOW_STATUS_OK;
}

/* A volume over voxels that lie in `memory`: the rank's part of the whole. */
static snow_status wrap_voxels(snow_insitu *insitu, const void *voxels,
                               const snow_box *memory, const int64_t pitch[2]) {
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
    snow_volume_set_pitch(insitu->volume, pitch);
    INSITU_TRY(clip_voxels(insitu));
    INSITU_TRY(snow_volume_set_extent(insitu->volume, &part));
    INSITU_TRY(snow_volume_set_whole(insitu->volume, &insitu->whole));
    snow_volume_freeze(insitu->volume); /* until the next update */
    return SNOW_STATUS_OK;
}

/* Collective.  The voxels, from wherever they are. */
static snow_status gather_voxels(snow_insitu *insitu) {
    snow_box memory;
    size_t value = snow_type_size(insitu->type);
    int64_t *pitch = insitu->pitch;
    const void *shared = in_place(insitu, &memory, pitch);
    snow_status status = SNOW_STATUS_OK;
    insitu->copied = !shared;
    if (!shared) {
        memory = insitu->layout.stored;
        status = reserve_dense(insitu, value);
    }
    INSITU_TRY(snow_comm_agree_status(insitu->comm, status));
    if (!shared) {
        pitch[0] = memory.count[0];
        pitch[1] = pitch[0] * memory.count[1];
    }
    if (insitu->layout.uneven)
        INSITU_TRY(snow_insitu_move_cells(insitu, value));
    else if (insitu->layout.exchanged)
        INSITU_TRY(snow_voxels_move(insitu->voxels, insitu->moved, value,
                                    insitu->dense));
    else if (!shared)
        copy_bricks(insitu, value);
    status =
        wrap_voxels(insitu, shared ? shared : insitu->dense, &memory, pitch);
    return snow_comm_agree_status(insitu->comm, status);
}

snow_status snow_insitu_take(snow_insitu *insitu) {
    insitu->taken = false;
    INSITU_TRY(snow_insitu_lay_out(insitu));
    INSITU_TRY(gather_voxels(insitu));
    insitu->taken = true;
    return SNOW_STATUS_OK;
}
