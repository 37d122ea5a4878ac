/* cmd_slice.c - the verb slice: one slice of a volume as a picture.
 *
 * The header says where the slice lies, and a crop has no more than it read. So
 * a slice of a volume larger than memory takes the memory of a slice. */
#include "commands/commands.h"
#include "options/config.h"
#include "picture/annotations.h"
#include "picture/channels.h"
#include "picture/layers.h"
#include "picture/outputs.h"
#include "picture/render_stats.h"
#include "picture/show.h"
#include "picture/warnings.h"
#include "run/interrupt.h"
#include "run/log.h"
#include "run/start.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Degrees between a slice and the plane it stands for that are worth a note. */
#define OBLIQUE 1.0

typedef struct slice_work {
    options opts; /* in a mode of its own, cropped to the slice */
    snow_context *context;
    const char *path;
    snow_volume_info whole; /* what the slices are counted in */
    snow_view view;
    int axis, world;      /* of the grid, and of the world beside it */
    int64_t index;        /* in the whole */
    double position;      /* of its middle, in the world */
    snow_volume *volume;  /* the slice */
    char *cut;            /* its voxels, if all came through a pipe */
    channel_set channels; /* of colours, the first of which it is */
    snow_transfer *transfer;
    layers layers; /* that lie over it */
    snow_image *image;
    snow_settings settings;
    render_times times;
    double begin, frame;
} slice_work;

/* --- which slice ---------------------------------------------------------- */

static const char *axis_name(const slice_work *w) {
    return w->opts.axis ? w->opts.axis : "axial";
}

static const char *unit_of(const snow_volume_info *info) {
    return *info->unit ? info->unit : "mm";
}

/* The coordinate of a slice's middle along the axis of the world that it lies
 * across. */
static double position_of(const slice_work *w, double index) {
    const snow_volume_info *info = &w->whole;
    double at = info->matrix[w->world][3];
    for (int i = 0; i < 3; i++)
        at += info->matrix[w->world][i] *
              (i == w->axis ? index : ((double)info->dims[i] - 1) / 2);
    return at;
}

/* A number, or a position with the unit of the world behind it. */
static int find_place(slice_work *w) {
    const char *at = w->opts.at, *unit = unit_of(&w->whole);
    double last = (double)w->whole.dims[w->axis] - 1;
    char *end = NULL;
    double index = at ? strtod(at, &end) : floor((last + 1) / 2);
    if (at && end > at && strcmp(end, unit) == 0)
        index = rint((index - position_of(w, 0)) /
                     w->whole.matrix[w->world][w->axis]);
    else if (at && (end == at || *end))
        index = NAN;
    if (!(index >= 0 && index <= last) || index < floor(index) ||
        index > floor(index))
        return fail_usage("--at: '%s' is no slice across %s: must be 0 to %g, "
                          "or a position from %g%s to %g%s",
                          at, axis_name(w), last, position_of(w, 0), unit,
                          position_of(w, last), unit);
    w->index = (int64_t)index;
    w->position = position_of(w, index);
    return CONTINUE;
}

/* Of a volume that is a single slice, the cut that shows its face. */
static void choose_axis(slice_work *w) {
    static const char *const names[] = {"axial", "coronal", "sagittal"};
    const int64_t *dims = w->whole.dims;
    if (w->opts.axis || (dims[0] == 1) + (dims[1] == 1) + (dims[2] == 1) != 1)
        return;
    for (int n = 0; n < 3 && !w->opts.axis; n++) {
        snow_view view = w->view;
        int axis;
        if (!snow_slice_view(w->context, &w->whole, names[n], &view, &axis) &&
            dims[axis] == 1)
            w->opts.axis = names[n];
    }
}

static int find_slice(slice_work *w) {
    snow_view_init(&w->view);
    w->view.width = (int)w->opts.size[0];
    w->view.height = (int)w->opts.size[1];
    choose_axis(w);
    snow_status status = snow_slice_view(w->context, &w->whole, axis_name(w),
                                         &w->view, &w->axis);
    if (status != SNOW_STATUS_OK)
        return fail_status(w->context, status);
    /* The nearest axis of the world, and how far the slice's normal is from
     * it. */
    const double *normal = w->view.back;
    w->world = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(normal[i]) > fabs(normal[w->world]) + 1e-6)
            w->world = i;
    double angle = acos(fmin(fabs(normal[w->world]), 1)) * 180 / acos(-1);
    if (angle > OBLIQUE && strlen(axis_name(w)) > 1 && w->opts.verbosity >= 0)
        say("note: slices of the grid are %.0f degrees off %s: this is the "
            "nearest of them, as it is",
            angle, axis_name(w));
    return find_place(w);
}

