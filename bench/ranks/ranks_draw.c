/* bench/ranks/ranks_draw.c - the picture of one rank, and what each of many
 * does for the same: draws its part, takes the time, and on rank 0 compares.
 *
 * The first picture also encodes; the others are of the same look, as when
 * nothing but the view changes, and are timed. */
#include "ranks.h"

#include "comm/comm.h" /* what was read in place is in no public record */

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One step of 8 bits, and the rounding of floats that hold such steps. */
static const double allowed = 1.0 / 255 + 1e-6;

static double seconds_of(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The view, and the settings of one thread. */
static snow_status settle(snow_context *context, const ranks_options *options,
                          snow_view *view, snow_settings *settings) {
    snow_volume_info info = {.size = sizeof info};
    snow_view_init(view);
    snow_settings_init(settings);
    snow_status status =
        snow_volume_inspect(context, options->path, &options->data, &info);
    if (status == SNOW_STATUS_OK)
        status = snow_view_from_name(context, info.medical ? "anterior" : "+z",
                                     view);
    view->width = view->height = options->side;
    view->azimuth = options->azimuth;
    view->elevation = options->elevation;
    settings->threshold = options->threshold;
    settings->threads = 1;
    return status;
}

/* --- one rank that is alone ----------------------------------------------- */

/* To whole steps of 1/255, as pixels travel. */
static void round_pixels(snow_image *image) {
    float *pixels = snow_image_pixels(image);
    size_t count = (size_t)snow_image_width(image) *
                   (size_t)snow_image_height(image) *
                   (size_t)snow_image_channels(image);
    for (size_t i = 0; i < count; i++)
        pixels[i] = (float)(unsigned char)(pixels[i] * 255 + 0.5f) / 255;
}

/* As many pictures as by many ranks, the last of which is kept. */
static snow_status draw_alone(snow_frame *frame, const snow_volume *volume,
                              const snow_transfer *transfer,
                              const snow_view *view,
                              const snow_settings *settings,
                              const ranks_options *options, ranks_alone *out) {
    const clockid_t clock =
        options->simulated ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC;
    snow_status status = SNOW_STATUS_OK;
    *out = (ranks_alone){.seconds = INFINITY};
    for (int i = 0; i <= options->runs && status == SNOW_STATUS_OK; i++) {
        snow_image_free(out->image);
        out->image = NULL;
        const double start = seconds_of(clock);
        status = snow_frame_render(frame, volume, transfer, view, settings,
                                   &out->image);
        if (i > 0)
            out->seconds = fmin(out->seconds, seconds_of(clock) - start);
    }
    if (status == SNOW_STATUS_OK)
        round_pixels(out->image);
    return status;
}

snow_status ranks_draw_alone(snow_context *context,
                             const ranks_options *options, ranks_alone *out) {
    const snow_look look = {.size = sizeof look};
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    snow_view view;
    snow_settings settings;
    snow_status status = settle(context, options, &view, &settings);
    if (status == SNOW_STATUS_OK)
        status =
            snow_volume_open(context, options->path, &options->data, &volume);
    if (status == SNOW_STATUS_OK)
        status = snow_transfer_new_for_volume(volume, &look, &transfer);
    if (status == SNOW_STATUS_OK)
        status = snow_frame_new(context, &frame);
    if (status == SNOW_STATUS_OK)
        status =
            draw_alone(frame, volume, transfer, &view, &settings, options, out);
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}

/* --- one of many ---------------------------------------------------------- */

/* The figures that a rank sends: the least of its pictures. */
typedef struct rank_figures {
    double splat, exchange;
    uint64_t bytes_sent, bytes_in_place;
} rank_figures;

typedef struct rank_state {
    const ranks_options *options;
    snow_comm *comm;
    snow_context *context;
    snow_view view;
    snow_settings settings;
    snow_ranks_options how;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    snow_image *image; /* rank 0's */
    rank_figures mine, *all;
    double *ends; /* of a picture, for each rank */
    ranks_row row;
} rank_state;

static snow_status prepare(rank_state *s) {
    const size_t ranks = (size_t)snow_comm_size(s->comm);
    s->how = (snow_ranks_options){.size = sizeof s->how,
                                  .cut = s->options->cut,
                                  .combining = s->options->combining,
                                  .pixel_bits = 8};
    s->mine = (rank_figures){.splat = INFINITY, .exchange = INFINITY};
    s->row = (ranks_row){.ranks = (int)ranks, .picture = INFINITY};
    s->all = calloc(ranks, sizeof *s->all);
    s->ends = calloc(ranks, sizeof *s->ends);
    if (!s->all || !s->ends)
        return snow_context_fail(s->context, SNOW_STATUS_NO_MEMORY,
                                 "no memory for figures; close other programs");
    snow_status status = settle(s->context, s->options, &s->view, &s->settings);
    return status == SNOW_STATUS_OK ? snow_frame_new(s->context, &s->frame)
                                    : status;
}

/* Of the last picture. */
static void note_stats(rank_state *s) {
    const snow_ranks_stats *stats = snow_frame_ranks_stats(s->frame);
    s->mine.splat = fmin(s->mine.splat, stats->cpu_splat);
    s->mine.exchange =
        fmin(s->mine.exchange, stats->seconds_combine + stats->seconds_gather);
    s->row.rounds = stats->rounds;
    memcpy(s->row.radices, stats->radices, sizeof s->row.radices);
}

/* Collective.  Only the first picture is not timed. */
static snow_status draw(rank_state *s, bool timed) {
    const int ranks = snow_comm_size(s->comm);
    snow_status status =
        snow_comm_agree_status(s->comm, SNOW_STATUS_OK); /* a barrier */
    const uint64_t sent = s->comm->bytes_sent, placed = s->comm->bytes_shared;
    const double start = snow_comm_seconds(s->comm);
    snow_image_free(s->image);
    s->image = NULL;
    if (status == SNOW_STATUS_OK)
        status = snow_ranks_render(s->frame, s->comm, s->volume, s->transfer,
                                   &s->view, &s->settings, &s->how, &s->image);
    const double took = snow_comm_seconds(s->comm) - start;
    if (status != SNOW_STATUS_OK || !timed)
        return status;
    note_stats(s);
    s->mine.bytes_sent = s->comm->bytes_sent - sent;
    s->mine.bytes_in_place = s->comm->bytes_shared - placed;
    status = snow_comm_allgather(s->comm, &took, sizeof took, s->ends);
    double last = 0;
    for (int i = 0; i < ranks; i++)
        last = fmax(last, s->ends[i]);
    s->row.picture = fmin(s->row.picture, last);
    return status;
}

/* Rank 0's: the picture is that of one rank. */
static snow_status compare(rank_state *s, const ranks_alone *alone) {
    snow_image_difference found = {.size = sizeof found};
    snow_status status = snow_image_compare(s->image, alone->image, &found);
    s->row.difference = fmax(s->row.difference, found.largest);
    if (status == SNOW_STATUS_OK && !(found.largest <= allowed)) /* nor NaN */
        status = snow_context_fail(
            s->context, SNOW_STATUS_FAILED,
            "the picture of %d ranks is %g off that of one, more than a step "
            "of 8 bits; no time is printed, please report this",
            s->row.ranks, found.largest);
    return status;
}

/* Collective: the figures of all. */
static snow_status sum_up(rank_state *s) {
    const int ranks = s->row.ranks;
    ranks_row *row = &s->row;
    snow_status status =
        snow_comm_allgather(s->comm, &s->mine, sizeof s->mine, s->all);
    for (int i = 0; i < ranks && status == SNOW_STATUS_OK; i++) {
        const rank_figures *one = &s->all[i];
        row->splat_slowest = fmax(row->splat_slowest, one->splat);
        row->exchange_slowest = fmax(row->exchange_slowest, one->exchange);
        row->splat_mean += one->splat / ranks;
        row->exchange_mean += one->exchange / ranks;
        row->bytes_sent += one->bytes_sent;
        row->bytes_in_place += one->bytes_in_place;
    }
    return status;
}

/* All pictures of a rank whose part is open. */
static snow_status measure(rank_state *s, const ranks_alone *alone) {
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; i <= s->options->runs && status == SNOW_STATUS_OK; i++) {
        status = draw(s, i > 0);
        if (status == SNOW_STATUS_OK && snow_comm_rank(s->comm) == 0)
            status = compare(s, alone);
        status = snow_comm_agree_status(s->comm, status);
    }
    return status == SNOW_STATUS_OK ? sum_up(s) : status;
}

static void finish(rank_state *s) {
    snow_image_free(s->image);
    snow_frame_free(s->frame);
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
    free(s->all);
    free(s->ends);
}

snow_status ranks_body(snow_comm *comm, void *user) {
    ranks_session *session = user;
    const snow_look look = {.size = sizeof look};
    rank_state s = {.options = session->options,
                    .comm = comm,
                    .context = snow_comm_context(comm)};
    snow_status status = snow_comm_agree_status(comm, prepare(&s));
    if (status == SNOW_STATUS_OK)
        status = snow_ranks_open(comm, s.options->path, &s.options->data, &look,
                                 &s.view, &s.settings, &s.how, &s.volume,
                                 &s.transfer);
    if (status == SNOW_STATUS_OK)
        status = measure(&s, session->alone);
    if (status == SNOW_STATUS_OK && snow_comm_rank(comm) == 0)
        session->row = s.row;
    finish(&s);
    return status;
}
