/* cmd_render.c - one picture: open, look, view, render, write, tell.
 *
 * Everything that can be refused is refused before the volume is read:
 * options that contradict each other, and outputs that cannot be written. */
#include "commands.h"
#include "interrupt.h"
#include "outputs.h"
#include "render_stats.h"
#include "report.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* "-" as in most tools; a file of that name is ./-. */
static bool is_stream(const char *path) {
    return path && strcmp(path, "-") == 0;
}

/* Whether a path gets a PNG, the only format with bits and a background. */
static bool is_png(const char *path) {
    size_t length = strlen(path);
    return is_stream(path) ||
           (length >= 4 && strcmp(path + length - 4, ".png") == 0) ||
           (length >= 4 && strcmp(path + length - 4, ".PNG") == 0);
}

int check_settings(const options *asked) {
    if (strcmp(asked->method, "original") == 0 &&
        strcmp(asked->encoding, "auto") != 0)
        return fail_usage("--encoding: method original encodes nothing; leave "
                          "one of the two out");
    return check_look(asked);
}

/* Needs no file, so it comes before everything else. */
static int check_combination(const options *asked) {
    if (!asked->output)
        return fail_usage("no output is named; add -o OUT.png");
    if (!is_png(asked->output) && (asked->background.given || asked->bits))
        return fail_usage("%s: --background and --bits are for PNG files; "
                          "leave them out or name a .png",
                          asked->output);
    if (asked->stats && (strcmp(asked->stats, asked->output) == 0 ||
                         same_place(asked->stats, asked->output)))
        return fail_usage("--stats: goes where --output goes; name two places");
    if (is_stream(asked->output) && isatty(STDOUT_FILENO))
        return fail_usage("--output: '-' is a terminal; send it to a pipe or a "
                          "file");
    return check_settings(asked);
}

/* A long rendering must not end in an output that could have been refused at
 * once. */
static int check_paths(snow_context *context, const options *asked) {
    snow_status status =
        snow_image_check_path(context, asked->output, asked->overwrite);
    if (status != SNOW_OK)
        return fail_status(context, status);
    return asked->stats ? check_stats_path(asked->stats, asked->overwrite)
                        : GO_ON;
}

/* A millimetre in the units of the volume's world. */
static int opacity_length(const options *asked, const snow_volume_info *info,
                          double *out) {
    static const struct {
        const char *unit;
        double length;
    } units[] = {{"", 1},     {"mm", 1},   {"um", 1e3},
                 {"nm", 1e6}, {"m", 1e-3}, {"angstrom", 1e7}};
    *out = 0;
    if (strcmp(asked->opacity_unit, "mm") != 0)
        return GO_ON;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        if (strcmp(units[i].unit, info->unit) == 0)
            *out = units[i].length;
    }
    if (*out > 0)
        return GO_ON;
    return fail_usage("--opacity-unit: the volume's unit '%s' is no length; "
                      "give voxel",
                      info->unit);
}

/* The texts were checked against the choices of the table, so that every name
 * is known to the library. */
void fill_settings(const options *asked, snow_settings *out) {
    snow_settings_init(out);
    out->threshold = asked->threshold < 0 ? 0 : asked->threshold;
    out->method = (snow_method)snow_method_named(asked->method);
    out->encoding = (snow_encoding)snow_encoding_named(asked->encoding);
    out->kernel = (snow_kernel)snow_kernel_named(asked->kernel);
    out->footprint = (int)asked->footprint;
    out->shade =
        strcmp(asked->shade, "none") == 0 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    out->ambient = asked->ambient;
    out->diffuse = asked->diffuse;
    out->specular = asked->specular;
    out->shininess = asked->shininess;
    out->light_azimuth = asked->light[0];
    out->light_elevation = asked->light[1];
    out->quality = (snow_quality)snow_quality_named(asked->quality);
    out->isa = (snow_isa)snow_isa_named(asked->isa);
    out->threads = (int)asked->threads;
    out->deterministic = asked->deterministic;
}

int make_settings(const options *asked, const snow_volume *volume,
                  snow_settings *out) {
    fill_settings(asked, out);
    return opacity_length(asked, snow_volume_describe(volume),
                          &out->opacity_length);
}

/* A named view sets size and angles too, hence it comes before them. */
int make_view(snow_context *context, const options *asked,
              const snow_volume *volume, snow_view *out) {
    snow_view_default(volume, out);
    if (asked->view) {
        snow_status status = snow_view_named(context, asked->view, out);
        if (status != SNOW_OK)
            return fail_status(context, status);
    }
    out->width = (int)asked->size[0];
    out->height = (int)asked->size[1];
    out->azimuth = asked->azimuth;
    out->elevation = asked->elevation;
    out->roll = asked->roll;
    out->zoom = asked->zoom;
    out->fov = asked->fov;
    return GO_ON;
}

