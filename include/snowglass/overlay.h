/* snowglass/overlay.h - shapes that are drawn over a picture as it is written
 * to a file of levels; they never touch the picture's floats. */
#ifndef SNOWGLASS_OVERLAY_H
#define SNOWGLASS_OVERLAY_H

#include <snowglass/image.h>
#include <snowglass/transfer.h>
#include <snowglass/view.h>

/* An empty one for pictures of a size. Free with snow_overlay_free. */
SNOW_API snow_status snow_overlay_new(
    snow_context *context, int width, int height, snow_overlay **out);
SNOW_API void snow_overlay_free(snow_overlay *overlay);

/* Letters and bars keep off those before them, always, and where there is room
 * off alpha above 1/2 of this picture (NULL: none), which must live as long. */
SNOW_API void snow_overlay_keep_off(snow_overlay *, const snow_image *);

/* Pixels of a capital letter that suits pictures of its size. */
SNOW_API double snow_overlay_text_height(const snow_overlay *overlay);
/* A line of UTF-8 (Latin-1), capitals `height` pixels high. (x, y) is the
 * place of (share_x, share_y) in its box, whose upper left corner is (0, 0). */
SNOW_API snow_status snow_overlay_text(snow_overlay *overlay, double x,
    double y, double share_x, double share_y, double height, const char *text);
/* The patient's side (R L A P S I) nearest to the left, right, top and bottom
 * edge; two letters where it is over 25 degrees off; "" unless info->medical.
 * Draws them, on pictures with sides of at least 64 pixels. */
SNOW_API snow_status snow_view_orientation(snow_context *context,
    const snow_volume_info *info, const snow_view *view, char letters[4][4]);
SNOW_API snow_status snow_overlay_orientation(
    snow_overlay *overlay, const snow_volume_info *info, const snow_view *view);

/* Lower right, sides of at least 128 pixels: the colours with ticks, and
 * opacity as a line. `unit` may be NULL. `range`, of pictures without opacity:
 * values of the first and the last colour; else NULL. */
SNOW_API snow_status snow_overlay_color_bar(snow_overlay *overlay,
    const snow_transfer *transfer, const char *unit, const double range[2]);
/* Lower left, sides of at least 128 pixels, not in perspective: a length. */
SNOW_API snow_status snow_overlay_scale_bar(
    snow_overlay *overlay, const snow_volume_info *info, const snow_view *view);
/* Edges of the volume's box, those behind it only where the picture that is
 * kept off is clear; `axes`: with ticks. Sides of at least 128 pixels. */
SNOW_API snow_status snow_overlay_box(snow_overlay *overlay,
    const snow_volume_info *info, const snow_view *view, bool axes);
/* A volume's time: "12 h", the date of a unit "hours since 1990-01-01", or by a
 * format of printf (one %g, %f or %e) or strftime; false: it cannot. */
SNOW_API bool snow_time_text(
    const snow_volume_info *info, const char *format, char *out, size_t room);
/* Lines of text, upper left; sides of at least 64 pixels. */
SNOW_API snow_status snow_overlay_title(snow_overlay *, const char *text);

#endif
