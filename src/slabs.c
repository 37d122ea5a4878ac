/* slabs.c - see slabs.h.
 *
 * A slab has as many ghost layers as a part needs (ghosts.h), so that it makes
 * every sample of its own as the whole would, and no other (section 4 of the
 * paper).  Of surfaces the nearest one counts: slabs may come in any order.
 * Depths of over are where opacity passes 1/2, and each slab goes on with the
 * alphas of those in front of it:
 *
 *        eye                 along z; the slab that the eye is level with comes
 *   5  4  3 | 0 | 1  2       first, then those on either side, away from it
 *
 * No ray meets slabs on both sides. */
#include "slabs.h"

#include "classify/fade.h"
#include "depth.h"
#include "frame.h"
#include "ghosts.h"
#include "image/image.h"
#include "volume/stream.h"

#include <math.h>
#include <string.h>

/* A picture in the making. */
typedef struct slabs {
    snow_frame *frame;
    const snow_job *job; /* of the whole */
    snow_settings settings;
    snow_stats stats;  /* of the slabs so far */
    int64_t made;      /* as in snow_slab_cut */
    snow_image *image; /* of surfaces */
    snow_image *depth; /* of what is nearest so far, NaN where nothing is */
    float *alphas;     /* of over */
} slabs;

static snow_status new_depth(const slabs *s, snow_image **out) {
    const snow_view *view = s->job->view;
    SNOW_TRY(
        snow_image_new(s->job->context, view->width, view->height, 1, out));
    for (int64_t n = 0; n < (int64_t)view->width * view->height; n++)
        (*out)->pixels[n] = NAN;
    return SNOW_OK;
}

/* The slice along z that the eye is level with, or the one nearest to it. */
static int64_t nearest_slice(const snow_job *job) {
    const snow_placement *p = &job->placement;
    const int axes[3] = {p->u_axis, p->v_axis, p->slice_axis};
    int64_t last = job->volume->info.dims[2] - 1;
    double of[4], level = 0;
    snow_depth_place(job, of);
    for (int n = 0; n < 3; n++)
        if (axes[n] == 2)
            level = p->perspective ? p->eye.at[n]
                    : of[n] < 0    ? (double)last
                                   : 0;
    return level > 0 ? (int64_t)fmin(floor(level + 0.5), (double)last) : 0;
}

/* Instead of bytes that nobody knows. */
static snow_status fail_room(const slabs *s, const snow_slab_cut *cut) {
    const snow_job *job = s->job;
    char limit[64];
    snow_print_limit(job->context, limit);
    return snow_fail(
        job->context, SNOW_NO_MEMORY,
        "%s: slabs of %.1f MiB, %lld slices of which belong to their "
        "neighbours, and what is made of them have no place%s; allow more "
        "memory, give --crop or, where a pixel is several voxels wide, a "
        "larger --size",
        snow_stream_path(job->volume),
        (double)snow_slab_bytes(job->volume, cut) / 0x1p20,
        (long long)(2 * cut->ghosts), limit);
}

static snow_status visit(slabs *s, snow_slab_fn *render) {
    const snow_job *job = s->job;
    int64_t layers[3];
    SNOW_TRY(snow_ghosts_needed(
        job->context, &job->volume->info, job->view, &s->settings,
        snow_transfer_fades(job->transfer), false, layers));
    const snow_slab_cut cut = {.step = 1,
                               .ghosts = layers[2],
                               .made = s->made,
                               .from = nearest_slice(job)};
    snow_status status = snow_slabs_visit(job->volume, &cut, render, s);
    return status == SNOW_NO_MEMORY ? fail_room(s, &cut) : status;
}

/* What was counted of a slab, for the whole. */
static void add_stats(slabs *s) {
    const snow_stats *here = &s->frame->stats;
    snow_stats *all = &s->stats;
    all->encoding = here->encoding;
    all->method = here->method;
    all->interesting += here->interesting;
    all->ea_bytes += here->ea_bytes;
    all->ia_bytes += here->ia_bytes;
    all->pa_bytes += here->pa_bytes;
    all->seconds_classify += here->seconds_classify;
    all->seconds_shade += here->seconds_shade;
    all->seconds_encode += here->seconds_encode;
    all->seconds_splat += here->seconds_splat;
    all->seconds_composite += here->seconds_composite;
}

/* How many times a slab's bytes its samples take: floats of all voxels. */
static int64_t made_of(const snow_job *job) {
    int64_t sample = job->channels * (int64_t)sizeof(float);
    int64_t voxel = (int64_t)snow_type_size(job->volume->info.type);
    return sample > voxel ? sample / voxel : 1;
}

static snow_status begin_slab(slabs *s, const snow_volume *slab,
                              snow_job *job) {
    return snow_job_begin(s->frame, slab, s->job->transfer, s->job->view,
                          &s->settings, 1, 0, job);
}

/* --- surfaces -------------------------------------------------------------
 */

/* What of a slab's surfaces is in front of those found so far. */
static void take_nearer(slabs *s, const snow_image *image,
                        const snow_image *depth) {
    size_t channels = (size_t)image->channels;
    size_t count = (size_t)image->width * (size_t)image->height;
    for (size_t n = 0; n < count; n++) {
        if (!(depth->pixels[n] < s->depth->pixels[n]) &&
            !(isnan(s->depth->pixels[n]) && !isnan(depth->pixels[n])))
            continue;
        s->depth->pixels[n] = depth->pixels[n];
        memcpy(s->image->pixels + n * channels, image->pixels + n * channels,
               channels * sizeof *image->pixels);
    }
}

