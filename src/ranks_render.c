/* ranks_render.c - one picture by many processors: figure 8 of the paper with
 * its lines 14 to 20, for any boxes in the place of slabs.
 *
 *   every rank             its part  -> local image          (lines 02 to 13)
 *   exchange               local images -> pieces            (14 to 18)
 *   every rank             its piece -> pixels               (the warp)
 *   gather                 pixels -> the picture, on rank 0  (19, 20)
 *
 * What a rank finds wrong by itself is agreed on before anybody waits for a
 * message of it; what all ranks find wrong alike needs no word.
 *
 * A local image by the sheared method along one axis is begun as soon as the
 * picture is, and then drawn while others wait, for messages of the picture
 * before it (ranks_flight.c).  From then on it needs no volume.  Where its turn
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
#include "ranks_parts.h"

#include "decompose/order.h"
#include "image/image.h"
#include "volume/volume.h"

#include <string.h>

/* --- the beginning --------------------------------------------------------
 */

/* The volume's level where the picture is of one (levels.h).  Its settings are
 * the volume's. */
static snow_status take_level(snow_picture *p, const snow_transfer *transfer,
                              snow_settings *settings,
                              const snow_volume **volume, int halvings[3]) {
    SNOW_TRY(
        snow_settings_resolve(p->frame->context, &(*volume)->info, settings));
    return snow_levels_take(&p->frame->levels, *volume, transfer, &p->view,
                            settings, volume, halvings);
}

/* What the beginning of a job counts is this picture's. */
static snow_status begin_job(snow_picture *p, const snow_volume *volume,
                             const snow_transfer *transfer,
                             const snow_settings *settings) {
    snow_stats last = p->frame->stats;
    snow_status status = snow_job_begin(p->frame, volume, transfer, &p->view,
                                        settings, 1, 0, &p->job);
    p->stats = p->frame->stats;
    p->stats.ranks = p->ranks->ranks;
    p->job.stats = &p->stats;
    p->frame->stats = last;
    return status;
}

static snow_status begin_picture(snow_picture *p, const snow_volume *volume,
                                 const snow_transfer *transfer,
                                 const snow_settings *settings) {
    snow_context *context = p->frame->context;
    if (p->how.pixel_bits != 0 && p->how.pixel_bits != 8)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "pixels of %d bits cannot travel; take 8, or 0 for "
                         "floats",
                         p->how.pixel_bits);
    SNOW_TRY(begin_job(p, volume, transfer, settings));
    SNOW_TRY(snow_picture_check_mode(p));
    if (p->job.settings.mode != SNOW_MODE_OVER &&
        p->job.settings.mode != SNOW_MODE_ISO)
        return SNOW_OK; /* made of what has been gathered */
    if (p->ranks->rank != 0 && !p->how.scattered)
        return SNOW_OK;
    SNOW_TRY(snow_image_new(context, p->view.width, p->view.height,
                            p->job.channels, &p->image));
    if (p->how.pixel_bits != 8 || p->how.scattered)
        return SNOW_OK;
    size_t bytes = (size_t)p->view.width * (size_t)p->view.height *
                   (size_t)p->job.channels;
    p->bytes = snow_allocate_clear(context, bytes);
    return p->bytes ? SNOW_OK : SNOW_NO_MEMORY;
}

/* The one axis that a picture of the sheared method is made along; -1 where it
 * is blended of several, or made by another method.  The same on all ranks. */
static int axis_alone(const snow_picture *p) {
    int axis = p->job.placement.slice_axis;
    double shares[3];
    if (p->job.settings.method != SNOW_METHOD_SHEARED ||
        p->job.settings.mode != SNOW_MODE_OVER || p->job.settings.depth ||
        snow_job_shares(&p->job, shares) != SNOW_OK)
        return -1;
    return shares[axis] < 1 ? -1 : axis;
}

