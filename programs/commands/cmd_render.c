/* cmd_render.c - the verb render: opens a volume, makes the transfer function
 * and the view, renders and writes one picture, and reports.
 *
 * Bad options are refused before the volume is read: options that contradict
 * each other and outputs that cannot be written. */
#include "commands/commands.h"
#include "picture/marks.h"
#include "picture/outputs.h"
#include "picture/paint.h"
#include "picture/render_state.h"
#include "picture/render_stats.h"
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

int check_settings(const options *asked) {
    if (strcmp(asked->method, "original") == 0 &&
        strcmp(asked->encoding, "auto") != 0)
        return fail_usage("--encoding: method original uses no encoding; "
                          "remove --encoding or --method");
    bool iso = strcmp(asked->mode, "iso") == 0;
    if (iso != !isnan(asked->iso))
        return fail_usage("--%s: needs --%s too; add it",
                          iso ? "mode iso" : "iso",
                          iso ? "iso VALUE" : "mode iso");
    if (asked->view && asked->position.given)
        return fail_usage("--position: conflicts with --view, which also "
                          "places the camera; give only one of them");
    int done = marks_check(asked);
    return done == CONTINUE ? check_look(asked) : done;
}

static bool same_output(const char *a, const char *b) {
    return a && b && (strcmp(a, b) == 0 || same_place(a, b));
}

/* Whether the depths become channel Z of the picture's own file. */
static bool is_beside(const options *asked) {
    return asked->depth && same_output(asked->depth, asked->output);
}

int check_depth_mode(const options *asked) {
    if (!asked->depth || strcmp(asked->mode, "over") == 0 ||
        strcmp(asked->mode, "iso") == 0)
        return CONTINUE;
    return fail_usage("--depth: mode %s has no depth; use mode over or iso",
                      asked->mode);
}

/* Depths need a single picture and a format that holds numbers.  They get a
 * file of their own, or the picture's file if its format has a depth
 * channel. */
static int check_depth(const options *asked) {
    const char *path = asked->depth;
    int done = check_depth_mode(asked);
    if (!path || done != CONTINUE)
        return done;
    if (snow_image_format_bits(path) != 0)
        return fail_usage("--depth: %s cannot hold depths; use a name that "
                          "ends in .npy, .pfm, .exr or .tif",
                          path);
    if (same_output(path, asked->stats))
        return fail_usage(
            "--depth: is the same file as --stats; name two files");
    if (is_beside(asked) && !snow_image_format_has_depth(asked->output))
        return fail_usage("--depth: is the same file as --output; name two "
                          "files, or use one .exr for both");
    return CONTINUE;
}

/* These checks need no file, so they come before everything else. */
static int check_combination(const options *asked) {
    if (!asked->output)
        return fail_usage("no output file given; add -o OUT.png");
    if (snow_image_format_bits(asked->output) == 0 &&
        (asked->background.given || asked->bits))
        return fail_usage("%s: --background and --bits work only for PNG and "
                          "WebP; remove them or name a .png",
                          asked->output);
    if (asked->stats && (strcmp(asked->stats, asked->output) == 0 ||
                         same_place(asked->stats, asked->output)))
        return fail_usage(
            "--stats: is the same file as --output; name two files");
    if (is_stream(asked->output) && isatty(STDOUT_FILENO))
        return fail_usage("--output: standard output is a terminal; send it to "
                          "a pipe or a file");
    int done = scene_check(asked);
    if (done == CONTINUE)
        done = check_depth(asked);
    return done == CONTINUE ? check_settings(asked) : done;
}

snow_image_options picture_form(const options *asked) {
    snow_image_options form = {
        .size = sizeof form,
        .flatten = asked->background.given,
        .bits = asked->bits ? (asked->bits[0] == '8' ? 8 : 16) : 0,
        .overwrite = asked->overwrite};
    memcpy(form.background, asked->background.rgb, sizeof form.background);
    return form;
}

/* A long rendering must not end at an output that could have been refused at
 * the start. */
