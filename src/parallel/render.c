/* parallel/render.c - the combiner of many ranks: one picture by many
 * processors.
 *
 *   every rank             its part  -> local image          (lines 02 to 13)
 *   exchange               local images -> pieces            (14 to 18)
 *   every rank             its piece -> pixels               (the warp)
 *   gather                 pixels -> the picture, on rank 0  (19, 20)
 *
 * What a rank finds wrong by itself is agreed on before anybody waits for a
 * message of it; what all ranks find wrong alike needs no word.
 *
 * A local image by shear-warp along one axis is begun as soon as the
 * picture is, and then drawn while others wait, for messages of the picture
 * before it (pipeline.c).  From then on it needs no volume.  Where its turn
 * comes before all of it is drawn, its parts are sent as they are done:
 *
 *   rank 0   draw 1 | send 1, draw 2 | send 2, draw 0
 *   rank 1   draw 2 | send 2, draw 0 | send 0, draw 1
 *   rank 2   draw 0 | send 0, draw 1 | send 1, draw 2     pieces are numbered
 *                                                         as their ranks are
 *
 * Every rank begins behind its own piece, so that nobody gets all messages at
 * once, and what is drawn last need not be sent.  Other local images are made
 * when it is their picture's turn. */
#include "base/clear.h"
#include "base/fingerprint.h"
#include "parallel/internal.h"
#include "parallel/part.h"
#include "volume/stream_internal.h"

#include <string.h>

/* --- the beginning -------------------------------------------------------- */

/* Returns whether a picture has one pass and one volume, whose method leaves
 * its local image to be drawn, of voxels in memory, and needs no word of
 * others first. Ranks that have failed, or have a new volume alone, may
 * differ: synchronize_all finds out. */
static bool is_ahead(const snow_in_flight *f) {
    const snow_picture *p = &f->picture;
    return p->job.settings.mode == SNOW_MODE_OVER && p->pass_count == 1 &&
           !p->job.layer_count && p->passes[0].method->ahead &&
           !p->job.volume->stream &&
           (p->job.settings.method != SNOW_METHOD_SHEAR_WARP ||
            snow_in_flight_knows_values(f));
}

static bool is_sum(snow_mode mode) {
    return mode != SNOW_MODE_OVER && mode != SNOW_MODE_ISO;
}

/* An image of zeros; one that is there already is cleared. */
static snow_status make_clear(const snow_job *job, snow_image **image) {
    if (!*image)
        SNOW_TRY(snow_image_make(job->context, job->view->width,
                                 job->view->height, job->channels, image));
    return snow_clear(job->context, (*image)->pixels, snow_job_bytes(job));
}

/* What the picture is gathered in; pairs have an image of their own. */
static snow_status make_images(snow_in_flight *f) {
    snow_picture *p = &f->picture;
    snow_context *context = p->frame->context;
    if (f->how.pixel_bits != 0 && f->how.pixel_bits != 8)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "invalid pixel_bits %d: must be 8, or 0 for floats",
                         f->how.pixel_bits);
    if (is_sum(p->job.settings.mode) || !snow_in_flight_keeps(f))
        return SNOW_STATUS_OK;
    SNOW_TRY(make_clear(&p->job, &p->image));
    if (f->how.pixel_bits != 8 || f->how.scattered)
        return SNOW_STATUS_OK;
    const size_t bytes = snow_job_bytes(&p->job) / sizeof(float);
    f->bytes = snow_allocate(context, bytes);
    return f->bytes ? snow_clear(context, f->bytes, bytes)
                    : SNOW_STATUS_NO_MEMORY;
}

static snow_status begin_picture(snow_picture *p, snow_status status) {
    snow_in_flight *f = snow_in_flight_of(p);
    f->generation = p->job.volume->generation;
    f->ranks->apart = false;
    snow_volume_find_extent(p->job.volume, &f->part);
    f->left_out = p->job.volume->left_out;
    const snow_box box = snow_part_box(p->job.volume);
    memcpy(f->part.first, box.first, sizeof box.first);
    memcpy(f->part.count, box.count, sizeof box.count);
    p->ranks_stats.ranks = f->ranks->ranks;
    p->begin_at = f->ranks->begin_at;
    if (status == SNOW_STATUS_OK)
        status = make_images(f);
    p->ahead = is_ahead(f);
    f->drawn_cpu = snow_in_flight_cpu(f);
    if (status == SNOW_STATUS_OK && p->ahead &&
        p->job.settings.method == SNOW_METHOD_SHEAR_WARP)
        status = snow_in_flight_recall_values(f);
    return status;
}