/* Local work: begins this rank's intermediate image. */
static snow_status begin_axis(snow_picture *p, int axis, bool aside,
                              snow_axis_work *work) {
    bool high = p->job.settings.quality == SNOW_QUALITY_HIGH;
    snow_sheared **sheared = &p->frame->sheared[high ? axis : 0];
    SNOW_TRY(snow_job_order(&p->job, axis, &work->placement, &work->order));
    work->order.begin_at = p->ranks->begin_at;
    if (p->job.settings.deterministic && work->order.clip.cuts)
        return snow_fail(p->job.context, SNOW_BAD_USAGE,
                         "deterministic pictures are not blended of several "
                         "axes by many ranks; take quality normal");
    if (!*sheared)
        SNOW_TRY(snow_sheared_new(p->job.context, sheared));
    work->sheared = *sheared;
    return snow_sheared_begin(*sheared, &work->order, aside, &p->stats,
                              &work->image);
}

/* What is counted is counted now, while there is a volume. */
static snow_status begin_ahead(snow_picture *p, int axis, bool aside) {
    double cpu = snow_picture_cpu(p);
    SNOW_TRY(begin_axis(p, axis, aside, &p->work));
    p->stats.cpu_splat += snow_picture_cpu(p) - cpu;
    p->drawing = true;
    return snow_job_finish(p->frame, &p->job);
}

void snow_picture_fail(snow_picture *p, snow_status status) {
    p->status = status;
    if (status != SNOW_OK)
        memcpy(p->message, p->frame->context->message, sizeof p->message);
}

void snow_picture_begin(snow_picture *p, const snow_volume *volume,
                        const snow_transfer *transfer,
                        const snow_settings *settings, bool aside) {
    snow_settings own = snow_settings_known(settings);
    int halvings[3] = {0, 0, 0};
    snow_picture_fail(p, take_level(p, transfer, &own, &volume, halvings));
    p->serial = volume->serial;
    snow_volume_get_part(volume, &p->part);
    /* Also where there is no level: all ranks begin in the same way. */
    snow_status status = begin_picture(p, volume, transfer, &own);
    memcpy(p->stats.halvings, halvings, sizeof halvings);
    int axis = axis_alone(p);
    p->ahead = axis >= 0;
    if (p->status == SNOW_OK && status == SNOW_OK && p->ahead)
        status = begin_ahead(p, axis, aside);
    if (p->status == SNOW_OK)
        snow_picture_fail(p, status);
}

/* --- meeting --------------------------------------------------------------
 */

/* Mixes bytes into a number of 62 bits (Fowler, Noll and Vo's hash). */
static void mix(uint64_t *hash, const void *bytes, size_t count) {
    const unsigned char *at = bytes;
    for (size_t n = 0; n < count; n++)
        *hash = (*hash ^ at[n]) * UINT64_C(1099511628211);
}

/* What must be the same on all ranks, as a number. */
static int64_t terms_of(const snow_picture *p) {
    const snow_job *job = &p->job;
    const snow_settings *s = &job->settings;
    const snow_placement *place = &job->placement;
    const int numbers[] = {
        job->channels,      (int)s->method,    (int)s->quality,
        (int)s->kernel,     s->footprint,      (int)s->shade,
        s->deterministic,   place->width,      place->height,
        (int)s->mode,       s->depth,          (int)p->how.combining,
        p->how.radix,       p->how.pixel_bits, place->slice_axis,
        place->perspective, p->how.scattered};
    const double reals[] = {
        place->back[0],    place->back[1],   place->back[2],   place->up[0],
        place->up[1],      place->up[2],     place->path,      s->threshold,
        s->opacity_length, s->iso,           job->view->zoom,  job->view->fov,
        place->origin[0],  place->origin[1], place->eye.at[0], place->eye.at[1],
        place->eye.at[2]};
    uint64_t hash = UINT64_C(14695981039346656037);
    mix(&hash, numbers, sizeof numbers);
    mix(&hash, reals, sizeof reals);
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
        return snow_fail(r->context, SNOW_BAD_USAGE,
                         "ranks have parts of different volumes");
    for (int axis = 0; axis < 3; axis++)
        all *= (uint64_t)r->parts[0].dims[axis];
    if (voxels == all)
        return SNOW_OK;
    return snow_fail(r->context, SNOW_BAD_USAGE,
                     "%d parts of %llu voxels do not make up a volume of "
                     "%llu; let each voxel be one rank's own",
                     r->ranks, (unsigned long long)voxels,
                     (unsigned long long)all);
}

