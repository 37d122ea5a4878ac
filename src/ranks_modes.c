/* ranks_modes.c - modes other than over by many processors, and depths.
 *
 *   mip, minip   pairs (value, 1): the larger of two    bit for bit the serial
 *   mean, sum    pairs of sums: their sum               but for rounding
 *   iso          opaque pixels: what is in front, which is over's business
 *   depth        pairs (depth, 1): the same
 *
 * A depth of over is where opacity passes 1/2, which depends on all that is in
 * front: for these processors take turns, the nearest first, and each goes on
 * with the alphas that the one before it left.
 *
 * Each processor makes the pairs of its part (modes.h) over the whole's range,
 * which all agree on first; they are exchanged as over's local images are, on
 * the slices' lattice where that is how they were made, warped or copied piece
 * by piece, and brought to rank 0, which makes colours or values of them. */
#include "ranks_parts.h"

#include "decompose/order.h"
#include "depth.h"
#include "image/image.h"
#include "volume/volume.h"

#include <math.h>
#include <string.h>

snow_status snow_picture_check_mode(const snow_picture *p) {
    const snow_settings *s = &p->job.settings;
    if (s->depth && s->mode != SNOW_MODE_ISO && s->mode != SNOW_MODE_OVER)
        return snow_fail(p->job.context, SNOW_BAD_USAGE,
                         "mode %s has no depth; take over or iso",
                         snow_mode_name(s->mode));
    if (s->deterministic &&
        (s->mode == SNOW_MODE_MEAN || s->mode == SNOW_MODE_SUM))
        return snow_fail(p->job.context, SNOW_BAD_USAGE,
                         "mode %s of many ranks is rounded as its parts are, "
                         "so that it cannot be deterministic; render on one",
                         snow_mode_name(s->mode));
    return SNOW_OK;
}

/* Collective.  The range of all parts into the frame's ramp. */
static snow_status agree_range(snow_picture *p) {
    enum { MINUS_LOW, HIGH, HOLES, COUNT };
    snow_ramp *ramp = &p->frame->ramp;
    snow_comm *comm = p->ranks->comm;
    double words[COUNT] = {-INFINITY, -INFINITY, 0};
    SNOW_TRY(snow_comm_agree(comm, snow_ramp_measure(&p->job, ramp)));
    if (!ramp->empty) {
        words[MINUS_LOW] = -ramp->low;
        words[HIGH] = ramp->high;
    }
    words[HOLES] = !ramp->whole;
    SNOW_TRY(snow_comm_reduce_doubles(comm, words, COUNT, SNOW_MAX));
    if (!(-words[MINUS_LOW] <= words[HIGH]))
        words[MINUS_LOW] = words[HIGH] = 0;
    snow_ramp_widen(ramp, -words[MINUS_LOW], words[HIGH], words[HOLES] == 0);
    if (isfinite(ramp->high - ramp->low))
        return SNOW_OK;
    return snow_fail(p->job.context, SNOW_BAD_INPUT,
                     "values from %g to %g span more than a number holds; only "
                     "mode over shows them",
                     ramp->low, ramp->high);
}

/* --- pairs ----------------------------------------------------------------
 */

static snow_laying laying_of(snow_mode mode) {
    return mode == SNOW_MODE_MIP || mode == SNOW_MODE_MINIP ? SNOW_LAY_MOST
                                                            : SNOW_LAY_SUM;
}

/* Cleared room for local pixels of an exact method, and what they are. */
static snow_status make_local(snow_picture *p, int channels,
                              snow_local *local) {
    snow_ranks *r = p->ranks;
    const snow_view *view = &p->view;
    size_t floats =
        (size_t)view->width * (size_t)view->height * (size_t)channels;
    SNOW_TRY(snow_reserve(p->job.context, &r->images, &r->images_capacity, 0,
                          floats * sizeof *r->images));
    memset(r->images, 0, floats * sizeof *r->images);
    *local = (snow_local){.width = view->width,
                          .height = view->height,
                          .channels = channels,
                          .stride = (size_t)view->width * (size_t)channels,
                          .pixels = r->images,
                          .layers = 1,
                          .layer_floats = floats,
                          .drawn = {{0, 0, view->width, view->height}}};
    return SNOW_OK;
}

