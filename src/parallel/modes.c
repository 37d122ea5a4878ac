/* parallel/modes.c - modes other than over by many processors, and depths.
 *
 *   mip, minip   pairs (value, 1): the larger of two    bit for bit the serial
 *   mean, sum    pairs of sums: their sum               but for rounding; the
 *                                                       same if deterministic
 *   iso          opaque pixels: what is in front, which is over's business
 *   depth        pairs (depth, 1): the same
 *
 * A depth of over is where opacity passes 1/2, which depends on all that is in
 * front: for these processors take turns, the nearest first, and each goes on
 * with the alphas that the one before it left.
 *
 * Each processor makes the pairs of its part (render/modes/modes.h) over the
 * whole's range, which all agree on first; they are exchanged as over's local
 * images are, on the slices' lattice where that is how they were made, warped
 * or copied piece by piece, and brought to rank 0, which makes colours or
 * values of them. */
#include "base/clear.h"
#include "parallel/internal.h"

#include <math.h>

snow_status snow_in_flight_agree_range(snow_in_flight *f) {
    enum { MINUS_LOW, HIGH, HOLES, COUNT };
    snow_identity_transfer *identity = &f->picture.frame->identity;
    snow_comm *comm = f->ranks->comm;
    double words[COUNT] = {-INFINITY, -INFINITY, 0};
    SNOW_TRY(snow_comm_agree_status(
        comm, snow_identity_transfer_measure(&f->picture.job, identity)));
    if (!identity->empty) {
        words[MINUS_LOW] = -identity->low;
        words[HIGH] = identity->high;
    }
    words[HOLES] = !identity->whole;
    SNOW_TRY(snow_comm_reduce_doubles(comm, words, COUNT, SNOW_REDUCE_MAX));
    if (!(-words[MINUS_LOW] <= words[HIGH]))
        words[MINUS_LOW] = words[HIGH] = 0;
    return snow_identity_transfer_widen(f->picture.job.context, identity,
                                        -words[MINUS_LOW], words[HIGH],
                                        words[HOLES] == 0);
}

/* Finds the ranges of the volume and of its layers. A part without voxels of
 * its own has none that count. */
static snow_status measure_values(snow_in_flight *f, snow_data_range *range) {
    snow_extent part;
    const snow_job *job = &f->picture.job;
    snow_frame *frame = f->picture.frame;
    const snow_transfer *look =
        job->settings.mode == SNOW_MODE_OVER ? job->transfer : NULL;
    for (int n = 0; n <= job->layer_count; n++) {
        const snow_transfer *of = n ? job->layers[n - 1].transfer : look;
        range[n] = (snow_data_range){.low = INFINITY,
                                     .high = -INFINITY,
                                     .log = of && of->log,
                                     .linear = of ? of->linear : 0};
    }
    SNOW_TRY(snow_value_path_new(frame->context, &frame->value_path));
    snow_volume_find_extent(job->volume, &part);
    if (!part.count[0] || !part.count[1] || !part.count[2])
        return SNOW_STATUS_OK;
    for (int n = 0; n < job->layer_count; n++)
        SNOW_TRY(snow_value_measure_layer(frame->value_path, n, &job->layers[n],
                                          job->settings.threads,
                                          &range[n + 1]));
    return snow_value_measure(frame->value_path, job->volume, look,
                              job->settings.threads, range);
}

/* Collective.  What all parts have together; *lost: some rank has no planes. */
static snow_status join_values(snow_in_flight *f, snow_data_range *range,
                               bool *lost) {
    enum { LOST, FIRST, MINUS_LOW = 0, HIGH, HOLES, MASKED, COUNT };
    const int count = 1 + f->picture.job.layer_count;
    double all[FIRST + COUNT * (1 + SNOW_LAYERS_MAX)];
    all[LOST] = f->picture.job.volume->lost_clip;
    for (int n = 0; n < count; n++) {
        double *words = all + FIRST + COUNT * n;
        words[MINUS_LOW] = -range[n].low;
        words[HIGH] = range[n].high;
        words[HOLES] = range[n].holes;
        words[MASKED] = range[n].masked;
    }
    SNOW_TRY(snow_comm_reduce_doubles(
        f->ranks->comm, all, (size_t)(FIRST + COUNT * count), SNOW_REDUCE_MAX));
    *lost = all[LOST] > 0;
    for (int n = 0; n < count; n++) {
        const double *words = all + FIRST + COUNT * n;
        range[n].low = -words[MINUS_LOW];
        range[n].high = words[HIGH];
        range[n].holes = words[HOLES] > 0;
        range[n].masked = words[MASKED] > 0;
    }
    return SNOW_STATUS_OK;
}