/* Collective.  Every rank's part to all. */
static snow_status share_parts(snow_ranks *r, const snow_picture *p) {
    r->serial = 0;
    SNOW_TRY(snow_comm_share(r->comm, &p->part, sizeof p->part, r->parts));
    for (int rank = 0; rank < r->ranks; rank++) {
        const snow_part *part = &r->parts[rank];
        bool none = !part->count[0] || !part->count[1] || !part->count[2];
        for (int axis = 0; axis < 3; axis++) {
            r->boxes[rank].first[axis] = part->first[axis];
            r->boxes[rank].count[axis] = none ? 0 : part->count[axis];
        }
    }
    SNOW_TRY(check_parts(r));
    r->serial = p->serial;
    return SNOW_OK;
}

/* Whether this rank knows the parts of a picture. */
static bool knows_parts(const snow_picture *p) {
    return p->serial && p->ranks->serial == p->serial;
}

/* Collective.  How the ranks' own work went, and what they have counted in the
 * picture before; parts, where one is new. */
static snow_status meet(snow_picture *p, snow_status status, bool *new_parts) {
    enum { FAILED, NEW, TERMS, MINUS_TERMS, COUNT };
    snow_ranks *r = p->ranks;
    snow_comm *comm = r->comm;
    const int64_t *counts;
    int64_t words[COUNT + SNOW_COUNTS_MOST] = {status != SNOW_OK, 1, 0, 0};
    r->groups = snow_exchange_counts(r->combiner, &counts);
    const size_t count_bytes = (size_t)r->groups * sizeof *counts;
    memcpy(words + COUNT, counts, count_bytes);
    if (status == SNOW_OK) {
        words[NEW] = !knows_parts(p);
        words[TERMS] = terms_of(p);
        words[MINUS_TERMS] = -words[TERMS];
    }
    SNOW_TRY(snow_comm_reduce_both(comm, words, COUNT, (size_t)r->groups));
    memcpy(r->group_counts, words + COUNT, count_bytes);
    if (words[FAILED])
        return snow_comm_agree(comm, status);
    if (words[TERMS] != -words[MINUS_TERMS])
        return snow_fail(p->job.context, SNOW_BAD_USAGE,
                         "ranks were asked for different pictures; give all "
                         "the same view and settings");
    *new_parts = words[NEW] != 0;
    return *new_parts ? share_parts(p->ranks, p) : SNOW_OK;
}

/* --- the local image ------------------------------------------------------
 */

/* Tiles of tile lines y0 .. y1 - 1 of a layer that were drawn on, as pixels;
 * what else lies among them is cleared. */
static snow_rectangle drawn_part(const snow_sheared_image *image, int layer,
                                 int y0, int y1) {
    const unsigned char *drawn =
        image->drawn + (size_t)layer * image->layer_tiles;
    snow_rectangle box = {image->tiles, INT32_MAX, 0, 0};
    for (int n = y0 * image->tiles; n < y1 * image->tiles; n++) {
        int x = n % image->tiles, y = n / image->tiles;
        if (!drawn[n])
            continue;
        box.x0 = x < box.x0 ? x : box.x0;
        box.y0 = y < box.y0 ? y : box.y0;
        box.x1 = x + 1 > box.x1 ? x + 1 : box.x1;
        box.y1 = y + 1;
    }
    if (box.x0 >= box.x1)
        return (snow_rectangle){0, 0, 0, 0};
    snow_sheared_clear(image, layer, box.x0, box.y0, box.x1, box.y1);
    box.x0 *= image->tile_width;
    box.x1 *= image->tile_width;
    box.y0 *= image->tile_height;
    box.y1 *= image->tile_height;
    box.x1 = box.x1 < image->width ? box.x1 : image->width;
    box.y1 = box.y1 < image->height ? box.y1 : image->height;
    return box;
}

/* While it is exchanged (snow_unfinished). */
static bool draw_band(void *of) {
    const snow_picture *p = of;
    return snow_ranks_draw(p->ranks);
}

static bool look_at_lines(void *of, int y0, int y1, snow_rectangle *drawn) {
    const snow_picture *p = of;
    const snow_sheared_image *image = &p->work.image;
    int first = y0 / image->tile_height,
        end = (y1 - 1) / image->tile_height + 1;
    if (p->drawing && !snow_sheared_drawn(p->work.sheared, first, end))
        return false;
    snow_ranks_pause(p->ranks);
    *drawn = drawn_part(image, 0, first, end);
    return true;
}