/* Local work: this rank's pairs, ready to be exchanged. */
static snow_status render_pairs(snow_picture *p, snow_local *local) {
    snow_job *pairs = &p->job;
    snow_laying laying = laying_of(pairs->settings.mode);
    if (pairs->settings.method == SNOW_METHOD_SHEARED) {
        p->work.local.laying = laying;
        SNOW_TRY(snow_modes_reduce(p->frame, pairs, &p->work.placement,
                                   &p->work.image));
        return snow_picture_prepare(p, &p->work);
    }
    SNOW_TRY(make_local(p, 2, local));
    local->laying = laying;
    pairs->pixels = p->ranks->images;
    SNOW_TRY(snow_job_render_exact(p->frame, pairs));
    return snow_picture_prepare_exact(p, local);
}

/* Collective.  The whole's pairs, on rank 0; p->job is the job of pairs. */
static snow_status combine_pairs(snow_picture *p, snow_image *image) {
    snow_local local;
    double cpu = snow_picture_cpu(p);
    snow_status status = render_pairs(p, &local);
    p->stats.cpu_splat += snow_picture_cpu(p) - cpu;
    SNOW_TRY(snow_comm_agree(p->ranks->comm, status));
    return p->job.settings.method == SNOW_METHOD_SHEARED
               ? snow_picture_combine_axis(p, &p->work, 0, image)
               : snow_picture_combine_exact(p, &local, 0, image);
}

/* As bytes would have travelled. */
static void round_colors(const snow_picture *p) {
    snow_image *image = p->image;
    size_t count =
        (size_t)image->width * (size_t)image->height * (size_t)image->channels;
    for (size_t n = 0;
         p->how.pixel_bits == 8 && image->channels > 1 && n < count; n++)
        image->pixels[n] =
            (float)(unsigned char)(image->pixels[n] * 255 + 0.5f) / 255;
}

static bool keeps_pixels(const snow_picture *p) {
    return p->ranks->rank == 0 || p->how.scattered;
}

/* Local work: colours or values of pairs. */
static snow_status paint(snow_picture *p, const snow_job *job,
                         const snow_image *pairs) {
    if (!pairs)
        return SNOW_OK;
    SNOW_TRY(snow_modes_paint(p->frame, job, NULL, pairs->pixels, &p->image));
    round_colors(p);
    return SNOW_OK;
}

static snow_status render_reduced(snow_picture *p) {
    snow_comm *comm = p->ranks->comm;
    snow_image *image = NULL;
    snow_job job, pairs;
    snow_status status = SNOW_OK;
    if (keeps_pixels(p))
        status = snow_image_new(p->job.context, p->view.width, p->view.height,
                                2, &image);
    if (status == SNOW_OK)
        status = snow_modes_pairs(p->frame, &p->job, &pairs);
    status = snow_comm_agree(comm, status);
    if (status == SNOW_OK) {
        job = p->job;
        p->job = pairs;
        status = combine_pairs(p, image);
        if (status == SNOW_OK)
            status = snow_job_finish(p->frame, &p->job);
        p->job = job;
        status = status == SNOW_OK ? paint(p, &job, image) : status;
    }
    snow_image_free(image);
    return snow_comm_agree(comm, status);
}

/* --- surfaces -------------------------------------------------------------
 */

/* (depth, 1) where there is a depth. */
static void take_depths(const snow_image *depth, float *pairs) {
    size_t count = (size_t)depth->width * (size_t)depth->height;
    for (size_t n = 0; n < count; n++) {
        bool here = !isnan(depth->pixels[n]);
        pairs[2 * n] = here ? depth->pixels[n] : 0;
        pairs[2 * n + 1] = here;
    }
}

static void give_depths(const snow_image *pairs, snow_image *depth) {
    size_t count = (size_t)depth->width * (size_t)depth->height;
    for (size_t n = 0; n < count; n++)
        depth->pixels[n] =
            pairs->pixels[2 * n + 1] > 0 ? pairs->pixels[2 * n] : NAN;
}

/* Collective.  The nearest of this and the other ranks' depths into p->depth of
 * rank 0. */
