/* annotate/measure.c - lines, angles and ellipses that are measured, in a
 * picture of their volume, with their numbers (render/measure.c finds them). */
#include "annotate/length.h"
#include "annotate/strokes.h"
#include "base/vec3.h"
#include "transform/transform.h"

#include <snowglass/extend.h>
#include <snowglass/overlay.h>

#include <stdio.h>
#include <string.h>

/* Strokes of an ellipse. */
#define PIECES 96

/* Lines of a label, and bytes of each. */
#define LINES_MOST 4
#define LINE_BYTES 80

/* A measure before the camera. */
typedef struct measure_view {
    snow_overlay *overlay;
    const snow_volume_info *info;
    snow_camera camera;
    double bounds[4]; /* of its picture in the overlay: x0 y0 x1 y1 */
    const snow_measure *measure;
    double height; /* of letters */
    char lines[LINES_MOST][LINE_BYTES];
    int count;
} measure_view;

/* A place of the world, in pixels; false: it is behind the camera. */
static bool project(const measure_view *m, const double place[3],
                    double pixel[2]) {
    double world[3], point[3];
    for (int i = 0; i < 3; i++) {
        const double length = m->info->axis_scale[i];
        world[i] = place[i] * (fabs(length) > 0 ? length : 1);
    }
    snow_camera_point(&m->camera, m->info, world, point);
    if (m->camera.distance > 0 && point[2] > 0.999 * m->camera.distance)
        return false;
    snow_camera_pixel(&m->camera, point, pixel);
    for (int i = 0; i < 2; i++)
        pixel[i] += m->bounds[i];
    return true;
}

/* --- the shape ------------------------------------------------------------ */

static snow_status stroke(const measure_view *m, const double a[3],
                          const double b[3]) {
    double from[2], to[2];
    if (!project(m, a, from) || !project(m, b, to))
        return SNOW_STATUS_OK;
    return snow_overlay_stroke(m->overlay, from[0], from[1], to[0], to[1]);
}

/* A short stroke across the end of a line. */
static snow_status draw_end(const measure_view *m, const double end[3],
                            const double other[3]) {
    double at[2], to[2];
    if (!project(m, end, at) || !project(m, other, to))
        return SNOW_STATUS_OK;
    const double dx = to[0] - at[0], dy = to[1] - at[1];
    const double length = hypot(dx, dy), tick = 0.4 * m->height;
    const double x = length > 0 ? -dy / length * tick : tick;
    const double y = length > 0 ? dx / length * tick : 0;
    return snow_overlay_stroke(m->overlay, at[0] - x, at[1] - y, at[0] + x,
                               at[1] + y);
}

static snow_status draw_ellipse(const measure_view *m) {
    const double(*points)[3] = m->measure->points;
    double before[3];
    for (int n = 0; n <= PIECES; n++) {
        const double turn = 2 * acos(-1) * n / PIECES;
        double at[3];
        for (int i = 0; i < 3; i++)
            at[i] = points[0][i] + cos(turn) * (points[1][i] - points[0][i]) +
                    sin(turn) * (points[2][i] - points[0][i]);
        if (n)
            SNOW_TRY(stroke(m, before, at));
        memcpy(before, at, sizeof before);
    }
    return SNOW_STATUS_OK;
}

static snow_status draw_shape(const measure_view *m) {
    const double(*points)[3] = m->measure->points;
    const int last = m->measure->kind == SNOW_MEASURE_LINE ? 1 : 2;
    SNOW_TRY(snow_begin_strokes(m->overlay, m->height));
    if (m->measure->kind == SNOW_MEASURE_ELLIPSE)
        return draw_ellipse(m);
    for (int n = 0; n < last; n++)
        SNOW_TRY(stroke(m, points[n], points[n + 1]));
    SNOW_TRY(draw_end(m, points[0], points[1]));
    return draw_end(m, points[last], points[last - 1]);
}

/* --- the label ------------------------------------------------------------ */

static void add_line(measure_view *m, const char *text) {
    snprintf(m->lines[m->count++], LINE_BYTES, "%s", text);
}

