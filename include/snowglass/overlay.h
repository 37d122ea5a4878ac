/* snowglass/overlay.h - shapes that are drawn over a picture.
 *
 * They are drawn as a picture is written to a file of levels, or turned into
 * bytes (snow_image_options.overlay), and never touch the picture's floats.
 * Pictures that are too small for a shape get none of it, which is no error. */
#ifndef SNOWGLASS_OVERLAY_H
#define SNOWGLASS_OVERLAY_H

#include <snowglass/image.h>
#include <snowglass/transfer.h>
#include <snowglass/view.h>

/* Makes an empty overlay for pictures of a size. */
SNOW_API snow_status snow_overlay_new(
    snow_context *context, int width, int height, snow_overlay **out);
SNOW_API void snow_overlay_free(snow_overlay *overlay);

/* Sets the picture below, which hides edges of the box (snow_overlay_box). It
 * must live as long as the overlay. */
SNOW_API void snow_overlay_set_picture(
    snow_overlay *overlay, const snow_image *picture);

/* Returns the pixels of a capital letter that suits pictures of the size. */
SNOW_API double snow_overlay_text_height(const snow_overlay *overlay);

/* Adds a line of UTF-8 (letters of Latin-1 and Greek; a box for others, with a
 * warning), whose capitals are `height` pixels high. (x, y) is the pixel where
 * the point (share_x, share_y) of its box lies: 0, 0 is the upper left corner,
 * 1, 1 the lower right one. Errors: BAD_USAGE (a number that is not finite, a
 * height of 0 or below). */
SNOW_API snow_status snow_overlay_text(snow_overlay *overlay, double x,
    double y, double share_x, double share_y, double height, const char *text);

/* Gives the side of the patient (R L A P S I) that is nearest to the left,
 * right, top and bottom edge of a picture: two letters where it is over 25
 * degrees off, "" unless info->medical. */
SNOW_API snow_status snow_view_orientation(snow_context *context,
    const snow_volume_info *info, const snow_view *view, char letters[4][4]);

/* Adds these letters, on sides of at least 64 pixels. */
SNOW_API snow_status snow_overlay_orientation(
    snow_overlay *overlay, const snow_volume_info *info, const snow_view *view);

/* Adds a bar of colours with ticks, and its opacity as a line, at the right, on
 * sides of at least 128 pixels. `unit` may be NULL. `range` is NULL, or for
 * pictures without opacity the values of the first and the last colour. Bar n
 * of `count` counts from 0, the lowest one. Errors: BAD_USAGE (no such bar). */
SNOW_API snow_status snow_overlay_color_bar(snow_overlay *overlay,
    const snow_transfer *transfer, const char *unit, const double range[2],
    int n, int count);

/* Returns the `strip` of a view whose picture leaves room for the bars that the
 * overlay has so far. */
SNOW_API double snow_overlay_strip(const snow_overlay *overlay);

/* Adds a length with its unit, lower right, on sides of at least 128 pixels;
 * not in perspective. */
SNOW_API snow_status snow_overlay_scale_bar(
    snow_overlay *overlay, const snow_volume_info *info, const snow_view *view);

/* Adds the edges of the volume's box, those behind it only where the picture
 * below is clear; `axes`: with ticks and numbers. Sides of at least 128 pixels.
 */
SNOW_API snow_status snow_overlay_box(snow_overlay *overlay,
    const snow_volume_info *info, const snow_view *view, bool axes);

/* Writes the time of a volume to `out`, of `room` bytes: "12 h", or the date of
 * a unit such as "hours since 1990-01-01"; or by a format of printf (one %g, %f
 * or %e) or strftime. Returns false where it cannot; then the text is
 * undefined. */
SNOW_API bool snow_time_text(
    const snow_volume_info *info, const char *format, char *out, size_t room);

/* Puts into `value` the time that a date such as "2000-01-31 12:00:00" means in
 * the volume's time unit and calendar. Hours, minutes and seconds may be left
 * out. Returns false, and leaves `value` as it was, where the unit counts from
 * no date, or where the calendar has no such day. */
SNOW_API bool snow_time_value(
    const snow_volume_info *info, const char *date, double *value);

/* Adds lines of text, upper left, on sides of at least 64 pixels. */
SNOW_API snow_status snow_overlay_title(
    snow_overlay *overlay, const char *text);

/* What is measured: the length of a line, the angle at the second of three
 * points, the area of an ellipse on a slice. */
typedef enum snow_measure_kind {
    SNOW_MEASURE_NONE,
    SNOW_MEASURE_LINE,
    SNOW_MEASURE_ANGLE,
    SNOW_MEASURE_ELLIPSE
} snow_measure_kind;

/* A measurement, in the units of the world's axes and free of their scale. The
 * points of an ellipse are its middle and where two half-axes end. */
typedef struct snow_measure {
    size_t size;
    snow_measure_kind kind;
    int axis, outside; /* of the grid; the first point out of the volume: 1.. */
    int64_t index, count; /* slice across that axis; voxels, -1: none of it */
    double points[3][3];
    double result;                    /* length; degrees; area */
    double mean, deviation, min, max; /* of data values; NaN: unknown */
    char unit[16];
} snow_measure;
SNOW_RECORD(snow_measure);
#define SNOW_MEASURES_MAX 64

/* Reads measurement `n` (from 0) of a text such as "line X,Y,Z X,Y,Z; angle P P
 * P; ellipse AXIS POS C A B" (docs/output.md); its kind is NONE past the last.
 * `info` NULL: only the words are checked. Errors: BAD_USAGE (other words). */
SNOW_API snow_status snow_measure_read(snow_context *context, const char *text,
    int n, const snow_volume_info *info, snow_measure *out);

/* Fills a measurement's values, in a volume or a crop of it. */
SNOW_API snow_status snow_measure_values(
    const snow_volume *volume, snow_measure *measure);

/* Adds a measurement, on a picture whose view begins at pixel (x, y). */
SNOW_API snow_status snow_overlay_measure(snow_overlay *overlay,
    const snow_volume_info *info, const snow_view *view, double x, double y,
    const char *value_unit, const snow_measure *measure);

#endif