/* --- meeting -------------------------------------------------------------- */

/* Mixes the volumes that are drawn with the first one into a hash; those that
 * stay in their files may be others on other machines. */
static uint64_t mix_layers(uint64_t hash, const snow_frame *frame) {
    for (int n = 0; n < frame->layer_count; n++) {
        const snow_layer *layer = &frame->layers[n];
        const snow_volume *volume = layer->volume;
        const int64_t facts[] = {
            layer->mixes,         (int64_t)volume->info.type,
            volume->info.dims[0], volume->info.dims[1],
            volume->info.dims[2], volume->stream ? volume->stream->print : 0};
        hash = snow_hash_mix(hash, facts, sizeof facts);
    }
    return hash;
}

/* What must be the same on all ranks, as a number. */
static int64_t terms_of(const snow_in_flight *p) {
    const snow_job *job = &p->picture.job;
    const snow_settings *s = &job->settings;
    const snow_placement *place = &job->placement;
    const snow_left_out *left = &p->left_out;
    const int numbers[] = {
        job->channels,      (int)s->method,    (int)s->quality,
        (int)s->kernel,     s->footprint,      (int)s->shade,
        s->deterministic,   place->width,      place->height,
        (int)s->mode,       s->depth,          (int)p->how.combining,
        p->how.radix,       p->how.pixel_bits, place->slice_axis,
        place->perspective, p->how.scattered,  (int)s->light,
        job->layer_count,   left->any};
    const double reals[] = {
        place->back[0],   place->back[1],     place->back[2],
        place->up[0],     place->up[1],       place->up[2],
        place->path,      s->threshold,       s->opacity_length,
        s->iso,           job->view->zoom,    job->view->fov,
        place->origin[0], place->origin[1],   place->eye.at[0],
        place->eye.at[1], place->eye.at[2],   s->ambient,
        s->diffuse,       s->specular,        s->shininess,
        s->light_azimuth, s->light_elevation, s->depth_darkening,
        s->occlusion,     left->low,          left->high};
    uint64_t hash = snow_hash_mix(SNOW_HASH_START, numbers, sizeof numbers);
    hash = snow_hash_mix(hash, reals, sizeof reals);
    hash = mix_layers(hash, p->picture.frame);
    return (int64_t)(hash >> 2);
}

/* Each voxel is one rank's own, of one whole.  All ranks find the same. */
static snow_status check_parts(const snow_ranks *r) {
    uint64_t voxels = 0, all = 1;
    bool same = true;
    for (int rank = 0; rank < r->ranks; rank++) {
        voxels += (uint64_t)snow_box_voxels(&r->boxes[rank]);
        same = same && memcmp(r->parts[rank].dims, r->parts[0].dims,
                              sizeof r->parts[0].dims) == 0;
    }
    if (!same)
        return snow_fail(r->context, SNOW_STATUS_BAD_USAGE,
                         "ranks hold parts of different volumes; open the same "
                         "volume on all ranks");
    for (int axis = 0; axis < 3; axis++)
        all *= (uint64_t)r->parts[0].dims[axis];
    if (voxels == all)
        return SNOW_STATUS_OK;
    return snow_fail(r->context, SNOW_STATUS_BAD_USAGE,
                     "%d parts hold %llu voxels, but the volume has %llu: "
                     "every voxel must belong to exactly one rank",
                     r->ranks, (unsigned long long)voxels,
                     (unsigned long long)all);
}

