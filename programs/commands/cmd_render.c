/* cmd_render.c - the verb render: opens a volume, makes the transfer function
 * and the view, renders and writes one picture, and reports.
 *
 * Bad options are refused before the volume is read: options that contradict
 * each other and outputs that cannot be written. */
#include "commands/commands.h"
#include "picture/annotations.h"
#include "picture/outputs.h"
#include "picture/paint.h"
#include "picture/render_state.h"
#include "picture/render_stats.h"
#include "picture/show.h"
#include "picture/warnings.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/start.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* "-" is standard output, as in most tools; a file of that name is ./-. */
static bool is_stream(const char *path) {
    return path && strcmp(path, "-") == 0;
}

int check_settings(const options *opts) {
    if (strcmp(opts->method, "original") == 0 &&
        strcmp(opts->encoding, "auto") != 0)
        return fail_usage("--encoding: method original uses no encoding; "
                          "remove --encoding or --method");
    bool iso = strcmp(opts->mode, "iso") == 0;
    if (iso != !isnan(opts->iso))
        return fail_usage("--%s: needs --%s too; add it",
                          iso ? "mode iso" : "iso",
                          iso ? "iso VALUE" : "mode iso");
    if (opts->view && opts->position.given)
        return fail_usage("--position: conflicts with --view, which also "
                          "places the camera; give only one of them");
    int done = annotations_check(opts);
    return done == CONTINUE ? check_look(opts) : done;
}

int check_stats_apart(const options *opts) {
    return check_apart(opts->stats, opts->output,
                       "--stats: is the same file as --output; name two files");
}

/* Whether the depths become channel Z of the picture's own file. */
static bool is_beside(const options *opts) {
    return opts->depth && same_output(opts->depth, opts->output);
}

int check_depth_mode(const options *opts) {
    if (!opts->depth || !mode_is_projection(opts->mode))
        return CONTINUE;
    return fail_usage("--depth: mode %s has no depth; use mode over or iso",
                      opts->mode);
}

/* Depths need a single picture and a format that holds numbers.  They get a
 * file of their own, or the picture's file if its format has a depth
 * channel. */
static int check_depth(const options *opts) {
    const char *path = opts->depth;
    int done = check_depth_mode(opts);
    if (!path || done != CONTINUE)
        return done;
    done = check_no_folder(path);
    if (done != CONTINUE)
        return done;
    if (snow_image_format_bits(path) != 0)
        return fail_usage("--depth: %s cannot hold depths; use a name that "
                          "ends in .npy, .pfm, .exr or .tif",
                          path);
    done = check_apart(path, opts->stats,
                       "--depth: is the same file as --stats; name two files");
    if (done != CONTINUE)
        return done;
    return check_apart(path, opts->output,
                       snow_image_format_has_depth(opts->output)
                           ? NULL
                           : "--depth: is the same file as --output; name two "
                             "files, or use one .exr for both");
}

/* These checks need no file, so they come before everything else. */
int check_picture(const options *opts) {
    if (snow_image_format_bits(opts->output) == 0 &&
        (opts->background.given || opts->bits))
        return fail_usage("%s: --background and --bits work only for PNG, "
                          "WebP and JPEG; remove them or name a .png",
                          opts->output);
    if (show_check(opts) != CONTINUE)
        return SNOW_STATUS_BAD_USAGE;
    if (is_stream(opts->output) && !opts->show && isatty(STDOUT_FILENO))
        return fail_usage("--output: standard output is a terminal; send it to "
                          "a pipe or a file");
    int done = check_depth(opts);
    if (done == CONTINUE)
        done = check_stats_apart(opts);
    return done == CONTINUE ? check_settings(opts) : done;
}

snow_image_options picture_form(const options *opts,
                                const snow_transfer *transfer) {
    snow_image_options form = {.size = sizeof form,
                               .bits = options_bits(opts),
                               .overwrite = opts->overwrite};
    paint_background(opts, transfer, &form);
    return form;
}

