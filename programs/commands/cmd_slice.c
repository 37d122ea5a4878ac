/* cmd_slice.c - the verb slice: one slice of a volume as a picture, several in
 * one, or a series of them.
 *
 * The header says where the slice lies, and a crop has no more than it read. So
 * a slice of a volume larger than memory takes the memory of a slice. */
#include "commands/commands.h"
#include "commands/world.h"
#include "options/config.h"
#include "picture/annotations.h"
#include "picture/outputs.h"
#include "picture/show.h"
#include "picture/warnings.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/start.h"
#include "slice/slice.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Channels that nobody asked for, and that do not fit together, give way to the
 * first one. */
static int draw_first(slice_work *w) {
    channels_note(&w->opts, &w->whole, "several need more memory");
    channels_close(&w->channels);
    snow_transfer_free(w->transfer);
    snow_image_free(w->image);
    snow_volume_close(w->volume);
    w->transfer = NULL;
    w->image = NULL;
    w->volume = NULL;
    w->opts.channel = 0;
    int done = open_input(w->context, &w->opts, w->path, &w->volume);
    if (done == CONTINUE)
        done = slice_open_colors(w);
    if (done != CONTINUE)
        return done;
    return check_volume(w->context, slice_draw(w), name_of_input(w->path));
}

static int make_picture(slice_work *w) {
    int done = slice_inspect(w);
    if (done == CONTINUE)
        done = slice_read(w);
    if (done == CONTINUE)
        done = slice_measure(w);
    if (done != CONTINUE)
        return done;
    snow_status status = slice_draw(w);
    if (status == SNOW_STATUS_NO_MEMORY && w->channels.list.count > 1 &&
        !w->opts.channels.count)
        return draw_first(w);
    return check_volume(w->context, status, name_of_input(w->path));
}

/* "axial slice 15 of 0 to 29, at 3.8mm". */
static void describe_place(const slice_work *w, char *out, size_t size) {
    const snow_slice_place *first = &w->places[0];
    const snow_slice_place *last = &w->places[w->count - 1];
    const char *axis = slice_axis_name(w), *unit = slice_unit(w);
    char units[64];
    world_units(&w->whole, units, sizeof units);
    if (w->kind == SLICE_ORTHO)
        snprintf(out, size,
                 "axial slice %" PRId64 ", coronal %" PRId64
                 ", sagittal %" PRId64 ", at %g,%g,%g%s",
                 first->index, w->places[1].index, last->index, w->point[0],
                 w->point[1], w->point[2],
                 strchr(units, ',') ? units : units + (*units == ' '));
    else if (w->kind == SLICE_GRID)
        snprintf(out, size,
                 "%" PRId64 " %s slices from %" PRId64 " to %" PRId64
                 " of 0 to %" PRId64,
                 w->count, axis, first->index, last->index,
                 w->whole.dims[w->axis] - 1);
    else
        snprintf(out, size, "%s slice %" PRId64 " of 0 to %" PRId64 ", at %g%s",
                 axis, first->index, w->whole.dims[w->axis] - 1,
                 slice_position(w, (double)first->index), unit);
}

static void report(const slice_work *w) {
    char volume[256], place[256], colors[512], thick[64];
    describe_volume(&w->whole, volume, sizeof volume);
    describe_place(w, place, sizeof place);
    slice_describe_slab(w, thick, sizeof thick);
    slice_describe_colors(w, colors, sizeof colors);
    config_note_slice(&w->opts, w->channels.list.count ? NULL : w->transfer,
                      w->kind == SLICE_ORTHO ? NULL : slice_axis_name(w),
                      w->kind == SLICE_ONE ? w->places[0].index : -1);
    if (w->transfer && w->channels.list.count)
        config_note_channels(&w->opts, &w->channels.list, SNOW_SHADE_NONE,
                             NULL);
    annotations_report(&w->opts);
    if (w->opts.verbosity < 0)
        return;
    say("%s: %s; %s%s; %s; %dx%d pixels%s%s", name_of_input(w->path), volume,
        place, thick, colors, w->size[0], w->size[1],
        w->opts.named ? "; to " : "", w->opts.named ? w->opts.output : "");
    measures_report(w->measures);
    if (picture_is_empty(w->image))
        say("note: the picture is empty: the slice has no finite value, or "
            "with --scale log none above 0; give another --at");
}

/* Shows what a PNG would: where values are written, the same slice in
 * colours. */
static int show_slice(const slice_work *w) {
    slice_work shown = *w;
    snow_overlay *overlay = NULL;
    int done = CONTINUE;
    if (!slice_has_colors(w)) {
        shown.transfer = NULL;
        shown.image = NULL;
        done = slice_open_colors(&shown);
        if (done == CONTINUE)
            done = check_status(w->context, slice_draw(&shown));
    }
    shown.opts.output = "-";
    snow_image_options form = picture_form(&shown.opts, NULL);
    if (done == CONTINUE) {
        snow_status status = slice_make_overlay(&shown, &overlay);
        form.overlay = overlay;
        done = status == SNOW_STATUS_OK ? show_picture(shown.image, &form)
                                        : fail_status(w->context, status);
    }
    snow_overlay_free(overlay);
    if (!slice_has_colors(w)) {
        snow_image_free(shown.image);
        snow_transfer_free(shown.transfer);
    }
    return done;
}

