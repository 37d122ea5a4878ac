/* render_state.c - renders pictures of a file.  Each of many ranks has its part
 * of the volume, and the first gets the pictures (snowglass/ranks.h). */
#include "picture/render_state.h"
#include "commands/commands.h"
#include "options/config.h"
#include "picture/annotations.h"
#include "picture/light.h"
#include "picture/warnings.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/start.h"

#include <snowglass/extend.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

/* What each rank reports to the others about a picture. */
typedef struct rank_figures {
    snow_stats stats;
    double combine, gather; /* seconds */
    uint64_t peak;
} rank_figures;

int render_state_check(const options *opts) {
    int done = layers_check(opts);
    if (done != CONTINUE)
        return done;
    warn_unused(opts);
    if (process_ranks() > 1 && strcmp(opts->operands[0], "-") == 0)
        return fail_usage("-: standard input cannot be shared by several "
                          "ranks, which each read a part; name a file");
    return CONTINUE;
}

int render_state_new(const options *opts, render_state *out) {
    *out = (render_state){.opts = opts};
    int done = open_render_context(opts, &out->context);
    if (done == CONTINUE) {
        snow_context_set_memory_limit(out->context, opts->memory);
        snow_context_set_progress(out->context, progress_show, NULL);
        size_t ranks = (size_t)process_ranks();
        out->figures = calloc(ranks, sizeof(rank_figures));
        if (!out->figures)
            done =
                fail_memory("out of memory at the start; close other programs");
    }
    return process_agree(done);
}

/* In any order, but the context last; all of them accept NULL. */
void render_state_free(render_state *s) {
    snow_image_free(s->made);
    for (int n = 0; n < s->in_flight; n++)
        snow_image_free(s->begun[n].made);
    snow_frame_free(s->frame);
    layers_close(&s->layers);
    channels_close(&s->channels);
    snow_transfer_free(s->transfer);
    snow_volume_close(s->volume);
    free(s->figures);
    if (s->context)
        close_render_context(s->context);
}

/* --- a volume ------------------------------------------------------------- */

static int place_camera(render_state *s) {
    int done = make_view(s->context, s->opts, &s->whole, &s->view);
    if (done == CONTINUE)
        done = make_settings(s->opts, &s->whole, &s->settings);
    s->settings.stop = interrupt_asked;
    return done;
}

/* What `frames` pictures of a turn show, from each side. */
static snow_status frame_turn(render_state *s, snow_comm *comm, size_t frames) {
    double *azimuths = malloc(frames * sizeof *azimuths);
    if (!azimuths)
        return snow_context_fail(s->context, SNOW_STATUS_NO_MEMORY,
                                 "out of memory for %zu angles; close other "
                                 "programs",
                                 frames);
    for (size_t i = 0; i < frames; i++)
        azimuths[i] = s->opts->azimuth + 360 * (double)i / (double)frames;
    const bool boxed = s->opts->box || s->channels.list.count > 1;
    snow_status status =
        snow_view_fit(comm, s->volume, boxed ? NULL : s->transfer, &s->settings,
                      azimuths, frames, &s->view);
    free(azimuths);
    return status;
}

/* So that the edges of a box are in the picture, the numbers of its axes, and
 * lines of text above or below it. */
#define OUTLINE_ZOOM 0.96
#define AXES_ZOOM 0.8
#define LINE_ZOOM 0.115

double render_state_margin(const options *opts) {
    const int lines = (opts->title != NULL) + (opts->annotate.text != NULL);
    if (!opts->box)
        return 1;
    return fmin(options_has_axes(opts) ? AXES_ZOOM : OUTLINE_ZOOM,
                OUTLINE_ZOOM - LINE_ZOOM * lines);
}

/* Frames what the look shows, once for all pictures.  What later steps show is
 * not known: their grid is framed. */
