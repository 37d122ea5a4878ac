/* render/parts.c - see parts.h. */
#include "render/parts.h"

#include "render/ghosts.h"
#include "render/modes/depth.h"

#include <math.h>

/* The own slice along z that the eye is level with, or the one nearest to it.
 */
static int64_t nearest_slice(const snow_job *job) {
    const snow_placement *p = &job->placement;
    const int axes[3] = {p->u_axis, p->v_axis, p->slice_axis};
    snow_extent part;
    double of[4], level = 0;
    snow_volume_find_extent(job->volume, &part);
    const int64_t first = part.first[2], last = first + part.count[2] - 1;
    snow_depth_place(job, of);
    for (int n = 0; n < 3; n++)
        if (axes[n] == 2)
            level = p->perspective ? p->eye.at[n]
                    : of[n] < 0    ? (double)last
                                   : 0;
    level = fmin(floor(level + 0.5), (double)last) - (double)first;
    return level > 0 ? (int64_t)level : 0;
}

/* Bytes that shear-warp encodes a voxel in at most, but for margins:
 * numbers of 2 bytes, packed and as rows, with places and masks; what grows is
 * copied.
 */
#define VALUE_BYTES 8

/* Those of the layers, which are read beside it and perhaps resampled. */
static int64_t layer_bytes(const snow_job *job) {
    int64_t bytes = 0;
    for (int n = 0; n < job->layer_count; n++)
        bytes += VALUE_BYTES +
                 2 * (int64_t)snow_type_size(job->layers[n].volume->info.type);
    return bytes;
}

/* How many times a slab's bytes its samples take: floats of all voxels that
 * footprints are made of; 0: few. */
static int64_t made_of(const snow_job *job) {
    int64_t sample = job->channels * (int64_t)sizeof(float);
    int64_t voxel = (int64_t)snow_type_size(job->volume->info.type);
    if (job->settings.method == SNOW_METHOD_SHEAR_WARP)
        return (VALUE_BYTES + layer_bytes(job)) / voxel;
    if (job->settings.mode == SNOW_MODE_ISO ||
        job->settings.method != SNOW_METHOD_FOOTPRINT)
        return 0;
    return sample > voxel ? sample / voxel : 1;
}

static snow_status open_slabs(snow_parts *parts) {
    const snow_job *job = parts->whole;
    int64_t layers[3];
    if (job->settings.deterministic)
        return snow_fail(
            job->context, SNOW_STATUS_NO_MEMORY,
            "%s: a deterministic picture by method %s needs all voxels in "
            "memory; allow more memory, or render without deterministic",
            job->volume->path, snow_method_name(job->settings.method));
    SNOW_TRY(snow_step(parts->picture->pass->method->begin, parts->picture,
                       parts->whole));
    SNOW_TRY(snow_ghosts_needed(
        job->context, &job->volume->info, job->view, &job->settings,
        snow_transfer_slopes(job->transfer, &job->volume->info), false,
        layers));
    parts->cut = (snow_slab_cut){
        .ghosts = layers[2],
        .made = made_of(job),
        .clipped = job->settings.method == SNOW_METHOD_SHEAR_WARP ||
                   job->settings.method == SNOW_METHOD_RAYCAST,
        .from = nearest_slice(job)};
    if (parts->picture->pass->method->cut)
        parts->picture->pass->method->cut(parts->picture, parts->whole,
                                          &parts->cut);
    snow_slabs_open(job->volume, &parts->cut, &parts->slabs);
    parts->many = true;
    return SNOW_STATUS_OK;
}

snow_status snow_parts_open(snow_parts *parts, snow_picture *p,
                            snow_status status) {
    snow_job *whole = &p->pass->job;
    *parts = (snow_parts){.picture = p, .whole = whole};
    parts->progress = snow_monitor_divide(
        &p->monitor, (double)(p->pass - p->passes), p->pass_count);
    whole->pixels = p->local.pixels;
    whole->depths = p->local.depths;
    return status == SNOW_STATUS_OK && whole->volume && whole->volume->stream
               ? open_slabs(parts)
               : status;
}