/* A long rendering must not end at an output that could have been refused at
 * the start. */
int check_picture_paths(snow_context *context, const options *opts) {
    const char *const paths[] = {opts->output, opts->depth, opts->stats};
    snow_image_options form = picture_form(opts, NULL);
    int done = check_input_first(opts, paths, sizeof paths / sizeof *paths);
    if (done == CONTINUE)
        done = check_no_folder(opts->output);
    if (done == CONTINUE && opts->depth)
        done = check_no_folder(opts->depth);
    if (done == CONTINUE && !is_stream(opts->output))
        done = check_apart(opts->output, opts->operands[0],
                           "--output: is the input, which would be lost; name "
                           "another file");
    if (done != CONTINUE)
        return done;
    snow_status status = snow_image_check(
        context, opts->output, (int)(opts->size[0] ? opts->size[0] : 1),
        (int)(opts->size[1] ? opts->size[1] : 1), &form);
    if (status == SNOW_STATUS_OK && opts->depth && !is_beside(opts))
        status = snow_image_check(
            context, opts->depth, 1, 1,
            &(snow_image_options){.size = sizeof(snow_image_options),
                                  .overwrite = opts->overwrite});
    if (status != SNOW_STATUS_OK)
        return fail_status(context, status);
    return opts->stats ? check_stats_path(opts->stats, opts->overwrite)
                       : CONTINUE;
}

/* One picture and its timings. */
typedef struct work {
    render_state state;
    snow_image *image; /* NULL on ranks that do not write */
    double begin;
    paint_given painted; /* how a picture of values was painted */
} work;

static snow_status make_annotations(const work *w, const options *opts,
                                    const snow_image *image,
                                    const paint_given *painted,
                                    snow_overlay **out) {
    const render_state *s = &w->state;
    const picture_annotations annotations = {
        opts,
        s->whole,
        s->view,
        s->transfer,
        {painted->range[0], painted->range[1]},
        &s->channels,
        layers_legend(&s->layers, false),
        .measures = s->measures};
    return annotations_make(&annotations, opts->azimuth, -1, image, s->context,
                            out);
}

/* Shows what a PNG would, whatever is written. */
static int show(const work *w, const options *opts) {
    const render_state *s = &w->state;
    options as_png = *opts;
    paint_given painted = w->painted;
    snow_image *colors = NULL;
    snow_overlay *overlay = NULL;
    int done = CONTINUE;
    as_png.output = "-";
    if (snow_image_channels(w->image) == 1)
        done = paint_copy(&as_png, s->context, s->transfer, false, w->image,
                          &colors, &painted);
    const snow_image *image = colors ? colors : w->image;
    if (done == CONTINUE) {
        snow_image_options form = picture_form(&as_png, render_state_ground(s));
        snow_status status =
            make_annotations(w, &as_png, image, &painted, &overlay);
        form.overlay = overlay;
        done = status == SNOW_STATUS_OK ? show_picture(image, &form)
                                        : fail_status(s->context, status);
    }
    snow_overlay_free(overlay);
    snow_image_free(colors);
    return done;
}

/* A pipe is written directly and may block, so an interruption there does not
 * wait. */
static int write_picture(work *w, const options *opts) {
    snow_image_options form =
        picture_form(opts, render_state_ground(&w->state));
    snow_overlay *overlay = NULL;
    double begin = seconds_now();
    if (!is_special(opts->output))
        interrupt_hold(); /* before the message, so that its reader can rely on
                             it */
    if (!process_talks())
        return CONTINUE;
    const snow_image_options plain = {.size = sizeof plain,
                                      .overwrite = opts->overwrite};
    const snow_image *depth = snow_frame_depth(w->state.frame);
    bool beside = is_beside(opts);
    annotations_report(opts);
    snow_status status =
        make_annotations(w, opts, w->image, &w->painted, &overlay);
    progress_begin(opts, "writing");
    form.overlay = overlay;
    form.depth = beside ? depth : NULL;
    if (status == SNOW_STATUS_OK && !(opts->show && is_stream(opts->output)))
        status = snow_image_save(w->image, opts->output, &form);
    if (status == SNOW_STATUS_OK && opts->depth && !beside)
        status = snow_image_save(depth, opts->depth, &plain);
    if (status == SNOW_STATUS_OK && !opts->show && !opts->stats &&
        !is_special(opts->output))
        interrupt_finish();
    progress_end(opts);
    int done = CONTINUE;
    if (status != SNOW_STATUS_OK)
        done = fail_status(w->state.context, status);
    else if (opts->show)
        done = show(w, opts);
    snow_overlay_free(overlay);
    w->state.times.write = seconds_now() - begin;
    return done;
}