static snow_status combine_depths(snow_picture *p, const snow_image *depth) {
    snow_context *context = p->job.context;
    snow_image *pairs = NULL;
    snow_local local;
    int channels = p->job.channels;
    int deterministic = p->job.settings.deterministic;
    p->job.settings.deterministic = 0; /* pixels of one rank each */
    snow_status status = make_local(p, 2, &local);
    if (status == SNOW_OK) {
        take_depths(depth, p->ranks->images);
        status = snow_picture_prepare_exact(p, &local);
    }
    if (status == SNOW_OK && keeps_pixels(p))
        status =
            snow_image_new(context, p->view.width, p->view.height, 2, &pairs);
    if (status == SNOW_OK && keeps_pixels(p))
        status = snow_image_new(context, p->view.width, p->view.height, 1,
                                &p->depth);
    status = snow_comm_agree(p->ranks->comm, status);
    p->job.channels = 2;
    if (status == SNOW_OK)
        status = snow_picture_combine_exact(p, &local, 0, pairs);
    p->job.channels = channels;
    p->job.settings.deterministic = deterministic;
    if (status == SNOW_OK && pairs)
        give_depths(pairs, p->depth);
    snow_image_free(pairs);
    return status;
}

/* Room for this rank's own depths. */
static snow_status make_depth(snow_picture *p) {
    snow_frame *frame = p->frame;
    snow_image_free(frame->depth);
    frame->depth = NULL;
    if (!p->job.settings.depth)
        return SNOW_OK;
    return snow_image_new(p->job.context, p->view.width, p->view.height, 1,
                          &frame->depth);
}

/* Collective.  Alphas from the rank in front, and on to the one behind. */
static snow_status take_turn(snow_picture *p, int seat, float *alphas,
                             snow_status *local) {
    snow_ranks *r = p->ranks;
    size_t bytes =
        (size_t)p->view.width * (size_t)p->view.height * sizeof *alphas;
    if (seat > 0) {
        SNOW_TRY(snow_comm_receive(r->comm, alphas, bytes, r->order[seat - 1],
                                   SNOW_TAG_LAYERS, &r->messages[0]));
        SNOW_TRY(snow_comm_wait_all(r->comm, r->messages, 1));
    }
    *local = snow_depth_behind(p->frame, &p->job, alphas);
    if (seat + 1 == r->ranks)
        return SNOW_OK;
    SNOW_TRY(snow_comm_send(r->comm, alphas, bytes, r->order[seat + 1],
                            SNOW_TAG_LAYERS, &r->messages[0]));
    return snow_comm_wait_all(r->comm, r->messages, 1);
}

snow_status snow_picture_render_depth(snow_picture *p) {
    snow_ranks *r = p->ranks;
    snow_sight sight;
    snow_local local;
    int seat = 0;
    snow_status status = make_depth(p);
    if (status == SNOW_OK)
        status = make_local(p, 1, &local);
    snow_clip_sight(&p->job.placement, &sight);
    if (status == SNOW_OK)
        status = snow_order_boxes(p->job.context, r->boxes, r->ranks, &sight,
                                  r->order);
    SNOW_TRY(snow_comm_agree(r->comm, status));
    while (r->order[seat] != r->rank)
        seat++;
    SNOW_TRY(take_turn(p, seat, r->images, &status));
    SNOW_TRY(snow_comm_agree(r->comm, status));
    return combine_depths(p, p->frame->depth);
}

/* Local work: this rank's surfaces, with room for depths in frame->depth. */
static snow_status find_surfaces(snow_picture *p, snow_image **image,
                                 snow_local *local) {
    p->job.settings.deterministic = 0; /* bits do not depend on parts */
    SNOW_TRY(make_depth(p));
    SNOW_TRY(snow_iso_render(p->frame, &p->job, image));
    SNOW_TRY(make_local(p, p->job.channels, local));
    local->pixels = (*image)->pixels;
    return snow_picture_prepare_exact(p, local);
}

static snow_status render_surfaces(snow_picture *p) {
    snow_image *image = NULL;
    snow_local local;
    double cpu = snow_picture_cpu(p);
    snow_status status = find_surfaces(p, &image, &local);
    p->stats.cpu_splat += snow_picture_cpu(p) - cpu;
    status = snow_comm_agree(p->ranks->comm, status);
    if (status == SNOW_OK)
        status =
            snow_picture_combine_exact(p, &local, p->how.pixel_bits, p->image);
    if (status == SNOW_OK && p->frame->depth)
        status = combine_depths(p, p->frame->depth);
    snow_image_free(image);
    return status;
}

snow_status snow_picture_render_mode(snow_picture *p) {
    SNOW_TRY(agree_range(p));
    return p->job.settings.mode == SNOW_MODE_ISO ? render_surfaces(p)
                                                 : render_reduced(p);
}