static snow_status frame_view(render_state *s) {
    snow_comm *comm = process_ranks() > 1 ? process_comm() : NULL;
    snow_status status = SNOW_STATUS_OK;
    if (strcmp(s->opts->fit, "visible") != 0)
        return SNOW_STATUS_OK;
    const bool boxed = s->opts->box != NULL;
    if (!s->framed && s->turns)
        status = frame_turn(s, comm, (size_t)s->opts->frames);
    else if (!s->framed)
        status = snow_view_fit(comm, s->volume,
                               s->steps || boxed || s->channels.list.count > 1
                                   ? NULL
                                   : s->transfer,
                               &s->settings, NULL, 0, &s->view);
    if (status != SNOW_STATUS_OK)
        return status;
    if (!s->framed)
        s->view.zoom *= render_state_margin(s->opts);
    if (!s->framed)
        s->frame_of = s->view;
    s->view = s->frame_of;
    s->framed = true;
    return SNOW_STATUS_OK;
}

void render_state_choose_shade(render_state *s) {
    if (s->channels.list.count && !options_given(s->opts, "shade"))
        s->settings.shade = SNOW_SHADE_NONE;
    if (s->transfer && snow_transfer_is_unshaded(s->transfer) &&
        s->settings.mode != SNOW_MODE_ISO &&
        (!s->layers.transfer ||
         snow_transfer_is_unshaded(s->layers.transfer)) &&
        !options_given(s->opts, "shade"))
        s->settings.shade = SNOW_SHADE_NONE;
}

/* Growing blocks of the encoding leave gaps in the heap, which count as memory
 * of the process.  Blocks with their own pages are returned to the system. */
static void return_memory(void) {
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 256 << 10);
#endif
}

/* Opens the volume in memory or in its file. */
static int open_as_planned(render_state *s, const options *step) {
    if (!s->plan.streams)
        return open_input(s->context, step, s->path, &s->volume);
    return_memory();
    snow_volume_options data = data_options(step);
    snow_status status = snow_volume_open_streamed(
        s->context, s->path, &data, s->plan.slab_bytes, &s->volume);
    return status == SNOW_STATUS_OK ? CONTINUE
                                    : fail_status(s->context, status);
}

static void report_slabs(const render_state *s) {
    if (s->opts->verbosity > 0)
        say("%s: stays in its file and is read in slabs of at least %.1f MiB: "
            "it is larger than the memory limit",
            s->path, (double)s->plan.slab_bytes / 0x1p20);
    if (s->opts->verbosity >= 0 && s->plan.packed)
        say("note: %s is smaller than its voxels and is unpacked again for "
            "each slab; convert it to a file of plain voxels to be faster",
            s->path);
}

/* For all channels that are drawn, as far as they are known. */
static int plan_memory(render_state *s, const options *step) {
    snow_volume_options data = data_options(step);
    bool report = step->verbosity > 0 && !s->transfer;
    int done = memory_plan_for(step, s->path, &data, s->channels.list.count,
                               report, &s->plan);
    if (done != CONTINUE)
        return done;
    s->plan.streams = s->plan.streams || (s->in_slabs && s->plan.may_stream);
    snow_context_set_memory_limit(s->context, s->plan.limit);
    return CONTINUE;
}

static void drop_frame(render_state *s) {
    snow_frame_free(s->frame);
    s->frame = NULL;
    s->frames_dropped++;
}

/* The volume is in memory, but what is computed from it does not fit beside it:
 * opens it again as a stream, and starts over. */
static int leave_in_file(render_state *s, const options *step) {
    drop_frame(s);
    snow_volume_close(s->volume);
    s->volume = NULL;
    channels_close_volumes(&s->channels);
    s->in_slabs = s->plan.streams = true;
    report_slabs(s);
    return open_as_planned(s, step);
}

static bool may_leave(const render_state *s, snow_status status) {
    return status == SNOW_STATUS_NO_MEMORY && s->plan.may_stream &&
           !s->plan.streams;
}