/* Collective.  Every rank's part to all. */
static snow_status share_parts(snow_ranks *r, const snow_in_flight *p) {
    r->generation = r->ordered = 0;
    SNOW_TRY(snow_comm_allgather(r->comm, &p->part, sizeof p->part, r->parts));
    for (int rank = 0; rank < r->ranks; rank++) {
        const snow_extent *part = &r->parts[rank];
        bool none = !part->count[0] || !part->count[1] || !part->count[2];
        for (int axis = 0; axis < 3; axis++) {
            r->boxes[rank].first[axis] = part->first[axis];
            r->boxes[rank].count[axis] = none ? 0 : part->count[axis];
        }
    }
    SNOW_TRY(check_parts(r));
    r->generation = p->generation;
    return SNOW_STATUS_OK;
}

/* Returns whether this rank knows the parts of a picture. */
static bool knows_parts(const snow_in_flight *p) {
    return p->generation && p->ranks->generation == p->generation;
}

/* Some drew it over a range of values that others have to ask for. */
static snow_status fail_apart(snow_ranks *r) {
    r->apart = true;
    r->values_of = 0;
    return snow_fail(r->context, SNOW_STATUS_BAD_USAGE,
                     "a picture was begun with a new volume on some ranks "
                     "only; begin it again, or give all ranks a new one");
}

/* Collective.  How the ranks' own work went, and what they have counted in the
 * picture before; parts, where one is new. */
static snow_status synchronize_all(snow_in_flight *p, snow_status status,
                                   bool *new_parts) {
    enum { FAILED, NEW, AHEAD, NOT_AHEAD, TERMS, MINUS_TERMS, COUNT };
    snow_ranks *r = p->ranks;
    snow_comm *comm = r->comm;
    const int64_t *counts;
    int64_t words[COUNT + SNOW_COUNTS_MOST] = {
        status != SNOW_STATUS_OK, 1, p->picture.ahead, !p->picture.ahead};
    r->groups = snow_exchange_counts(r->combiner, &counts);
    const size_t count_bytes = (size_t)r->groups * sizeof *counts;
    memcpy(words + COUNT, counts, count_bytes);
    if (status == SNOW_STATUS_OK) {
        words[NEW] = !knows_parts(p);
        words[TERMS] = terms_of(p);
        words[MINUS_TERMS] = -words[TERMS];
    }
    SNOW_TRY(snow_comm_reduce_both(comm, words, COUNT, (size_t)r->groups));
    memcpy(r->group_counts, words + COUNT, count_bytes);
    if (words[FAILED])
        return snow_comm_agree_status(comm, status);
    if (words[AHEAD] && words[NOT_AHEAD])
        return fail_apart(r);
    if (words[TERMS] != -words[MINUS_TERMS])
        return snow_fail(
            r->context, SNOW_STATUS_BAD_USAGE,
            "views, settings or overlays differ between ranks; give all ranks "
            "the same");
    *new_parts = words[NEW] != 0;
    return *new_parts ? share_parts(r, p) : SNOW_STATUS_OK;
}

static snow_status synchronize(snow_picture *p, snow_status status) {
    snow_in_flight *f = snow_in_flight_of(p);
    bool new_parts;
    SNOW_TRY(synchronize_all(f, status, &new_parts));
    if (p->job.settings.mode != SNOW_MODE_OVER)
        SNOW_TRY(snow_in_flight_agree_range(f));
    return p->job.settings.method == SNOW_METHOD_SHEAR_WARP
               ? snow_in_flight_agree_values(f)
               : SNOW_STATUS_OK;
}

/* --- places --------------------------------------------------------------- */

/* A layer, or in deterministic pictures of the footprint methods one for each
 * node. */
static snow_status place_layers(snow_in_flight *f) {
    const snow_job *job = &f->picture.pass->job;
    snow_local_image *local = &f->picture.local;
    local->layers = 1;
    if (job->settings.deterministic)
        local->layers =
            snow_group_nodes(job->placement.slices, job->slab, local->nodes);
    if (local->layers < 0)
        return snow_fail(job->context, SNOW_STATUS_BAD_USAGE,
                         "parts of a deterministic picture must begin and end "
                         "at multiples of %d groups of slices",
                         SNOW_GROUPS);
    return snow_in_flight_capacity(f, job, local->layers);
}