static void end_drawing(void *of) {
    const snow_picture *p = of;
    snow_ranks_settle(p->ranks);
}

/* --- the exchange ---------------------------------------------------------
 */

/* Local work: which rank is before which, and room. */
static snow_status prepare_exchange(snow_picture *p, const snow_local *local,
                                    const snow_placement *placement) {
    snow_sight sight;
    if (p->job.settings.deterministic)
        return snow_layers_prepare(p->ranks, local, placement);
    snow_clip_sight(placement, &sight);
    return snow_order_boxes(p->job.context, p->ranks->boxes, p->ranks->ranks,
                            &sight, p->ranks->order);
}

static void tell_rounds(snow_picture *p, const snow_exchange_figures *told) {
    snow_stats *stats = &p->stats;
    const int most = (int)(sizeof stats->radices / sizeof *stats->radices);
    stats->rounds = told->rounds;
    for (int i = 0; i < told->rounds && i < most; i++)
        stats->radices[i] = told->radices[i];
    stats->active_pixels = told->active;
    stats->bytes_early = (uint64_t)told->early;
    p->ranks->begin_at = told->begin_at;
}

/* Collective.  Local images to pieces, of `grain` pixels or multiples. */
static snow_status exchange(snow_picture *p, const snow_local *local,
                            const snow_placement *placement, int grain,
                            snow_piece *piece) {
    snow_ranks *r = p->ranks;
    const snow_unfinished unfinished = {draw_band, look_at_lines, end_drawing,
                                        p};
    if (p->job.settings.deterministic)
        return snow_layers_exchange(r, local, placement, piece);
    const snow_exchange_order order = {
        .width = local->width,
        .height = local->height,
        .channels = local->channels,
        .pixels = local->pixels,
        .stride = local->stride,
        .drawn = local->drawn[0],
        .ranks = r->order,
        .method = p->how.combining,
        .radix = p->how.radix,
        .laying = local->laying,
        .grain = grain,
        .counts = p->ahead ? r->group_counts : NULL,
        .count_groups = r->groups,
        .unfinished = p->drawing ? &unfinished : NULL};
    SNOW_TRY(snow_exchange(r->combiner, &order, piece));
    tell_rounds(p, snow_exchange_told(r->combiner));
    snow_exchange_pieces(r->combiner, r->firsts, r->counts);
    return SNOW_OK;
}

/* This rank's pixels to their places in its own image. */
static void keep_pixels(const snow_picture *p, int pixel_bits,
                        snow_image *image) {
    const snow_ranks *r = p->ranks;
    size_t channels = (size_t)image->channels, at = 0;
    for (size_t n = 0; n < r->run_count; n++) {
        const snow_pixel_run *run = &r->runs[n];
        size_t count = (size_t)run->count * channels;
        float *out =
            image->pixels +
            ((size_t)run->y * (size_t)image->width + (size_t)run->x) * channels;
        if (pixel_bits != 8)
            memcpy(out, r->packed + at * sizeof *out, count * sizeof *out);
        for (size_t i = 0; pixel_bits == 8 && i < count; i++)
            out[i] = (float)r->packed[at + i] / 255;
        at += count;
    }
}

static snow_status deliver(snow_picture *p, int pixel_bits, snow_image *image) {
    if (p->how.scattered) {
        keep_pixels(p, pixel_bits, image);
        return SNOW_OK;
    }
    const snow_delivery delivery = {pixel_bits, image, p->bytes, &p->stats};
    double cpu = snow_picture_cpu(p);
    snow_status status = snow_pixels_gather(p->ranks, &p->job, &delivery);
    p->stats.cpu_gather += snow_picture_cpu(p) - cpu;
    return status;
}

/* --- the sheared method ---------------------------------------------------
 */

/* What was drawn is told where that is over. */
static snow_local local_of(const snow_sheared_image *image, bool drawing) {
    snow_local local = {.width = image->width,
                        .height = image->height,
                        .channels = image->channels,
                        .stride = image->stride,
                        .pixels = image->pixels,
                        .layers = image->layers,
                        .layer_floats = image->layer_floats};
    memcpy(local.nodes, image->nodes, sizeof local.nodes);
    for (int n = 0; image->width && n < image->layers && !drawing; n++)
        local.drawn[n] =
            drawn_part(image, n, 0, (int)image->layer_tiles / image->tiles);
    return local;
}

