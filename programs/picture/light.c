/* light.c - see light.h. */
#include "picture/light.h"

#include <math.h>
#include <stdint.h>
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
    const float *from = snow_image_pixels((snow_image *)(uintptr_t)one);
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