/* Whether channels that nobody asked for may give way: all pictures of a movie
 * show the same. */
static bool may_drop(const render_state *s, snow_status status) {
    return status == SNOW_STATUS_NO_MEMORY && s->channels.list.count > 1 &&
           !s->opts->channels.count && !s->steps && !s->drawn.path;
}

/* What is computed from several channels does not fit beside them: starts over
 * with the first one. */
static int drop_channels(render_state *s, const options *step) {
    channels_note(s->opts, &s->whole, "several need more memory");
    drop_frame(s);
    channels_close(&s->channels);
    snow_transfer_free(s->transfer);
    s->transfer = NULL;
    s->framed = false;
    return render_state_open(s, s->path, step->time);
}

/* Reading slabs is not counted. */
static snow_status make_look(render_state *s, const options *step) {
    snow_look look = look_options(step);
    double begin = seconds_now(), before = snow_volume_read_seconds(s->volume);
    snow_status status =
        s->channels.list.count
            ? channels_look(NULL, step, &s->whole, &s->channels.list.picks[0],
                            s->volume, &s->transfer)
            : snow_transfer_new_for_volume(s->volume, &look, &s->transfer);
    double reading = snow_volume_read_seconds(s->volume) - before;
    s->times.look += seconds_now() - begin - reading;
    s->times.read += reading;
    return status;
}

/* Channels and the overlay lie where the volume does: in memory, or in its
 * file. */
static int open_layers(render_state *s, const options *step) {
    layers *l = &s->layers;
    l->quiet = may_leave(s, SNOW_STATUS_NO_MEMORY) ||
               may_drop(s, SNOW_STATUS_NO_MEMORY);
    l->slab_bytes = s->plan.slab_bytes;
    snow_status status =
        channels_open(step, s->context, s->path, s->plan.streams, l->slab_bytes,
                      &s->channels);
    int done = status == SNOW_STATUS_OK
                   ? layers_open(step, s->context, s->volume, l)
               : l->quiet && status == SNOW_STATUS_NO_MEMORY
                   ? (int)status
                   : fail_volume(s->context, status, name_of_input(s->path));
    if (done != SNOW_STATUS_NO_MEMORY || !may_leave(s, (snow_status)done))
        return done;
    done = leave_in_file(s, step);
    return done == CONTINUE ? open_layers(s, step) : done;
}

static int frame_alone(render_state *s, const options *step) {
    double begin = seconds_now(), before = snow_volume_read_seconds(s->volume);
    snow_status status = frame_view(s);
    int done = CONTINUE;
    if (may_leave(s, status)) {
        done = leave_in_file(s, step);
        if (done == CONTINUE)
            done = open_layers(s, step);
        before = 0;
        status = done == CONTINUE ? frame_view(s) : SNOW_STATUS_OK;
    }
    if (may_drop(s, status) || may_drop(s, (snow_status)done))
        return drop_channels(s, step);
    if (status != SNOW_STATUS_OK)
        return fail_volume(s->context, status, name_of_input(s->path));
    double reading = snow_volume_read_seconds(s->volume) - before;
    s->times.look += seconds_now() - begin - reading;
    s->times.read += reading;
    return done;
}

/* The volume, and which channels of its file are drawn.  Opens it again where
 * the first of them is another. */
static int open_first(render_state *s, options *step) {
    const int64_t opened = step->channel;
    const bool known = s->channels.chosen;
    int done = open_as_planned(s, step);
    if (done != CONTINUE)
        return done;
    s->whole = *snow_volume_get_info(s->volume);
    done =
        channels_choose(step, &s->whole, channels_hinder(step), &s->channels);
    if (done != CONTINUE || known || !s->channels.list.count)
        return done;
    const bool streamed = s->plan.streams;
    step->channel = s->channels.list.picks[0].index;
    if (s->channels.list.count > 1)
        done = plan_memory(s, step);
    if (done != CONTINUE ||
        (step->channel == opened && !streamed && !s->plan.streams))
        return done;
    snow_volume_close(s->volume);
    s->volume = NULL;
    done = open_as_planned(s, step);
    if (done == CONTINUE)
        s->whole = *snow_volume_get_info(s->volume);
    return done;
}

