/* render/layers.c - further volumes of a picture (snow_frame_set_layers) where
 * the first has its voxels in parts.
 *
 *   first volume    | own slices |g|      g: ghost layers that its look needs
 *   a layer      |gg| own slices |gg|     its own, which may be more
 *
 * A layer in its file is read for the part that is drawn: a rank's, which
 * serves its pictures until another part does, or a slab of a file. */
#include "render/ghosts.h"
#include "render/picture.h"

#include <string.h>

/* What a layer must have stored for the part: its own voxels, with ghosts. */
static snow_status find_box(snow_context *context, const snow_request *r,
                            const snow_volume_info *whole,
                            const snow_layer *layer, snow_extent *part,
                            int64_t count[3]) {
    int64_t layers[3];
    snow_volume_find_extent(r->volume, part);
    SNOW_TRY(snow_ghosts_needed(
        context, whole, r->view, r->settings,
        snow_transfer_slopes(layer->transfer, &layer->volume->info), false,
        layers));
    for (int i = 0; i < 3; i++) {
        const bool none = !part->count[0] || !part->count[1] || !part->count[2];
        const int64_t first = none ? 0 : part->first[i];
        const int64_t end = none ? 1 : first + part->count[i];
        const int64_t above = whole->dims[i] - end;
        part->stored[i] = first > layers[i] && !none ? first - layers[i] : 0;
        count[i] = end - part->stored[i];
        if (!none)
            count[i] += above < layers[i] ? above : layers[i];
    }
    return SNOW_STATUS_OK;
}

/* Returns whether what was taken serves still. */
static bool serves(const snow_layer_file *t, const snow_layer *layer,
                   const snow_volume *part, const snow_extent *wanted,
                   const int64_t count[3]) {
    bool has = t->volume && t->part && t->part == part->generation &&
               t->of == layer->volume->generation;
    for (int i = 0; i < 3 && has; i++) {
        const int64_t skipped = wanted->stored[i] - t->volume->part.stored[i];
        has = skipped >= 0 && skipped + count[i] <= t->volume->info.dims[i];
    }
    return has;
}

static snow_status read_layer(snow_layer_file *t, const snow_layer *layer,
                              const snow_request *r) {
    snow_context *context = r->volume->context;
    const snow_volume *file = layer->volume;
    snow_volume_info whole;
    snow_extent part;
    int64_t count[3];
    snow_volume_whole(r->volume, &whole);
    SNOW_TRY(find_box(context, r, &whole, layer, &part, count));
    if (serves(t, layer, r->volume, &part, count))
        return SNOW_STATUS_OK;
    snow_volume_close(t->volume);
    t->volume = NULL;
    SNOW_TRY(snow_volume_take_box(
        file, &whole, &part, count,
        snow_transfer_has_labels(layer->transfer, &file->info), &t->volume));
    snow_volume_freeze(t->volume);
    t->of = file->generation;
    t->part = r->volume->generation;
    return SNOW_STATUS_OK;
}

snow_status snow_layers_place(snow_frame *frame, const snow_request *request) {
    for (int n = 0; n < request->layer_count; n++) {
        frame->placed[n] = frame->layers[n];
        if (!frame->layers[n].volume->stream)
            continue;
        SNOW_TRY(read_layer(&frame->read[n], &frame->layers[n], request));
        frame->placed[n].volume = frame->read[n].volume;
    }
    return SNOW_STATUS_OK;
}

void snow_layers_drop(snow_frame *frame, int first) {
    for (int n = first; n < SNOW_LAYERS_MAX; n++) {
        snow_volume_close(frame->read[n].volume);
        frame->read[n].volume = NULL;
    }
}

/* --- checks --------------------------------------------------------------- */

/* Returns whether it has what the volume has, of the same whole. */
static bool is_beside(const snow_volume *layer, const snow_volume *volume) {
    snow_volume_info a, b;
    snow_extent own, other;
    snow_volume_whole(layer, &a);
    snow_volume_whole(volume, &b);
    snow_volume_find_extent(layer, &own);
    snow_volume_find_extent(volume, &other);
    return memcmp(a.dims, b.dims, sizeof a.dims) == 0 &&
           memcmp(a.matrix, b.matrix, sizeof a.matrix) == 0 &&
           memcmp(own.first, other.first, sizeof own.first) == 0 &&
           memcmp(own.count, other.count, sizeof own.count) == 0;
}

static snow_status check_layer(const snow_job *job, int n) {
    const snow_layer *layer = &job->layers[n];
    const bool in_file = layer->volume->stream != NULL;
    if (in_file && job->volume->stream)
        return SNOW_STATUS_OK;
    if (job->volume->stream)
        return snow_fail(job->context, SNOW_STATUS_BAD_USAGE,
                         "%s stays in its file, and layer %d is in memory; "
                         "take snow_volume_open_streamed for both",
                         job->volume->path, n + 1);
    if (in_file || !is_beside(layer->volume, job->volume))
        return snow_fail(job->context, SNOW_STATUS_BAD_USAGE,
                         "layer %d is not on the grid of the volume; take "
                         "snow_volume_regrid",
                         n + 1);
    if (!layer->volume->is_part)
        return SNOW_STATUS_OK;
    return snow_ghosts_check(
        job->context, layer->volume, job->view, &job->settings,
        snow_transfer_slopes(layer->transfer, &layer->volume->info));
}

snow_status snow_layers_check(snow_job *job) {
    const snow_settings *s = &job->settings;
    if (!job->layer_count)
        return SNOW_STATUS_OK;
    if (s->mode != SNOW_MODE_OVER || (s->method != SNOW_METHOD_SHEAR_WARP &&
                                      s->method != SNOW_METHOD_RAYCAST))
        return snow_fail(job->context, SNOW_STATUS_BAD_USAGE,
                         "several volumes in one picture need mode over and "
                         "method shear-warp or raycast");
    for (int n = 0; n < job->layer_count; n++) {
        SNOW_TRY(check_layer(job, n));
        if (!job->layers[n].transfer->grey)
            job->channels = 4; /* what any layer colours has colours */
    }
    return SNOW_STATUS_OK;
}