snow_status snow_in_flight_agree_values(snow_in_flight *f) {
    snow_value_path **path = &f->picture.frame->value_path;
    snow_data_range range[1 + SNOW_LAYERS_MAX];
    bool lost;
    f->ranks->values_of = 0;
    SNOW_TRY(snow_comm_agree_status(f->ranks->comm, measure_values(f, range)));
    SNOW_TRY(join_values(f, range, &lost));
    if (lost)
        return snow_fail(
            f->ranks->context, SNOW_STATUS_BAD_USAGE,
            "method shear-warp needs the clip planes on every rank, and some "
            "have none; clip all parts of the volume");
    f->ranks->values = range[0];
    f->ranks->values_of = f->generation;
    snow_value_set_range(*path, range);
    const int layers = f->picture.job.layer_count;
    const snow_status status = snow_value_set_layers(*path, range + 1, layers);
    return layers ? snow_comm_agree_status(f->ranks->comm, status) : status;
}

bool snow_in_flight_knows_values(const snow_in_flight *f) {
    const snow_ranks *r = f->ranks;
    return r->values_of && r->values_of == f->generation &&
           snow_data_range_is_of(&r->values, f->picture.job.transfer);
}

snow_status snow_in_flight_recall_values(snow_in_flight *f) {
    snow_data_range own; /* labels are a part's own, too */
    SNOW_TRY(measure_values(f, &own));
    snow_value_set_range(f->picture.frame->value_path, &f->ranks->values);
    return snow_value_set_layers(f->picture.frame->value_path, NULL, 0);
}

/* --- pairs ---------------------------------------------------------------- */

snow_status snow_in_flight_paint(snow_in_flight *f) {
    snow_picture *p = &f->picture;
    if (!f->gathered)
        return SNOW_STATUS_OK;
    SNOW_TRY(
        snow_modes_paint(p->frame, &p->job, f->gathered->pixels, &p->image));
    if (f->how.pixel_bits == 8 && p->image->channels > 1)
        snow_round_pixels(p->image);
    return SNOW_STATUS_OK;
}

/* --- depths --------------------------------------------------------------- */

/* (depth, 1) where there is a depth. */
static void take_depths(const snow_image *depth, float *pairs) {
    size_t count = (size_t)depth->width * (size_t)depth->height;
    for (size_t n = 0; n < count; n++) {
        bool here = !isnan(depth->pixels[n]);
        pairs[2 * n] = here ? depth->pixels[n] : 0;
        pairs[2 * n + 1] = here;
    }
}

/* Depths are exchanged as pairs, each of one rank. */
static snow_job pairs_job(const snow_in_flight *f) {
    snow_job job = f->picture.pass->job;
    job.channels = 2;
    job.settings.mode = SNOW_MODE_OVER;
    job.settings.deterministic = 0;
    return job;
}

/* Local work. */
static snow_status prepare_pairs(snow_in_flight *f, const snow_job *job,
                                 snow_image **pairs) {
    snow_picture *p = &f->picture;
    p->local.layers = 1;
    SNOW_TRY(snow_in_flight_capacity(f, job, 1));
    take_depths(p->near, f->ranks->images);
    SNOW_TRY(snow_in_flight_prepare(f, job));
    if (!snow_in_flight_keeps(f))
        return SNOW_STATUS_OK;
    SNOW_TRY(
        snow_image_new(job->context, p->view.width, p->view.height, 2, pairs));
    return snow_image_new(job->context, p->view.width, p->view.height, 1,
                          &p->depth);
}

