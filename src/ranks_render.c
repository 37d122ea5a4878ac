/* ranks_render.c - one picture by many processors: figure 8 of the paper with
 * its lines 14 to 20, for any boxes in the place of slabs.
 *
 *   every rank             its part  -> local image          (lines 02 to 13)
 *   exchange               local images -> pieces            (14 to 18)
 *   every rank             its piece -> pixels               (the warp)
 *   gather                 pixels -> the picture, on rank 0  (19, 20)
 *
 * What a rank finds wrong by itself is agreed on before anybody waits for a
 * message of it; what all ranks find wrong alike needs no word. */
#include "ranks_parts.h"

#include "decompose/order.h"
#include "image/image.h"
#include "volume/volume.h"

#include <string.h>

/* One picture in the making. */
typedef struct picture {
    snow_frame *frame;
    snow_ranks *ranks;
    snow_comm *comm;
    snow_job job;
    snow_ranks_options how;
    snow_image *image; /* on rank 0 */
    unsigned char *bytes;
} picture;

/* --- what a frame keeps ---------------------------------------------------
 */

void snow_ranks_free(snow_ranks *r) {
    if (!r)
        return;
    snow_context *context = r->context;
    void *const blocks[] = {r->parts,    r->boxes,   r->order, r->firsts,
                            r->counts,   r->offsets, r->sent,  r->came,
                            r->messages, r->piece,   r->lines, r->images,
                            r->runs,     r->packed,  r->rows};
    for (size_t n = 0; n < sizeof blocks / sizeof *blocks; n++)
        snow_release(context, blocks[n]);
    snow_combiner_free(r->combiner);
    snow_release(context, r);
}

static snow_status take_arrays(snow_ranks *r) {
    snow_context *context = r->context;
    uint64_t count = (uint64_t)r->ranks;
    bool fine =
        (r->parts = snow_allocate_array(context, count, sizeof *r->parts)) &&
        (r->boxes = snow_allocate_array(context, count, sizeof *r->boxes)) &&
        (r->order = snow_allocate_array(context, count, sizeof *r->order)) &&
        (r->firsts = snow_allocate_array(context, count, sizeof *r->firsts)) &&
        (r->counts = snow_allocate_array(context, count, sizeof *r->counts)) &&
        (r->offsets =
             snow_allocate_array(context, count, sizeof *r->offsets)) &&
        (r->messages =
             snow_allocate_array(context, 4 * count + 16, sizeof *r->messages));
    return fine ? snow_combiner_new(r->comm, &r->combiner) : SNOW_NO_MEMORY;
}

/* The frame's record for a communicator. */
static snow_status open_ranks(snow_frame *frame, snow_comm *comm) {
    if (frame->ranks && frame->ranks->comm == comm)
        return SNOW_OK;
    snow_ranks_free(frame->ranks);
    frame->ranks = NULL;
    snow_ranks *r = snow_allocate_clear(frame->context, sizeof *r);
    if (!r)
        return SNOW_NO_MEMORY;
    r->context = frame->context;
    r->comm = comm;
    r->rank = snow_comm_rank(comm);
    r->ranks = snow_comm_ranks(comm);
    snow_status status = take_arrays(r);
    if (status == SNOW_OK)
        frame->ranks = r;
    else
        snow_ranks_free(r);
    return status;
}

/* --- meeting --------------------------------------------------------------
 */

static snow_ranks_options options_known(const snow_ranks_options *how) {
    snow_ranks_options known = {0};
    if (how)
        memcpy(&known, how,
               how->size < sizeof known ? how->size : sizeof known);
    return known;
}

static snow_status begin_picture(picture *p, const snow_volume *volume,
                                 const snow_transfer *transfer,
                                 const snow_view *view,
                                 const snow_settings *settings) {
    snow_context *context = p->frame->context;
    if (p->how.pixel_bits != 0 && p->how.pixel_bits != 8)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "pixels of %d bits cannot travel; take 8, or 0 for "
                         "floats",
                         p->how.pixel_bits);
    SNOW_TRY(open_ranks(p->frame, p->comm));
    p->ranks = p->frame->ranks;
    SNOW_TRY(snow_job_begin(p->frame, volume, transfer, view, settings, 1, 0,
                            &p->job));
    if (p->job.settings.mode != SNOW_MODE_OVER)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "mode %s is not built for many ranks yet; render on "
                         "one, or take mode over",
                         snow_mode_name(p->job.settings.mode));
    if (p->job.settings.depth)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "depths are not built for many ranks yet; render on "
                         "one, or leave them out");
    if (snow_comm_rank(p->comm) != 0 && !p->how.scattered)
        return SNOW_OK;
    SNOW_TRY(snow_image_new(context, view->width, view->height, p->job.channels,
                            &p->image));
    if (p->how.pixel_bits != 8 || p->how.scattered)
        return SNOW_OK;
    size_t bytes =
        (size_t)view->width * (size_t)view->height * (size_t)p->job.channels;
    p->bytes = snow_allocate_clear(context, bytes);
    return p->bytes ? SNOW_OK : SNOW_NO_MEMORY;
}