/* "52.3 mm", "43.2 degrees"; of an ellipse, what its voxels have. */
static void write_lines(measure_view *m, const char *value_unit) {
    const snow_measure *measure = m->measure;
    const char *space = *measure->unit ? " " : "", *unit = measure->unit;
    char text[LINE_BYTES];
    if (measure->kind == SNOW_MEASURE_LINE) {
        const double factor = snow_length_factor(
            measure->result, SNOW_LENGTH_LEAST, SNOW_LENGTH_BELOW, &unit);
        snow_text_print(text, sizeof text, "%.4g%s%s", measure->result * factor,
                        space, unit);
    } else if (measure->kind == SNOW_MEASURE_ANGLE)
        snow_text_print(text, sizeof text, "%.4g\xc2\xb0", measure->result);
    else
        snow_text_print(text, sizeof text, "%.4g%s%s%s, n %lld",
                        measure->result, space, unit, *unit ? "\xc2\xb2" : "",
                        (long long)measure->count);
    if (measure->kind == SNOW_MEASURE_ELLIPSE && measure->count > 0) {
        char values[LINE_BYTES];
        const char *sign = measure->count > 1 ? " \xc2\xb1 " : "";
        char deviation[24] = "";
        if (measure->count > 1)
            snow_text_print(deviation, sizeof deviation, "%.4g",
                            measure->deviation);
        snow_text_print(values, sizeof values, "%.4g%s%s%s%.20s", measure->mean,
                        sign, deviation, *value_unit ? " " : "", value_unit);
        add_line(m, values);
        snow_text_print(values, sizeof values, "%.4g to %.4g", measure->min,
                        measure->max);
        add_line(m, values);
    }
    add_line(m, text);
}

/* How many spots are tried. */
#define SPOTS 8

/* Where a label may stand: beside a point, in a direction. */
typedef struct label_spot {
    double x, y, dx, dy;
} label_spot;

static label_spot spot_of(double x, double y, double dx, double dy) {
    const double length = hypot(dx, dy);
    if (!(length > 0))
        return (label_spot){x, y, 1, 0};
    return (label_spot){x, y, dx / length, dy / length};
}

/* Of a line beside its middle, of an angle beyond its corner, of an ellipse on
 * any side of it. */
static void find_spots(const measure_view *m, const double box[4],
                       label_spot spots[SPOTS]) {
    const double x = (box[0] + box[2]) / 2, y = (box[1] + box[3]) / 2;
    double p[3][2];
    spots[0] = (label_spot){box[2], y, 1, 0};
    spots[1] = (label_spot){box[0], y, -1, 0};
    spots[2] = (label_spot){x, box[3], 0, 1};
    spots[3] = (label_spot){x, box[1], 0, -1};
    for (int n = 0; n < 4; n++) {
        const double dx = n & 1 ? -1 : 1, dy = n & 2 ? -1 : 1;
        spots[4 + n] =
            spot_of(dx > 0 ? box[2] : box[0], dy > 0 ? box[3] : box[1], dx, dy);
    }
    if (m->measure->kind == SNOW_MEASURE_ELLIPSE)
        return;
    const bool line = m->measure->kind == SNOW_MEASURE_LINE;
    for (int n = 0; n < (line ? 2 : 3); n++)
        if (!project(m, m->measure->points[n], p[n]))
            return;
    if (line) {
        const double dx = p[1][0] - p[0][0], dy = p[1][1] - p[0][1];
        const double sign = dy < 0 ? -1 : 1; /* first to the right */
        spots[0] = spot_of((p[0][0] + p[1][0]) / 2, (p[0][1] + p[1][1]) / 2,
                           sign * dy, -sign * dx);
        spots[1] =
            (label_spot){spots[0].x, spots[0].y, -spots[0].dx, -spots[0].dy};
        return;
    }
    double dx = 0, dy = 0;
    for (int n = 0; n < 3; n += 2) {
        const label_spot side =
            spot_of(0, 0, p[n][0] - p[1][0], p[n][1] - p[1][1]);
        dx -= side.dx;
        dy -= side.dy;
    }
    spots[0] = spot_of(p[1][0], p[1][1], dx, dy);
}

