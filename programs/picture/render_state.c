/* render_state.c - renders pictures of a file.  Each of many ranks has its part
 * of the volume, and the first gets the pictures (snowglass/ranks.h). */
#include "picture/render_state.h"
#include "commands/commands.h"
#include "commands/first.h"
#include "picture/annotations.h"
#include "picture/warnings.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/start.h"

#include <snowglass/extend.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

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
    first_volume *first = opts->first;
    int done = CONTINUE;
    if (first && first->volume) {
        out->context = first->context;
        out->ready = first->volume;
        out->times.read = first->seconds;
        *first = (first_volume){.context = NULL};
    } else {
        done = open_render_context(opts, &out->context);
    }
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
    snow_volume_close(s->ready);
    free(s->measures);
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

void render_state_leave_strip(render_state *s) {
    s->strip = annotations_strip(
        &(picture_annotations){s->opts,
                               s->whole,
                               s->view,
                               s->transfer,
                               {0, 0},
                               &s->channels,
                               layers_legend(&s->layers, s->each_time),
                               .measures = NULL});
    s->view.strip = s->strip;
}

/* Frames what the look shows, once for all pictures, from each side of a turn.
 * What later steps show is not known: their grid is framed. */
static snow_status frame_view(render_state *s) {
    annotations_find_unit(s->opts, s->volume, process_ranks() > 1, &s->whole);
    if (!s->drawn.path && !s->framed)
        render_state_leave_strip(s);
    s->view.strip = s->strip;
    if (strcmp(s->opts->fit, "visible") != 0)
        return SNOW_STATUS_OK;
    if (!s->framed) {
        snow_comm *comm = process_ranks() > 1 ? process_comm() : NULL;
        const bool whole = s->opts->box || s->channels.list.count > 1 ||
                           (s->steps && !s->turns);
        const size_t sides = s->turns ? (size_t)s->opts->frames : 0;
        double *azimuths = sides ? malloc(sides * sizeof *azimuths) : NULL;
        if (sides && !azimuths)
            return snow_context_fail(s->context, SNOW_STATUS_NO_MEMORY,
                                     "out of memory for %zu angles; close "
                                     "other programs",
                                     sides);
        for (size_t i = 0; i < sides; i++)
            azimuths[i] = s->opts->azimuth + 360 * (double)i / (double)sides;
        snow_status status =
            snow_view_fit(comm, s->volume, whole ? NULL : s->transfer,
                          &s->settings, azimuths, sides, &s->view);
        free(azimuths);
        if (status != SNOW_STATUS_OK)
            return status;
        s->view.zoom *= render_state_margin(s->opts);
        s->frame_of = s->view;
        s->framed = true;
    }
    s->view = s->frame_of;
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

/* Opens the volume in memory or in its file. */
static int open_as_planned(render_state *s, const options *step) {
    if (s->ready) {
        s->volume = s->ready;
        s->ready = NULL;
        return CONTINUE;
    }
    if (!s->plan.streams)
        return open_input(s->context, step, s->path, &s->volume);
#ifdef __GLIBC__
    /* Growing blocks of the encoding leave gaps in the heap, which count as
     * memory of the process.  Blocks with their own pages are returned to the
     * system. */
    mallopt(M_MMAP_THRESHOLD, 256 << 10);
#endif
    snow_volume_options data = data_options(step);
    return check_status(
        s->context, snow_volume_open_streamed(s->context, s->path, &data,
                                              s->plan.slab_bytes, &s->volume));
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
    bool report = step->verbosity > 0 && !s->transfer && !s->in_slabs;
    int done = memory_plan_for(step, s->path, &data, s->channels.list.count,
                               report, &s->plan);
    if (done != CONTINUE)
        return done;
    s->plan.streams = s->plan.streams || (s->in_slabs && s->plan.may_stream);
    snow_context_set_memory_limit(s->context, s->plan.limit);
    return CONTINUE;
}

/* Whether the volume may stay in its file instead. */
static bool may_leave(const render_state *s) {
    return s->plan.may_stream && !s->plan.streams;
}

bool render_state_may_start_over(const render_state *s, int status) {
    const bool may_drop = s->channels.list.count > 1 &&
                          !s->opts->channels.count && !s->steps &&
                          !s->drawn.path;
    return status == SNOW_STATUS_NO_MEMORY && (may_leave(s) || may_drop);
}

int render_state_start_over(render_state *s, int64_t time) {
    if (may_leave(s)) {
        s->in_slabs = true;
    } else {
        channels_note(s->opts, &s->whole, "several need more memory");
        channels_close(&s->channels);
        snow_transfer_free(s->transfer);
        s->transfer = NULL;
        s->framed = false;
    }
    render_state_drop_frame(s);
    return render_state_open(s, s->path, time);
}

void render_state_drop_frame(render_state *s) {
    snow_frame_free(s->frame);
    s->frame = NULL;
    s->frames_dropped++;
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
    l->quiet = render_state_may_start_over(s, SNOW_STATUS_NO_MEMORY);
    l->slab_bytes = s->plan.slab_bytes;
    snow_status status =
        channels_open(step, s->context, s->path, s->plan.streams, l->slab_bytes,
                      &s->channels);
    if (l->quiet && status == SNOW_STATUS_NO_MEMORY)
        return (int)status;
    return status == SNOW_STATUS_OK
               ? layers_open(step, s->context, s->volume, l)
               : fail_volume(s->context, status, name_of_input(s->path));
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
    if (status == SNOW_STATUS_OK)
        done = open_layers(s, step);
    if (render_state_may_start_over(s, (int)status) ||
        render_state_may_start_over(s, done))
        return render_state_start_over(s, step->time);
    if (status != SNOW_STATUS_OK)
        return fail_volume(s->context, status, name_of_input(s->path));
    if (done == CONTINUE)
        done = place_camera(s);
    render_state_choose_shade(s);
    if (done != CONTINUE)
        return done;
    double before = snow_volume_read_seconds(s->volume);
    begin = seconds_now();
    status = frame_view(s);
    if (render_state_may_start_over(s, (int)status))
        return render_state_start_over(s, step->time);
    double reading = snow_volume_read_seconds(s->volume) - before;
    s->times.look += seconds_now() - begin - reading;
    s->times.read += reading;
    return check_volume(s->context, status, name_of_input(s->path));
}

bool render_state_is_sum(const render_state *s) {
    return mode_is_projection(s->opts->mode) && s->channels.list.count;
}

/* Eight bits per channel suffice between ranks if the picture is placed on a
 * background that was asked for, and rounded to them in the end.  On the
 * default background floats travel, so that no faint picture is rounded to an
 * empty one (exit status 7). */
snow_ranks_options render_state_how(const render_state *s) {
    const options *opts = s->opts;
    bool coarse = opts->background.given && !opts->deterministic &&
                  options_bits(opts) != 16;
    return (snow_ranks_options){
        .size = sizeof(snow_ranks_options),
        .cut = (snow_partition)option_choice("cut", opts->cut),
        .combining = (snow_combine)option_choice("combine", opts->combine),
        .radix = (int)opts->radix,
        .pixel_bits = coarse && !render_state_is_sum(s) ? 8 : 0,
        .turns = s->turns,
        .transfer = s->transfer,
        .one_look = s->one_look && !opts->overlay && !s->channels.list.count};
}

/* The look of each channel by all ranks, which read equal parts of it.  Those
 * of projections stay: each has its own picture. */
static int open_channels(render_state *s, const options *step) {
    const snow_look any = {.size = sizeof any, .preset = "linear"};
    snow_ranks_options how = render_state_how(s);
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
    return process_agree(check_status(s->context, status));
}

/* Making the transfer function counts as reading: it needs values of all
 * parts. */
static int open_part(render_state *s, options *step) {
    double begin = seconds_now();
    snow_volume_options data = data_options(step);
    snow_look look = look_options(step);
    snow_transfer *transfer = NULL;
    snow_volume_info_init(&s->whole);
    int done = check_status(
        s->context, snow_volume_inspect(s->context, s->path, &data, &s->whole));
    if (done == CONTINUE)
        done = channels_choose(step, &s->whole, channels_hinder(step),
                               &s->channels);
    if (done == CONTINUE) /* the partition depends on the camera */
        done = place_camera(s);
    done = process_agree(done);
    if (done == CONTINUE)
        done = open_channels(s, step);
    if (done != CONTINUE)
        return done;
    if (s->channels.list.count)
        data = channels_data(step, &s->channels.list.picks[0]);
    snow_ranks_options how = render_state_how(s);
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
    return process_ranks() > 1 ? open_part(s, &step) : open_alone(s, &step);
}
