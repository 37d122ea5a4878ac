/* annotate/box.c - the edges of a volume's box in a picture, with ticks.
 *
 * A face is seen whose outer side is towards the viewer.  An edge of a face
 * that is seen lies before everything; one of two others lies behind, and is
 * drawn only where the picture is clear.  An axis has its ticks along an edge
 * of the outline: one face of it is seen, and one is not. */
#include "annotate/length.h"
#include "annotate/strokes.h"
#include "base/vec3.h"
#include "image/image.h"
#include "transfer/scale.h"
#include "transform/transform.h"

#include <snowglass/extend.h>
#include <snowglass/overlay.h>

#include <stdio.h>
#include <string.h>

/* Alpha from which on a picture hides what is behind it. */
#define HIDES 0.02F

/* Pixels of the pieces of an edge that may be hidden. */
#define PIECE 2.0

/* Heights of numbers that the ticks of an axis are apart, at least; of one that
 * is nearly upright, whose numbers stand above one another. */
#define APART 4.0
#define APART_UPRIGHT 2.0

#define TEXTS_MOST 64

/* The box before the camera. */
typedef struct box_view {
    snow_overlay *overlay;
    const snow_volume_info *info;
    snow_camera camera;
    double sides[3][3];          /* from end to end, along right, up and back */
    bool seen[3][2];             /* the lower and the upper face of each axis */
    double height;               /* of numbers */
    size_t others;               /* shapes that were there before */
    double texts[TEXTS_MOST][4]; /* names and numbers: their places */
    int text_count;
} box_view;

/* A point of the box, -0.5 to 0.5 along each axis, relative to the target. */
static void point_of(const box_view *b, const double at[3], double point[3]) {
    for (int i = 0; i < 3; i++) {
        point[i] = b->camera.middle[i];
        for (int axis = 0; axis < 3; axis++)
            point[i] += at[axis] * b->sides[axis][i];
    }
}

static void project(const box_view *b, const double at[3], double pixel[2]) {
    double p[3];
    point_of(b, at, p);
    snow_camera_pixel(&b->camera, p, pixel);
}

static void find_faces(box_view *b) {
    for (int axis = 0; axis < 3; axis++)
        for (int end = 0; end < 2; end++) {
            double at[3] = {0}, p[3], normal[3], to[3] = {0, 0, 1};
            at[axis] = end - 0.5;
            point_of(b, at, p);
            snow_cross(b->sides[(axis + 1) % 3], b->sides[(axis + 2) % 3],
                       normal);
            double out = snow_dot(normal, b->sides[axis]) * (end ? 1 : -1);
            for (int i = 0; i < 3 && b->camera.distance > 0; i++)
                to[i] = (i == 2 ? b->camera.distance : 0) - p[i];
            double towards = snow_dot(normal, to) * (out > 0 ? 1 : -1);
            b->seen[axis][end] =
                towards > 1e-9 * snow_length(normal) * snow_length(to);
        }
}

/* The ends of edge n, 0 to 3, along an axis; how many of its faces are seen. */
static int edge_of(const box_view *b, int axis, int n, double ends[2][3]) {
    int other[2] = {(axis + 1) % 3, (axis + 2) % 3};
    int side[2] = {n & 1, n >> 1};
    for (int end = 0; end < 2; end++) {
        ends[end][axis] = end - 0.5;
        for (int i = 0; i < 2; i++)
            ends[end][other[i]] = side[i] - 0.5;
    }
    return b->seen[other[0]][side[0]] + b->seen[other[1]][side[1]];
}

/* --- edges ---------------------------------------------------------------- */

static bool is_clear(const box_view *b, const double pixel[2]) {
    const snow_image *below = b->overlay->below;
    double x = floor(pixel[0]), y = floor(pixel[1]);
    int channels = below ? below->channels : 0;
    if (channels < 2 || !(x >= 0 && x < below->width) ||
        !(y >= 0 && y < below->height))
        return true;
    size_t at = (size_t)y * (size_t)below->width + (size_t)x;
    return below->pixels[(at + 1) * (size_t)channels - 1] < HIDES;
}

static snow_status draw_edge(const box_view *b, const double a[2],
                             const double c[2], bool behind) {
    double length = hypot(c[0] - a[0], c[1] - a[1]);
    int pieces = behind ? (int)fmin(ceil(length / PIECE), 65536) : 1;
    for (int n = 0; n < pieces; n++) {
        double from[2], to[2], middle[2];
        for (int i = 0; i < 2; i++) {
            from[i] = a[i] + (c[i] - a[i]) * n / pieces;
            to[i] = a[i] + (c[i] - a[i]) * (n + 1) / pieces;
            middle[i] = 0.5 * (from[i] + to[i]);
        }
        if (!behind || is_clear(b, middle))
            SNOW_TRY(snow_overlay_stroke(b->overlay, from[0], from[1], to[0],
                                         to[1]));
    }
    return SNOW_STATUS_OK;
}

