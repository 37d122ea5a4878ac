/* render/shear_warp/eye_rays.c - the rays of the lattice's samples in
 * perspective.
 */
#include "render/shear_warp/internal.h"

#include <math.h>
#include <string.h>

typedef struct rays_job {
    snow_value_path *path;
    size_t lanes[2]; /* of a resampled slice, along u and v */
} rays_job;

static void place_lanes(void *of, int64_t item, int worker) {
    const rays_job *job = of;
    snow_value_path *path = job->path;
    const snow_value_rays *rays = &path->rays;
    const snow_resampled_slice *resampled = &path->resampled_slices[item];
    (void)worker;
    path->spreads[item] = snow_value_eye_spread(&path->lattice, resampled);
    for (int axis = 0; axis < 2; axis++)
        snow_value_eye_lanes(&path->lattice, resampled, axis, rays->tiles[axis],
                             rays->stored[axis], path->made.store.margin,
                             path->lanes[axis] +
                                 (size_t)item * job->lanes[axis]);
}

/* How the rays' lengths follow from their ways. */
static void measure_ways(const snow_value_path *path, const snow_placement *p,
                         snow_value_rays *rays) {
    const int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int n = 0; n < 6; n++)
        rays->metric[n] =
            (float)(p->eye.metric[pairs[n][0]][pairs[n][1]] * (n < 3 ? 1 : 2));
    rays->usual = (float)(1 / (path->lattice.path * path->lattice.per_slice));
}

/* The way's part along the light that is fixed to the camera. */
static void place_light(const snow_value_params *params,
                        const snow_value_lattice *l, snow_value_rays *rays) {
    const snow_volume_info *info = &params->volume->info;
    const snow_placement *p = params->placement;
    const int axes[3] = {p->u_axis, p->v_axis, p->slice_axis};
    const double *spacing = info->spacing;
    const snow_lights lights = snow_lights_of(p, params->settings);
    const double *light = lights.to[0]; /* of no use if it is a head light */
    double toward = l->nearest_first ? -1 : 1;
    for (int n = 0; n < 3; n++) {
        double sum = 0;
        for (int i = 0; i < 3; i++)
            sum += info->matrix[i][axes[n]] * light[i];
        rays->aside[n] = (float)(toward * sum);
    }
    rays->toward =
        (float)(toward * fmin(spacing[0], fmin(spacing[1], spacing[2])));
}

static void describe(const snow_value_lattice *l, snow_value_rays *rays) {
    double height = l->front - l->eye[2];
    rays->middles = l->quincunx ? 2 : 1;
    rays->line = rays->middles * l->cells[0];
    for (int phase = 0; phase < l->phases; phase++) {
        int middle = phase % rays->middles, cell = phase / rays->middles;
        const int at[2] = {cell % l->cells[0], cell / l->cells[0]};
        for (int axis = 0; axis < 2; axis++) {
            rays->cell[phase][axis] = (uint8_t)at[axis];
            rays->spot[phase][axis] =
                (uint8_t)(at[axis] * rays->middles + middle);
        }
    }
    for (int axis = 0; axis < 2; axis++) {
        int side = axis == 0 ? SNOW_VALUE_COLUMNS : SNOW_VALUE_ROWS;
        rays->cells[axis] = l->cells[axis];
        rays->phases[axis] = l->cells[axis] * rays->middles;
        rays->tiles[axis] = (int)((l->voxels[axis] + side - 1) / side);
        rays->slope[axis][0] = ((double)l->first[axis] - l->eye[axis]) / height;
        rays->slope[axis][1] = 1 / (rays->phases[axis] * height);
    }
}

snow_status snow_value_place_rays(snow_value_path *path,
                                  const snow_value_params *params) {
    const snow_value_lattice *l = &path->lattice;
    snow_value_rays *rays = &path->rays;
    rays_job job = {.path = path};
    size_t resampled_slices = (size_t)l->resampled_count;
    *rays = (snow_value_rays){0};
    describe(l, rays);
    memcpy(rays->stored, params->clip->stored, sizeof rays->stored);
    measure_ways(path, params->placement, rays);
    place_light(params, l, rays);
    SNOW_TRY(SNOW_RESERVE(path->context, path->spreads, 0, resampled_slices));
    for (int axis = 0; axis < 2; axis++) {
        job.lanes[axis] =
            (size_t)rays->phases[axis] * (size_t)rays->tiles[axis];
        SNOW_TRY(SNOW_RESERVE(path->context, path->lanes[axis], 0,
                              resampled_slices * job.lanes[axis]));
        rays->lanes[axis] = path->lanes[axis];
    }
    rays->resampled_slices = path->spreads;
    return snow_parallel(path->context, params->settings->threads,
                         l->resampled_count, place_lanes, &job);
}
