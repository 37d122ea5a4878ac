/* annotations.c - makes overlays from the options.  Pictures of 8 and 16 bits
 * get them when they are written.  A picture in memory, its checksum and files
 * of floats never do. */
#include "picture/annotations.h"
#include "movie/movie_encoder.h"
#include "run/log.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Whether an output can show annotations: a picture of 8 or 16 bits, or a
 * movie. */
static bool shows_annotations(const char *path) {
    return movie_format_of(path) || snow_image_format_bits(path) > 0;
}

int annotations_check(const options *opts) {
    if (opts->output && (opts->legend || opts->time_label) &&
        !shows_annotations(opts->output))
        return fail_usage("%s: --%s cannot be drawn into a file of floats; "
                          "remove it or name a .png",
                          opts->output, opts->legend ? "legend" : "time-label");
    return CONTINUE;
}

void annotations_report(const options *opts) {
    if (opts->legend && opts->fov > 0 && opts->verbosity >= 0)
        say("--legend: the scale bar is left out: in perspective no single "
            "length is valid");
}

/* Presets for CT use Hounsfield units, unless a range spreads them over other
 * values. */
static const char *unit_of_values(const options *opts) {
    int preset = opts->preset ? snow_preset_from_name(opts->preset) : -1;
    bool spread = opts->range.kind != SNOW_RANGE_AUTO || !isnan(opts->window);
    bool ct =
        preset >= 0 && strncmp(snow_preset_name((size_t)preset), "ct-", 3) == 0;
    return ct && !spread ? "HU" : NULL;
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
                                  unit_of_values(opts), over ? NULL : range);
}

static snow_status add_annotations(const picture_annotations *annotations,
                                   const snow_view *view, int64_t step,
                                   snow_overlay *overlay) {
    const options *opts = annotations->opts;
    snow_status status = SNOW_STATUS_OK;
    if (!opts->no_labels)
        status = snow_overlay_orientation(overlay, &annotations->info, view);
    if (status == SNOW_STATUS_OK && opts->legend)
        status = add_colors(annotations, overlay);
    if (status == SNOW_STATUS_OK && opts->legend)
        status = snow_overlay_scale_bar(overlay, &annotations->info, view);
    if (status == SNOW_STATUS_OK && opts->time_label && step >= 0) {
        char text[40];
        snprintf(text, sizeof text, "step %" PRId64, step);
        status = snow_overlay_title(overlay, text);
    }
    return status;
}

snow_status annotations_make(const picture_annotations *annotations,
                             double azimuth, int64_t step,
                             snow_context *context, snow_overlay **out) {
    const options *opts = annotations->opts;
    bool letters = !opts->no_labels && annotations->info.medical;
    snow_view view = annotations->view;
    snow_overlay *overlay = NULL;
    *out = NULL;
    if (!shows_annotations(opts->output) && strcmp(opts->output, "-") != 0)
        return SNOW_STATUS_OK;
    if (!letters && !opts->legend && !opts->time_label)
        return SNOW_STATUS_OK;
    view.azimuth = azimuth;
    snow_status status =
        snow_overlay_new(context, view.width, view.height, &overlay);
    if (status == SNOW_STATUS_OK)
        status = add_annotations(annotations, &view, step, overlay);
    if (status == SNOW_STATUS_OK)
        *out = overlay;
    else
        snow_overlay_free(overlay);
    return status;
}