static int check_paths(snow_context *context, const options *asked) {
    snow_image_options form = picture_form(asked);
    snow_status status =
        snow_image_check(context, asked->output, (int)asked->size[0],
                         (int)asked->size[1], &form);
    if (status == SNOW_STATUS_OK && asked->depth && !is_beside(asked))
        status = snow_image_check_path(context, asked->depth, asked->overwrite);
    if (status != SNOW_STATUS_OK)
        return fail_status(context, status);
    return asked->stats ? check_stats_path(asked->stats, asked->overwrite)
                        : CONTINUE;
}

/* Whether opacities are per millimetre: a file of a transfer function may say
 * so, but the command line has priority. */
static bool is_per_mm(const options *asked) {
    if (asked->loaded && !options_given(asked, "opacity-unit"))
        return snow_look_file_look(asked->loaded)->per_mm;
    return strcmp(asked->opacity_unit, "mm") == 0;
}

/* The length of a millimetre in the unit of the volume's world. */
static int opacity_length(const options *asked, const snow_volume_info *info,
                          double *out) {
    static const struct {
        const char *unit;
        double length;
    } units[] = {{"", 1},     {"mm", 1},   {"um", 1e3},
                 {"nm", 1e6}, {"m", 1e-3}, {"angstrom", 1e7}};
    *out = 0;
    if (!is_per_mm(asked))
        return CONTINUE;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        if (strcmp(units[i].unit, info->unit) == 0)
            *out = units[i].length;
    }
    if (*out > 0)
        return CONTINUE;
    return fail_usage("--opacity-unit mm: the volume's unit '%s' is not a "
                      "length; use --opacity-unit voxel",
                      info->unit);
}

/* The option table has checked the words, so the library knows every name. */
void fill_settings(const options *asked, snow_settings *out) {
    snow_settings_init(out);
    out->threshold = asked->threshold < 0 ? 0 : asked->threshold;
    out->method = (snow_method)snow_method_from_name(asked->method);
    out->encoding = (snow_encoding)snow_encoding_from_name(asked->encoding);
    out->kernel = (snow_kernel)snow_kernel_from_name(asked->kernel);
    out->footprint = (int)asked->footprint;
    out->shade =
        strcmp(asked->shade, "none") == 0 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    out->ambient = asked->ambient;
    out->diffuse = asked->diffuse;
    out->specular = asked->specular;
    out->shininess = asked->shininess;
    out->light = asked->light.light;
    out->light_azimuth = asked->light.azimuth;
    out->light_elevation = asked->light.elevation;
    out->depth_darkening = asked->depth_darkening;
    out->occlusion = asked->occlusion;
    out->quality = (snow_quality)snow_quality_from_name(asked->quality);
    out->isa = (snow_isa)snow_isa_from_name(asked->isa);
    out->threads = (int)asked->threads;
    out->deterministic = asked->deterministic;
    out->mode = (snow_mode)snow_mode_from_name(asked->mode);
    out->iso = isnan(asked->iso) ? 0 : asked->iso;
    out->depth = asked->depth != NULL;
}

int make_settings(const options *asked, const snow_volume_info *info,
                  snow_settings *out) {
    fill_settings(asked, out);
    if (!out->threads)
        out->threads = launch_threads();
    return opacity_length(asked, info, &out->opacity_length);
}

static void place_camera(const options *asked, snow_view *out) {
    out->has_position = asked->position.given;
    out->has_target = asked->target.given;
    out->has_up = asked->up.given;
    memcpy(out->position, asked->position.at, sizeof out->position);
    memcpy(out->target, asked->target.at, sizeof out->target);
    memcpy(out->upward, asked->up.at, sizeof out->upward);
}

/* A named view also sets size and angles, so it comes before them. */
int make_view(snow_context *context, const options *asked,
              const snow_volume_info *info, snow_view *out) {
    snow_view_init(out);
    snow_status status = snow_view_from_name(
        context, asked->view ? asked->view : snow_view_default_name(info), out);
    if (status != SNOW_STATUS_OK)
        return fail_status(context, status);
    out->width = (int)asked->size[0];
    out->height = (int)asked->size[1];
    out->azimuth = asked->azimuth;
    out->elevation = asked->elevation;
    out->roll = asked->roll;
    out->zoom = asked->zoom;
    out->fov = asked->fov;
    place_camera(asked, out);
    return CONTINUE;
}

/* One picture and its timings. */
typedef struct work {
    scene scene;
    snow_image *image; /* NULL on ranks that do not write */
    double begin;
    paint_given painted; /* how a picture of values was painted */
} work;

