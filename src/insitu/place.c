/* insitu/place.c - the grid that bricks in the world make up together.
 *
 * All ranks take the least and the greatest place of a voxel, by reduction, and
 * each counts its bricks' voxels from there. */
#include "insitu/internal.h"

#include <math.h>
#include <string.h>

/* Share of a spacing by which a brick may miss the voxels of the grid: places
 * are often computed, or single precision. */
#define MISS 0.01

/* Most voxels along an axis that are counted exactly in a double. */
#define DIMS_MOST 4e15

/* The bounds of all bricks, reduced to the least. */
enum { LOW = 0, HIGH = 3, SPACING = 6, SPACING_MOST = 9, BOUNDS = 12 };

static bool is_empty(const snow_world_brick *brick) {
    return brick->count[0] < 1 || brick->count[1] < 1 || brick->count[2] < 1;
}

/* This rank's bounds; those of HIGH and SPACING_MOST are negative, since the
 * least of all is taken. */
static void find_bounds(const snow_world_brick *bricks, int count,
                        const double spacing[3], double bounds[BOUNDS]) {
    for (int i = 0; i < BOUNDS; i++)
        bounds[i] = INFINITY;
    for (int n = 0; n < count; n++)
        for (int i = 0; i < 3 && !is_empty(&bricks[n]); i++) {
            double low = bricks[n].origin[i];
            double high = low + (double)(bricks[n].count[i] - 1) * spacing[i];
            bounds[LOW + i] = fmin(bounds[LOW + i], low);
            bounds[HIGH + i] = fmin(bounds[HIGH + i], -high);
            bounds[SPACING + i] = spacing[i];
            bounds[SPACING_MOST + i] = -spacing[i];
        }
}

static snow_status check_bounds(snow_insitu *insitu,
                                const double bounds[BOUNDS]) {
    for (int i = 0; i < 3; i++) {
        double least = bounds[SPACING + i], most = -bounds[SPACING_MOST + i];
        double dims = (-bounds[HIGH + i] - bounds[LOW + i]) / least;
        if (isinf(bounds[LOW + i]))
            return snow_context_fail(insitu->context, SNOW_STATUS_BAD_USAGE,
                                     "no rank has a brick; give at least one");
        if (!(least > 0) || !(most - least <= 1e-6 * most))
            return snow_context_fail(
                insitu->context, SNOW_STATUS_BAD_USAGE,
                "spacings along axis %d are between %g and %g: all bricks must "
                "have the same positive spacing",
                i, least, most);
        if (!(dims < DIMS_MOST))
            return snow_context_fail(insitu->context, SNOW_STATUS_BAD_USAGE,
                                     "invalid grid of %g voxels along axis %d; "
                                     "correct the positions of the bricks",
                                     dims, i);
    }
    return SNOW_STATUS_OK;
}

/* A brick's first voxel in the grid. */
static snow_status locate(snow_insitu *insitu, int id,
                          const snow_world_brick *brick,
                          const double bounds[BOUNDS], int64_t first[3]) {
    for (int i = 0; i < 3; i++) {
        double at = (brick->origin[i] - bounds[LOW + i]) / bounds[SPACING + i];
        first[i] = (int64_t)floor(at + 0.5);
        if (!(fabs(at - floor(at + 0.5)) <= MISS))
            return snow_context_fail(
                insitu->context, SNOW_STATUS_BAD_USAGE,
                "brick %d begins at voxel %g along axis %d of the grid: it "
                "must begin at a whole voxel",
                id, at, i);
    }
    return SNOW_STATUS_OK;
}

/* Gives up the last layer on every side where the grid goes on. */
static void trim(const int64_t dims[3], snow_insitu_brick *brick) {
    for (int i = 0; i < 3; i++)
        if (brick->box.first[i] + brick->box.count[i] < dims[i]) {
            brick->box.count[i]--;
            brick->halo.high[i]++;
        }
}

/* What the bricks are in the grid. */
static snow_status find_boxes(snow_insitu *insitu,
                              const snow_world_brick *bricks, int count,
                              const double bounds[BOUNDS],
                              snow_insitu_brick *out) {
    for (int n = 0; n < count; n++) {
        out[n] = (snow_insitu_brick){.halo = bricks[n].halo};
        if (is_empty(&bricks[n]))
            continue;
        memcpy(out[n].box.count, bricks[n].count, sizeof out[n].box.count);
        INSITU_TRY(locate(insitu, n, &bricks[n], bounds, out[n].box.first));
    }
    return SNOW_STATUS_OK;
}