static snow_status place_volume(snow_picture *p, snow_status status) {
    snow_in_flight *f = snow_in_flight_of(p);
    const snow_job *job = &p->pass->job;
    f->drawn_cpu = snow_in_flight_cpu(f);
    if (p->pass->depth)
        return snow_in_flight_take_turn(f, status);
    SNOW_TRY(status);
    /* Where pixels come together that are not the picture yet. */
    if (snow_in_flight_keeps(f) && is_sum(job->settings.mode))
        SNOW_TRY(make_clear(job, &f->gathered));
    if (p->pass->method->warps)
        return SNOW_STATUS_OK;
    SNOW_TRY(place_layers(f));
    if (!job->settings.depth || job->settings.mode != SNOW_MODE_ISO)
        return SNOW_STATUS_OK;
    return snow_picture_new_depths(p, &p->near);
}

/* --- combination ---------------------------------------------------------- */

/* Collective.  Of a picture whose local image was begun: what it needs is
 * prepared before the ranks meet, where this one knows all parts. */
static snow_status synchronize_ahead(snow_in_flight *f, const snow_job *job,
                                     snow_status status) {
    bool known = knows_parts(f), new_parts;
    if (f->picture.drawing && job->settings.deterministic)
        snow_ranks_drain(f->ranks);
    if (status == SNOW_STATUS_OK && known)
        status = snow_in_flight_prepare(f, job);
    SNOW_TRY(synchronize_all(f, status, &new_parts));
    return new_parts ? snow_comm_agree_status(f->ranks->comm,
                                              snow_in_flight_prepare(f, job))
                     : SNOW_STATUS_OK;
}

/* Local work: the rest of the local image. */
static snow_status end_local(snow_in_flight *f, const snow_job *job) {
    snow_picture *p = &f->picture;
    if (p->drawing) {
        double mark = snow_ranks_clock(f->ranks);
        snow_line_batch_end(p->drawing);
        p->drawing = NULL;
        p->stats.seconds_splat += snow_ranks_clock(f->ranks) - mark;
    }
    p->ranks_stats.cpu_splat += snow_in_flight_cpu(f) - f->drawn_cpu;
    SNOW_TRY(snow_monitor_status(&p->monitor));
    return snow_in_flight_prepare(f, job);
}

static snow_status combine(snow_picture *p, const snow_job *job,
                           snow_status status) {
    snow_in_flight *f = snow_in_flight_of(p);
    if (p->pass->depth)
        return snow_in_flight_give_turn(f, status);
    if (p->ahead)
        SNOW_TRY(synchronize_ahead(f, job, status));
    else {
        if (status == SNOW_STATUS_OK)
            status = end_local(f, job);
        SNOW_TRY(snow_comm_agree_status(f->ranks->comm, status));
    }
    return snow_in_flight_exchange(f, job);
}

/* --- the picture ---------------------------------------------------------- */

static snow_status display(snow_picture *p, snow_status status) {
    snow_in_flight *f = snow_in_flight_of(p);
    const snow_job *job = &p->pass->job;
    bool whole = !is_sum(job->settings.mode);
    SNOW_TRY(status);
    if (p->pass->depth)
        return snow_in_flight_combine_depths(f);
    SNOW_TRY(snow_in_flight_deliver(f, job, whole ? f->how.pixel_bits : 0,
                                    whole ? p->image : f->gathered));
    if (is_sum(job->settings.mode))
        return snow_comm_agree_status(f->ranks->comm, snow_in_flight_paint(f));
    return p->near ? snow_in_flight_combine_depths(f) : SNOW_STATUS_OK;
}

static snow_status agree(snow_picture *p, snow_status status) {
    return snow_comm_agree_status(snow_in_flight_of(p)->ranks->comm, status);
}

static snow_status reduce(snow_picture *p, int64_t *values, size_t count,
                          snow_reduce by) {
    return snow_comm_reduce_ints(snow_in_flight_of(p)->ranks->comm, values,
                                 count, by);
}

const snow_combine_ops snow_combine_ranks = {.begin = begin_picture,
                                             .synchronize = synchronize,
                                             .place = place_volume,
                                             .combine = combine,
                                             .display = display,
                                             .agree = agree,
                                             .reduce = reduce};