snow_status snow_picture_prepare(snow_picture *p, snow_axis_work *work) {
    snow_laying laying = work->local.laying;
    if (!work->image.width)
        return SNOW_OK;
    work->local = local_of(&work->image, p->drawing);
    work->local.laying = laying;
    SNOW_TRY(snow_lines_prepare(p->ranks, &work->local));
    return prepare_exchange(p, &work->local, &work->placement);
}

snow_status snow_picture_combine_axis(snow_picture *p,
                                      const snow_axis_work *work,
                                      int pixel_bits, snow_image *image) {
    snow_ranks *r = p->ranks;
    snow_piece piece;
    if (!work->image.width) /* the same on all ranks */
        return SNOW_OK;
    double mark = snow_ranks_clock(r), cpu = snow_picture_cpu(p);
    SNOW_TRY(
        exchange(p, &work->local, &work->placement, work->image.width, &piece));
    SNOW_TRY(snow_lines_exchange(r, &work->image, &piece));
    double combined = snow_ranks_clock(r), combined_cpu = snow_picture_cpu(p);
    p->stats.seconds_combine += combined - mark;
    p->stats.cpu_combine += combined_cpu - cpu;
    snow_status status =
        snow_pixels_warp(r, &work->image, &p->job, &piece, pixel_bits);
    p->stats.seconds_warp += snow_ranks_clock(r) - combined;
    p->stats.cpu_warp += snow_picture_cpu(p) - combined_cpu;
    SNOW_TRY(snow_comm_agree(r->comm, status));
    return deliver(p, pixel_bits, image);
}

/* Collective.  Of a picture whose local image was begun. */
static snow_status render_ahead(snow_picture *p, snow_status status) {
    bool known = knows_parts(p), new_parts;
    if (status == SNOW_OK && known)
        status = snow_picture_prepare(p, &p->work);
    SNOW_TRY(meet(p, status, &new_parts));
    if (new_parts)
        SNOW_TRY(
            snow_comm_agree(p->ranks->comm, snow_picture_prepare(p, &p->work)));
    return snow_picture_combine_axis(p, &p->work, p->how.pixel_bits, p->image);
}

/* Collective.  The picture with slices along one axis of several. */
static snow_status render_axis(snow_picture *p, int axis, snow_image *image) {
    double cpu = snow_picture_cpu(p);
    snow_status status = begin_axis(p, axis, false, &p->work);
    if (status == SNOW_OK) {
        double mark = snow_ranks_clock(p->ranks);
        snow_sheared_end(p->work.sheared);
        p->stats.seconds_splat += snow_ranks_clock(p->ranks) - mark;
        p->stats.cpu_splat += snow_picture_cpu(p) - cpu;
        status = snow_picture_prepare(p, &p->work);
    }
    SNOW_TRY(snow_comm_agree(p->ranks->comm, status));
    return snow_picture_combine_axis(p, &p->work, 0, image);
}

/* As bytes would have travelled. */
static void round_pixels(float *pixels, size_t count) {
    for (size_t n = 0; n < count; n++)
        pixels[n] = (float)(unsigned char)(pixels[n] * 255 + 0.5f) / 255;
}

/* Collective.  A blend of several axes: their pictures travel as floats, and
 * are added up on rank 0 in the order of frame.c. */
static snow_status render_blend(snow_picture *p) {
    const snow_view *view = p->job.view;
    size_t floats =
        (size_t)view->width * (size_t)view->height * (size_t)p->job.channels;
    double shares[3];
    snow_image *layer = NULL;
    snow_status status = SNOW_OK;
    SNOW_TRY(snow_job_shares(&p->job, shares)); /* alike on all ranks */
    if (p->image)
        status = snow_image_new(p->job.context, view->width, view->height,
                                p->job.channels, &layer);
    status = snow_comm_agree(p->ranks->comm, status);
    for (int axis = 0; axis < 3 && status == SNOW_OK; axis++) {
        if (shares[axis] == 0)
            continue;
        if (layer)
            memset(layer->pixels, 0, floats * sizeof *layer->pixels);
        status = render_axis(p, axis, layer);
        for (size_t n = 0; layer && status == SNOW_OK && n < floats; n++)
            p->image->pixels[n] += (float)shares[axis] * layer->pixels[n];
    }
    snow_image_free(layer);
    if (status == SNOW_OK && p->image && p->how.pixel_bits == 8)
        round_pixels(p->image->pixels, floats);
    return status;
}

