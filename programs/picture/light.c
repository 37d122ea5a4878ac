/* light.c - see light.h. */
#include "picture/light.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static size_t pixels_of(const snow_image *image) {
    return (size_t)snow_image_width(image) * (size_t)snow_image_height(image);
}

snow_status light_add(snow_context *context, const snow_image *one,
                      double share, snow_image **sum) {
    const int channels = snow_image_channels(one);
    snow_status status = *sum ? SNOW_STATUS_OK
                              : snow_image_new(context, snow_image_width(one),
                                               snow_image_height(one), 4, sum);
    if (status != SNOW_STATUS_OK)
        return status;
    const float *from = snow_image_data(one);
    float *to = snow_image_pixels(*sum);
    for (size_t n = pixels_of(one); n; n--, from += channels, to += 4) {
        to[3] = fmaxf(to[3], from[channels - 1]);
        for (int c = 0; c < 3; c++)
            to[c] += (float)share * from[channels == 4 ? c : 0];
    }
    return SNOW_STATUS_OK;
}

void light_limit(snow_image *sum) {
    float *at = snow_image_pixels(sum);
    for (size_t n = pixels_of(sum); n; n--, at += 4)
        for (int c = 0; c < 3; c++)
            at[c] = fminf(at[c], at[3]);
}

bool light_of_colormap(size_t index, double rgb[3]) {
    snow_color_point points[SNOW_COLORMAP_POINTS_MAX];
    if (snow_colormap_points(index, points, SNOW_COLORMAP_POINTS_MAX) != 2 ||
        points[0].red + points[0].green + points[0].blue > 0)
        return false;
    memcpy(rgb, &points[1].red, 3 * sizeof *rgb);
    return true;
}

/* --- an overlay of a slice ------------------------------------------------ */

/* The most that an overlay covers of a slice where no opacities are asked. */
#define COVER 0.5

double light_cover(const snow_transfer *transfer, bool asked, double factor,
                   bool outline) {
    const bool labels = snow_transfer_label(transfer, 0);
    const double cover = factor >= 0 ? factor : COVER;
    snow_look look = {.size = sizeof look};
    double most = 0;
    if (asked && (labels || factor < 0))
        return 1;
    if (outline && factor < 0)
        return labels ? 1 : INFINITY; /* what is seen at all */
    if (!labels && snow_transfer_get_look(transfer, &look) == SNOW_STATUS_OK)
        for (size_t n = 0; n < look.opacity_count; n++)
            most = fmax(most, look.opacities[n].opacity);
    return most > 0 ? cover / most : cover;
}

/* Pixels of a line around a label, by the shorter side of the picture. */
static int width_of(const snow_image *image) {
    const int width = snow_image_width(image),
              height = snow_image_height(image);
    const int side = width < height ? width : height;
    return side < 400 ? 1 : side < 1000 ? 2 : 3;
}

/* What each pixel shows: the number of a label, 1 for values, 0 for nothing.
 * NULL: no memory. */
static double *find_parts(const snow_transfer *transfer, snow_image *values) {
    const size_t count =
        (size_t)snow_image_width(values) * (size_t)snow_image_height(values);
    const bool labels = snow_transfer_label(transfer, 0);
    const float *value = snow_image_pixels(values);
    double *parts = malloc(count * sizeof *parts);
    for (size_t n = 0; n < count && parts; n++) {
        double rgba[4];
        snow_transfer_evaluate(transfer, (double)value[n], rgba);
        parts[n] = !(rgba[3] > 0) ? 0 : labels ? (double)value[n] : 1;
    }
    return parts;
}

/* Whether a pixel lies within so many pixels of another part. */
static bool is_border(const double *parts, int width, int height, int x, int y,
                      int reach) {
    const double own = parts[(size_t)y * (size_t)width + (size_t)x];
    for (int b = y - reach; b <= y + reach; b++)
        for (int a = x - reach; a <= x + reach; a++) {
            const int away = (a - x) * (a - x) + (b - y) * (b - y);
            if (a < 0 || b < 0 || a >= width || b >= height ||
                away > reach * reach)
                continue;
            const double other = parts[(size_t)b * (size_t)width + (size_t)a];
            if (other < own || other > own)
                return true;
        }
    return false;
}

/* Leaves values only at the borders of parts, which lie within these, so that
 * neighbours have a line each. */
static snow_status keep_borders(const snow_transfer *transfer,
                                snow_image *values) {
    const int width = snow_image_width(values);
    const int height = snow_image_height(values), reach = width_of(values);
    double *parts = find_parts(transfer, values);
    if (!parts)
        return SNOW_STATUS_NO_MEMORY;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            if (!is_border(parts, width, height, x, y, reach))
                snow_image_pixels(
                    values)[(size_t)y * (size_t)width + (size_t)x] = NAN;
    free(parts);
    return SNOW_STATUS_OK;
}

/* Lays the colours of values over a picture. */
static void lay(const snow_transfer *transfer, double cover,
                const snow_image *values, const snow_image *below,
                snow_image *out) {
    const size_t count =
        (size_t)snow_image_width(out) * (size_t)snow_image_height(out);
    const int parts = snow_image_channels(below);
    const float *value = snow_image_data(values);
    const float *from = snow_image_data(below);
    float *to = snow_image_pixels(out);
    for (size_t n = 0; n < count; n++, from += parts, to += 4) {
        double rgba[4];
        snow_transfer_evaluate(transfer, (double)value[n], rgba);
        const double share = rgba[3] > 0 ? fmin(cover * rgba[3], 1) : 0;
        rgba[3] = 1;
        for (int c = 0; c < 4; c++)
            to[c] = (float)(share * rgba[c] +
                            (1 - share) * (double)from[c == 3       ? parts - 1
                                                       : parts == 4 ? c
                                                                    : 0]);
    }
}

snow_status light_lay_slice(snow_context *context, const snow_volume *volume,
                            const snow_transfer *transfer, double cover,
                            bool outline, int64_t index, const snow_view *view,
                            const snow_settings *settings, snow_image **image) {
    snow_settings how = *settings;
    snow_image *values = NULL, *made = NULL;
    if (snow_transfer_label(transfer, 0))
        how.kernel = SNOW_KERNEL_BOX; /* numbers of labels are not mixed */
    snow_status status =
        snow_slice_render(volume, index, NULL, view, &how, &values);
    if (status == SNOW_STATUS_OK && outline)
        status = keep_borders(transfer, values);
    if (status == SNOW_STATUS_OK)
        status = snow_image_new(context, snow_image_width(values),
                                snow_image_height(values), 4, &made);
    if (status == SNOW_STATUS_OK) {
        lay(transfer, cover, values, *image, made);
        snow_image_free(*image);
        *image = made;
    }
    snow_image_free(values);
    return status;
}

snow_status light_fade(snow_comm *comm, const snow_transfer *transfer,
                       const snow_volume *volume, double factor,
                       const snow_opacity_point *points, size_t count,
                       snow_transfer **out) {
    snow_look look = {.size = sizeof look};
    snow_opacity_point own[LIGHT_POINTS];
    snow_status status = snow_transfer_get_look(transfer, &look);
    if (status != SNOW_STATUS_OK)
        return status;
    if (!points) {
        points = look.opacities;
        count = look.opacity_count;
    }
    count = count < LIGHT_POINTS ? count : LIGHT_POINTS;
    for (size_t n = 0; n < count; n++)
        own[n] =
            (snow_opacity_point){points[n].value, factor * points[n].opacity};
    look.opacities = own;
    look.opacity_count = count;
    return snow_ranks_new_transfer(comm, volume, &look, out);
}
