/* render/mipmap.c - see levels.h. */
#include "render/mipmap.h"
#include "base/vec3.h"
#include "classify/gradient_opacity.h"
#include "render/ghosts.h"
#include "render/settings_resolve.h"
#include "transfer/transfer.h"
#include "transform/transform.h"
#include "volume/downsample.h"

#include <math.h>
#include <string.h>

/* An axis of 2^63 voxels has none left after so many. */
#define MIPMAP_LEVELS_MOST 62

/* So that rounding does not decide where a pixel is just two voxels wide. */
#define MARGIN 1e-6

struct snow_mipmap {
    snow_context *context;
    struct {
        uint64_t of; /* serial of what it was made of */
        int lean;
        snow_volume *volume; /* NULL: not made */
    } levels[MIPMAP_LEVELS_MOST];
    snow_downsample_buffers room;
};

void snow_mipmap_free(snow_mipmap *levels) {
    if (!levels)
        return;
    for (int n = 0; n < MIPMAP_LEVELS_MOST; n++)
        snow_volume_close(levels->levels[n].volume);
    snow_release(levels->context, levels->room.block);
    snow_release(levels->context, levels);
}

/* --- the rule ------------------------------------------------------------- */

/* The smallest world length of a pixel's side on the volume, however it is
 * turned about the target. */
static double least_pitch(const snow_volume_info *info,
                          const snow_camera *camera) {
    if (camera->distance == 0)
        return camera->pitch;
    double reach = snow_volume_radius(info) + snow_length(camera->middle);
    return camera->pitch * (camera->distance - reach) / camera->distance;
}

snow_status snow_mipmap_wanted(snow_context *context,
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
            if (count[axis] < SNOW_DOWNSAMPLE_LEAST ||
                pitch < (first ? 2 : 4) * voxel ||
                (!first && voxels <= SNOW_LEVEL_MANY))
                continue;
            count[axis] = (count[axis] + 1) / 2;
            halvings[axis]++;
            any = true;
        }
    }
    return SNOW_STATUS_OK;
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

/* --- making --------------------------------------------------------------- */

static int largest_lod(const int halvings[3]) {
    int most = halvings[0] > halvings[1] ? halvings[0] : halvings[1];
    return most > halvings[2] ? most : halvings[2];
}

/* The axes that are halved for level n.  Voxels become alike: those first that
 * are to be halved most often. */
static void axes_of(int n, const int halvings[3], bool axes[3]) {
    for (int axis = 0; axis < 3; axis++)
        axes[axis] = halvings[axis] >= largest_lod(halvings) - n;
}

snow_volume_info snow_mipmap_info(const snow_volume_info *info,
                                  const int halvings[3]) {
    snow_volume_info level = *info;
    for (int n = 0; n < largest_lod(halvings); n++) {
        bool axes[3];
        axes_of(n, halvings, axes);
        level = snow_downsampled_info(&level, axes);
    }
    return level;
}

void snow_mipmap_layers(const snow_volume_info *info, const int halvings[3],
                        int64_t layers[3]) {
    for (int axis = 0; axis < 3; axis++)
        for (int n = halvings[axis]; n > 0; n--) {
            int64_t dims = info->dims[axis];
            for (int before = 1; before < n; before++)
                dims = (dims + 1) / 2;
            layers[axis] = snow_downsampled_layers(dims, layers[axis]);
        }
}

static bool same_grid(const snow_volume_info *a, const snow_volume_info *b) {
    return a->type == b->type && memcmp(a->dims, b->dims, sizeof a->dims) == 0;
}

/* What is known of a level of `from` before there are voxels.  False where it
 * has none of its own. */
static bool plan_level(const snow_volume *from, bool axes[3],
                       snow_volume_info *whole, snow_extent *part,
                       snow_volume_info *info) {
    int64_t stored[3];
    snow_volume_info before;
    snow_volume_whole(from, &before);
    *whole = snow_downsampled_info(&before, axes);
    bool any = snow_downsampled_part(from, whole->dims, part, stored);
    *info = from->is_part ? snow_volume_info_of_box(whole, part->stored, stored)
                          : *whole;
    return any;
}