/* Decompression and conversion count as reading. */
static int open_alone(render_state *s, options *step) {
    int done = plan_memory(s, step);
    double begin = seconds_now();
    if (done == CONTINUE)
        done = open_first(s, step);
    s->times.read += seconds_now() - begin;
    if (done != CONTINUE)
        return done;
    if (s->plan.streams)
        report_slabs(s);
    snow_status status = s->transfer ? SNOW_STATUS_OK : make_look(s, step);
    if (may_leave(s, status)) {
        done = leave_in_file(s, step);
        status = done == CONTINUE ? make_look(s, step) : SNOW_STATUS_OK;
    }
    if (status == SNOW_STATUS_OK && done == CONTINUE)
        done = open_layers(s, step);
    if (may_drop(s, status) || may_drop(s, (snow_status)done))
        return drop_channels(s, step);
    if (status != SNOW_STATUS_OK)
        return fail_volume(s->context, status, name_of_input(s->path));
    if (done == CONTINUE)
        done = place_camera(s);
    render_state_choose_shade(s);
    return done == CONTINUE ? frame_alone(s, step) : done;
}

/* Projections of channels are added up. */
static bool is_sum_of_channels(const render_state *s) {
    return mode_is_projection(s->opts->mode) && s->channels.list.count;
}

/* Eight bits per channel suffice between ranks if the picture is placed on a
 * background that was asked for, and rounded to them in the end.  On the
 * default background floats travel, so that no faint picture is rounded to an
 * empty one (exit status 7). */
static snow_ranks_options how_of(const render_state *s) {
    const options *opts = s->opts;
    bool coarse = opts->background.given && !opts->deterministic &&
                  options_bits(opts) != 16;
    return (snow_ranks_options){
        .size = sizeof(snow_ranks_options),
        .cut = (snow_partition)option_choice("cut", opts->cut),
        .combining = (snow_combine)option_choice("combine", opts->combine),
        .radix = (int)opts->radix,
        .pixel_bits = coarse && !is_sum_of_channels(s) ? 8 : 0,
        .turns = s->turns,
        .transfer = s->transfer,
        .one_look = s->one_look && !opts->overlay && !s->channels.list.count};
}

/* The look of each channel by all ranks, which read equal parts of it.  Those
 * of projections stay: each has its own picture. */
static int open_channels(render_state *s, const options *step) {
    const snow_look any = {.size = sizeof any, .preset = "linear"};
    snow_ranks_options how = how_of(s);
    snow_status status = SNOW_STATUS_OK;
    how.cut = SNOW_PARTITION_EQUAL;
    how.transfer = NULL;
    for (int n = 0; n < s->channels.list.count && status == SNOW_STATUS_OK;
         n++) {
        channel_pick *pick = &s->channels.list.picks[n];
        const snow_volume_options data = channels_data(step, pick);
        snow_transfer **look = n ? &s->channels.looks[n] : &s->transfer;
        snow_transfer *unused = NULL;
        snow_volume *part = NULL;
        if (*look && !(n && mode_is_projection(step->mode)))
            continue;
        status = snow_ranks_open(process_comm(), s->path, &data, &any, &s->view,
                                 &s->settings, &how, &part, &unused);
        snow_transfer_free(unused);
        if (status == SNOW_STATUS_OK && !*look)
            status = channels_look(process_comm(), step, &s->whole, pick, part,
                                   look);
        if (n && mode_is_projection(step->mode))
            s->channels.volumes[n] = part;
        else
            snow_volume_close(part);
    }
    if (status == SNOW_STATUS_OK)
        status =
            channels_open(step, s->context, s->path, true, 0, &s->channels);
    return process_agree(
        status == SNOW_STATUS_OK ? CONTINUE : fail_status(s->context, status));
}