static snow_status draw_edges(const box_view *b) {
    SNOW_TRY(snow_begin_strokes(b->overlay, 0.6 * b->height));
    for (int axis = 0; axis < 3; axis++)
        for (int n = 0; n < 4; n++) {
            double ends[2][3], pixels[2][2];
            int seen = edge_of(b, axis, n, ends);
            if (b->info->dims[axis] == 1)
                continue;
            project(b, ends[0], pixels[0]);
            project(b, ends[1], pixels[1]);
            SNOW_TRY(draw_edge(b, pixels[0], pixels[1], seen == 0));
        }
    return SNOW_STATUS_OK;
}

/* --- axes ----------------------------------------------------------------- */

/* An axis: where it is in the picture, and what its ends are called. */
typedef struct box_axis {
    double ends[2][3], pixels[2][2];
    double out[2];  /* unit vector, away from the box */
    double from[2]; /* coordinates of the ends */
    char name[24];  /* "x (mm)" */
} box_axis;

/* Samples sit at integers.  Of an oblique axis lengths are counted from its
 * first one. */
static void name_axis(const box_view *b, int axis, box_axis *out) {
    const snow_volume_info *info = b->info;
    /* The world's axis along a grid's one, or -1 where it is oblique. */
    int found = -1;
    for (int i = 0; i < 3; i++)
        if (fabs(info->matrix[i][axis]) > 1e-6 * info->spacing[axis])
            found = found < 0 ? i : 3;
    int world = found < 3 ? found : -1;
    double first = world < 0 ? 0 : info->matrix[world][3];
    double step = world < 0 ? info->spacing[axis] : info->matrix[world][axis];
    const char *unit = world < 0 || !*info->axis_unit[world]
                           ? info->unit
                           : info->axis_unit[world];
    if (world >= 0 && fabs(info->axis_scale[world]) > 0) {
        first /= info->axis_scale[world];
        step /= info->axis_scale[world];
    }
    if (!strcmp(unit, "1"))
        unit = "";
    for (int end = 0; end < 2; end++)
        out->from[end] =
            first + step * (end ? (double)info->dims[axis] - 0.5 : -0.5);
    const double factor =
        snow_length_factor(fmax(fabs(out->from[0]), fabs(out->from[1])),
                           SNOW_LENGTH_LEAST, SNOW_LENGTH_BELOW, &unit);
    for (int end = 0; end < 2; end++)
        out->from[end] *= factor;
    snprintf(out->name, sizeof out->name, "%c%s%s%s",
             world < 0 ? "ijk"[axis] : "xyz"[world], *unit ? " (" : "", unit,
             *unit ? ")" : "");
}

/* The edge of the outline that is farthest down and to the left. */
static bool find_axis(const box_view *b, int axis, box_axis *out) {
    double middle[3], best = -INFINITY;
    project(b, (double[3]){0, 0, 0}, middle);
    for (int n = 0; n < 4; n++) {
        box_axis edge;
        if (edge_of(b, axis, n, edge.ends) != 1)
            continue;
        project(b, edge.ends[0], edge.pixels[0]);
        project(b, edge.ends[1], edge.pixels[1]);
        double along[2] = {edge.pixels[1][0] - edge.pixels[0][0],
                           edge.pixels[1][1] - edge.pixels[0][1]};
        double length = hypot(along[0], along[1]);
        if (length < APART * b->height)
            continue;
        double normal[2] = {-along[1] / length, along[0] / length};
        double off = (edge.pixels[0][0] - middle[0]) * normal[0] +
                     (edge.pixels[0][1] - middle[1]) * normal[1];
        for (int i = 0; i < 2; i++)
            edge.out[i] = off < 0 ? -normal[i] : normal[i];
        double rank = edge.out[1] - 0.7 * edge.out[0];
        if (rank <= best)
            continue;
        best = rank;
        *out = edge;
    }
    return best > -INFINITY;
}

/* How far to move what reaches from `low` to `high` so that it begins in the
 * picture, and ends there if it is not longer. */
static double move_inside(double low, double high, double size) {
    double by = fmax(-low, fmin(size - high, 0));
    return by < 0 ? floor(by) : ceil(by);
}

/* Whether a text would touch an earlier one; else it takes the place. */
static bool is_taken(box_view *b, const double given[4]) {
    const double gap = 0.25 * b->height;
    const double box[4] = {given[0] - gap, given[1] - gap, given[2] + gap,
                           given[3] + gap};
    for (int n = 0; n < b->text_count; n++) {
        const double *other = b->texts[n];
        if (box[0] < other[2] && other[0] < box[2] && box[1] < other[3] &&
            other[1] < box[3])
            return true;
    }
    if (b->text_count < TEXTS_MOST)
        memcpy(b->texts[b->text_count++], given, sizeof b->texts[0]);
    return false;
}

/* Writes a text about a point, `x` and `y` pixels from it; in the picture, if
 * the point is. */