/* Comes after the picture is written, since the figures include the writing. */
static int report_figures(work *w, const options *opts) {
    if (!process_talks())
        return SNOW_STATUS_OK;
    w->state.times.total = seconds_now() - w->begin;
    render_report report = render_state_report(&w->state);
    int done = picture_is_empty(w->image) ? EXIT_EMPTY : SNOW_STATUS_OK;
    report.image = w->image;
    if (opts->verbosity > 0)
        log_stats(&report);
    if (!opts->stats)
        return done;
    if (!is_special(opts->stats))
        interrupt_hold();
    json_t *tree = stats_json(&report);
    if (w->state.measures)
        json_object_set_new(tree, "measures", measures_json(w->state.measures));
    int stats = write_json(tree, opts->stats, opts->overwrite);
    return stats == SNOW_STATUS_OK ? done : stats;
}

static void report_choices(const work *w) {
    char text[1024];
    render_state_choices(&w->state, text, sizeof text);
    if (w->state.opts->verbosity >= 0)
        say("%s%s%s%s", text, w->painted.words,
            w->state.opts->named ? "; to " : "",
            w->state.opts->named ? w->state.opts->output : "");
    if (w->state.opts->verbosity >= 0)
        measures_report(w->state.measures);
    warn_picture(&w->state, w->image);
    render_state_note(&w->state, w->painted.range);
}

/* Refuses what can be refused before anything is read; the rank that writes
 * checks the outputs. */
static int check_request(work *w, const options *opts) {
    int done = check_picture(opts);
    if (done == CONTINUE)
        done = render_state_check(opts);
    done = process_agree(done);
    if (done == CONTINUE)
        done = render_state_new(opts, &w->state);
    w->state.one_look = true;
    if (done != CONTINUE || !process_talks())
        return done;
    return check_picture_paths(w->state.context, opts);
}

/* Up to the picture in memory. */
static int make_picture(work *w, const options *opts) {
    progress_begin(opts, "reading");
    int done = render_state_open(&w->state, opts->operands[0], opts->time);
    progress_end(opts);
    if (done == CONTINUE)
        done = render_state_measure(&w->state, false);
    if (done != CONTINUE)
        return done;
    progress_begin(opts, "rendering");
    done = render_state_draw(&w->state, opts->azimuth, &w->image);
    if (done == CONTINUE)
        done = paint_values(opts, w->state.context, w->state.transfer, false,
                            &w->image, &w->painted);
    progress_end(opts);
    return done;
}

/* The stages in their order; the first fault ends them. */
static int run_stages(work *w, const options *opts) {
    int done = process_agree(check_request(w, opts));
    if (done != CONTINUE)
        return done;
    interrupt_guard();
    done = make_picture(w, opts);
    done = process_agree(interrupt_unguard() ? EXIT_INTERRUPTED : done);
    if (done != CONTINUE)
        return done;
    report_choices(w);
    done = process_agree(write_picture(w, opts));
    progress_end(opts);
    return done == CONTINUE ? report_figures(w, opts) : done;
}

/* The only way out, so that everything is freed after every failure. */
int cmd_render(const options *opts) {
    work w = {.begin = seconds_now()};
    int done = run_stages(&w, opts);
    snow_image_free(w.image);
    render_state_free(&w.state);
    return done;
}
