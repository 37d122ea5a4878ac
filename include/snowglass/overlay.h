/* snowglass/overlay.h - what is drawn over a picture as it is written: letters
 * of orientation, a colour bar, a scale bar, a line of text.
 *
 * An overlay is a list of shapes, so that it takes no memory to speak of, and
 * never touches the picture's floats: files of 8 and 16 bits a channel show it
 * (snow_image_options), files of floats and check sums do not.  Everything is
 * white with a dark border, which any background leaves readable. */
#ifndef SNOWGLASS_OVERLAY_H
#define SNOWGLASS_OVERLAY_H

#include <snowglass/image.h>
#include <snowglass/transfer.h>
#include <snowglass/view.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An empty one for pictures of a size.  Errors: SNOW_STATUS_BAD_USAGE,
 * SNOW_STATUS_NO_MEMORY. Free with snow_overlay_free, which accepts NULL. */
SNOW_API snow_status snow_overlay_new(snow_context *context, int width,
                                      int height, snow_overlay **out);
SNOW_API void snow_overlay_free(snow_overlay *overlay);

/* Height of a capital letter, in pixels, that suits pictures of its size. */
SNOW_API double snow_overlay_text_height(const snow_overlay *overlay);

/* Draws a line of text (ASCII; other bytes are boxes) whose capitals are
 * `height` pixels high.  (x, y) is the place in the picture at which the share
 * (share_x, share_y) of its box lies: (0, 0) its upper left corner, (1, 1) its
 * lower right one on the base line.  Errors: SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_overlay_text(snow_overlay *overlay, double x,
                                       double y, double share_x, double share_y,
                                       double height, const char *text);

/* Which patient's side each edge of the picture is nearest to: left, right,
 * top, bottom, of R L A P S I (right, left, anterior, posterior, superior,
 * inferior); two letters, the nearer one first, where the edge is more than 25
 * degrees away from either.  Of a volume whose world is a patient
 * (snow_volume_info.medical) only; else all are "".  Errors:
 * SNOW_STATUS_BAD_USAGE (the view). */
SNOW_API snow_status snow_view_orientation(snow_context *context,
                                           const snow_volume_info *info,
                                           const snow_view *view,
                                           char letters[4][4]);

/* Draws them, in the middle of the edges; nothing on pictures with a side below
 * 64 pixels.  Errors: as above, SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_overlay_orientation(snow_overlay *overlay,
                                              const snow_volume_info *info,
                                              const snow_view *view);

/* Draws, in the lower right corner, the colours along the values of a transfer
 * function with ticks at round values, and over them its opacity as a line: 0
 * is at the left border, its largest value at the right one.  `unit` of the
 * values may be NULL.  `range` of pictures without opacity: the values that the
 * first and the last colour stand for, and no line; else NULL.  Nothing on
 * pictures with a side below 128 pixels.
 * Errors: SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_overlay_color_bar(snow_overlay *overlay,
                                            const snow_transfer *transfer,
                                            const char *unit,
                                            const double range[2]);

/* Draws, in the lower left corner, a line of a round length.  In perspective,
 * where a length has no one size, and on pictures with a side below 128 pixels
 * nothing is drawn.  Errors: SNOW_STATUS_BAD_USAGE (the view),
 * SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_overlay_scale_bar(snow_overlay *overlay,
                                            const snow_volume_info *info,
                                            const snow_view *view);

/* Draws a line of text in the upper left corner, on pictures with a side of 64
 * pixels or more.  Errors: SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_overlay_title(snow_overlay *overlay,
                                        const char *text);

#ifdef __cplusplus
}
#endif
#endif