/* Collective.  Where ranks have more voxels than the grid, they share some. */
static snow_status share_borders(snow_insitu *insitu, const int64_t dims[3],
                                 snow_insitu_brick *bricks, int count) {
    int64_t held = 0;
    for (int n = 0; n < count; n++)
        held += snow_box_voxels(&bricks[n].box);
    INSITU_TRY(snow_comm_reduce_ints(insitu->comm, &held, 1, SNOW_REDUCE_SUM));
    double all = (double)dims[0] * (double)dims[1] * (double)dims[2];
    for (int n = 0; n < count && (double)held > all; n++)
        if (snow_box_voxels(&bricks[n].box))
            trim(dims, &bricks[n]);
    return SNOW_STATUS_OK;
}

static bool is_same(const snow_insitu *insitu, const int64_t dims[3],
                    const double bounds[BOUNDS],
                    const snow_insitu_brick *bricks, int count) {
    if (insitu->brick_count != count ||
        memcmp(insitu->whole.dims, dims, sizeof insitu->whole.dims) != 0)
        return false;
    for (int i = 0; i < 3; i++)
        if (insitu->whole.matrix[i][3] != bounds[LOW + i] ||
            insitu->whole.spacing[i] != bounds[SPACING + i])
            return false;
    for (int n = 0; n < count; n++) {
        const snow_insitu_brick *old = &insitu->bricks[n];
        if (memcmp(&old->box, &bricks[n].box, sizeof old->box) != 0 ||
            memcmp(&old->halo, &bricks[n].halo, sizeof old->halo) != 0)
            return false;
    }
    return true;
}

static snow_status set_grid_and_bricks(snow_insitu *insitu,
                                       const int64_t dims[3],
                                       const double bounds[BOUNDS],
                                       const snow_insitu_brick *bricks,
                                       int count) {
    if (is_same(insitu, dims, bounds, bricks, count))
        return SNOW_STATUS_OK;
    INSITU_TRY(
        snow_insitu_set_grid(insitu, dims, bounds + LOW, bounds + SPACING));
    for (int n = 0; n < count; n++)
        INSITU_TRY(snow_insitu_set_brick(insitu, n, bricks[n].box.first,
                                         bricks[n].box.count, &bricks[n].halo));
    return SNOW_STATUS_OK;
}

/* Collective. */
static snow_status place_all(snow_insitu *insitu,
                             const snow_world_brick *bricks, int count,
                             const double spacing[3],
                             snow_insitu_brick *placed) {
    double bounds[BOUNDS];
    int64_t dims[3];
    find_bounds(bricks, count, spacing, bounds);
    INSITU_TRY(snow_comm_reduce_doubles(insitu->comm, bounds, BOUNDS,
                                        SNOW_REDUCE_MIN));
    INSITU_TRY(check_bounds(insitu, bounds));
    for (int i = 0; i < 3; i++)
        dims[i] = (int64_t)floor(
            (-bounds[HIGH + i] - bounds[LOW + i]) / bounds[SPACING + i] + 1.5);
    INSITU_TRY(snow_comm_agree_status(
        insitu->comm, find_boxes(insitu, bricks, count, bounds, placed)));
    INSITU_TRY(share_borders(insitu, dims, placed, count));
    return snow_comm_agree_status(
        insitu->comm, set_grid_and_bricks(insitu, dims, bounds, placed, count));
}

snow_status snow_insitu_place_bricks(snow_insitu *insitu,
                                     const snow_world_brick *bricks, int count,
                                     const double spacing[3]) {
    snow_insitu_brick *placed = snow_context_allocate(
        insitu->context, (size_t)(count > 0 ? count : 0) * sizeof *placed);
    snow_status status = snow_insitu_begin(insitu);
    snow_status here = placed ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    if (status == SNOW_STATUS_OK)
        status = snow_comm_agree_status(insitu->comm, here);
    if (status == SNOW_STATUS_OK)
        status = place_all(insitu, bricks, count, spacing, placed);
    snow_context_release(insitu->context, placed);
    insitu->given = SNOW_STATUS_OK; /* of the setters above: agreed on */
    return snow_insitu_end(insitu, status);
}