/* --- the exact methods ----------------------------------------------------
 */

/* Local work: the local image; in deterministic pictures one for each node. */
static snow_status render_exact_local(snow_picture *p, snow_local *local) {
    snow_ranks *r = p->ranks;
    snow_job *job = &p->job;
    const snow_view *view = job->view;
    size_t floats =
        (size_t)view->width * (size_t)view->height * (size_t)job->channels;
    *local = (snow_local){.width = view->width,
                          .height = view->height,
                          .channels = job->channels,
                          .stride = (size_t)(view->width * job->channels),
                          .layers = 1,
                          .layer_floats = floats};
    if (job->settings.deterministic)
        local->layers =
            snow_group_nodes(job->placement.slices, job->slab, local->nodes);
    if (local->layers < 0)
        return snow_fail(job->context, SNOW_BAD_USAGE,
                         "parts of a deterministic picture are cut at borders "
                         "of %d groups of slices",
                         SNOW_GROUPS);
    size_t bytes = (size_t)local->layers * floats * sizeof *r->images;
    SNOW_TRY(snow_reserve(job->context, &r->images, &r->images_capacity, 0,
                          bytes + 1));
    memset(r->images, 0, bytes);
    local->pixels = r->images;
    for (int n = 0; n < local->layers; n++) {
        job->pixels = r->images + (size_t)n * floats;
        local->drawn[n] = (snow_rectangle){0, 0, view->width, view->height};
        SNOW_TRY(job->settings.deterministic
                     ? snow_job_render_node(p->frame, job, local->nodes[n])
                     : snow_job_render_exact(p->frame, job));
    }
    return snow_picture_prepare_exact(p, local);
}

snow_status snow_picture_prepare_exact(snow_picture *p,
                                       const snow_local *local) {
    return prepare_exchange(p, local, &p->job.placement);
}

snow_status snow_picture_combine_exact(snow_picture *p, const snow_local *local,
                                       int pixel_bits, snow_image *image) {
    snow_ranks *r = p->ranks;
    snow_piece piece;
    double mark = snow_ranks_clock(r), cpu = snow_picture_cpu(p);
    SNOW_TRY(exchange(p, local, &p->job.placement, 1, &piece));
    p->stats.seconds_combine += snow_ranks_clock(r) - mark;
    p->stats.cpu_combine += snow_picture_cpu(p) - cpu;
    SNOW_TRY(snow_comm_agree(r->comm,
                             snow_pixels_copy(r, &p->job, &piece, pixel_bits)));
    return deliver(p, pixel_bits, image);
}

static snow_status render_exact(snow_picture *p) {
    snow_local local;
    double cpu = snow_picture_cpu(p);
    snow_status status = render_exact_local(p, &local);
    p->stats.cpu_splat += snow_picture_cpu(p) - cpu;
    SNOW_TRY(snow_comm_agree(p->ranks->comm, status));
    return snow_picture_combine_exact(p, &local, p->how.pixel_bits, p->image);
}

/* --- a picture ------------------------------------------------------------
 */

/* Collective.  Local work included, up to the counts. */
static snow_status render_wholly(snow_picture *p, snow_status status) {
    bool new_parts;
    SNOW_TRY(meet(p, status, &new_parts));
    if (p->job.settings.mode != SNOW_MODE_OVER)
        return snow_picture_render_mode(p);
    SNOW_TRY(p->job.settings.method == SNOW_METHOD_SHEARED ? render_blend(p)
                                                           : render_exact(p));
    if (p->job.settings.depth)
        SNOW_TRY(snow_picture_render_depth(p));
    return snow_comm_agree(p->ranks->comm, snow_job_finish(p->frame, &p->job));
}

snow_status snow_picture_combine(snow_picture *p) {
    snow_status status = p->status;
    if (p->drawing && p->job.settings.deterministic)
        snow_ranks_settle(p->ranks);
    if (status != SNOW_OK) /* others may have failed since */
        status = snow_fail(p->frame->context, status, "%s", p->message);
    return p->ahead ? render_ahead(p, status) : render_wholly(p, status);
}
