/* volume/clip_planes.c - see clip_planes.h. */
#include "volume/clip_planes.h"

#include <math.h>
#include <string.h>

/* This is a share of the least spacing: a voxel that lies in a plane stays,
 * however the place is rounded, which parts of a volume do differently. */
#define PLANE_TOLERANCE 1e-6

bool snow_is_plane(const double plane[4]) {
    return plane[0] != 0 || plane[1] != 0 || plane[2] != 0 || plane[3] != 0;
}

snow_status snow_planes_check(snow_context *context, const double *planes,
                              size_t count) {
    for (size_t n = 0; n < count; n++) {
        const double *p = planes + 4 * n;
        const bool has_normal = p[0] != 0 || p[1] != 0 || p[2] != 0;
        if (!snow_is_plane(p) ||
            (has_normal && isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) &&
             isfinite(p[3])))
            continue;
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "clip plane %zu is %g %g %g %g; give finite numbers, "
                         "of which the first three, its normal, are not all 0",
                         n, p[0], p[1], p[2], p[3]);
    }
    return SNOW_STATUS_OK;
}

static void to_index(const snow_volume_info *info, const double plane[4],
                     snow_index_plane index) {
    const double *s = info->spacing;
    double least = fmin(fmin(s[0], s[1]), s[2]);
    double length = hypot(hypot(plane[0], plane[1]), plane[2]);
    index[3] = plane[3] + PLANE_TOLERANCE * least * length;
    for (int axis = 0; axis < 3; axis++)
        index[axis] = 0;
    for (int row = 0; row < 3; row++) {
        index[3] -= plane[row] * info->matrix[row][3];
        for (int axis = 0; axis < 3; axis++)
            index[axis] += plane[row] * info->matrix[row][axis];
    }
}

/* The most voxels that a ray of shear-warp moves aside between two sheets
 * (SNOW_VALUE_REACH_MOST). */
#define ASIDE_MOST 24

/* Room for planes; none of them is there yet. */
static snow_status allocate_planes(snow_context *context, size_t planes,
                                   snow_clip_planes **out) {
    snow_clip_planes *clip = snow_allocate_clear(context, sizeof *clip);
    snow_status status = SNOW_STATUS_NO_MEMORY;
    if (clip) {
        clip->context = context;
        status = SNOW_RESERVE(context, clip->planes, 0, planes);
    }
    if (status != SNOW_STATUS_OK) {
        snow_clip_planes_free(clip);
        clip = NULL;
    }
    *out = clip;
    return status;
}

snow_status snow_clip_planes_new(snow_context *context,
                                 const snow_volume_info *info,
                                 const snow_clip_planes *before,
                                 const double *planes, size_t count,
                                 snow_clip_planes **out) {
    size_t most = count + (before ? before->plane_count : 0), used = 0;
    *out = NULL;
    for (size_t n = 0; n < count; n++)
        used += snow_is_plane(planes + 4 * n);
    if (!used && !before)
        return SNOW_STATUS_OK;
    SNOW_TRY(allocate_planes(context, most, out));
    snow_clip_planes *clip = *out;
    /* A ray moves no farther aside between two sheets than slices are apart, in
     * perspective twice as far; values there and gradients look two voxels on.
     */
    const double *s = info->spacing;
    for (int axis = 0; axis < 3; axis++) {
        double ratio = fmax(s[0], fmax(s[1], s[2])) / s[axis];
        clip->reach[axis] = 2 + ceil(2 * fmin(ratio, ASIDE_MOST));
    }
    for (size_t n = 0; before && n < before->plane_count; n++)
        memcpy(clip->planes[clip->plane_count++], before->planes[n],
               sizeof *clip->planes);
    for (size_t n = 0; n < count; n++)
        if (snow_is_plane(planes + 4 * n))
            to_index(info, planes + 4 * n, clip->planes[clip->plane_count++]);
    return SNOW_STATUS_OK;
}