static snow_status make_marks(const work *w, snow_overlay **out) {
    const scene *s = &w->scene;
    const picture_marks marks = {s->asked,
                                 s->whole,
                                 s->view,
                                 s->transfer,
                                 {w->painted.range[0], w->painted.range[1]}};
    marks_report(s->asked);
    return marks_make(&marks, s->asked->azimuth, -1, s->context, out);
}

/* A pipe is written directly and may block, so an interruption there does not
 * wait. */
static int write_picture(work *w, const options *asked) {
    snow_image_options form = picture_form(asked);
    snow_overlay *overlay = NULL;
    double begin = seconds_now();
    if (!is_special(asked->output))
        interrupt_hold(); /* before the message, so that its reader can rely on
                             it */
    if (!launch_talks())
        return CONTINUE;
    const snow_image_options plain = {.size = sizeof plain,
                                      .overwrite = asked->overwrite};
    const snow_image *depth = snow_frame_depth(w->scene.frame);
    bool beside = is_beside(asked);
    snow_status status = make_marks(w, &overlay);
    progress_begin(asked, "writing");
    form.overlay = overlay;
    form.depth = beside ? depth : NULL;
    if (status == SNOW_STATUS_OK)
        status = snow_image_save(w->image, asked->output, &form);
    if (status == SNOW_STATUS_OK && asked->depth && !beside)
        status = snow_image_save(depth, asked->depth, &plain);
    snow_overlay_free(overlay);
    w->scene.times.write = seconds_now() - begin;
    return status == SNOW_STATUS_OK ? CONTINUE
                                    : fail_status(w->scene.context, status);
}

/* Comes after the picture is written, since the figures include the writing. */
static int report_figures(work *w, const options *asked) {
    if (!launch_talks())
        return SNOW_STATUS_OK;
    w->scene.times.total = seconds_now() - w->begin;
    render_report report = scene_report(&w->scene);
    report.image = w->image;
    if (asked->verbosity > 0)
        log_stats(&report);
    if (!asked->stats)
        return SNOW_STATUS_OK;
    if (!is_special(asked->stats))
        interrupt_hold();
    return write_json(stats_json(&report), asked->stats, asked->overwrite);
}

static void report_choices(const work *w) {
    char text[1024];
    scene_choices(&w->scene, text, sizeof text);
    if (w->scene.asked->verbosity >= 0)
        say("%s%s", text, w->painted.words);
    warn_picture(&w->scene, w->image);
}

/* Refuses what can be refused before anything is read; the rank that writes
 * checks the outputs. */
static int check_request(work *w, const options *asked) {
    int done = launch_agree(check_combination(asked));
    if (done == CONTINUE)
        done = scene_new(asked, &w->scene);
    if (done != CONTINUE || !launch_talks())
        return done;
    return check_paths(w->scene.context, asked);
}

/* Up to the picture in memory. */
static int make_picture(work *w, const options *asked) {
    progress_begin(asked, "reading");
    int done = scene_open(&w->scene, asked->operands[0], asked->time);
    progress_end(asked);
    if (done != CONTINUE)
        return done;
    progress_begin(asked, "rendering");
    done = scene_draw(&w->scene, asked->azimuth, &w->image);
    if (done == CONTINUE)
        done = paint_values(asked, w->scene.context, w->scene.transfer, false,
                            &w->image, &w->painted);
    progress_end(asked);
    return done;
}

/* The stages in their order; the first fault ends them. */
static int run_stages(work *w, const options *asked) {
    int done = launch_agree(check_request(w, asked));
    if (done != CONTINUE)
        return done;
    interrupt_guard();
    done = make_picture(w, asked);
    done = launch_agree(interrupt_unguard() ? EXIT_INTERRUPTED : done);
    if (done != CONTINUE)
        return done;
    report_choices(w);
    done = launch_agree(write_picture(w, asked));
    progress_end(asked);
    return done == CONTINUE ? report_figures(w, asked) : done;
}

/* The only way out, so that everything is freed after every failure. */
int cmd_render(const options *asked) {
    work w = {.begin = seconds_now()};
    int done = run_stages(&w, asked);
    snow_image_free(w.image);
    scene_free(&w.scene);
    return done;
}