static snow_status write_beside(box_view *b, const double point[2], double x,
                                double y, const double share[2],
                                const char *text) {
    snow_overlay *overlay = b->overlay;
    x += point[0];
    y += point[1];
    SNOW_TRY(
        snow_overlay_text(overlay, x, y, share[0], share[1], b->height, text));
    const double *box = overlay->shapes[overlay->shape_count - 1].box;
    const double width = overlay->width, height = overlay->height;
    const double by[2] = {move_inside(box[0], box[2], width),
                          move_inside(box[1], box[3], height)};
    if ((by[0] != 0 || by[1] != 0) && point[0] >= 0 && point[0] <= width &&
        point[1] >= 0 && point[1] <= height) {
        overlay->shape_count--;
        SNOW_TRY(snow_overlay_text(overlay, x + by[0], y + by[1], share[0],
                                   share[1], b->height, text));
    }
    /* It does not lie upon others than the box, nor on one of another axis. */
    if (snow_overlay_meets(overlay, overlay->shape_count - 1, b->others) ||
        is_taken(b, overlay->shapes[overlay->shape_count - 1].box))
        overlay->shape_count--;
    return SNOW_STATUS_OK;
}

static snow_status draw_number(box_view *b, const double at[2],
                               const double out[2], double away,
                               const char *text) {
    const double share[2] = {0.5 - 0.5 * out[0], 0.5 - 0.5 * out[1]};
    return write_beside(b, at, away * b->height * out[0],
                        away * b->height * out[1], share, text);
}

static void place_on(const box_view *b, const box_axis *axis, double share,
                     double pixel[2]) {
    double at[3];
    for (int i = 0; i < 3; i++)
        at[i] =
            axis->ends[0][i] + share * (axis->ends[1][i] - axis->ends[0][i]);
    project(b, at, pixel);
}

/* Beyond the numbers, or, beside which there may be no room, above their end.
 */
static snow_status draw_name(box_view *b, const box_axis *axis) {
    double at[2];
    place_on(b, axis, 0.5, at);
    if (fabs(axis->out[0]) < 0.8)
        return draw_number(b, at, axis->out, 3.2, axis->name);
    const double *end = axis->pixels[axis->pixels[0][1] > axis->pixels[1][1]];
    const double share[2] = {axis->out[0] < 0, 1};
    return write_beside(b, end, 0.9 * b->height * axis->out[0],
                        -1.2 * b->height, share, axis->name);
}

static snow_status draw_axis(box_view *b, const box_axis *axis) {
    double from = axis->from[0], length = axis->from[1] - from;
    double pixels = hypot(axis->pixels[1][0] - axis->pixels[0][0],
                          axis->pixels[1][1] - axis->pixels[0][1]);
    const double apart = fabs(axis->out[0]) < 0.8 ? APART : APART_UPRIGHT;
    double step = fabs(length) * apart * b->height / pixels, at[2];
    step = snow_round_below(2.4999 * step);
    double low = fmin(from, from + length), high = fmax(from, from + length);
    SNOW_TRY(snow_begin_strokes(b->overlay, b->height));
    for (double n = ceil(low / step - 1e-6); n <= high / step + 1e-6; n++) {
        place_on(b, axis, (n * step - from) / length, at);
        SNOW_TRY(snow_overlay_stroke(b->overlay, at[0], at[1],
                                     at[0] + 0.5 * b->height * axis->out[0],
                                     at[1] + 0.5 * b->height * axis->out[1]));
    }
    for (double n = ceil(low / step - 1e-6); n <= high / step + 1e-6; n++) {
        char text[40];
        snow_text_print(text, sizeof text, "%.6g", n == 0 ? 0 : n * step);
        place_on(b, axis, (n * step - from) / length, at);
        SNOW_TRY(draw_number(b, at, axis->out, 0.9, text));
    }
    return SNOW_STATUS_OK;
}

snow_status snow_overlay_box(snow_overlay *overlay,
                             const snow_volume_info *info,
                             const snow_view *view, bool axes) {
    snow_context *context = overlay->context;
    snow_volume_info volume;
    snow_view from;
    box_view b = {
        .overlay = overlay, .info = &volume, .others = overlay->shape_count};
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, info, &volume));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &from));
    SNOW_TRY(snow_camera_make(context, &volume, &from, &b.camera));
    if (snow_shorter_side(overlay) < SNOW_BAR_SIDE_LEAST)
        return SNOW_STATUS_OK;
    const double *frame[3] = {b.camera.right, b.camera.up, b.camera.back};
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < 3; i++) {
            const double column[3] = {volume.matrix[0][axis],
                                      volume.matrix[1][axis],
                                      volume.matrix[2][axis]};
            b.sides[axis][i] =
                snow_dot(column, frame[i]) * (double)volume.dims[axis];
        }
    b.height = snow_number_height(overlay);
    find_faces(&b);
    SNOW_TRY(draw_edges(&b));
    box_axis edges[3];
    int count = 0;
    for (int axis = 0; axis < 3 && axes; axis++)
        if (volume.dims[axis] > 1 && find_axis(&b, axis, &edges[count]))
            name_axis(&b, axis, &edges[count++]);
    /* Names first, which no number is to take the place of. */
    for (int n = 0; n < count; n++)
        SNOW_TRY(draw_name(&b, &edges[n]));
    for (int n = 0; n < count; n++)
        SNOW_TRY(draw_axis(&b, &edges[n]));
    return SNOW_STATUS_OK;
}
