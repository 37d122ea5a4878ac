/* parallel/exchange.c - local images to pieces of the picture, and these to
 * rank 0: lines 14 to 20 of figure 8, for any boxes in the place of slabs. */
#include "base/clear.h"
#include "parallel/internal.h"

#include <string.h>

/* --- the local image ------------------------------------------------------ */

/* Tiles of tile lines y0 .. y1 - 1 of a layer that were drawn on, as pixels;
 * what else lies among them is cleared. */
static snow_rectangle drawn_part(const snow_shear_warp_image *image, int layer,
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
    snow_shear_warp_clear(image, layer, box.x0, box.y0, box.x1, box.y1);
    box.x0 *= image->tile_width;
    box.x1 *= image->tile_width;
    box.y0 *= image->tile_height;
    box.y1 *= image->tile_height;
    box.x1 = box.x1 < image->width ? box.x1 : image->width;
    box.y1 = box.y1 < image->height ? box.y1 : image->height;
    return box;
}

/* Returns whether lines y0 .. y1 - 1 are finished; if so, what of them was
 * drawn on. */
static bool look_at_lines(const snow_in_flight *p, int y0, int y1,
                          snow_rectangle *drawn) {
    const snow_shear_warp_image *image = &p->picture.local.image;
    int first = y0 / image->tile_height,
        end = (y1 - 1) / image->tile_height + 1;
    if (p->picture.drawing &&
        !snow_line_batch_drawn(p->picture.drawing, first, end))
        return false;
    snow_ranks_pause(p->ranks);
    *drawn = drawn_part(image, 0, first, end);
    return true;
}

/* `drawn` is known only when the image is finished. */
static snow_local shear_warp_local(const snow_shear_warp_image *image,
                                   bool drawing) {
    snow_local local = {.image = *image};
    for (int n = 0; image->width && n < image->layers && !drawing; n++)
        local.drawn[n] =
            drawn_part(image, n, 0, (int)image->layer_tiles / image->tiles);
    return local;
}

/* Pixels of the picture, in ranks->images. */
static snow_local picture_local(const snow_in_flight *p, const snow_job *job) {
    const snow_view *view = job->view;
    snow_local local = {
        .image = {.width = view->width,
                  .height = view->height,
                  .channels = job->channels,
                  .stride = (size_t)(view->width * job->channels),
                  .pixels = p->ranks->images,
                  .layers = p->picture.local.layers,
                  .layer_floats = snow_job_bytes(job) / sizeof(float)}};
    for (int n = 0; n < local.image.layers; n++)
        local.drawn[n] = (snow_rectangle){0, 0, view->width, view->height};
    return local;
}

/* --- the exchange --------------------------------------------------------- */

/* How local images of a mode are laid over one another. */
static snow_composite_op composite_op_of(snow_mode mode) {
    switch (mode) {
    case SNOW_MODE_MIP:
    case SNOW_MODE_MINIP:
        return SNOW_COMPOSITE_MAXIMUM;
    case SNOW_MODE_MEAN:
    case SNOW_MODE_SUM:
        return SNOW_COMPOSITE_SUM;
    default:
        return SNOW_COMPOSITE_OVER;
    }
}

snow_status snow_in_flight_capacity(snow_in_flight *f, const snow_job *job,
                                    int layers) {
    snow_ranks *r = f->ranks;
    size_t bytes = snow_job_bytes(job);
    SNOW_TRY(
        snow_reserve(job->context, &r->images, 0, (uint64_t)layers, bytes));
    f->picture.local.pixels = r->images;
    return snow_clear(job->context, r->images, (size_t)layers * bytes);
}

static const snow_placement *placement_of(const snow_in_flight *p,
                                          const snow_job *job) {
    return p->picture.pass->method->warps ? &p->picture.local.placement
                                          : &job->placement;
}

/* An empty intermediate image is the same on all ranks. */
static bool is_empty(const snow_in_flight *p) {
    return p->picture.pass->method->warps && !p->picture.local.image.width;
}

static snow_status prepare(snow_in_flight *p, const snow_job *job) {
    const snow_placement *placement = placement_of(p, job);
    const bool warps = p->picture.pass->method->warps;
    if (is_empty(p))
        return SNOW_STATUS_OK;
    p->local =
        warps ? shear_warp_local(&p->picture.local.image, p->picture.drawing)
              : picture_local(p, job);
    p->local.composite_op = composite_op_of(job->settings.mode);
    if (warps)
        SNOW_TRY(snow_lines_prepare(p->ranks, &p->picture.local.image));
    if (job->settings.deterministic)
        return snow_layers_prepare(p->ranks, &p->local, placement);
    return snow_ranks_put_in_order(p->ranks, placement);
}

/* What is kept for the next picture makes room. */
snow_status snow_in_flight_prepare(snow_in_flight *p, const snow_job *job) {
    snow_value_path *path = p->picture.frame->value_path;
    if (path && job->volume && job->volume->stream)
        snow_value_leave_memory(path, snow_value_exchange_bytes(path));
    return prepare(p, job);
}