void snow_clip_planes_free(snow_clip_planes *clip) {
    if (!clip)
        return;
    snow_release(clip->context, clip->planes);
    snow_release(clip->context, clip->voxels);
    snow_release(clip->context, clip);
}

snow_status snow_clip_planes_move(const snow_clip_planes *clip,
                                  const int64_t by[3], snow_clip_planes **out) {
    SNOW_TRY(allocate_planes(clip->context, clip->plane_count, out));
    snow_clip_planes *moved = *out;
    memcpy(moved->reach, clip->reach, sizeof moved->reach);
    moved->plane_count = clip->plane_count;
    for (size_t n = 0; n < clip->plane_count; n++) {
        memcpy(moved->planes[n], clip->planes[n], sizeof *moved->planes);
        for (int axis = 0; axis < 3; axis++)
            moved->planes[n][3] -= moved->planes[n][axis] * (double)by[axis];
    }
    return SNOW_STATUS_OK;
}

void snow_clip_planes_show(const snow_clip_planes *clip, snow_type type,
                           bool shown, void *voxels) {
    for (size_t n = 0; n < clip->voxel_count; n++) {
        const snow_clipped_voxel *voxel = &clip->voxels[n];
        double value = shown ? voxel->native : NAN;
        if (type == SNOW_TYPE_FLOAT32)
            ((float *)voxels)[voxel->at] = (float)value;
        else
            ((double *)voxels)[voxel->at] = value;
    }
}

/* Returns whether a voxel is beyond a plane; *reached: it is in reach of all
 * planes that it is beyond. */
static bool is_beyond(const snow_clip_planes *clip, const int64_t at[3],
                      bool *reached) {
    bool beyond = false;
    *reached = true;
    for (size_t n = 0; n < clip->plane_count; n++) {
        const double *p = clip->planes[n];
        double place =
            p[0] * (double)at[0] + p[1] * (double)at[1] + p[2] * (double)at[2];
        if (!(place > p[3]))
            continue;
        beyond = true;
        *reached &= place - p[3] <= clip->reach[0] * fabs(p[0]) +
                                        clip->reach[1] * fabs(p[1]) +
                                        clip->reach[2] * fabs(p[2]);
    }
    return beyond;
}

snow_status snow_clip_planes_apply(snow_clip_planes *clip,
                                   const int64_t dims[3], int64_t first,
                                   size_t count, bool keep, double *stored) {
    int64_t at[3] = {first % dims[0], first / dims[0] % dims[1],
                     first / dims[0] / dims[1]};
    for (size_t i = 0; i < count; i++) {
        bool reached;
        if (is_beyond(clip, at, &reached)) {
            if (keep && reached && !isnan(stored[i])) {
                SNOW_TRY(SNOW_RESERVE(clip->context, clip->voxels,
                                      clip->voxel_count,
                                      clip->voxel_count + 1));
                clip->voxels[clip->voxel_count++] =
                    (snow_clipped_voxel){first + (int64_t)i, stored[i]};
            }
            stored[i] = NAN;
        }
        if (++at[0] < dims[0])
            continue;
        at[0] = 0;
        if (++at[1] < dims[1])
            continue;
        at[1] = 0;
        at[2]++;
    }
    return SNOW_STATUS_OK;
}

double snow_clip_planes_value(const snow_clip_planes *clip, int64_t index) {
    size_t low = 0, high = clip->voxel_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (clip->voxels[middle].at < index)
            low = middle + 1;
        else
            high = middle;
    }
    return low < clip->voxel_count && clip->voxels[low].at == index
               ? clip->voxels[low].native
               : NAN;
}

double snow_clip_planes_value_at(const snow_clip_planes *clip,
                                 const int64_t dims[3], const int64_t at[3]) {
    bool reached;
    if (!is_beyond(clip, at, &reached) || !reached)
        return NAN;
    return snow_clip_planes_value(clip,
                                  (at[2] * dims[1] + at[1]) * dims[0] + at[0]);
}
