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

/* The picture below, which hides edges of the box; it must live as long. */
SNOW_API void snow_overlay_set_picture(snow_overlay *, const snow_image *);
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

/* At the right, sides of at least 128 pixels: the colours with ticks, and
 * opacity as a line. `unit` may be NULL. `range`, of pictures without opacity:
 * values of the first and the last colour; else NULL. Bar 0 is the lowest. */
SNOW_API snow_status snow_overlay_color_bar(snow_overlay *overlay,
    const snow_transfer *transfer, const char *unit, const double range[2],
    int n, int count);
/* The `strip` of a view whose picture leaves room for the bars so far. */
SNOW_API double snow_overlay_strip(const snow_overlay *);
/* A length, lower right, sides of at least 128 pixels, not in perspective. */
SNOW_API snow_status snow_overlay_scale_bar(
    snow_overlay *overlay, const snow_volume_info *info, const snow_view *view);
/* Edges of the volume's box, those behind it only where the picture below is
 * clear; `axes`: with ticks. Sides of at least 128 pixels. */
SNOW_API snow_status snow_overlay_box(snow_overlay *overlay,
    const snow_volume_info *info, const snow_view *view, bool axes);
/* A volume's time: "12 h", the date of a unit "hours since 1990-01-01", or by a
 * format of printf (one %g, %f or %e) or strftime; false: it cannot. */
SNOW_API bool snow_time_text(
    const snow_volume_info *info, const char *format, char *out, size_t room);
/* Lines of text, upper left; sides of at least 64 pixels. */
SNOW_API snow_status snow_overlay_title(snow_overlay *, const char *text);
/* What is measured: along a line, at the second of three points, in an ellipse
 * on a slice; in units of the world's axes, free of their scale. An ellipse has
 * its middle and where two half-axes end. */
typedef enum snow_measure_kind {
    SNOW_MEASURE_NONE,
    SNOW_MEASURE_LINE,
    SNOW_MEASURE_ANGLE,
    SNOW_MEASURE_ELLIPSE
} snow_measure_kind;
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
/* Reads number `n`, from 0, of "line X,Y,Z X,Y,Z; angle P P P; ellipse AXIS POS
 * C A B" (docs/output.md); NONE past the last. `info` NULL: checks the words.
 * Finds the values, in a volume or a crop of it. Draws it, from (x, y) on. */
SNOW_API snow_status snow_measure_read(snow_context *, const char *text, int n,
    const snow_volume_info *info, snow_measure *out);
SNOW_API snow_status snow_measure_values(const snow_volume *, snow_measure *);
SNOW_API snow_status snow_overlay_measure(snow_overlay *overlay,
    const snow_volume_info *info, const snow_view *view, double x, double y,
    const char *value_unit, const snow_measure *measure);

#endif