/* Mixes bytes into a number of 62 bits (Fowler, Noll and Vo's hash). */
static void mix(uint64_t *hash, const void *bytes, size_t count) {
    const unsigned char *at = bytes;
    for (size_t n = 0; n < count; n++)
        *hash = (*hash ^ at[n]) * UINT64_C(1099511628211);
}

/* What must be the same on all ranks, as a number. */
static int64_t terms_of(const picture *p) {
    const snow_job *job = &p->job;
    const snow_settings *s = &job->settings;
    const snow_placement *place = &job->placement;
    const int numbers[] = {
        job->channels,         (int)s->method,     (int)s->quality,
        (int)s->kernel,        s->footprint,       (int)s->shade,
        s->deterministic,      place->width,       place->height,
        (int)p->how.combining, p->how.radix,       p->how.pixel_bits,
        place->slice_axis,     place->perspective, p->how.scattered};
    const double reals[] = {
        place->back[0],   place->back[1],   place->back[2],
        place->up[0],     place->up[1],     place->up[2],
        place->path,      s->threshold,     s->opacity_length,
        job->view->zoom,  job->view->fov,   place->origin[0],
        place->origin[1], place->eye.at[0], place->eye.at[1],
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
static snow_status share_parts(snow_ranks *r, const snow_volume *volume) {
    snow_part mine;
    snow_volume_get_part(volume, &mine);
    r->serial = 0;
    SNOW_TRY(snow_comm_share(r->comm, &mine, sizeof mine, r->parts));
    for (int rank = 0; rank < r->ranks; rank++) {
        const snow_part *part = &r->parts[rank];
        bool none = !part->count[0] || !part->count[1] || !part->count[2];
        for (int axis = 0; axis < 3; axis++) {
            r->boxes[rank].first[axis] = part->first[axis];
            r->boxes[rank].count[axis] = none ? 0 : part->count[axis];
        }
    }
    SNOW_TRY(check_parts(r));
    r->serial = volume->serial;
    return SNOW_OK;
}

/* Collective.  How the ranks' own preparations went; parts, where one is new.
 */
static snow_status meet(picture *p, snow_status status) {
    enum { FAILED, NEW, TERMS, MINUS_TERMS, COUNT };
    int64_t words[COUNT] = {status != SNOW_OK, 1, 0, 0};
    if (status == SNOW_OK) {
        const snow_volume *volume = p->job.volume;
        words[NEW] = !volume->serial || p->ranks->serial != volume->serial;
        words[TERMS] = terms_of(p);
        words[MINUS_TERMS] = -words[TERMS];
    }
    SNOW_TRY(snow_comm_reduce_ints(p->comm, words, COUNT, SNOW_MAX));
    if (words[FAILED])
        return snow_comm_agree(p->comm, status);
    if (words[TERMS] != -words[MINUS_TERMS])
        return snow_fail(p->job.context, SNOW_BAD_USAGE,
                         "ranks were asked for different pictures; give all "
                         "the same view and settings");
    return words[NEW] ? share_parts(p->ranks, p->job.volume) : SNOW_OK;
}

/* --- the exchange ---------------------------------------------------------
 */

/* Local work: which rank is before which, and room. */
static snow_status prepare_exchange(picture *p, const snow_local *local,
                                    const snow_placement *placement) {
    snow_sight sight;
    if (p->job.settings.deterministic)
        return snow_layers_prepare(p->ranks, local, placement);
    snow_clip_sight(placement, &sight);
    return snow_order_boxes(p->job.context, p->ranks->boxes, p->ranks->ranks,
                            &sight, p->ranks->order);
}

/* Collective.  Local images to pieces, of `grain` pixels or multiples. */
static snow_status exchange(picture *p, const snow_local *local,
                            const snow_placement *placement, int grain,
                            snow_piece *piece) {
    snow_ranks *r = p->ranks;
    if (p->job.settings.deterministic)
        return snow_layers_exchange(r, local, placement, piece);
    const snow_exchange_order order = {.width = local->width,
                                       .height = local->height,
                                       .channels = local->channels,
                                       .pixels = local->pixels,
                                       .stride = local->stride,
                                       .drawn = local->drawn[0],
                                       .ranks = r->order,
                                       .method = p->how.combining,
                                       .radix = p->how.radix,
                                       .grain = grain};
    SNOW_TRY(snow_exchange(r->combiner, &order, piece));
    snow_exchange_pieces(r->combiner, r->firsts, r->counts);
    return SNOW_OK;
}

/* This rank's pixels to their places in its own image. */
static void keep_pixels(const picture *p, int pixel_bits, snow_image *image) {
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

static snow_status deliver(picture *p, int pixel_bits, snow_image *image) {
    if (p->how.scattered) {
        keep_pixels(p, pixel_bits, image);
        return SNOW_OK;
    }
    const snow_delivery delivery = {pixel_bits, image, p->bytes,
                                    &p->frame->stats};
    return snow_pixels_gather(p->ranks, &p->job, &delivery);
}

/* --- the sheared method ---------------------------------------------------
 */

/* The tiles of a layer that were drawn on, as pixels; what else lies among
 * them is cleared. */
static snow_rectangle drawn_part(const snow_sheared_image *image, int layer) {
    const unsigned char *drawn =
        image->drawn + (size_t)layer * image->layer_tiles;
    snow_rectangle box = {image->tiles, INT32_MAX, 0, 0};
    for (int n = 0; n < (int)image->layer_tiles; n++) {
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

static snow_local local_of(const snow_sheared_image *image) {
    snow_local local = {.width = image->width,
                        .height = image->height,
                        .channels = image->channels,
                        .stride = image->stride,
                        .pixels = image->pixels,
                        .layers = image->layers,
                        .layer_floats = image->layer_floats};
    memcpy(local.nodes, image->nodes, sizeof local.nodes);
    for (int n = 0; image->width && n < image->layers; n++)
        local.drawn[n] = drawn_part(image, n);
    return local;
}

/* One axis' share of a picture on its way. */
typedef struct axis_work {
    snow_placement placement;
    snow_sheared_order order;
    snow_sheared *sheared;
    snow_sheared_image image;
    snow_local local;
} axis_work;

/* Local work: this rank's intermediate image, and all that the exchange needs.
 */
static snow_status splat_axis(picture *p, int axis, snow_sheared **sheared,
                              axis_work *work) {
    SNOW_TRY(snow_job_order(&p->job, axis, &work->placement, &work->order));
    if (p->job.settings.deterministic && work->order.clip.cuts)
        return snow_fail(p->job.context, SNOW_BAD_USAGE,
                         "deterministic pictures are not blended of several "
                         "axes by many ranks; take quality normal");
    if (!*sheared)
        SNOW_TRY(snow_sheared_new(p->job.context, sheared));
    work->sheared = *sheared;
    SNOW_TRY(
        snow_sheared_splat(*sheared, &work->order, p->job.stats, &work->image));
    if (!work->image.width)
        return SNOW_OK;
    work->local = local_of(&work->image);
    SNOW_TRY(snow_lines_prepare(p->ranks, &work->local));
    return prepare_exchange(p, &work->local, &work->placement);
}

/* Collective.  The picture with slices along one axis, into `image` of rank 0.
 */
static snow_status render_axis(picture *p, int axis, snow_sheared **sheared,
                               int pixel_bits, snow_image *image) {
    snow_stats *stats = &p->frame->stats;
    axis_work work;
    snow_piece piece;
    snow_status status = splat_axis(p, axis, sheared, &work);
    SNOW_TRY(snow_comm_agree(p->comm, status));
    if (!work.image.width) /* the same on all ranks */
        return SNOW_OK;
    double mark = snow_comm_seconds(p->comm);
    SNOW_TRY(
        exchange(p, &work.local, &work.placement, work.image.width, &piece));
    SNOW_TRY(snow_lines_exchange(p->ranks, &work.image, &piece));
    double combined = snow_comm_seconds(p->comm), start = snow_seconds();
    stats->seconds_combine += combined - mark;
    status = snow_pixels_warp(p->ranks, work.sheared, &p->job, &piece,
                              work.image.width, pixel_bits);
    stats->seconds_warp += snow_seconds() - start;
    SNOW_TRY(snow_comm_agree(p->comm, status));
    return deliver(p, pixel_bits, image);
}

/* As bytes would have travelled. */
static void round_pixels(float *pixels, size_t count) {
    for (size_t n = 0; n < count; n++)
        pixels[n] = (float)(unsigned char)(pixels[n] * 255 + 0.5f) / 255;
}

/* Collective.  A blend of several axes: their pictures travel as floats, and
 * are added up on rank 0 in the order of frame.c. */
static snow_status render_blend(picture *p, const double shares[3]) {
    const snow_view *view = p->job.view;
    size_t floats =
        (size_t)view->width * (size_t)view->height * (size_t)p->job.channels;
    snow_image *layer = NULL;
    snow_status status = SNOW_OK;
    if (p->image)
        status = snow_image_new(p->job.context, view->width, view->height,
                                p->job.channels, &layer);
    status = snow_comm_agree(p->comm, status);
    for (int axis = 0; axis < 3 && status == SNOW_OK; axis++) {
        if (shares[axis] == 0)
            continue;
        if (layer)
            memset(layer->pixels, 0, floats * sizeof *layer->pixels);
        status = render_axis(p, axis, &p->frame->sheared[axis], 0, layer);
        for (size_t n = 0; layer && status == SNOW_OK && n < floats; n++)
            p->image->pixels[n] += (float)shares[axis] * layer->pixels[n];
    }
    snow_image_free(layer);
    if (status == SNOW_OK && p->image && p->how.pixel_bits == 8)
        round_pixels(p->image->pixels, floats);
    return status;
}

static snow_status render_sheared(picture *p) {
    int axis = p->job.placement.slice_axis;
    double shares[3];
    SNOW_TRY(snow_job_shares(&p->job, shares)); /* alike on all ranks */
    if (shares[axis] < 1)
        return render_blend(p, shares);
    bool high = p->job.settings.quality == SNOW_QUALITY_HIGH;
    return render_axis(p, axis, &p->frame->sheared[high ? axis : 0],
                       p->how.pixel_bits, p->image);
}

/* --- the exact methods ----------------------------------------------------
 */

/* Local work: the local image; in deterministic pictures one for each node. */
static snow_status render_exact_local(picture *p, snow_local *local) {
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
    return prepare_exchange(p, local, &job->placement);
}

static snow_status render_exact(picture *p) {
    snow_local local;
    snow_piece piece;
    SNOW_TRY(snow_comm_agree(p->comm, render_exact_local(p, &local)));
    double mark = snow_comm_seconds(p->comm);
    SNOW_TRY(exchange(p, &local, &p->job.placement, 1, &piece));
    p->frame->stats.seconds_combine += snow_comm_seconds(p->comm) - mark;
    SNOW_TRY(
        snow_comm_agree(p->comm, snow_pixels_copy(p->ranks, &p->job, &piece,
                                                  p->how.pixel_bits)));
    return deliver(p, p->how.pixel_bits, p->image);
}

/* --- a picture ------------------------------------------------------------
 */

/* A group of one: its local image is the picture. */
static snow_status render_alone(picture *p, const snow_volume *volume,
                                const snow_transfer *transfer,
                                const snow_view *view,
                                const snow_settings *settings) {
    SNOW_TRY(snow_frame_render(p->frame, volume, transfer, view, settings,
                               &p->image));
    if (p->how.pixel_bits == 8 && p->image->channels > 1)
        round_pixels(p->image->pixels, (size_t)p->image->width *
                                           (size_t)p->image->height *
                                           (size_t)p->image->channels);
    return SNOW_OK;
}

static snow_status render_together(picture *p, const snow_volume *volume,
                                   const snow_transfer *transfer,
                                   const snow_view *view,
                                   const snow_settings *settings) {
    double start = snow_seconds(), cpu = snow_cpu_seconds();
    snow_stats *stats = &p->frame->stats;
    SNOW_TRY(meet(p, begin_picture(p, volume, transfer, view, settings)));
    stats->ranks = p->ranks->ranks;
    SNOW_TRY(p->job.settings.method == SNOW_METHOD_SHEARED ? render_sheared(p)
                                                           : render_exact(p));
    stats->seconds_frame = snow_seconds() - start;
    stats->cpu_frame = snow_cpu_seconds() - cpu;
    return snow_comm_agree(p->comm, snow_job_finish(p->frame, &p->job));
}

snow_status
snow_ranks_render(snow_frame *frame, snow_comm *comm, const snow_volume *volume,
                  const snow_transfer *transfer, const snow_view *view,
                  const snow_settings *settings, const snow_ranks_options *how,
                  snow_image **image) {
    picture p = {.frame = frame, .comm = comm, .how = options_known(how)};
    snow_status status =
        snow_comm_ranks(comm) == 1
            ? render_alone(&p, volume, transfer, view, settings)
            : render_together(&p, volume, transfer, view, settings);
    snow_release(frame->context, p.bytes);
    if (status == SNOW_OK)
        *image = p.image;
    else
        snow_image_free(p.image);
    return status;
}
