/* bench/frame/frame_run.c - one rank's share of a picture: timed, counted, and
 * on rank 0 compared with the picture of the whole.
 *
 * The first picture is also encoded; the others are of the same look, as when
 * nothing but the view changes.  Each rank works on one thread, so that its
 * processor time is that of its thread, or process. */
#include "frame.h"
#include "hosts.h"

#include <snowglass/extend.h>

#include <stdlib.h>
#include <string.h>

static double cpu_seconds(const frame_rank *s) {
    struct timespec now;
    clock_gettime(s->cpu_clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The same without what the transport took. */
static double work_seconds(const frame_rank *s) {
    return s->options->simulated ? snow_simulated_work(s->comm)
                                 : cpu_seconds(s) - s->meter.inside;
}

/* --- before --------------------------------------------------------------- */

static snow_status fill_view(frame_rank *s) {
    const frame_options *options = s->options;
    snow_volume_info info = {.size = sizeof info};
    snow_view_init(&s->view);
    snow_status status =
        snow_volume_inspect(s->context, options->path, &options->data, &info);
    if (status == SNOW_STATUS_OK)
        status = snow_view_from_name(
            s->context, info.medical ? "anterior" : "+z", &s->view);
    s->view.width = options->width;
    s->view.height = options->height;
    s->view.azimuth = options->azimuth;
    s->view.elevation = options->elevation;
    return status;
}

static snow_status prepare(frame_rank *s) {
    const frame_options *options = s->options;
    snow_settings_init(&s->settings);
    s->settings.threshold = options->threshold;
    s->settings.threads = 1;
    s->how = (snow_ranks_options){.size = sizeof(snow_ranks_options),
                                  .cut = options->cut,
                                  .combining = options->combining,
                                  .radix = options->radix,
                                  .pixel_bits = 8,
                                  .turns = options->turn > 0};
    s->all = calloc((size_t)snow_comm_size(s->comm), sizeof *s->all);
    const size_t figures =
        (size_t)snow_comm_size(s->comm) * (size_t)options->runs;
    s->splats = calloc(figures, sizeof *s->splats);
    s->works = calloc(figures, sizeof *s->works);
    if (!s->all || !s->splats || !s->works)
        return snow_context_fail(s->context, SNOW_STATUS_NO_MEMORY,
                                 "no memory for figures; close other programs");
    snow_status status = fill_view(s);
    return status == SNOW_STATUS_OK ? snow_frame_new(s->context, &s->frame)
                                    : status;
}

static snow_status open_part(frame_rank *s) {
    double start = snow_comm_seconds(s->comm), cpu = cpu_seconds(s);
    const snow_look look = {.size = sizeof look};
    snow_status status = snow_ranks_open(
        s->comm, s->options->path, &s->options->data, &look, &s->view,
        &s->settings, &s->how, &s->volume, &s->transfer);
    s->mine.seconds[FRAME_READ] = snow_comm_seconds(s->comm) - start;
    s->mine.seconds[FRAME_READ_CPU] = cpu_seconds(s) - cpu;
    return status;
}

static void finish(frame_rank *s) {
    snow_image_free(s->image);
    snow_frame_free(s->frame);
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
    free(s->all);
    free(s->splats);
    free(s->works);
}

/* --- a picture ------------------------------------------------------------ */

/* What the library says of the last picture. */
static void take_stats(frame_rank *s, bool first) {
    const snow_stats *stats = snow_frame_stats(s->frame);
    const snow_ranks_stats *shared = snow_frame_ranks_stats(s->frame);
    double *seconds = s->mine.seconds;
    snow_extent part = {.size = sizeof part};
    snow_volume_get_extent(s->volume, &part);
    if (first)
        seconds[FRAME_ENCODE] = stats->seconds_classify + stats->seconds_shade +
                                stats->seconds_encode;
    seconds[FRAME_SPLAT] = stats->seconds_splat + stats->seconds_composite;
    seconds[FRAME_EXCHANGE] = shared->seconds_combine;
    seconds[FRAME_WARP] = stats->seconds_warp;
    seconds[FRAME_GATHER] = shared->seconds_gather;
    if (first)
        s->mine.first_local = shared->cpu_splat;
    else
        seconds[FRAME_ENCODE_CPU] =
            s->mine.first_local > shared->cpu_splat
                ? s->mine.first_local - shared->cpu_splat
                : 0;
    seconds[FRAME_SPLAT_CPU] = shared->cpu_splat;
    seconds[FRAME_EXCHANGE_CPU] = shared->cpu_combine;
    seconds[FRAME_WARP_CPU] = shared->cpu_warp;
    seconds[FRAME_GATHER_CPU] = shared->cpu_gather;
    s->mine.active = shared->active_pixels;
    s->mine.early = shared->bytes_early;
    s->mine.rounds =
        shared->rounds < FRAME_ROUNDS_MOST ? shared->rounds : FRAME_ROUNDS_MOST;
    memcpy(s->mine.radices, shared->radices, sizeof s->mine.radices);
    s->mine.voxels = stats->interesting;
    s->mine.slices = part.count[stats->slice_axis];
    s->mine.method = stats->method;
}

/* Collective. */
static snow_status draw(frame_rank *s, bool first) {
    double *seconds = s->mine.seconds;
    uint64_t messages, bytes;
    snow_image_free(s->image);
    s->image = NULL;
    snow_status status =
        snow_comm_agree_status(s->comm, SNOW_STATUS_OK); /* a barrier */
    if (status != SNOW_STATUS_OK)
        return status;
    snow_comm_sent(s->comm, &messages, &bytes);
    const double start = snow_comm_seconds(s->comm), cpu = cpu_seconds(s);
    const double work = work_seconds(s);
    status = snow_ranks_render(s->frame, s->comm, s->volume, s->transfer,
                               &s->view, &s->settings, &s->how, &s->image);
    seconds[first ? FRAME_FIRST : FRAME_TOTAL] =
        snow_comm_seconds(s->comm) - start;
    seconds[FRAME_WORK_CPU] = work_seconds(s) - work; /* within all of it: */
    seconds[first ? FRAME_FIRST_CPU : FRAME_TOTAL_CPU] = cpu_seconds(s) - cpu;
    snow_comm_sent(s->comm, &s->mine.messages, &s->mine.bytes);
    s->mine.messages -= messages;
    s->mine.bytes -= bytes;
    if (status == SNOW_STATUS_OK)
        take_stats(s, first);
    return status;
}

/* --- all ranks ------------------------------------------------------------ */

static void add_rank(const frame_figures *f, int ranks, frame_result *out) {
    for (int i = 0; i < FRAME_STAGES; i++) {
        if (f->seconds[i] > out->most[i])
            out->most[i] = f->seconds[i];
        out->mean[i] += f->seconds[i] / ranks;
    }
    out->bytes_sum += f->bytes;
    out->early_sum += f->early;
    out->voxels_sum += f->voxels;
    if (f->bytes > out->bytes_most)
        out->bytes_most = f->bytes;
    if (f->messages > out->messages_most)
        out->messages_most = f->messages;
    if (f->voxels > out->voxels_most)
        out->voxels_most = f->voxels;
    if (f->active > out->active_most)
        out->active_most = f->active;
    if (f->slices < out->slices_least)
        out->slices_least = f->slices;
}

/* Channels, and pixels that are not transparent: the last channel's. */
static void count_pixels(snow_image *image, frame_result *out) {
    const float *pixels = snow_image_pixels(image);
    int64_t count = (int64_t)snow_image_width(image) * snow_image_height(image);
    out->channels = snow_image_channels(image);
    for (int64_t i = 1; i <= count; i++)
        out->shown += pixels[i * out->channels - 1] > 0;
}

/* Collective: the figures of all, summed up on each. */
static snow_status sum_up(frame_rank *s, frame_result *out) {
    const int ranks = snow_comm_size(s->comm);
    *out = (frame_result){.ranks = ranks, .slices_least = INT64_MAX};
    snow_status status =
        snow_comm_allgather(s->comm, &s->mine, sizeof s->mine, s->all);
    if (status != SNOW_STATUS_OK)
        return status;
    for (int i = 0; i < ranks; i++)
        add_rank(&s->all[i], ranks, out);
    out->method = s->all[0].method;
    out->nodes = ranks; /* that are simulated, of one processor */
    out->node_ranks = 1;
    if (!s->options->simulated) {
        bench_hosts hosts;
        status = bench_hosts_count(s->comm, &hosts);
        if (status != SNOW_STATUS_OK)
            return status;
        out->nodes = hosts.nodes;
        out->node_ranks = hosts.node_ranks;
    }
    if (s->image)
        count_pixels(s->image, out);
    out->rounds = s->all[0].rounds;
    memcpy(out->radices, s->all[0].radices, sizeof out->radices);
    return SNOW_STATUS_OK;
}

/* What local images took, of all ranks. */
static void note_splats(frame_rank *s, int number) {
    const int ranks = snow_comm_size(s->comm);
    for (int i = 0; i < ranks; i++) {
        const int place = i * s->options->runs + number;
        s->splats[place] = s->all[i].seconds[FRAME_SPLAT_CPU];
        s->works[place] = s->all[i].seconds[FRAME_WORK_CPU];
    }
}

/* Ranks' least over the pictures since the last cut, but the first of them,
 * which encodes: noise would make some rank slow at every picture. */
static void find_least(const frame_rank *s, const double *times,
                       double *slowest, double *mean) {
    const int ranks = snow_comm_size(s->comm), runs = s->options->runs;
    const int first = s->cuts ? s->cut_before + 1 : 0;
    double most = 0, sum = 0;
    for (int i = 0; i < ranks && first < runs; i++) {
        const double *row = times + i * runs;
        double least = row[first];
        for (int n = first + 1; n < runs; n++)
            least = row[n] < least ? row[n] : least;
        most = least > most ? least : most;
        sum += least;
    }
    *slowest = most;
    *mean = sum / ranks;
}

/* Collective.  Parts may be cut anew by the time that pictures took; but the
 * last pictures are of one cut. */
static snow_status balance(frame_rank *s, int number) {
    const snow_volume *before = s->volume;
    if (number > s->options->runs * 2 / 3)
        return SNOW_STATUS_OK;
    snow_status status = snow_ranks_rebalance(s->frame, s->comm, s->transfer,
                                              &s->view, &s->settings, &s->how,
                                              FRAME_PICTURES_LEFT, &s->volume);
    if (status == SNOW_STATUS_OK && before != s->volume)
        s->cut_before = number;
    s->cuts += before != s->volume;
    return status;
}

/* What the ranks worked on the fastest picture so far. */
static snow_status write_profile(frame_rank *s) {
    const char *path = s->options->profile;
    if (!path || snow_comm_rank(s->comm) ||
        frame_write_profile(path, s->all, snow_comm_size(s->comm)))
        return SNOW_STATUS_OK;
    return snow_context_fail(s->context, SNOW_STATUS_FAILED,
                             "%s: cannot be written; name a file in a folder "
                             "that is yours",
                             path);
}

/* Collective.  Of the later pictures the fastest counts. */
static snow_status measure(frame_rank *s, frame_result *out) {
    snow_status status = draw(s, true);
    for (int i = 0; i < s->options->runs && status == SNOW_STATUS_OK; i++) {
        frame_result this = {0};
        status = balance(s, i);
        if (status == SNOW_STATUS_OK)
            status = draw(s, false);
        if (status == SNOW_STATUS_OK)
            status = sum_up(s, &this);
        if (status == SNOW_STATUS_OK)
            note_splats(s, i);
        if (status == SNOW_STATUS_OK &&
            (i == 0 || i == s->cut_before + 1 ||
             this.most[FRAME_TOTAL] < out->most[FRAME_TOTAL])) {
            *out = this;
            status = snow_comm_agree_status(s->comm, write_profile(s));
        }
    }
    out->cuts = s->cuts;
    if (status == SNOW_STATUS_OK) {
        find_least(s, s->splats, &out->splat_most, &out->splat_mean);
        find_least(s, s->works, &out->work_most, &out->work_mean);
    }
    return status;
}

/* --- the picture of one rank ---------------------------------------------- */

/* To whole steps of 1/255, as pixels travelled. */
static void round_pixels(snow_image *image) {
    float *pixels = snow_image_pixels(image);
    size_t count = (size_t)snow_image_width(image) *
                   (size_t)snow_image_height(image) *
                   (size_t)snow_image_channels(image);
    for (size_t i = 0; i < count; i++)
        pixels[i] = (float)(unsigned char)(pixels[i] * 255 + 0.5f) / 255;
}

typedef struct alone {
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    snow_image *image;
} alone;

static snow_status open_alone(frame_rank *s, alone *a) {
    const snow_look look = {.size = sizeof look};
    snow_status status = snow_volume_open(s->context, s->options->path,
                                          &s->options->data, &a->volume);
    if (status == SNOW_STATUS_OK)
        status = snow_transfer_new_for_volume(a->volume, &look, &a->transfer);
    return status == SNOW_STATUS_OK ? snow_frame_new(s->context, &a->frame)
                                    : status;
}

/* As many pictures as by all ranks; the fastest of the later ones counts. */
static snow_status draw_alone(frame_rank *s, alone *a, frame_result *out) {
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; i <= s->options->runs && status == SNOW_STATUS_OK; i++) {
        snow_image_free(a->image);
        a->image = NULL;
        double cpu = cpu_seconds(s);
        status = snow_frame_render(a->frame, a->volume, a->transfer, &s->view,
                                   &s->settings, &a->image);
        cpu = cpu_seconds(s) - cpu;
        if (i == 0)
            out->alone_first = cpu;
        else if (i == 1 || cpu < out->alone)
            out->alone = cpu;
    }
    return status;
}

static snow_status compare(frame_rank *s, frame_result *out) {
    alone a = {0};
    snow_image_difference difference = {.size = sizeof difference};
    snow_status status = open_alone(s, &a);
    if (status == SNOW_STATUS_OK)
        status = draw_alone(s, &a, out);
    if (status == SNOW_STATUS_OK) {
        round_pixels(a.image);
        status = snow_image_compare(s->image, a.image, &difference);
    }
    if (status == SNOW_STATUS_OK) {
        out->checked = true;
        out->difference = difference.largest;
        out->voxels_whole = snow_frame_stats(a.frame)->interesting;
    }
    snow_image_free(a.image);
    snow_frame_free(a.frame);
    snow_transfer_free(a.transfer);
    snow_volume_close(a.volume);
    return status;
}

static bool is_checked(const frame_rank *s) {
    return s->options->check ||
           (!s->options->no_check &&
            snow_comm_size(s->comm) <= FRAME_CHECKED_RANKS);
}

/* All that is measured of a communicator's ranks. */
static snow_status run_frame(frame_rank *s, frame_session *session) {
    snow_comm *comm = s->comm;
    frame_result result = {0};
    snow_status status = snow_comm_agree_status(comm, prepare(s));
    if (status == SNOW_STATUS_OK)
        status = open_part(s);
    if (status == SNOW_STATUS_OK)
        status = measure(s, &result);
    if (status == SNOW_STATUS_OK && s->options->turn)
        status = frame_turn(s, &result);
    if (status == SNOW_STATUS_OK) {
        if (is_checked(s) && snow_comm_rank(comm) == 0)
            status = compare(s, &result);
        status = snow_comm_agree_status(comm, status);
    }
    if (status == SNOW_STATUS_OK && snow_comm_rank(comm) == 0)
        session->result = result;
    finish(s);
    return status;
}

snow_status frame_body(snow_comm *comm, void *user) {
    frame_session *session = user;
    frame_rank s = {.options = session->options,
                    .comm = comm,
                    .context = snow_comm_context(comm),
                    .cpu_clock = session->threads ? CLOCK_THREAD_CPUTIME_ID
                                                  : CLOCK_PROCESS_CPUTIME_ID};
    if (session->options->simulated)
        return run_frame(&s, session);
    s.meter = (bench_meter){.inner = comm, .clock = s.cpu_clock};
    snow_status status =
        snow_comm_agree_status(comm, bench_meter_new(&s.meter, &s.comm));
    if (status == SNOW_STATUS_OK)
        status = run_frame(&s, session);
    if (s.comm != comm)
        snow_comm_free(s.comm);
    return status;
}