/* Files of numbers get the values. */
static bool has_colors(const slice_work *w) {
    return snow_image_format_bits(w->opts.output) > 0 ||
           strcmp(w->opts.output, "-") == 0;
}

/* --- reading -------------------------------------------------------------- */

static void crop_to_slice(slice_work *w) {
    int64_t *crop = w->opts.crop[w->axis];
    crop[0] += w->index;
    crop[1] = crop[0] + 1;
}

/* The slice in the place of the whole, as a crop would have read it. */
static int cut_slice(slice_work *w) {
    snow_volume_info info = w->whole;
    snow_volume *slice = NULL;
    const int64_t *dims = w->whole.dims;
    const size_t size = snow_type_size(info.type);
    const size_t steps[3] = {size, size * (size_t)dims[0],
                             size * (size_t)(dims[0] * dims[1])};
    const int u = w->axis == 0, v = w->axis == 2 ? 1 : 2;
    info.dims[w->axis] = 1;
    for (int row = 0; row < 3; row++)
        info.matrix[row][3] += info.matrix[row][w->axis] * (double)w->index;
    w->cut = malloc(size * (size_t)(dims[u] * dims[v]));
    if (!w->cut)
        return fail_memory("out of memory for the slice; close other programs");
    char *out = w->cut;
    const char *from = snow_volume_voxels(w->volume);
    from += (size_t)w->index * steps[w->axis];
    for (int64_t b = 0; b < dims[v]; b++)
        for (int64_t a = 0; a < dims[u]; a++, out += size)
            memcpy(out, from + (size_t)a * steps[u] + (size_t)b * steps[v],
                   size);
    snow_status status = snow_volume_wrap(w->context, &info, w->cut, &slice);
    if (status != SNOW_STATUS_OK)
        return fail_status(w->context, status);
    snow_volume_close(w->volume);
    w->volume = slice;
    if (!options_given(&w->opts, "crop"))
        w->layers.whole = &w->whole;
    crop_to_slice(w);
    return CONTINUE;
}

static int open_piped(slice_work *w) {
    w->opts.mixes = true;
    int done = open_input(w->context, &w->opts, w->path, &w->volume);
    if (done != CONTINUE)
        return done;
    w->whole = *snow_volume_get_info(w->volume);
    done = channels_choose(&w->opts, &w->whole, channels_hinder(&w->opts),
                           &w->channels);
    if (done == CONTINUE)
        done = find_slice(w);
    return done == CONTINUE ? cut_slice(w) : done;
}

static int open_slice(slice_work *w) {
    /* Standard input can be read only once, so all of it is. */
    if (strcmp(w->path, "-") == 0)
        return open_piped(w);
    snow_volume_options data = data_options(&w->opts);
    snow_volume_info_init(&w->whole);
    show_warnings(&w->opts, w->context, false); /* they come again */
    int done = check_status(
        w->context, snow_volume_inspect(w->context, w->path, &data, &w->whole));
    show_warnings(&w->opts, w->context, true);
    if (done == CONTINUE)
        done = find_slice(w);
    snow_volume_info slice = w->whole;
    slice.dims[w->axis] = 1;
    if (done == CONTINUE)
        done = channels_choose(&w->opts, &slice,
                               has_colors(w) || w->opts.show
                                   ? channels_hinder(&w->opts)
                                   : "a file of numbers has one",
                               &w->channels);
    if (done != CONTINUE)
        return done;
    crop_to_slice(w);
    w->opts.mixes = true;
    if (w->channels.list.count)
        w->opts.channel = w->channels.list.picks[0].index;
    return open_input(w->context, &w->opts, w->path, &w->volume);
}

/* --- the picture ---------------------------------------------------------- */

/* The view is that of the voxels that were read, since its zoom counts in their
 * size. */
