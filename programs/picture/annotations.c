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

/* Whether an output can show annotations: a picture of 8 or 16 bits, or a
 * movie. */
static bool shows_annotations(const char *path) {
    return movie_format_of(path) || snow_image_format_bits(path) > 0;
}

int annotations_check(const options *opts) {
    const char *wanted = opts->legend       ? "legend"
                         : opts->scale_bar  ? "scale-bar"
                         : opts->time_label ? "time-label"
                                            : NULL;
    if (opts->output && wanted && !shows_annotations(opts->output))
        return fail_usage("%s: --%s cannot be drawn into a file of floats; "
                          "remove it or name a .png",
                          opts->output, wanted);
    return CONTINUE;
}

void annotations_report(const options *opts) {
    bool wanted = opts->legend || opts->scale_bar;
    if (wanted && opts->fov > 0 && opts->verbosity >= 0)
        say("--%s: the scale bar is left out: in perspective no single length "
            "is valid",
            opts->scale_bar ? "scale-bar" : "legend");
}

/* Of medical formats only DICOM names the unit of values.  A volume that stays
 * in its file has no figures: its unit is not known. */
void annotations_find_unit(const options *opts, const snow_volume *volume,
                           bool parts, snow_volume_info *whole) {
    snow_volume_statistics of;
    snow_volume_statistics_init(&of);
    double ends[2] = {INFINITY, INFINITY}; /* lowest, -highest */
    if (!opts->legend || whole->hounsfield || !whole->medical ||
        *whole->modality)
        return;
    if (snow_volume_get_statistics(volume, &of) == SNOW_STATUS_OK &&
        of.finite > 0) {
        ends[0] = of.min;
        ends[1] = -of.max;
    }
    if (parts &&
        snow_comm_reduce_doubles(process_comm(), ends, 2, SNOW_REDUCE_MIN) !=
            SNOW_STATUS_OK)
        return;
    whole->hounsfield = snow_are_hounsfield(whole, ends[0], -ends[1]);
}

/* Projections show values by colour alone: the colours of the look, or those
 * that the values were painted with. */
static snow_status add_colors(const picture_annotations *annotations,
                              snow_overlay *overlay) {
    const options *opts = annotations->opts;
    double range[2] = {annotations->range[0], annotations->range[1]};
    bool over = strcmp(opts->mode, "over") == 0;
    if (range[0] == 0 && range[1] == 0)
        snow_transfer_domain(annotations->transfer, &range[0], &range[1]);
    return snow_overlay_color_bar(overlay, annotations->transfer,
                                  annotations->info.hounsfield ? "HU" : NULL,
                                  over ? NULL : range);
}

/* The letters come last: they have the most places to go to. */
static snow_status add_annotations(const picture_annotations *annotations,
                                   const snow_view *view, int64_t step,
                                   snow_overlay *overlay) {
    const options *opts = annotations->opts;
    snow_status status = SNOW_STATUS_OK;
    if (opts->legend)
        status = add_colors(annotations, overlay);
    if (status == SNOW_STATUS_OK && (opts->legend || opts->scale_bar))
        status = snow_overlay_scale_bar(overlay, &annotations->info, view);
    if (status == SNOW_STATUS_OK && opts->time_label && step >= 0) {
        char text[40];
        snprintf(text, sizeof text, "step %" PRId64, step);
        status = snow_overlay_title(overlay, text);
    }
    if (status == SNOW_STATUS_OK && !opts->no_labels)
        status = snow_overlay_orientation(overlay, &annotations->info, view);
    return status;
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
    if (!letters && !opts->legend && !opts->scale_bar && !opts->time_label)
        return SNOW_STATUS_OK;
    view.azimuth = azimuth;
    snow_status status =
        snow_overlay_new(context, view.width, view.height, &overlay);
    if (status == SNOW_STATUS_OK) {
        snow_overlay_keep_off(overlay, image);
        status = add_annotations(annotations, &view, step, overlay);
    }
    if (status == SNOW_STATUS_OK)
        *out = overlay;
    else
        snow_overlay_free(overlay);
    return status;
}
