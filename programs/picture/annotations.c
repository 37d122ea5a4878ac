/* annotations.c - makes overlays from the options.  Pictures of 8 and 16 bits
 * get them when they are written.  A picture in memory, its checksum and files
 * of floats never do. */
#include "picture/annotations.h"
#include "movie/movie_encoder.h"
#include "run/log.h"
#include "run/start.h"

#include <inttypes.h>
#include <math.h>
#include <snowglass/extend.h>
#include <stdio.h>
#include <string.h>

#define TITLE_BYTES 256
#define TITLE_MOST 1000 /* bytes of --title */

/* Pictures of sums leave room for numbers of such a magnitude. */
#define UNKNOWN 10000

/* Whether an output can show annotations: a picture of 8 or 16 bits, or a
 * movie. */
static bool shows_annotations(const char *path) {
    return movie_format_of(path) || snow_image_format_bits(path) > 0;
}

int annotations_check(const options *opts) {
    const char *wanted = opts->legend.scale    ? "legend"
                         : opts->title         ? "title"
                         : opts->box           ? "box"
                         : opts->annotate.text ? "annotate"
                         : opts->measure       ? "measure"
                                               : NULL;
    if (opts->output && wanted && !shows_annotations(opts->output))
        return fail_usage("%s: --%s cannot be drawn into a file of floats; "
                          "remove it or name a .png",
                          opts->output, wanted);
    if (opts->title && strlen(opts->title) > TITLE_MOST)
        return fail_usage("--title: has %zu bytes: at most %d are drawn; "
                          "shorten it",
                          strlen(opts->title), TITLE_MOST);
    return CONTINUE;
}

void annotations_report(const options *opts) {
    if (opts->legend.scale && opts->fov > 0 && opts->verbosity >= 0)
        say("--legend: the scale bar is left out: in perspective no single "
            "length is valid");
}

/* Of medical formats only DICOM names the unit of values.  A volume that stays
 * in its file has no figures: its unit is not known. */
void annotations_find_unit(const options *opts, const snow_volume *volume,
                           bool parts, snow_volume_info *whole) {
    snow_volume_statistics of;
    snow_volume_statistics_init(&of);
    double ends[2] = {INFINITY, INFINITY}; /* lowest, -highest */
    if (!(opts->legend.bar || opts->measure) || whole->hounsfield ||
        !whole->medical || *whole->modality)
        return;
    if (snow_volume_get_statistics(volume, &of) == SNOW_STATUS_OK &&
        of.finite > 0) {
        ends[0] = of.min;
        ends[1] = -of.max;
    }
    if (parts && snow_comm_reduce_doubles(process_comm(), ends, 2,
                                          SNOW_REDUCE_MIN) != SNOW_STATUS_OK)
        return;
    whole->hounsfield = snow_are_hounsfield(whole, ends[0], -ends[1]);
}

/* "temperature (K)", as far as it is known. */
static void make_caption(const picture_annotations *annotations,
                         char caption[TITLE_BYTES]) {
    const snow_volume_info *info = &annotations->info;
    const legend_value *legend = &annotations->opts->legend;
    const char *unit = *legend->unit      ? legend->unit
                       : info->hounsfield ? "HU"
                                          : info->value_unit;
    const char *title = *legend->name ? legend->name : info->quantity;
    bool both = *title && *unit;
    snprintf(caption, TITLE_BYTES, "%.100s%s%.100s%s", title, both ? " (" : "",
             unit, both ? ")" : "");
}

/* By its name in the file, or by its number. */
static void name_channel(const snow_volume_info *info, const channel_pick *pick,
                         char out[64]) {
    const bool known = pick->index < SNOW_CHANNELS_MAX &&
                       pick->index < info->channels &&
                       *info->channel[pick->index].name;
    if (known)
        snprintf(out, 64, "%s", info->channel[pick->index].name);
    else
        snprintf(out, 64, "channel %" PRId64, pick->index);
}

