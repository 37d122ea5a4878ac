/* levels.c - see levels.h. */
#include "levels.h"
#include "base/vec3.h"
#include "classify/transfer.h"
#include "transform/transform.h"
#include "volume/halve.h"

#include <math.h>
#include <string.h>

/* An axis of 2^63 voxels has none left after so many. */
#define LEVELS_MOST 62

/* So that rounding does not decide where a pixel is just two voxels wide. */
#define MARGIN 1e-6

struct snow_levels {
    snow_context *context;
    struct {
        uint64_t of; /* serial of what it was made of */
        int lean;
        snow_volume *volume; /* NULL: not made */
    } levels[LEVELS_MOST];
    snow_halve_room room;
};

void snow_levels_free(snow_levels *levels) {
    if (!levels)
        return;
    for (int n = 0; n < LEVELS_MOST; n++)
        snow_volume_close(levels->levels[n].volume);
    snow_release(levels->context, levels->room.block);
    snow_release(levels->context, levels);
}

/* --- the rule ---------------------------------------------------------------
 */

/* The smallest world length of a pixel's side on the volume, however it is
 * turned about the target. */
static double least_pitch(const snow_volume_info *info,
                          const snow_camera *camera) {
    if (camera->distance == 0)
        return camera->pitch;
    double reach = snow_volume_radius(info) + snow_length(camera->middle);
    return camera->pitch * (camera->distance - reach) / camera->distance;
}

snow_status snow_levels_wanted(snow_context *context,
                               const snow_volume_info *info,
                               const snow_view *view, int halvings[3]) {
    snow_camera camera;
    SNOW_TRY(snow_camera_make(context, info, view, &camera));
    double pitch = least_pitch(info, &camera) * (1 + MARGIN);
    int64_t count[3];
    bool any = true;
    memcpy(count, info->dims, sizeof count);
    memset(halvings, 0, 3 * sizeof *halvings);
    while (any) {
        double voxels = (double)count[0] * (double)count[1] * (double)count[2];
        any = false;
        for (int axis = 0; axis < 3; axis++) {
            double voxel = info->spacing[axis] * exp2(halvings[axis]);
            bool first = halvings[axis] == 0;
            if (count[axis] < SNOW_HALVE_LEAST ||
                pitch < (first ? 2 : 4) * voxel ||
                (!first && voxels <= SNOW_LEVEL_MANY))
                continue;
            count[axis] = (count[axis] + 1) / 2;
            halvings[axis]++;
            any = true;
        }
    }
    return SNOW_OK;
}

/* Whether colours have steps, as those of categories have. */
static bool has_categories(const snow_transfer *transfer) {
    const snow_color_point *c = transfer->colors;
    for (size_t n = 1; n < transfer->color_count; n++)
        if (c[n].value == c[n - 1].value &&
            (c[n].red != c[n - 1].red || c[n].green != c[n - 1].green ||
             c[n].blue != c[n - 1].blue))
            return true;
    return false;
}

/* Values lean to where opacities rise, all in all; to neither side where they
 * rise and fall. */
static int lean_of(const snow_transfer *transfer,
                   const snow_volume_info *info) {
    double up = 0, down = 0;
    for (size_t n = 1; n < transfer->opacity_count; n++) {
        double rise =
            transfer->opacities[n].opacity - transfer->opacities[n - 1].opacity;
        up += fmax(rise, 0);
        down += fmax(-rise, 0);
    }
    int lean = (up > 2 * down) - (down > 2 * up);
    return info->slope < 0 ? -lean : lean;
}

/* --- making -----------------------------------------------------------------
 */

static bool same_grid(const snow_volume_info *a, const snow_volume_info *b) {
    return a->type == b->type && memcmp(a->dims, b->dims, sizeof a->dims) == 0;
}

/* Level n, made of `from`, unless it is there. */
static snow_status make_level(snow_levels *levels, int n, int lean, int threads,
                              const snow_volume *from, const bool wanted[3]) {
    bool axes[3] = {wanted[0], wanted[1], wanted[2]};
    snow_volume_info info = snow_halved_info(&from->info, axes);
    snow_volume **made = &levels->levels[n].volume;
    bool same = *made && same_grid(&info, &(*made)->info);
    if (same && from->serial && levels->levels[n].of == from->serial &&
        levels->levels[n].lean == lean)
        return SNOW_OK;
    levels->levels[n].of = 0;
    if (!same) {
        snow_volume_close(*made);
        *made = NULL;
        SNOW_TRY(snow_volume_new(levels->context, &info, made));
    }
    (*made)->info = info;
    for (int axis = 0; axis < 3; axis++) {
        double step = (double)info.dims[axis] / (double)from->info.dims[axis];
        (*made)->fine[axis] =
            step * (from->fine[axis] > 0 ? from->fine[axis] : 1);
    }
    SNOW_TRY(
        snow_volume_halve(from, axes, lean, threads, &levels->room, *made));
    levels->levels[n].of = from->serial;
    levels->levels[n].lean = lean;
    return SNOW_OK;
}

/* Axes are halved in such an order that voxels become alike: those first that
 * are to be halved most often. */
static snow_status make_levels(snow_levels *levels, int lean, int threads,
                               const int halvings[3],
                               const snow_volume **level) {
    int most = 0;
    for (int axis = 0; axis < 3; axis++)
        most = halvings[axis] > most ? halvings[axis] : most;
    for (int n = 0; n < most; n++) {
        const bool axes[3] = {halvings[0] >= most - n, halvings[1] >= most - n,
                              halvings[2] >= most - n};
        SNOW_TRY(make_level(levels, n, lean, threads, *level, axes));
        *level = levels->levels[n].volume;
    }
    return SNOW_OK;
}

/* Voxels that stay in their file are not read for a level. */
static bool are_for(const snow_volume *volume, const snow_transfer *transfer,
                    const snow_settings *s) {
    return s->method == SNOW_METHOD_SHEARED &&
           s->quality == SNOW_QUALITY_DRAFT && s->mode == SNOW_MODE_OVER &&
           !s->deterministic && !volume->is_part && !volume->stream &&
           !has_categories(transfer);
}

snow_status snow_levels_take(snow_levels **levels, const snow_volume *volume,
                             const snow_transfer *transfer,
                             const snow_view *view,
                             const snow_settings *settings,
                             const snow_volume **level, int halvings[3]) {
    int wanted[3] = {0, 0, 0};
    snow_context *context = volume->context;
    const snow_volume *found = volume;
    if (are_for(volume, transfer, settings))
        SNOW_TRY(snow_levels_wanted(context, &volume->info, view, wanted));
    if (wanted[0] || wanted[1] || wanted[2]) {
        if (!*levels) {
            *levels = snow_allocate_clear(context, sizeof **levels);
            if (!*levels)
                return SNOW_NO_MEMORY;
            (*levels)->context = context;
        }
        SNOW_TRY(make_levels(*levels, lean_of(transfer, &volume->info),
                             settings->threads, wanted, &found));
    }
    memcpy(halvings, wanted, sizeof wanted);
    *level = found;
    return SNOW_OK;
}