/* The camera comes first: the partition of the volume depends on it. */
static int inspect(render_state *s, const options *step,
                   const snow_volume_options *data) {
    snow_volume_info_init(&s->whole);
    snow_status status =
        snow_volume_inspect(s->context, s->path, data, &s->whole);
    if (status != SNOW_STATUS_OK)
        return fail_status(s->context, status);
    int done =
        channels_choose(step, &s->whole, channels_hinder(step), &s->channels);
    return done == CONTINUE ? place_camera(s) : done;
}

/* Making the transfer function counts as reading: it needs values of all
 * parts. */
static int open_part(render_state *s, options *step) {
    double begin = seconds_now();
    snow_volume_options data = data_options(step);
    snow_look look = look_options(step);
    snow_transfer *transfer = NULL;
    int done = process_agree(inspect(s, step, &data));
    if (done == CONTINUE)
        done = open_channels(s, step);
    if (done != CONTINUE)
        return done;
    if (s->channels.list.count)
        data = channels_data(step, &s->channels.list.picks[0]);
    snow_ranks_options how = how_of(s);
    snow_status status =
        snow_ranks_open(process_comm(), s->path, &data, &look, &s->view,
                        &s->settings, &how, &s->volume, &transfer);
    if (status != SNOW_STATUS_OK)
        return fail_status(s->context, status);
    if (!s->transfer)
        s->transfer = transfer;
    done = process_agree(layers_open(step, s->context, s->volume, &s->layers));
    if (done != CONTINUE)
        return done;
    render_state_choose_shade(s);
    how.transfer = s->transfer;
    status = frame_view(s);
    if (status == SNOW_STATUS_OK && s->framed)
        status = snow_ranks_repartition(process_comm(), s->transfer, &s->view,
                                        &s->settings, &how, &s->volume);
    if (status != SNOW_STATUS_OK)
        return fail_status(s->context, status);
    s->times.read += seconds_now() - begin;
    return CONTINUE;
}

options render_state_step(const render_state *s, int64_t time) {
    options step = *s->opts;
    step.time = time;
    step.each_time = s->each_time;
    step.mixes = true;
    if (s->channels.list.count)
        step.channel = s->channels.list.picks[0].index;
    return step;
}

/* The old volume is closed first: there is never memory for two. */
int render_state_open(render_state *s, const char *path, int64_t time) {
    options step = render_state_step(s, time);
    s->path = path;
    snow_volume_close(s->volume);
    s->volume = NULL;
    channels_close_volumes(&s->channels);
    int done = process_ranks() > 1 ? open_part(s, &step) : open_alone(s, &step);
    if (done == CONTINUE)
        annotations_find_unit(s->opts, s->volume, process_ranks() > 1,
                              &s->whole);
    return done;
}

/* --- a picture ------------------------------------------------------------ */

/* Sums over ranks for counts; for times the slowest rank of each stage. */
static void add_figures(snow_stats *sum, const snow_stats *stats) {
    const struct {
        double *to, from;
    } rows[] = {{&sum->seconds_classify, stats->seconds_classify},
                {&sum->seconds_shade, stats->seconds_shade},
                {&sum->seconds_encode, stats->seconds_encode},
                {&sum->seconds_splat, stats->seconds_splat},
                {&sum->seconds_composite, stats->seconds_composite},
                {&sum->seconds_warp, stats->seconds_warp},
                {&sum->seconds_frame, stats->seconds_frame}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].from > *rows[i].to)
            *rows[i].to = rows[i].from;
    sum->voxels += stats->voxels;
    sum->interesting += stats->interesting;
    sum->ea_bytes += stats->ea_bytes;
    sum->ia_bytes += stats->ia_bytes;
    sum->pa_bytes += stats->pa_bytes;
}