/* A bar for each, the first one on top of `bars`. */
static snow_status add_channels(const picture_annotations *annotations,
                                int bars, snow_overlay *overlay) {
    const channel_set *c = annotations->channels;
    const bool over = strcmp(annotations->opts->mode, "over") == 0;
    snow_status status = SNOW_STATUS_OK;
    for (int n = 0; n < c->list.count && status == SNOW_STATUS_OK; n++) {
        const snow_transfer *look = n ? c->looks[n] : annotations->transfer;
        double range[2];
        char name[64];
        name_channel(&annotations->info, &c->list.picks[n], name);
        snow_transfer_domain(look, &range[0], &range[1]);
        status = snow_overlay_color_bar(
            overlay, look, name, over ? NULL : range, bars - 1 - n, bars);
    }
    return status;
}

/* Projections show values by colour alone: the colours of the look, or those
 * that the values were painted with. */
static snow_status add_colors(const picture_annotations *annotations, int bars,
                              snow_overlay *overlay) {
    const options *opts = annotations->opts;
    double range[2] = {annotations->range[0], annotations->range[1]};
    bool over = strcmp(opts->mode, "over") == 0 ||
                (strcmp(opts->mode, "slice") == 0 &&
                 snow_transfer_label(annotations->transfer, 0));
    if (range[0] == 0 && range[1] == 0)
        snow_transfer_domain(annotations->transfer, &range[0], &range[1]);
    char caption[TITLE_BYTES];
    make_caption(annotations, caption);
    return snow_overlay_color_bar(overlay, annotations->transfer, caption,
                                  over ? NULL : range, bars - 1, bars);
}

/* The labels of an overlay stand instead of the volume's bar, or below bars of
 * channels; so does the bar of its values.  It is not called by its file, whose
 * name may be a patient's. */
static snow_status add_legend(const picture_annotations *annotations,
                              snow_overlay *overlay) {
    const options *opts = annotations->opts;
    const bool slice = strcmp(opts->mode, "slice") == 0;
    const bool mixed =
        annotations->channels && annotations->channels->list.count;
    const snow_transfer *over =
        slice || strcmp(opts->mode, "over") == 0 ? annotations->overlay : NULL;
    const bool labels = over && snow_transfer_label(over, 0);
    char caption[TITLE_BYTES];
    double range[2];
    if (labels && !mixed) {
        make_caption(annotations, caption);
        return snow_overlay_color_bar(overlay, over, caption, NULL, 0, 1);
    }
    const int bars =
        (mixed ? annotations->channels->list.count : 1) + (over != NULL);
    snow_status status = mixed ? add_channels(annotations, bars, overlay)
                               : add_colors(annotations, bars, overlay);
    if (status != SNOW_STATUS_OK || !over)
        return status;
    snow_transfer_domain(over, &range[0], &range[1]);
    return snow_overlay_color_bar(overlay, over, "overlay",
                                  slice && !labels ? range : NULL, 0, bars);
}

/* The time of the picture, or the number of its step; "" where there is
 * neither. */
static void write_time(const picture_annotations *annotations, int64_t step,
                       char time[TITLE_BYTES]) {
    const options *opts = annotations->opts;
    const snow_volume_info *info = &annotations->info;
    *time = 0;
    if (opts->annotate.time &&
        snow_time_text(info, opts->annotate.format, time, TITLE_BYTES))
        return;
    if (step < 0 && info->times > 1)
        step = info->time;
    *time = 0;
    if (opts->annotate.text && step >= 0)
        snprintf(time, TITLE_BYTES, "step %" PRId64, step);
}

/* The title, and below it the time of the picture. */
static snow_status add_title(const picture_annotations *annotations,
                             int64_t step, snow_overlay *overlay) {
    const options *opts = annotations->opts;
    char text[TITLE_MOST + 1 + TITLE_BYTES], time[TITLE_BYTES];
    write_time(annotations, step, time);
    snprintf(text, sizeof text, "%s%s%s", opts->title ? opts->title : "",
             opts->title && *time ? "\n" : "", time);
    return snow_overlay_title(overlay, text);
}