/* What was counted of a slab, for the whole. */
static snow_status add_stats(snow_parts *parts) {
    const snow_stats *here = &parts->stats;
    snow_stats *all = parts->whole->stats;
    if (parts->picture->pass->depth)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_method_figures(parts->picture->pass->method, parts->picture,
                                 &parts->slab));
    all->encoding = here->encoding;
    all->encoded |= here->encoded;
    all->interesting += here->interesting;
    all->ea_bytes += here->ea_bytes;
    all->ia_bytes += here->ia_bytes;
    all->pa_bytes += here->pa_bytes;
    all->seconds_classify += here->seconds_classify;
    all->seconds_shade += here->seconds_shade;
    all->seconds_encode += here->seconds_encode;
    all->seconds_splat += here->seconds_splat;
    all->seconds_composite += here->seconds_composite;
    return SNOW_STATUS_OK;
}

/* A slab that was drawn. */
static snow_status end_slab(snow_parts *parts) {
    const snow_render_method *method = parts->picture->pass->method;
    SNOW_TRY(add_stats(parts));
    if (method->keep)
        method->keep(parts->picture, &parts->slab, &parts->slabs);
    return SNOW_STATUS_OK;
}

/* The slab's job is the whole's, of its own voxels. */
static snow_status begin_slab(snow_parts *parts, const snow_volume *volume) {
    const snow_job *whole = parts->whole;
    snow_frame *frame = parts->picture->frame;
    const snow_request request = {.volume = volume,
                                  .transfer = whole->transfer,
                                  .view = whole->view,
                                  .settings = &whole->settings,
                                  .layers = frame->placed,
                                  .layer_count = whole->layer_count};
    snow_status placed = snow_layers_place(frame, &request);
    if (frame->value_path && snow_value_lacks_memory(frame->value_path, placed))
        placed = snow_layers_place(frame, &request);
    SNOW_TRY(placed);
    SNOW_TRY(
        snow_job_begin(whole->context, &request, &parts->stats, &parts->slab));
    parts->slab.channels = whole->channels;
    parts->slab.composite = whole->composite;
    parts->slab.pixels = whole->pixels;
    parts->slab.depths = whole->depths;
    return SNOW_STATUS_OK;
}

static snow_status next_slab(snow_parts *parts, bool *any) {
    const snow_volume *volume;
    if (parts->part)
        SNOW_TRY(end_slab(parts));
    parts->part = &parts->slab;
    snow_value_path *path = parts->picture->frame->value_path;
    snow_status read = snow_slabs_next(&parts->slabs, &volume);
    if (path && snow_value_lacks_memory(path, read))
        read = snow_slabs_next(&parts->slabs, &volume);
    SNOW_TRY(read);
    *any = volume != NULL;
    return volume ? begin_slab(parts, volume) : SNOW_STATUS_OK;
}

snow_job *snow_parts_next(snow_parts *parts, snow_status *status) {
    bool any = false;
    if (!parts->many) {
        bool first = !parts->part;
        parts->part = parts->whole;
        return first ? parts->whole : NULL;
    }
    if (*status == SNOW_STATUS_OK)
        *status = next_slab(parts, &any);
    return *status == SNOW_STATUS_OK && any ? parts->part : NULL;
}

/* Instead of a number of bytes that means nothing to the user. */
static snow_status fail_room(const snow_parts *parts) {
    const snow_job *job = parts->whole;
    char limit[64];
    snow_print_limit(job->context, limit);
    return snow_fail(
        job->context, SNOW_STATUS_NO_MEMORY,
        "%s: slabs of %.1f MiB, with %lld slices of their neighbours, and "
        "their encoding do not fit%s; allow more memory, open a part by --crop "
        "or, where a pixel is several voxels wide, draw a larger picture",
        job->volume->path,
        (double)snow_slab_bytes(job->volume, &parts->cut) / 0x1p20,
        (long long)(2 * parts->cut.ghosts), limit);
}

snow_status snow_parts_close(snow_parts *parts, snow_status status) {
    snow_monitor_whole(&parts->picture->monitor, parts->progress);
    if (!parts->many)
        return status;
    snow_slabs_close(&parts->slabs);
    snow_layers_drop(parts->picture->frame, 0);
    return status == SNOW_STATUS_NO_MEMORY ? fail_room(parts) : status;
}
