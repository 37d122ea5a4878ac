/* image/overlay.c - shapes that are drawn over a picture row by row when it is
 * written.
 *
 * A stroke covers the points within its radius of its line; over one pixel at
 * the border the coverage falls from 1 to 0.  Where strokes of one shape
 * overlap the nearest counts, so joints are invisible.  The border of a shape,
 * dark around white and white around dark, lies below all of its strokes.
 * Shapes are composited with Porter and Duff's over. */
#include "image/overlay.h"
#include "image/image.h"

#include <snowglass/overlay.h>

#include <math.h>
#include <string.h>

/* Pixels per step: their distances are on the stack. */
#define SOME 256

#define WHITE 1.0f
#define DARK 0.0f
#define BORDER_OPACITY 0.8f

snow_status snow_overlay_new(snow_context *context, int width, int height,
                             snow_overlay **out) {
    if (width < 1 || height < 1 || width > SNOW_IMAGE_SIDE ||
        height > SNOW_IMAGE_SIDE)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "an overlay of %d x %d pixels is not possible; use 1 "
                         "to %d per side",
                         width, height, SNOW_IMAGE_SIDE);
    snow_overlay *overlay = snow_allocate(context, sizeof *overlay);
    if (!overlay)
        return SNOW_STATUS_NO_MEMORY;
    *overlay = (snow_overlay){
        .context = context, .width = width, .height = height, .grey = true};
    *out = overlay;
    return SNOW_STATUS_OK;
}

void snow_overlay_free(snow_overlay *overlay) {
    if (!overlay)
        return;
    snow_context *context = overlay->context;
    snow_release(context, overlay->numbers);
    snow_release(context, overlay->shapes);
    snow_release(context, overlay);
}

static snow_status add_shape(snow_overlay *overlay, const snow_shape *shape) {
    SNOW_TRY(SNOW_RESERVE(overlay->context, overlay->shapes,
                          overlay->shape_count, overlay->shape_count + 1));
    overlay->shapes[overlay->shape_count++] = *shape;
    return SNOW_STATUS_OK;
}

static snow_status add_numbers(snow_overlay *overlay, const float *numbers,
                               size_t count) {
    SNOW_TRY(SNOW_RESERVE(overlay->context, overlay->numbers,
                          overlay->number_count,
                          overlay->number_count + count));
    memcpy(overlay->numbers + overlay->number_count, numbers,
           count * sizeof *numbers);
    overlay->number_count += count;
    return SNOW_STATUS_OK;
}

snow_status snow_overlay_begin(snow_overlay *overlay, double radius,
                               double halo) {
    const snow_shape shape = {
        .first = overlay->number_count,
        .radius = radius,
        .halo = halo,
        .box = {INFINITY, INFINITY, -INFINITY, -INFINITY}};
    return add_shape(overlay, &shape);
}

snow_status snow_overlay_stroke(snow_overlay *overlay, double x0, double y0,
                                double x1, double y1) {
    snow_shape *shape = &overlay->shapes[overlay->shape_count - 1];
    const float ends[4] = {(float)x0, (float)y0, (float)x1, (float)y1};
    double reach = shape->halo + 1;
    SNOW_TRY(add_numbers(overlay, ends, 4));
    shape->count++;
    shape->box[0] = fmin(shape->box[0], fmin(x0, x1) - reach);
    shape->box[1] = fmin(shape->box[1], fmin(y0, y1) - reach);
    shape->box[2] = fmax(shape->box[2], fmax(x0, x1) + reach);
    shape->box[3] = fmax(shape->box[3], fmax(y0, y1) + reach);
    return SNOW_STATUS_OK;
}

snow_status snow_overlay_rows(snow_overlay *overlay, int x0, int y0, int x1,
                              int y1, const float *colors) {
    const snow_shape shape = {.filled = true,
                              .first = overlay->number_count,
                              .count = (size_t)(y1 - y0),
                              .box = {x0, y0, x1, y1}};
    for (size_t i = 0; i < shape.count; i++)
        if (colors[3 * i] != colors[3 * i + 1] ||
            colors[3 * i] != colors[3 * i + 2])
            overlay->grey = false;
    SNOW_TRY(add_numbers(overlay, colors, 3 * shape.count));
    return add_shape(overlay, &shape);
}

/* --- places --------------------------------------------------------------- */

void snow_overlay_set_picture(snow_overlay *overlay, const snow_image *image) {
    overlay->below = image;
}

bool snow_overlay_meets(const snow_overlay *overlay, size_t first,
                        size_t before) {
    for (size_t n = first; n < overlay->shape_count; n++)
        for (size_t m = 0; m < before; m++) {
            const double *own = overlay->shapes[n].box;
            const double *other = overlay->shapes[m].box;
            if (own[0] < other[2] && other[0] < own[2] && own[1] < other[3] &&
                other[1] < own[3])
                return true;
        }
    return false;
}