/* Whether a stroke passes through a rectangle x0 y0 x1 y1. */
static bool passes(const float *stroke, const double box[4]) {
    double from = 0, to = 1;
    for (int i = 0; i < 2; i++) {
        const double way = (double)stroke[2 + i] - (double)stroke[i];
        double a = box[i] - (double)stroke[i],
               b = box[2 + i] - (double)stroke[i];
        if (!(fabs(way) > 0)) {
            if (a > 0 || b < 0)
                return false;
            continue;
        }
        from = fmax(from, fmin(a / way, b / way));
        to = fmin(to, fmax(a / way, b / way));
    }
    return from <= to;
}

/* Whether nothing was drawn in a rectangle. */
static bool is_free(const snow_overlay *overlay, const double box[4]) {
    for (size_t n = 0; n < overlay->shape_count; n++) {
        const snow_shape *shape = &overlay->shapes[n];
        if (shape->box[0] > box[2] || box[0] > shape->box[2] ||
            shape->box[1] > box[3] || box[1] > shape->box[3])
            continue;
        if (shape->filled)
            return false;
        for (size_t i = 0; i < shape->count; i++)
            if (passes(&overlay->numbers[shape->first + 4 * i], box))
                return false;
    }
    return true;
}

/* In the first spot where it covers nothing, else in the first one.  All of it
 * is in the picture where the shape is. */
static snow_status draw_label(const measure_view *m, size_t shape) {
    snow_overlay *overlay = m->overlay;
    const double *box = overlay->shapes[shape].box;
    const double tall = (1.6 * (m->count - 1) + 1) * m->height;
    const double gap = 0.8 * m->height, clear = 0.4 * m->height;
    const double *edge = m->bounds;
    label_spot spots[SPOTS];
    double wide = 0, left = 0, top = 0;
    for (int n = 0; n < m->count; n++)
        wide = fmax(wide, m->height * snow_font_width(m->lines[n]));
    if (box[2] < edge[0] || box[3] < edge[1] || box[0] > edge[2] ||
        box[1] > edge[3])
        return SNOW_STATUS_OK;
    find_spots(m, box, spots);
    for (int n = 0; n <= SPOTS; n++) {
        const label_spot *spot = &spots[n % SPOTS];
        const double away =
            gap + (fabs(spot->dx) * wide + fabs(spot->dy) * tall) / 2;
        left = spot->x + away * spot->dx - wide / 2;
        top = spot->y + away * spot->dy - tall / 2;
        left = fmax(fmin(left, edge[2] - gap - wide), edge[0] + gap);
        top = fmax(fmin(top, edge[3] - gap - tall), edge[1] + gap);
        const double taken[4] = {left - clear, top - clear, left + wide + clear,
                                 top + tall + clear};
        if (is_free(overlay, taken))
            break;
    }
    for (int n = 0; n < m->count; n++)
        SNOW_TRY(snow_overlay_text(overlay, left, top + 1.6 * n * m->height, 0,
                                   0, m->height, m->lines[n]));
    return SNOW_STATUS_OK;
}

snow_status snow_overlay_measure(snow_overlay *overlay,
                                 const snow_volume_info *info,
                                 const snow_view *view, double x, double y,
                                 const char *value_unit,
                                 const snow_measure *measure) {
    snow_context *context = overlay->context;
    snow_volume_info volume;
    snow_view from;
    snow_measure one;
    measure_view m = {.overlay = overlay,
                      .info = &volume,
                      .bounds = {x, y},
                      .measure = &one,
                      .height = snow_number_height(overlay)};
    const size_t shape = overlay->shape_count;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, info, &volume));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &from));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_measure, measure, &one));
    m.bounds[2] = x + from.width;
    m.bounds[3] = y + from.height;
    SNOW_TRY(snow_camera_make(context, &volume, &from, &m.camera));
    if (one.kind == SNOW_MEASURE_NONE ||
        snow_shorter_side(overlay) < SNOW_BAR_SIDE_LEAST)
        return SNOW_STATUS_OK;
    SNOW_TRY(draw_shape(&m));
    write_lines(&m, value_unit ? value_unit : "");
    return draw_label(&m, shape);
}