static int write_slice(slice_work *w) {
    const options *opts = &w->opts;
    snow_image_options form = picture_form(opts, NULL);
    snow_overlay *overlay = NULL;
    double begin = seconds_now();
    bool shown = opts->show && strcmp(opts->output, "-") == 0;
    if (!is_special(opts->output))
        interrupt_hold();
    snow_status status = slice_make_overlay(w, &overlay);
    form.overlay = overlay;
    progress_begin(opts, "writing");
    if (status == SNOW_STATUS_OK && !shown)
        status = snow_image_save(w->image, opts->output, &form);
    progress_end(opts);
    int done = check_status(w->context, status);
    if (done == CONTINUE && opts->show)
        done = show_slice(w);
    snow_overlay_free(overlay);
    w->times.write = seconds_now() - begin;
    return done;
}

/* --- figures -------------------------------------------------------------- */

static json_t *figures_of_place(const slice_work *w) {
    const char *axis = slice_axis_name(w), *unit = slice_unit(w);
    if (w->kind == SLICE_ONE)
        return json_pack("{s:s,s:I,s:f,s:s}", "axis", axis, "index",
                         (json_int_t)w->places[0].index, "position",
                         slice_position(w, (double)w->places[0].index), "unit",
                         unit);
    json_t *indices = json_array();
    for (int64_t n = 0; n < w->count; n++)
        json_array_append_new(indices,
                              json_integer((json_int_t)w->places[n].index));
    return w->kind == SLICE_GRID
               ? json_pack("{s:s,s:o}", "axis", axis, "indices", indices)
               : json_pack("{s:o,s:[f,f,f],s:s}", "indices", indices, "point",
                           w->point[0], w->point[1], w->point[2], "unit",
                           w->whole.unit);
}

static json_t *figures(const slice_work *w) {
    snow_stats stats = {.size = sizeof stats,
                        .kernel = w->settings.kernel,
                        .threads = w->settings.threads,
                        .seconds_frame = w->frame};
    render_report made = {.volume = &w->whole,
                          .stats = &stats,
                          .peak = snow_context_peak_bytes(w->context),
                          .settings = &w->settings,
                          .image = w->image,
                          .times = &w->times};
    static const char *const others[] = {
        "threshold", "sparse_ratio", "encoding", "method", "footprint",
        "ranks",     "load",         "isa",      "quality"};
    json_t *tree = stats_json(&made);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        json_object_del(tree, others[i]);
    json_object_set_new(tree, "slice", figures_of_place(w));
    if (w->measures)
        json_object_set_new(tree, "measures", measures_json(w->measures));
    json_object_set_new(
        json_object_get(tree, "bytes"), "file",
        json_integer((json_int_t)snow_context_bytes_read(w->context)));
    return tree;
}

static int report_figures(slice_work *w) {
    const options *opts = &w->opts;
    int done = picture_is_empty(w->image) ? EXIT_EMPTY : SNOW_STATUS_OK;
    w->times.total = seconds_now() - w->begin;
    if (!opts->stats)
        return done;
    if (!is_special(opts->stats))
        interrupt_hold();
    int stats = write_json(figures(w), opts->stats, opts->overwrite);
    return stats == SNOW_STATUS_OK ? done : stats;
}

/* --- the stages ----------------------------------------------------------- */

/* What no slice can be drawn with. */
static int check_slices(const slice_work *w) {
    const options *opts = &w->opts;
    if (opts->footprint)
        return fail_usage("--kernel: a slice has no support; give %s alone",
                          opts->kernel);
    if (strcmp(opts->kernel, "gauss") == 0 ||
        strcmp(opts->kernel, "bspline") == 0)
        return fail_usage("--kernel: %s cannot draw a slice; use tent, or box "
                          "for the nearest voxel",
                          opts->kernel);
    if (opts->overlay && !slice_has_colors(w))
        return fail_usage("%s: a file of numbers holds one volume's values, "
                          "without --overlay; name a .png",
                          opts->output);
    return layers_check(opts);
}

static int check_request(slice_work *w) {
    const options *opts = &w->opts;
    const bool frames = w->kind == SLICE_FRAMES;
    int done = frames ? CONTINUE : check_picture(opts);
    if (done == CONTINUE)
        done = check_slices(w);
    if (done == CONTINUE)
        done = open_context(opts, &w->context);
    if (done != CONTINUE)
        return done;
    snow_context_set_memory_limit(w->context, opts->memory);
    snow_context_set_progress(w->context, progress_show, NULL);
    fill_settings(opts, &w->settings);
    if (!w->settings.threads)
        w->settings.threads = process_processors();
    w->settings.mode = SNOW_MODE_OVER; /* a slice has none */
    return frames ? CONTINUE : check_picture_paths(w->context, opts);
}

static int run_stages(slice_work *w) {
    int done = slice_choose_kind(w);
    if (done == CONTINUE)
        done = check_request(w);
    if (done != CONTINUE)
        return done;
    if (w->kind == SLICE_FRAMES)
        return slice_run_frames(w);
    interrupt_guard();
    done = make_picture(w);
    if (interrupt_unguard())
        return EXIT_INTERRUPTED;
    if (done != CONTINUE)
        return done;
    report(w);
    done = write_slice(w);
    return done == CONTINUE ? report_figures(w) : done;
}

/* The look, background and marks of a slice are those of projections: the
 * options get a mode that is neither over nor iso. */
int cmd_slice(const options *opts) {
    slice_work w = {.opts = *opts,
                    .path = opts->operands[0],
                    .begin = seconds_now(),
                    .layers = {.alone = true}}; /* of many ranks, one draws */
    w.opts.mode = "slice";
    if (!options_given(opts, "size"))
        w.opts.size[0] = w.opts.size[1] = 0;
    int done = run_stages(&w);
    snow_image_free(w.image);
    layers_close(&w.layers);
    snow_transfer_free(w.transfer);
    snow_volume_close(w.volume);
    channels_close(&w.channels);
    free(w.measures);
    free(w.cut);
    free(w.places);
    snow_context_free(w.context);
    return done;
}
