/* insitu/grid.c - the grid of a simulation, and the bricks of it that this rank
 * holds. */
#include "insitu/internal.h"

#include <string.h>

snow_volume_info snow_insitu_empty_grid(void) {
    snow_volume_info info = {
        .size = sizeof info, .slope = 1, .format = "memory", .times = 1};
    return info;
}

/* The most bricks of a rank: more are a wrong number. */
#define BRICKS_MOST 1000000

/* Along the axes of the world: the matrix has the spacing on its diagonal. */
static void place_grid(snow_volume_info *info, const double *origin,
                       const double *spacing) {
    for (int i = 0; i < 3; i++) {
        info->spacing[i] = spacing ? spacing[i] : 1;
        info->matrix[i][i] = info->spacing[i];
        info->matrix[i][3] = origin ? origin[i] : 0;
    }
    info->matrix[3][3] = 1;
}

snow_status snow_insitu_set_grid(snow_insitu *insitu, const int64_t dims[3],
                                 const double origin[3],
                                 const double spacing[3]) {
    snow_volume_info info = snow_insitu_empty_grid();
    memcpy(info.dims, dims, sizeof info.dims);
    place_grid(&info, origin, spacing);
    info.type = SNOW_TYPE_UINT8; /* any, for the check */
    for (int i = 0; i < 3; i++)
        if (!(info.spacing[i] > 0))
            return snow_insitu_refuse(insitu,
                                      "invalid spacing %g: must be positive",
                                      info.spacing[i]);
    /* By the rules for all volumes, whose voxels nobody looks at here. */
    snow_volume *volume = NULL;
    snow_status status =
        snow_volume_wrap(insitu->context, &info, &info, &volume);
    snow_volume_close(volume);
    INSITU_TRY(snow_insitu_set_error(insitu, status));
    insitu->whole = info;
    insitu->brick_count = 0;
    insitu->changed = true;
    return SNOW_STATUS_OK;
}

/* Makes room for brick `id`; those between are empty. */
static snow_status reserve_bricks(snow_insitu *insitu, int id) {
    const size_t size = sizeof *insitu->bricks;
    size_t had = (size_t)insitu->brick_count, count = (size_t)id + 1;
    if (count <= had)
        return SNOW_STATUS_OK;
    INSITU_TRY(snow_context_reserve(insitu->context, &insitu->bricks, had,
                                    count, size));
    memset(insitu->bricks + had, 0, (count - had) * size);
    for (size_t n = had; n < count; n++)
        for (int i = 0; i < 3; i++)
            insitu->bricks[n].cells[i] = 1;
    insitu->brick_count = (int)count;
    return SNOW_STATUS_OK;
}

static snow_status check_brick(snow_insitu *insitu, int id,
                               const int64_t first[3], const int64_t count[3],
                               const snow_halo *halo) {
    const int64_t *dims = insitu->whole.dims;
    if (!dims[0])
        return snow_insitu_refuse(insitu,
                                  "there is no grid to put a brick into; call "
                                  "snow_insitu_set_grid first");
    if (id < 0 || id >= BRICKS_MOST)
        return snow_insitu_refuse(insitu, "invalid brick %d: must be 0 to %d",
                                  id, BRICKS_MOST - 1);
    for (int i = 0; i < 3; i++) {
        if (count[i] < 0 || first[i] < 0 || count[i] > dims[i] ||
            first[i] > dims[i] - count[i])
            return snow_insitu_refuse(
                insitu,
                "brick %d has voxels %lld to %lld along axis %d, but "
                "the grid ends at %lld; correct first and count",
                id, (long long)first[i], (long long)(first[i] + count[i] - 1),
                i, (long long)(dims[i] - 1));
        if (halo->low[i] < 0 || halo->high[i] < 0 || halo->low[i] > INT32_MAX ||
            halo->high[i] > INT32_MAX)
            return snow_insitu_refuse(
                insitu,
                "brick %d has a halo below 0, or of billions; give "
                "the ghost voxels that lie around it",
                id);
    }
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_set_brick(snow_insitu *insitu, int id,
                                  const int64_t first[3],
                                  const int64_t count[3],
                                  const snow_halo *halo) {
    static const snow_halo none;
    if (!halo)
        halo = &none;
    INSITU_TRY(check_brick(insitu, id, first, count, halo));
    INSITU_TRY(snow_insitu_set_error(insitu, reserve_bricks(insitu, id)));
    snow_insitu_brick *brick = &insitu->bricks[id];
    *brick = (snow_insitu_brick){.halo = *halo, .cells = {1, 1, 1}};
    bool none_left = !count[0] || !count[1] || !count[2];
    for (int i = 0; i < 3 && !none_left; i++) {
        brick->box.first[i] = first[i];
        brick->box.count[i] = count[i];
    }
    insitu->changed = true;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_set_voxels(snow_insitu *insitu, int id, snow_type type,
                                   const void *voxels,
                                   const int64_t stride[3]) {
    if (id < 0 || id >= insitu->brick_count ||
        !snow_box_voxels(&insitu->bricks[id].box))
        return snow_insitu_refuse(insitu,
                                  "there is no brick %d; call "
                                  "snow_insitu_set_brick first",
                                  id);
    if (!voxels || !snow_type_size(type))
        return snow_insitu_refuse(
            insitu, "brick %d has no voxels or no type; give both", id);
    snow_insitu_brick *brick = &insitu->bricks[id];
    int64_t step = 1;
    for (int i = 0; i < 3; i++) {
        brick->stride[i] = stride ? stride[i] : step;
        step *= brick->halo.low[i] + brick->box.count[i] / brick->cells[i] +
                brick->halo.high[i];
    }
    brick->type = type;
    brick->voxels = voxels;
    return SNOW_STATUS_OK;
}
