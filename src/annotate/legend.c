/* annotate/legend.c - explains the lengths of a picture, and names it: a scale
 * bar, lines of text. */
#include "annotate/length.h"
#include "annotate/strokes.h"

#include "transfer/scale.h"
#include "transform/transform.h"

#include <snowglass/extend.h>
#include <snowglass/overlay.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Smaller pictures than this have no room for letters. */
#define NOTE_SIDE_LEAST 64

double snow_overlay_text_height(const snow_overlay *overlay) {
    return fmax(9, floor(0.036 * snow_shorter_side(overlay) + 0.5));
}

/* The base line and the left border are placed at the middle of a pixel, where
 * strokes of small letters are sharp. */
snow_status snow_overlay_text(snow_overlay *overlay, double x, double y,
                              double share_x, double share_y, double height,
                              const char *text) {
    if (!isfinite(x) || !isfinite(y) || !isfinite(share_x) ||
        !isfinite(share_y) || !(height > 0) || !isfinite(height))
        return snow_fail(overlay->context, SNOW_STATUS_BAD_USAGE,
                         "a text %g pixels high at %g, %g: give finite places "
                         "and a height above 0",
                         height, x, y);
    double left = x - share_x * height * snow_font_width(text);
    double base = y + (1 - share_y) * height;
    if (!*text)
        return SNOW_STATUS_OK;
    if (!overlay->boxes && !snow_font_has(text)) {
        snow_notify(overlay->context,
                    "%s: has letters that the font lacks, which are drawn as "
                    "boxes; it has those of Western Europe, and Greek",
                    text);
        overlay->boxes = true;
    }
    SNOW_TRY(snow_begin_strokes(overlay, height));
    return snow_font_draw(overlay, floor(left) + 0.5, floor(base) + 0.5, height,
                          text);
}

/* Takes the first `length` bytes of a text, or as many letters as there is
 * room for, and "..." then. */
static void take_line(const char *text, size_t length, char *line,
                      size_t room) {
    const bool cut = length >= room;
    if (cut)
        length = room - 4;
    while (cut && length > 0 && (text[length] & 0xc0) == 0x80)
        length--;
    snprintf(line, room, "%.*s%s", (int)length, text, cut ? "..." : "");
}

/* Adds lines from `y` on, in heights of letters; those that are wider than the
 * picture end with "...". */
static snow_status add_lines(snow_overlay *overlay, double y,
                             const char *text) {
    const double height = snow_overlay_text_height(overlay);
    const double width = overlay->width - overlay->strip;
    for (; *text; y += 1.7) {
        char line[1024];
        size_t length = strcspn(text, "\n");
        take_line(text, length, line, sizeof line);
        snow_font_shorten(width / height - 1.6, line);
        SNOW_TRY(snow_overlay_text(overlay, 0.8 * height, y * height, 0, 0,
                                   height, line));
        text += length + (text[length] == '\n');
    }
    return SNOW_STATUS_OK;
}

/* Below the letter of the upper edge, where it would cover that. */
snow_status snow_overlay_title(snow_overlay *overlay, const char *text) {
    static const double places[] = {0.8, 2.4};
    const size_t first = overlay->shape_count;
    if (snow_shorter_side(overlay) < NOTE_SIDE_LEAST || !*text)
        return SNOW_STATUS_OK;
    for (int n = 0; n < 2 && overlay->shape_count == first; n++) {
        SNOW_TRY(add_lines(overlay, places[n], text));
        if (snow_overlay_meets(overlay, first, first))
            overlay->shape_count = first;
    }
    if (overlay->shape_count == first)
        snow_notify(overlay->context, "the picture has no room for the title");
    return SNOW_STATUS_OK;
}

/* --- the scale bar -------------------------------------------------------- */

/* What stands in its place where the world's z has another scale: how many
 * times it is higher, where both are lengths. */
static bool write_height(const snow_volume_info *info, char *out, size_t size) {
    const double scale = fabs(info->axis_scale[2]);
    const char *unit = info->axis_unit[2];
    const double base = !*unit ? 1
                        : strcmp(info->unit, "degrees") != 0
                            ? 0
                            : snow_unit_length(unit, NULL) /
                                  (SNOW_DEGREE * snow_unit_length("m", NULL));
    if (info->dims[2] == 1 || !(scale > 0) || (!*unit && scale == 1))
        return false;
    const double digit = pow(10, floor(log10(scale / base)) - 1);
    if (base > 0)
        snow_text_print(out, size, "height x %.6g",
                        rint(scale / base / digit) * digit);
    else
        snow_text_print(out, size, "height not to scale");
    return true;
}

snow_status snow_overlay_scale_bar(snow_overlay *overlay,
                                   const snow_volume_info *info,
                                   const snow_view *view) {
    snow_context *context = overlay->context;
    snow_camera camera;
    snow_volume_info volume;
    snow_view from;
    char text[64];
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, info, &volume));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &from));
    SNOW_TRY(snow_camera_make(context, &volume, &from, &camera));
    if (camera.distance > 0 || snow_shorter_side(overlay) < SNOW_BAR_SIDE_LEAST)
        return SNOW_STATUS_OK;
    /* As wide as the strip allows, in its middle. */
    const double height = snow_number_height(overlay);
    const double edge = SNOW_STRIP_MARGIN * height;
    const double strip =
        overlay->width * fmax(view->strip, snow_overlay_strip(overlay));
    const double length =
        snow_round_below((strip - 2 * edge) * camera.pitch) / camera.pitch;
    double left = floor(overlay->width - (strip + length) / 2) + 0.5;
    overlay->strip = fmax(overlay->strip, strip);
    double right = left + length, tick = 0.35 * height;
    double y = floor(overlay->height - 1.2 * height) + 0.5;
    const bool from_above = fabs(camera.back[2]) > 1 - 1e-9;
    if (from_above || !write_height(&volume, text, sizeof text)) {
        const char *unit = volume.unit;
        const double world = length * camera.pitch;
        const double factor = snow_length_factor(world, 1, 1000, &unit);
        snow_text_print(text, sizeof text, "%.4g%s%s", world * factor,
                        *unit ? " " : "", unit);
        SNOW_TRY(snow_begin_strokes(overlay, height));
        SNOW_TRY(snow_overlay_stroke(overlay, left, y, right, y));
        SNOW_TRY(snow_overlay_stroke(overlay, left, y - tick, left, y + tick));
        SNOW_TRY(
            snow_overlay_stroke(overlay, right, y - tick, right, y + tick));
    }
    /* Above the middle, but within the picture. */
    const double half = height * snow_font_width(text) / 2;
    return snow_overlay_text(
        overlay, fmin((left + right) / 2, overlay->width - edge - half),
        y - 0.8 * height, 0.5, 1, height, text);
}

double snow_overlay_strip(const snow_overlay *overlay) {
    /* "500 mm" has room in any case. */
    const double scale = 5.4 * snow_number_height(overlay);
    const double share = fmax(overlay->strip, scale) / overlay->width;
    if (snow_shorter_side(overlay) < SNOW_BAR_SIDE_LEAST)
        return 0;
    return fmin(fmax(share, SNOW_STRIP_LEAST), SNOW_STRIP_MOST);
}