static snow_status draw(slice_work *w) {
    static const char *const axes[] = {"x", "y", "z"};
    const snow_volume_info *info = snow_volume_get_info(w->volume);
    int axis;
    double begin = seconds_now();
    snow_status status = SNOW_STATUS_OK;
    w->view.strip = 0;
    for (int n = 0; n < 2 && status == SNOW_STATUS_OK; n++) {
        if (n) /* a strip of the picture, whose size is known now */
            w->view.strip = annotations_strip(
                &(picture_annotations){&w->opts,
                                       *info,
                                       w->view,
                                       w->transfer,
                                       {0, 0},
                                       &w->channels,
                                       layers_legend(&w->layers, false)});
        w->view.width = (int)w->opts.size[0];
        w->view.height = (int)w->opts.size[1];
        status =
            snow_slice_view(w->context, info, axes[w->axis], &w->view, &axis);
        if (!w->transfer)
            break;
    }
    if (status == SNOW_STATUS_OK)
        status = snow_slice_render(w->volume, 0, w->transfer, &w->view,
                                   &w->settings, &w->image);
    if (status == SNOW_STATUS_OK && w->transfer && w->channels.list.count)
        status = channels_add_slices(&w->channels, w->context, 0, &w->view,
                                     &w->settings, &w->image);
    if (status == SNOW_STATUS_OK)
        status = layers_lay_slice(&w->opts, &w->layers, 0, &w->view,
                                  &w->settings, w->context, &w->image);
    w->frame = seconds_now() - begin;
    return status;
}

/* Labels are drawn as such where nothing else is asked, as in a picture. */
static int open_colors(slice_work *w) {
    static options automatic; /* large */
    const options *opts = &w->opts;
    automatic = *opts;
    automatic.mode = "over";
    bool asked = opts->preset || opts->tf || opts->colormap ||
                 opts->scale.log || opts->scale.symlog != 0 ||
                 options_range(opts).kind != SNOW_RANGE_AUTO;
    int done = CONTINUE;
    if (w->channels.list.count) {
        snow_status status =
            channels_look(NULL, opts, &w->whole, &w->channels.list.picks[0],
                          w->volume, &w->transfer);
        channels_close_volumes(&w->channels);
        if (status == SNOW_STATUS_OK)
            status = channels_open(opts, w->context, w->path, false, 0,
                                   &w->channels);
        return check_volume(w->context, status, name_of_input(w->path));
    }
    if (!asked)
        done = open_look(w->context, &automatic, w->volume, &w->transfer);
    if (done != CONTINUE ||
        (w->transfer && snow_transfer_label(w->transfer, 0)))
        return done;
    snow_transfer_free(w->transfer);
    w->transfer = NULL;
    return open_look(w->context, opts, w->volume, &w->transfer);
}

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
        done = open_colors(w);
    if (done != CONTINUE)
        return done;
    return check_volume(w->context, draw(w), name_of_input(w->path));
}

static int make_picture(slice_work *w) {
    const options *opts = &w->opts;
    double begin = seconds_now();
    progress_begin(opts, "reading");
    int done = open_slice(w);
    progress_end(opts);
    w->times.read = seconds_now() - begin;
    if (done == CONTINUE && has_colors(w))
        done = open_colors(w);
    if (done == CONTINUE)
        done = layers_open(opts, w->context, w->volume, &w->layers);
    w->times.look = seconds_now() - begin - w->times.read;
    if (done != CONTINUE)
        return done;
    snow_status status = draw(w);
    if (status == SNOW_STATUS_NO_MEMORY && w->channels.list.count > 1 &&
        !opts->channels.count)
        return draw_first(w);
    return check_volume(w->context, status, name_of_input(w->path));
}

/* The description of a look without its opacities, which a slice ignores. */
static void describe_colors(const slice_work *w, char *out, size_t size) {
    const char *text =
        w->transfer ? snow_transfer_description(w->transfer) : "data values";
    const char *opacity = strstr(text, "; opacity"), *reason = NULL;
    for (const char *at = opacity; at && (at = strstr(at, " ("));)
        reason = at++;
    snprintf(out, size, "%.*s%s",
             opacity ? (int)(opacity - text) : (int)strlen(text), text,
             reason ? reason : "");
}