/* Describes a level's volume, whose voxels are still to be made. */
static snow_status set_level(snow_volume *level, const snow_volume *from,
                             const snow_volume_info *whole,
                             const snow_extent *part,
                             const snow_volume_info *info) {
    snow_extent before;
    snow_volume_find_extent(from, &before);
    level->info = *info;
    level->is_part = level->knows_origin = false;
    for (int axis = 0; axis < 3; axis++) {
        double step = (double)whole->dims[axis] / (double)before.dims[axis];
        level->fine[axis] =
            step * (from->fine[axis] > 0 ? from->fine[axis] : 1);
    }
    if (!from->is_part)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_volume_set_whole(level, whole));
    return snow_volume_set_extent(level, part);
}

/* Level n, made of `from`, unless it is there. */
static snow_status make_level(snow_mipmap *levels, int n, int lean, int threads,
                              const snow_volume *from, bool axes[3]) {
    snow_volume_info whole, info;
    snow_extent part;
    bool any = plan_level(from, axes, &whole, &part, &info);
    snow_volume **made = &levels->levels[n].volume;
    bool same = *made && same_grid(&info, &(*made)->info);
    if (same && from->generation && levels->levels[n].of == from->generation &&
        levels->levels[n].lean == lean)
        return SNOW_STATUS_OK;
    levels->levels[n].of = 0;
    if (!same) {
        snow_volume_close(*made);
        *made = NULL;
        SNOW_TRY(snow_volume_new(levels->context, &info, made));
    }
    SNOW_TRY(set_level(*made, from, &whole, &part, &info));
    if (any)
        SNOW_TRY(snow_volume_downsample(from, axes, lean, threads,
                                        &levels->room, *made));
    else /* the one voxel that a volume has at least */
        memset((*made)->owned, 0, snow_type_size(info.type));
    levels->levels[n].of = from->generation;
    levels->levels[n].lean = lean;
    return SNOW_STATUS_OK;
}

static snow_status make_mipmap(snow_mipmap *levels, int lean, int threads,
                               const int halvings[3],
                               const snow_volume **level) {
    for (int n = 0; n < largest_lod(halvings); n++) {
        bool axes[3];
        axes_of(n, halvings, axes);
        SNOW_TRY(make_level(levels, n, lean, threads, *level, axes));
        *level = levels->levels[n].volume;
    }
    return SNOW_STATUS_OK;
}

bool snow_mipmap_serve(const snow_settings *s) {
    return s->method == SNOW_METHOD_SHEAR_WARP && !snow_draws_values(s) &&
           s->quality == SNOW_QUALITY_DRAFT && s->mode == SNOW_MODE_OVER &&
           !s->deterministic;
}

snow_status snow_mipmap_select(snow_mipmap **levels, const snow_volume *volume,
                               const snow_transfer *transfer,
                               const snow_view *view,
                               const snow_settings *settings,
                               const snow_volume **level, int halvings[3]) {
    int wanted[3] = {0, 0, 0};
    snow_context *context = volume->context;
    const snow_volume *found = volume;
    snow_volume_info whole;
    snow_volume_whole(volume, &whole);
    /* Voxels that stay in their file are not read for a level. */
    if (snow_mipmap_serve(settings) && !volume->stream &&
        !snow_transfer_has_categories(transfer))
        SNOW_TRY(snow_mipmap_wanted(context, &whole, view, wanted));
    if (largest_lod(wanted)) {
        SNOW_TRY(snow_ghosts_check(context, volume, view, settings,
                                   snow_transfer_has_gradient_opacity(transfer),
                                   wanted));
        if (!*levels) {
            *levels = snow_allocate_clear(context, sizeof **levels);
            if (!*levels)
                return SNOW_STATUS_NO_MEMORY;
            (*levels)->context = context;
        }
        SNOW_TRY(make_mipmap(*levels, lean_of(transfer, &volume->info),
                             settings->threads, wanted, &found));
    }
    memcpy(halvings, wanted, sizeof wanted);
    *level = found;
    return SNOW_STATUS_OK;
}