static void sum_up(render_state *s) {
    const rank_figures *figures = s->figures;
    const int ranks = process_ranks();
    int64_t most = 0;
    s->stats = figures[0].stats;
    s->combine = s->gather = 0;
    s->peak = 0;
    for (int rank = 0; rank < ranks; rank++) {
        if (rank)
            add_figures(&s->stats, &figures[rank].stats);
        s->combine = fmax(s->combine, figures[rank].combine);
        s->gather = fmax(s->gather, figures[rank].gather);
        if (figures[rank].peak > s->peak)
            s->peak = figures[rank].peak;
        if (figures[rank].stats.interesting > most)
            most = figures[rank].stats.interesting;
    }
    double mean = (double)s->stats.interesting / ranks;
    s->load = mean > 0 ? (double)most / mean : 1;
    if (s->stats.voxels && ranks > 1)
        s->stats.sparse_ratio =
            1 - (double)s->stats.interesting / (double)s->stats.voxels;
}

static int take_figures(render_state *s) {
    const snow_ranks_stats *shared = snow_frame_ranks_stats(s->frame);
    rank_figures mine = {*snow_frame_stats(s->frame), shared->seconds_combine,
                         shared->seconds_gather,
                         snow_context_peak_bytes(s->context)};
    snow_status status = SNOW_STATUS_OK;
    if (process_ranks() > 1)
        status =
            snow_comm_allgather(process_comm(), &mine, sizeof mine, s->figures);
    else
        memcpy(s->figures, &mine, sizeof mine);
    sum_up(s);
    return status == SNOW_STATUS_OK ? CONTINUE
                                    : fail_status(s->context, status);
}

/* Other modes than over have none; a frame may have those of a picture before.
 */
static snow_status set_layers(render_state *s) {
    static const layers none;
    static const channel_set alone;
    const bool over = s->settings.mode == SNOW_MODE_OVER;
    return layers_set(over ? &s->layers : &none, over ? &s->channels : &alone,
                      s->frame);
}

static snow_status begin_part(render_state *s) {
    snow_ranks_options how = how_of(s);
    snow_status status = set_layers(s);
    if (s->turns && status == SNOW_STATUS_OK)
        status = snow_ranks_repartition(process_comm(), s->transfer, &s->view,
                                        &s->settings, &how, &s->volume);
    return status == SNOW_STATUS_OK
               ? snow_ranks_begin(s->frame, process_comm(), s->volume,
                                  s->transfer, &s->view, &s->settings, &how)
               : status;
}

static int make_frame(render_state *s) {
    if (s->frame) /* on all ranks */
        return CONTINUE;
    snow_status status = snow_frame_new(s->context, &s->frame);
    return process_agree(
        status == SNOW_STATUS_OK ? CONTINUE : fail_status(s->context, status));
}

/* By this process, or by all ranks, whose parts serve each picture in turn. */
static snow_status project(render_state *s, snow_volume **volume,
                           const snow_transfer *look) {
    snow_comm *comm = process_comm();
    const snow_ranks_options how = how_of(s);
    if (process_ranks() == 1)
        return snow_frame_render(s->frame, *volume, look, &s->view,
                                 &s->settings, &s->made);
    snow_status status = snow_ranks_repartition(comm, look, &s->view,
                                                &s->settings, &how, volume);
    return status == SNOW_STATUS_OK
               ? snow_ranks_render(s->frame, comm, *volume, look, &s->view,
                                   &s->settings, &how, &s->made)
               : status;
}

static snow_status project_channels(render_state *s) {
    snow_image *sum = NULL;
    snow_status status = set_layers(s), added = SNOW_STATUS_OK;
    for (int n = 0; n < s->channels.list.count && status == SNOW_STATUS_OK;
         n++) {
        snow_image_free(s->made);
        s->made = NULL;
        status = project(s, n ? &s->channels.volumes[n] : &s->volume,
                         n ? s->channels.looks[n] : s->transfer);
        if (status == SNOW_STATUS_OK && s->made && added == SNOW_STATUS_OK)
            added = light_add(s->context, s->made,
                              s->channels.list.picks[n].opacity, &sum);
    }
    if (sum)
        light_limit(sum);
    snow_image_free(s->made);
    s->made = sum;
    return status == SNOW_STATUS_OK ? added : status;
}