static void report(const slice_work *w) {
    char volume[256], colors[512];
    describe_volume(&w->whole, volume, sizeof volume);
    describe_colors(w, colors, sizeof colors);
    config_note_slice(&w->opts, w->channels.list.count ? NULL : w->transfer,
                      axis_name(w), w->index);
    if (w->transfer && w->channels.list.count) {
        channels_describe(&w->channels, colors, sizeof colors);
        config_note_channels(&w->opts, &w->channels.list, SNOW_SHADE_NONE,
                             NULL);
    }
    annotations_report(&w->opts);
    if (w->opts.verbosity < 0)
        return;
    say("%s: %s; %s slice %" PRId64 " of 0 to %" PRId64 ", at %g%s; %s; "
        "%dx%d pixels%s%s",
        name_of_input(w->path), volume, axis_name(w), w->index,
        w->whole.dims[w->axis] - 1, w->position, unit_of(&w->whole), colors,
        w->view.width, w->view.height, w->opts.named ? "; to " : "",
        w->opts.named ? w->opts.output : "");
    if (picture_is_empty(w->image))
        say("note: the picture is empty: the slice has no finite value, or "
            "with --scale log none above 0; give another --at");
}

/* Letters stay at the edges: a slice fills its picture. */
static snow_status make_overlay(slice_work *w, snow_overlay **out) {
    picture_annotations annotations = {&w->opts,
                                       *snow_volume_get_info(w->volume),
                                       w->view,
                                       w->transfer,
                                       {0, 0},
                                       w->transfer ? &w->channels : NULL,
                                       layers_legend(&w->layers, false)};
    annotations_find_unit(&w->opts, w->volume, false, &annotations.info);
    return annotations_make(&annotations, 0, -1, NULL, w->context, out);
}

/* Shows what a PNG would: where values are written, the same slice in
 * colours. */
static int show_slice(const slice_work *w) {
    slice_work shown = *w;
    snow_overlay *overlay = NULL;
    int done = CONTINUE;
    if (!has_colors(w)) {
        shown.transfer = NULL;
        shown.image = NULL;
        done = open_colors(&shown);
        if (done == CONTINUE)
            done = check_status(w->context, draw(&shown));
    }
    shown.opts.output = "-";
    snow_image_options form = picture_form(&shown.opts);
    if (done == CONTINUE) {
        snow_status status = make_overlay(&shown, &overlay);
        form.overlay = overlay;
        done = status == SNOW_STATUS_OK ? show_picture(shown.image, &form)
                                        : fail_status(w->context, status);
    }
    snow_overlay_free(overlay);
    if (!has_colors(w)) {
        snow_image_free(shown.image);
        snow_transfer_free(shown.transfer);
    }
    return done;
}

static int write_slice(slice_work *w) {
    const options *opts = &w->opts;
    snow_image_options form = picture_form(opts);
    snow_overlay *overlay = NULL;
    double begin = seconds_now();
    bool shown = opts->show && strcmp(opts->output, "-") == 0;
    if (!is_special(opts->output))
        interrupt_hold();
    snow_status status = make_overlay(w, &overlay);
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
    json_object_set_new(tree, "slice",
                        json_pack("{s:s,s:I,s:f,s:s}", "axis", axis_name(w),
                                  "index", (json_int_t)w->index, "position",
                                  w->position, "unit", unit_of(&w->whole)));
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

static int check_request(slice_work *w) {
    const options *opts = &w->opts;
    int done = check_picture(opts);
    if (done == CONTINUE && opts->footprint)
        done = fail_usage("--kernel: a slice has no support; give %s alone",
                          opts->kernel);
    if (done == CONTINUE && (strcmp(opts->kernel, "gauss") == 0 ||
                             strcmp(opts->kernel, "bspline") == 0))
        done = fail_usage("--kernel: %s cannot draw a slice; use tent, or box "
                          "for the nearest voxel",
                          opts->kernel);
    if (done == CONTINUE)
        done = layers_check(opts);
    if (done == CONTINUE && opts->overlay && !has_colors(w))
        done = fail_usage("%s: a file of numbers holds one volume's values, "
                          "without --overlay; name a .png",
                          opts->output);
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
    return check_picture_paths(w->context, opts);
}

static int run_stages(slice_work *w) {
    int done = check_request(w);
    if (done != CONTINUE)
        return done;
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
    free(w.cut);
    snow_context_free(w.context);
    return done;
}