snow_status snow_in_flight_combine_depths(snow_in_flight *f) {
    const snow_job job = pairs_job(f);
    snow_image *pairs = NULL;
    snow_status status =
        snow_comm_agree_status(f->ranks->comm, prepare_pairs(f, &job, &pairs));
    if (status == SNOW_STATUS_OK)
        status = snow_in_flight_exchange(f, &job);
    if (status == SNOW_STATUS_OK)
        status = snow_in_flight_deliver(f, &job, 0, pairs);
    if (status == SNOW_STATUS_OK && pairs) {
        size_t count =
            (size_t)f->picture.depth->width * (size_t)f->picture.depth->height;
        for (size_t n = 0; n < count; n++)
            f->picture.depth->pixels[n] =
                pairs->pixels[2 * n + 1] > 0 ? pairs->pixels[2 * n] : NAN;
    }
    snow_image_free(pairs);
    return status;
}

/* --- depths of over -------------------------------------------------------
 *
 * Alphas travel through ranks->images. */

static int rank_position_of(const snow_ranks *r) {
    int rank_position = 0;
    while (r->order[rank_position] != r->rank)
        rank_position++;
    return rank_position;
}

/* Local work: the order of the ranks, and places. */
static snow_status prepare_turn(snow_in_flight *f) {
    snow_picture *p = &f->picture;
    snow_frame *frame = p->frame;
    const snow_job *job = &p->pass->job;
    snow_job alphas = *job;
    alphas.channels = 1;
    SNOW_TRY(snow_in_flight_capacity(f, &alphas, 1));
    SNOW_TRY(
        snow_reserve(job->context, &frame->layer, 0, 1, snow_job_bytes(job)));
    SNOW_TRY(snow_picture_new_depths(p, &p->near));
    SNOW_TRY(snow_clear(job->context, frame->layer, snow_job_bytes(job)));
    p->local.pixels = frame->layer;
    return snow_ranks_put_in_order(f->ranks, &job->placement);
}

snow_status snow_in_flight_take_turn(snow_in_flight *f, snow_status status) {
    snow_ranks *r = f->ranks;
    const snow_job *job = &f->picture.pass->job;
    size_t count = (size_t)job->view->width * (size_t)job->view->height;
    size_t channels = (size_t)job->channels;
    if (status == SNOW_STATUS_OK)
        status = prepare_turn(f);
    SNOW_TRY(snow_comm_agree_status(r->comm, status));
    int rank_position = rank_position_of(r);
    if (rank_position > 0) {
        SNOW_TRY(snow_comm_receive(
            r->comm, r->images, count * sizeof *r->images,
            r->order[rank_position - 1], SNOW_TAG_LAYERS, &r->messages[0]));
        SNOW_TRY(snow_comm_wait_all(r->comm, r->messages, 1));
    }
    for (size_t n = 0; n < count; n++)
        f->picture.local.pixels[(n + 1) * channels - 1] = r->images[n];
    f->turn = true;
    return SNOW_STATUS_OK;
}

snow_status snow_in_flight_give_turn(snow_in_flight *f, snow_status status) {
    snow_ranks *r = f->ranks;
    const snow_job *job = &f->picture.pass->job;
    size_t count = (size_t)job->view->width * (size_t)job->view->height;
    size_t channels = (size_t)job->channels;
    if (!f->turn) /* no rank has drawn */
        return status;
    int rank_position = rank_position_of(r);
    for (size_t n = 0; n < count; n++)
        r->images[n] = f->picture.local.pixels[(n + 1) * channels - 1];
    if (rank_position + 1 < r->ranks) {
        SNOW_TRY(snow_comm_send(r->comm, r->images, count * sizeof *r->images,
                                r->order[rank_position + 1], SNOW_TAG_LAYERS,
                                &r->messages[0]));
        SNOW_TRY(snow_comm_wait_all(r->comm, r->messages, 1));
    }
    return snow_comm_agree_status(r->comm, status);
}