static snow_status draw_volume(render_state *s) {
    if (is_sum_of_channels(s))
        return project_channels(s);
    snow_status status = set_layers(s);
    return status == SNOW_STATUS_OK
               ? snow_frame_render(s->frame, s->volume, s->transfer, &s->view,
                                   &s->settings, &s->made)
               : status;
}

/* What pictures before this one left in the frame has to go where the limit of
 * memory is too low for both. */
static snow_status draw_alone(render_state *s) {
    double before = snow_volume_read_seconds(s->volume);
    snow_status status = draw_volume(s);
    if (status == SNOW_STATUS_NO_MEMORY && s->drawn.path) {
        drop_frame(s);
        status = snow_frame_new(s->context, &s->frame);
        if (status == SNOW_STATUS_OK)
            status = draw_volume(s);
    }
    s->times.read += snow_volume_read_seconds(s->volume) - before;
    return status;
}

/* A lost rank makes both pictures in flight fail; only one message is
 * printed. */
static int fail_picture(render_state *s, snow_status status, const char *path) {
    if (!s->fault)
        s->fault = fail_volume(s->context, status, name_of_input(path));
    return s->fault;
}

int render_state_begin(render_state *s, double azimuth) {
    snow_status status;
    int done = make_frame(s);
    if (done != CONTINUE)
        return done;
    s->view.azimuth = azimuth;
    status = process_ranks() == 1    ? draw_alone(s)
             : is_sum_of_channels(s) ? project_channels(s)
                                     : begin_part(s);
    if (may_leave(s, status)) {
        options step = render_state_step(s, s->whole.time);
        done = leave_in_file(s, &step);
        if (done == CONTINUE)
            done = open_layers(s, &step);
        if (done == CONTINUE)
            done = make_frame(s);
        if (done == CONTINUE)
            status = draw_alone(s);
        else if (!may_drop(s, (snow_status)done))
            return done;
    }
    if (may_drop(s, status)) {
        options step = render_state_step(s, s->whole.time);
        done = drop_channels(s, &step);
        return done == CONTINUE ? render_state_begin(s, azimuth) : done;
    }
    done =
        status == SNOW_STATUS_OK ? CONTINUE : fail_picture(s, status, s->path);
    if (is_sum_of_channels(s)) /* rank 0 alone adds them */
        done = process_agree(done);
    if (done != CONTINUE)
        return done;
    s->begun[s->in_flight++] = (render_state_shot){s->path, s->whole, s->made};
    s->made = NULL;
    return CONTINUE;
}

int render_state_finish(render_state *s, snow_image **image) {
    snow_image *made = s->begun[0].made;
    snow_status status = SNOW_STATUS_OK;
    if (process_ranks() > 1 && !is_sum_of_channels(s))
        status = snow_ranks_finish(s->frame, &made);
    s->drawn = s->begun[0];
    s->begun[0] = s->begun[1];
    s->in_flight--;
    if (status != SNOW_STATUS_OK)
        return fail_picture(s, status, s->drawn.path);
    int done = take_figures(s);
    if (done == CONTINUE)
        *image = made;
    else
        snow_image_free(made);
    return done;
}

int render_state_draw(render_state *s, double azimuth, snow_image **image) {
    int done = render_state_begin(s, azimuth);
    return done == CONTINUE ? render_state_finish(s, image) : done;
}

/* --- reports -------------------------------------------------------------- */

render_report render_state_report(const render_state *s) {
    return (render_report){.volume = &s->drawn.whole,
                           .stats = &s->stats,
                           .combine = s->combine,
                           .gather = s->gather,
                           .peak = s->peak,
                           .load = s->load,
                           .settings = &s->settings,
                           .times = &s->times};
}