/* The title keeps off the letters, and the numbers of the box off all. */
static snow_status add_annotations(const picture_annotations *annotations,
                                   const snow_view *view, int64_t step,
                                   snow_overlay *overlay) {
    const options *opts = annotations->opts;
    snow_status status = SNOW_STATUS_OK;
    if (opts->legend.bar)
        status = add_legend(annotations, overlay);
    if (status == SNOW_STATUS_OK && opts->legend.scale)
        status = snow_overlay_scale_bar(overlay, &annotations->info, view);
    if (status == SNOW_STATUS_OK && !opts->no_labels)
        status = snow_overlay_orientation(overlay, &annotations->info, view);
    if (status == SNOW_STATUS_OK && annotations->more)
        status = annotations->more(annotations->user, overlay);
    if (status == SNOW_STATUS_OK)
        status = add_title(annotations, step, overlay);
    if (status == SNOW_STATUS_OK)
        status = measures_draw(annotations->measures, &annotations->info, view,
                               0, 0, annotations->axis,
                               annotations->index ? *annotations->index : -1,
                               overlay);
    if (status == SNOW_STATUS_OK && opts->box)
        status = snow_overlay_box(overlay, &annotations->info, view,
                                  options_has_axes(opts));
    return status;
}

double annotations_strip(const picture_annotations *given) {
    picture_annotations all = *given;
    const picture_annotations *annotations = &all;
    const options *opts = given->opts;
    if (strcmp(opts->mode, "mean") == 0 ||
        strcmp(opts->mode, "sum") == 0) { /* which are not known yet */
        all.range[0] = -UNKNOWN;
        all.range[1] = UNKNOWN;
    }
    snow_context *silent = NULL;
    snow_overlay *overlay = NULL;
    double strip = 0;
    const bool any = opts->legend.bar || (opts->legend.scale && !opts->fov);
    const int sides[2] = {annotations->view.width, annotations->view.height};
    if (!any || snow_context_new(NULL, &silent) != SNOW_STATUS_OK)
        return 0;
    if (snow_overlay_new(silent, sides[0], sides[1], &overlay) ==
            SNOW_STATUS_OK &&
        (!opts->legend.bar ||
         add_legend(annotations, overlay) == SNOW_STATUS_OK))
        strip = snow_overlay_strip(overlay);
    snow_overlay_free(overlay);
    snow_context_free(silent);
    return strip;
}

snow_status annotations_make(const picture_annotations *annotations,
                             double azimuth, int64_t step,
                             const snow_image *image, snow_context *context,
                             snow_overlay **out) {
    const options *opts = annotations->opts;
    bool letters = !opts->no_labels && annotations->info.medical;
    snow_view view = annotations->view;
    snow_overlay *overlay = NULL;
    *out = NULL;
    if (!shows_annotations(opts->output) && strcmp(opts->output, "-") != 0)
        return SNOW_STATUS_OK;
    if (!letters && !opts->legend.scale && !opts->title &&
        !opts->annotate.text && !opts->box && !annotations->measures &&
        !annotations->more)
        return SNOW_STATUS_OK;
    view.azimuth = azimuth;
    char time[TITLE_BYTES];
    write_time(annotations, step, time);
    if (opts->annotate.text && !*time)
        snow_context_warn(context, "--annotate draws nothing: the file has "
                                   "neither a time nor several steps");
    snow_status status =
        snow_overlay_new(context, view.width, view.height, &overlay);
    if (status == SNOW_STATUS_OK) {
        snow_overlay_set_picture(overlay, image);
        status = add_annotations(annotations, &view, step, overlay);
    }
    if (status == SNOW_STATUS_OK)
        *out = overlay;
    else
        snow_overlay_free(overlay);
    return status;
}