/* The objects of one picture, and what it took. */
typedef struct work {
    snow_context *context;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_frame *frame;
    snow_image *image;
    snow_settings settings;
    render_times times;
} work;

/* In any order but the context last; all of them accept NULL. */
static void free_work(work *w) {
    snow_image_free(w->image);
    snow_frame_free(w->frame);
    snow_transfer_free(w->transfer);
    snow_volume_close(w->volume);
    snow_context_free(w->context);
}

/* Decompression and conversion are part of the reading. */
static int read_volume(work *w, const options *asked) {
    double begin = seconds_now();
    progress(asked, "reading");
    int done = open_input(w->context, asked, asked->operands[0], &w->volume);
    w->times.read = seconds_now() - begin;
    return done;
}

/* Timed apart from the reading: the histogram takes a pass over all voxels. */
static int choose_look(work *w, const options *asked) {
    double begin = seconds_now();
    int done = open_look(w->context, asked, w->volume, &w->transfer);
    w->times.look = seconds_now() - begin;
    return done;
}

/* Calls the pipeline.  The view comes first: what is wrong with it costs no
 * buffers. */
static int make_picture(work *w, const options *asked) {
    snow_view view;
    int done = make_view(w->context, asked, w->volume, &view);
    if (done == GO_ON)
        done = make_settings(asked, w->volume, &w->settings);
    if (done != GO_ON)
        return done;
    progress(asked, "rendering");
    snow_status status = snow_frame_new(w->context, &w->frame);
    if (status == SNOW_OK)
        status = snow_frame_render(w->frame, w->volume, w->transfer, &view,
                                   &w->settings, &w->image);
    return status == SNOW_OK ? GO_ON
                             : fail_volume(w->context, status,
                                           name_of_input(asked->operands[0]));
}

/* The one line that says what was chosen where nothing was told. */
static void tell_choices(const work *w, const options *asked) {
    if (asked->verbosity < 0)
        return;
    const snow_stats *stats = snow_frame_stats(w->frame);
    const char *view = asked->view                                ? asked->view
                       : snow_volume_describe(w->volume)->medical ? "anterior"
                                                                  : "+z";
    bool encoded = stats->encoding != SNOW_ENCODING_AUTO;
    char volume[256];
    describe_volume(w->volume, volume, sizeof volume);
    say("%s: %s; %s; view %s; method %s%s%s", name_of_input(asked->operands[0]),
        volume, snow_transfer_text(w->transfer), view,
        snow_method_name(stats->method), encoded ? ", encoding " : "",
        encoded ? snow_encoding_name(stats->encoding) : "");
}

/* A pipe is written through and may block, so there an interruption does not
 * wait. */
static int write_picture(work *w, const options *asked) {
    snow_image_options form = {
        .flatten = asked->background.given,
        .bits = asked->bits ? (asked->bits[0] == '8' ? 8 : 16) : 0,
        .overwrite = asked->overwrite};
    memcpy(form.background, asked->background.rgb, sizeof form.background);
    double begin = seconds_now();
    if (!is_special(asked->output))
        interrupt_hold(); /* before the word, so that who reads it may rely */
    progress(asked, "writing");
    snow_status status = snow_image_save(w->image, asked->output, &form);
    w->times.write = seconds_now() - begin;
    return status == SNOW_OK ? GO_ON : fail_status(w->context, status);
}

/* After the picture is safe: its writing is part of the figures. */
static int tell_figures(work *w, const options *asked) {
    render_report report = {w->context,   w->volume, w->frame,
                            &w->settings, w->image,  &w->times};
    w->times.total = seconds_now() - w->times.begin;
    if (asked->verbosity > 0)
        tell_stats(&report);
    if (!asked->stats)
        return SNOW_OK;
    if (!is_special(asked->stats))
        interrupt_hold();
    return write_json(stats_json(&report), asked->stats, asked->overwrite);
}

/* The stages in their order; the first fault ends them. */
static int run(work *w, const options *asked) {
    int done = check_combination(asked);
    if (done == GO_ON)
        done = open_context(asked, &w->context);
    if (done == GO_ON)
        done = check_paths(w->context, asked);
    if (done == GO_ON)
        done = read_volume(w, asked);
    if (done == GO_ON)
        done = choose_look(w, asked);
    if (done == GO_ON)
        done = make_picture(w, asked);
    progress(asked, NULL);
    if (done != GO_ON)
        return done;
    tell_choices(w, asked);
    done = write_picture(w, asked);
    progress(asked, NULL);
    return done == GO_ON ? tell_figures(w, asked) : done;
}

/* One way out, so that whatever was made is freed at every fault. */
int cmd_render(const options *asked) {
    work w = {.times = {.begin = seconds_now()}};
    int done = run(&w, asked);
    free_work(&w);
    return done;
}