/* --- drawing -------------------------------------------------------------- */

/* Composites a colour over a pixel. */
static void composite_pixel(float *pixel, int channels, const float *rgb,
                            float cover) {
    bool missing = false;
    for (int c = 0; c < channels; c++)
        missing |= isnan(pixel[c]) != 0;
    for (int c = 0; c < channels; c++) {
        float above = c == channels - 1 ? 1 : rgb[c];
        float below = missing ? 0 : pixel[c];
        pixel[c] = cover * above + (1 - cover) * below;
    }
}

/* Squared distance of a point from a stroke. */
static float square_to(const float *stroke, float x, float y) {
    float along[2] = {stroke[2] - stroke[0], stroke[3] - stroke[1]};
    float from[2] = {x - stroke[0], y - stroke[1]};
    float length = along[0] * along[0] + along[1] * along[1];
    float t = along[0] * from[0] + along[1] * from[1];
    t = length > 0 ? fminf(fmaxf(t / length, 0), 1) : 0;
    from[0] -= t * along[0];
    from[1] -= t * along[1];
    return from[0] * from[0] + from[1] * from[1];
}

/* The pixels of [x, x + count) whose centres lie between two positions. */
static void clip_range(double low, double high, int x, int count,
                       int range[2]) {
    range[0] = (int)fmin(fmax(ceil(low - 0.5 - x), 0), count);
    range[1] = (int)fmin(fmax(floor(high - 0.5 - x) + 1, range[0]), count);
}

/* The smallest squared distance for each of some pixels. */
static void measure(const snow_overlay *overlay, const snow_shape *shape, int y,
                    int x, int count, float *squares) {
    const float *stroke = overlay->numbers + shape->first;
    float middle = (float)y + 0.5f, reach = (float)shape->halo + 1;
    for (size_t n = 0; n < shape->count; n++, stroke += 4) {
        int range[2];
        if (fminf(stroke[1], stroke[3]) - reach > middle ||
            fmaxf(stroke[1], stroke[3]) + reach < middle)
            continue;
        clip_range((double)(fminf(stroke[0], stroke[2]) - reach),
                   (double)(fmaxf(stroke[0], stroke[2]) + reach), x, count,
                   range);
        for (int i = range[0]; i < range[1]; i++)
            squares[i] = fminf(
                squares[i], square_to(stroke, (float)(x + i) + 0.5f, middle));
    }
}

static float cover_of(double radius, float distance) {
    float cover = (float)radius + 0.5f - distance;
    return fminf(fmaxf(cover, 0), 1);
}

static void draw_strokes(const snow_overlay *overlay, const snow_shape *shape,
                         bool light, int y, int x, int count, int channels,
                         float *pixels) {
    static const float inks[2][3] = {{WHITE, WHITE, WHITE}, {DARK, DARK, DARK}};
    float squares[SOME], far = (float)shape->halo + 1;
    for (int i = 0; i < count; i++)
        squares[i] = far * far;
    measure(overlay, shape, y, x, count, squares);
    for (int i = 0; i < count; i++) {
        float distance = sqrtf(squares[i]), *pixel = pixels + i * channels;
        float border = cover_of(shape->halo, distance);
        if (!(border > 0))
            continue;
        composite_pixel(pixel, channels, inks[!light], BORDER_OPACITY * border);
        composite_pixel(pixel, channels, inks[light],
                        cover_of(shape->radius, distance));
    }
}

static void draw_shape(const snow_overlay *overlay, const snow_shape *shape,
                       bool light, int y, int x, int count, int channels,
                       float *pixels) {
    int range[2];
    if (y + 0.5 < shape->box[1] || y + 0.5 > shape->box[3])
        return;
    clip_range(shape->box[0], shape->box[2], x, count, range);
    if (range[0] >= range[1])
        return;
    x += range[0];
    count = range[1] - range[0];
    pixels += range[0] * channels;
    if (!shape->filled) {
        draw_strokes(overlay, shape, light, y, x, count, channels, pixels);
        return;
    }
    const float *color =
        overlay->numbers + shape->first + 3 * (y - (int)shape->box[1]);
    for (int i = 0; i < count; i++)
        composite_pixel(pixels + i * channels, channels, color, 1);
}

void snow_overlay_draw(const snow_overlay *overlay, bool light, int y, int x,
                       int count, int channels, float *pixels) {
    for (int at = 0; at < count; at += SOME) {
        int some = count - at < SOME ? count - at : SOME;
        for (size_t n = 0; n < overlay->shape_count; n++)
            draw_shape(overlay, &overlay->shapes[n], light, y, x + at, some,
                       channels, pixels + at * channels);
    }
}