static void set_rounds(snow_in_flight *p, const snow_exchange_figures *given) {
    snow_ranks_stats *stats = &p->picture.ranks_stats;
    const int most = (int)(sizeof stats->radices / sizeof *stats->radices);
    stats->rounds = given->rounds;
    for (int i = 0; i < given->rounds && i < most; i++)
        stats->radices[i] = given->radices[i];
    stats->active_pixels = given->active;
    stats->bytes_early = (uint64_t)given->early;
    p->ranks->begin_at = given->begin_at;
}

/* Sends parts of a local image while the rest of it is drawn. */
static snow_status send_while_drawing(snow_in_flight *p) {
    snow_combiner *combiner = p->ranks->combiner;
    snow_rectangle drawn;
    int y0, y1;
    while (p->picture.drawing) {
        for (int n = 0; snow_exchange_awaits(combiner, n, &y0, &y1);) {
            if (look_at_lines(p, y0, y1, &drawn))
                SNOW_TRY(snow_exchange_send(combiner, n, drawn));
            else
                n++;
        }
        if (snow_exchange_awaits(combiner, 0, &y0, &y1) &&
            snow_ranks_draw(p->ranks))
            snow_exchange_progress(combiner);
        else
            snow_ranks_drain(p->ranks);
    }
    look_at_lines(p, 0, p->local.image.height, &p->local.drawn[0]);
    return SNOW_STATUS_OK;
}

static snow_status exchange(snow_in_flight *p, const snow_job *job) {
    snow_ranks *r = p->ranks;
    const snow_shear_warp_image *local = &p->local.image;
    const bool warps = p->picture.pass->method->warps;
    if (job->settings.deterministic)
        return snow_layers_exchange(r, &p->local, placement_of(p, job),
                                    &p->region);
    const snow_exchange_params order = {
        .width = local->width,
        .height = local->height,
        .channels = local->channels,
        .pixels = local->pixels,
        .stride = local->stride,
        .ranks = r->order,
        .method = p->how.combining,
        .radix = p->how.radix,
        .composite_op = p->local.composite_op,
        .grain = warps ? local->width : 1, /* pieces of whole lines */
        .threads = job->settings.threads,
        .counts = p->picture.ahead ? r->group_counts : NULL,
        .count_groups = r->groups};
    SNOW_TRY(snow_exchange_begin(r->combiner, &order));
    if (p->picture.drawing)
        SNOW_TRY(send_while_drawing(p));
    SNOW_TRY(snow_exchange_end(r->combiner, p->local.drawn[0], &p->region));
    set_rounds(p, snow_exchange_get_figures(r->combiner));
    snow_exchange_regions(r->combiner, r->firsts, r->counts);
    return SNOW_STATUS_OK;
}

snow_status snow_in_flight_exchange(snow_in_flight *p, const snow_job *job) {
    snow_ranks *r = p->ranks;
    snow_ranks_stats *stats = &p->picture.ranks_stats;
    double mark = snow_ranks_clock(r), cpu = snow_in_flight_cpu(p);
    if (is_empty(p))
        return SNOW_STATUS_OK;
    SNOW_TRY(exchange(p, job));
    if (p->picture.pass->method->warps)
        SNOW_TRY(snow_lines_exchange(r, &p->picture.local.image, &p->region));
    stats->seconds_combine += snow_ranks_clock(r) - mark;
    stats->cpu_combine += snow_in_flight_cpu(p) - cpu;
    return SNOW_STATUS_OK;
}

/* This rank's pixels to their places in its own image. */
static void keep_pixels(const snow_in_flight *p, int pixel_bits,
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

static snow_status gather(snow_in_flight *p, const snow_job *job,
                          int pixel_bits, snow_image *image) {
    if (p->how.scattered) {
        keep_pixels(p, pixel_bits, image);
        return SNOW_STATUS_OK;
    }
    double cpu = snow_in_flight_cpu(p);
    snow_status status = snow_pixels_gather(p, job, pixel_bits, image);
    p->picture.ranks_stats.cpu_gather += snow_in_flight_cpu(p) - cpu;
    return status;
}

/* Local work. */
static snow_status make_pixels(snow_in_flight *p, const snow_job *job,
                               int pixel_bits) {
    snow_ranks *r = p->ranks;
    snow_stats *stats = &p->picture.stats;
    if (!p->picture.pass->method->warps)
        return snow_pixels_copy(r, job, &p->region, pixel_bits);
    double mark = snow_ranks_clock(r), cpu = snow_in_flight_cpu(p);
    snow_status status = snow_pixels_warp(r, &p->picture.local.image, job,
                                          &p->region, pixel_bits);
    stats->seconds_warp += snow_ranks_clock(r) - mark;
    p->picture.ranks_stats.cpu_warp += snow_in_flight_cpu(p) - cpu;
    /* Bands that were sent may not have been drawn. */
    return status == SNOW_STATUS_OK ? snow_monitor_status(&p->picture.monitor)
                                    : status;
}

snow_status snow_in_flight_deliver(snow_in_flight *p, const snow_job *job,
                                   int pixel_bits, snow_image *image) {
    if (is_empty(p))
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_comm_agree_status(p->ranks->comm,
                                    make_pixels(p, job, pixel_bits)));
    return gather(p, job, pixel_bits, image);
}