void render_state_note(const render_state *s, const double painted[2]) {
    const char *view = s->opts->view;
    if (s->channels.list.count)
        config_note_channels(s->opts, &s->channels.list, s->settings.shade,
                             view ? view
                                  : snow_view_name_for(&s->drawn.whole, NULL));
    else
        config_note(s->opts, s->transfer, s->settings.shade,
                    view ? view : snow_view_name_for(&s->drawn.whole, NULL),
                    painted);
}

/* Of a range, by which rounding may move a point. */
#define ROUNDING 1e-12

/* The preset of data values that a range is for; NULL: none. */
static const snow_look *ranged_preset(const options *opts) {
    int preset = opts->preset ? snow_preset_from_name(opts->preset) : -1;
    if (preset < 0 || options_range(opts).kind == SNOW_RANGE_AUTO)
        return NULL;
    const snow_look *look = snow_preset_look((size_t)preset);
    return look->domain == SNOW_DOMAIN_DATA ? look : NULL;
}

/* A range stretches a preset of data values with its opacities, which few
 * expect of a window.  One as wide as the preset's own moves both ends of the
 * colours alike: those of the preset, or of a map over all of it. */
static void describe_squeeze(const render_state *s, char out[160]) {
    const snow_look *look = ranged_preset(s->opts);
    double ends[2];
    *out = 0;
    if (!look)
        return;
    double first = look->colors[0].value;
    double last = look->colors[look->color_count - 1].value;
    double low = fmin(first, look->opacities[0].value);
    double high = fmax(last, look->opacities[look->opacity_count - 1].value);
    bool mapped = s->opts->colormap != NULL;
    snow_transfer_domain(s->transfer, &ends[0], &ends[1]);
    ends[0] -= mapped ? low : first;
    ends[1] -= mapped ? high : last;
    if (fabs(ends[1] - ends[0]) <= ROUNDING * (high - low)) /* it is moved */
        return;
    snprintf(out, 160,
             "; the range squeezes or stretches the preset's own %g..%g and "
             "its opacities; one of the same width moves them",
             low, high);
}

void render_state_choices(const render_state *s, char *out, size_t size) {
    const double *from = s->opts->position.at;
    const char *view = s->opts->view
                           ? s->opts->view
                           : snow_view_name_for(&s->drawn.whole, NULL);
    char place[96];
    if (s->opts->position.given) {
        snprintf(place, sizeof place, "from %g,%g,%g", from[0], from[1],
                 from[2]);
        view = place;
    }
    bool encoded = s->stats.encoding != SNOW_ENCODING_AUTO;
    char volume[256], squeeze[160], look[640];
    describe_squeeze(s, squeeze);
    if (s->channels.list.count)
        channels_describe(&s->channels, look, sizeof look);
    else
        snprintf(look, sizeof look, "%s",
                 snow_transfer_description(s->transfer));
    describe_volume(&s->drawn.whole, volume, sizeof volume);
    bool over = s->settings.mode == SNOW_MODE_OVER;
    snprintf(out, size, "%s: %s; %s%s%s%s%s; view %s; %s%s%smethod %s%s%s",
             name_of_input(s->drawn.path), volume, look, squeeze,
             over ? "; opacity per " : "",
             !over                            ? ""
             : s->settings.opacity_length > 0 ? "mm"
                                              : "voxel",
             over && s->settings.shade == SNOW_SHADE_NONE ? "; not shaded" : "",
             view, over ? "" : "mode ",
             over ? "" : snow_mode_name(s->settings.mode),
             over                        ? ""
             : s->settings.threshold > 0 ? " of all voxels (no threshold), "
                                         : " of all voxels, ",
             snow_method_name(s->stats.method), encoded ? ", encoding " : "",
             encoded ? snow_encoding_name(s->stats.encoding) : "");
}