/* The frame's depth is the slab's meanwhile. */
static snow_status find_surfaces(const snow_volume *slab, void *user) {
    slabs *s = user;
    snow_job job;
    snow_image *image = NULL;
    SNOW_TRY(begin_slab(s, slab, &job));
    SNOW_TRY(snow_iso_render(s->frame, &job, &image));
    add_stats(s);
    take_nearer(s, image, s->frame->depth);
    snow_image_free(image);
    return SNOW_OK;
}

static snow_status make_surfaces(slabs *s) {
    const snow_view *view = s->job->view;
    SNOW_TRY(snow_image_new(s->job->context, view->width, view->height,
                            s->job->channels, &s->image));
    SNOW_TRY(new_depth(s, &s->depth));
    snow_image_free(s->frame->depth);
    s->frame->depth = NULL;
    SNOW_TRY(new_depth(s, &s->frame->depth));
    return visit(s, find_surfaces);
}

/* As iso.c; slabs have counted. */
static snow_status fill_figures(snow_frame *frame, const snow_job *job) {
    snow_job whole = *job;
    whole.settings.method = SNOW_METHOD_SHEARED;
    SNOW_TRY(snow_job_finish(frame, &whole));
    frame->stats.method = SNOW_METHOD_FOOTPRINT;
    return SNOW_OK;
}

snow_status snow_slabs_iso(snow_frame *frame, snow_job *job, snow_image **out) {
    slabs s = {.frame = frame,
               .job = job,
               .settings = job->settings,
               .stats = frame->stats};
    s.settings.depth = 1;
    s.settings.method = SNOW_METHOD_FOOTPRINT;
    s.settings.deterministic = 0; /* bits do not depend on parts */
    snow_status status = make_surfaces(&s);
    frame->stats = s.stats;
    snow_image_free(frame->depth);
    frame->depth = NULL;
    if (status != SNOW_OK) {
        snow_image_free(s.depth);
        snow_image_free(s.image);
        return status;
    }
    if (job->settings.depth)
        frame->depth = s.depth;
    else
        snow_image_free(s.depth);
    status = fill_figures(frame, job);
    if (status == SNOW_OK)
        *out = s.image;
    else
        snow_image_free(s.image);
    return status;
}

/* --- depths of over -------------------------------------------------------
 */

static snow_status pass_half(const snow_volume *slab, void *user) {
    slabs *s = user;
    snow_job job;
    SNOW_TRY(begin_slab(s, slab, &job));
    SNOW_TRY(snow_depth_behind(s->frame, &job, s->alphas));
    const float *here = s->frame->depth->pixels;
    size_t count = (size_t)s->depth->width * (size_t)s->depth->height;
    for (size_t n = 0; n < count; n++)
        if (!isnan(here[n]))
            s->depth->pixels[n] = here[n];
    return SNOW_OK;
}

static snow_status make_depths(slabs *s) {
    const snow_view *view = s->job->view;
    uint64_t pixels = (uint64_t)view->width * (uint64_t)view->height;
    SNOW_TRY(new_depth(s, &s->depth));
    s->alphas = snow_allocate_array(s->job->context, pixels, sizeof *s->alphas);
    if (!s->alphas)
        return SNOW_NO_MEMORY;
    memset(s->alphas, 0, (size_t)pixels * sizeof *s->alphas);
    return visit(s, pass_half);
}

snow_status snow_slabs_depth(snow_frame *frame, const snow_job *job) {
    slabs s = {.frame = frame, .job = job, .settings = job->settings};
    snow_stats told = frame->stats;
    s.settings.method = SNOW_METHOD_FOOTPRINT;
    s.settings.shade = SNOW_SHADE_NONE;
    s.made = made_of(job);
    s.settings.deterministic = 0;
    snow_status status = make_depths(&s);
    frame->stats = told;
    snow_release(job->context, s.alphas);
    if (status != SNOW_OK) {
        snow_image_free(s.depth);
        return status;
    }
    snow_image_free(frame->depth);
    frame->depth = s.depth;
    return SNOW_OK;
}

/* --- the exact methods ----------------------------------------------------
 */

/* On top of what slabs in front of it have laid. */
static snow_status lay_slab(const snow_volume *slab, void *user) {
    slabs *s = user;
    snow_job job;
    SNOW_TRY(begin_slab(s, slab, &job));
    job.channels = s->job->channels;
    job.lay = s->job->lay;
    job.pixels = s->job->pixels;
    SNOW_TRY(snow_job_render_exact(s->frame, &job));
    SNOW_TRY(snow_job_finish(s->frame, &job));
    add_stats(s);
    return SNOW_OK;
}

snow_status snow_slabs_exact(snow_frame *frame, const snow_job *job) {
    slabs s = {.frame = frame,
               .job = job,
               .settings = job->settings,
               .stats = frame->stats,
               .made = job->settings.method == SNOW_METHOD_FOOTPRINT
                           ? made_of(job)
                           : 0};
    if (job->settings.deterministic)
        return snow_fail(job->context, SNOW_NO_MEMORY,
                         "%s: a deterministic picture by the method %s needs "
                         "all voxels in memory at once; allow more of it, or "
                         "let it not be deterministic",
                         snow_stream_path(job->volume),
                         snow_method_name(job->settings.method));
    snow_status status = visit(&s, lay_slab);
    frame->stats = s.stats;
    return status;
}
