/* layers_slice.c - the overlay of a slice, laid over its picture. */
#include "picture/layers.h"

#include <math.h>

/* The most that an overlay covers of a slice where no opacities are asked. */
#define COVER 0.5

/* What its opacities are multiplied by: opacities of sheets say little of a
 * single one.  A factor is the most that it covers. */
static double cover_of(const options *opts, const snow_transfer *transfer) {
    const point_list *asked = &opts->overlay_look.opacity;
    const bool factor = points_are_factor(asked);
    const bool labels = snow_transfer_label(transfer, 0);
    const double cover = factor ? asked->points[0].opacity : COVER;
    snow_look look = {.size = sizeof look};
    double most = 0;
    if (asked->count && (labels || !factor))
        return 1;
    if (!labels && snow_transfer_get_look(transfer, &look) == SNOW_STATUS_OK)
        for (size_t n = 0; n < look.opacity_count; n++)
            most = fmax(most, look.opacities[n].opacity);
    return most > 0 ? cover / most : cover;
}

/* Lays the colours of values over a picture. */
static void lay(const snow_transfer *transfer, double cover,
                const snow_image *values, const snow_image *below,
                snow_image *out) {
    const size_t count =
        (size_t)snow_image_width(out) * (size_t)snow_image_height(out);
    const int parts = snow_image_channels(below);
    const float *value = snow_image_pixels((snow_image *)(uintptr_t)values);
    const float *from = snow_image_pixels((snow_image *)(uintptr_t)below);
    float *to = snow_image_pixels(out);
    for (size_t n = 0; n < count; n++, from += parts, to += 4) {
        double rgba[4];
        snow_transfer_evaluate(transfer, (double)value[n], rgba);
        const double share = fmin(cover * rgba[3], 1);
        rgba[3] = 1;
        for (int c = 0; c < 4; c++)
            to[c] = (float)(share * rgba[c] +
                            (1 - share) * (double)from[c == 3       ? parts - 1
                                                       : parts == 4 ? c
                                                                    : 0]);
    }
}

snow_status layers_lay_slice(const options *opts, const layers *l,
                             int64_t index, const snow_view *view,
                             const snow_settings *settings,
                             snow_context *context, snow_image **image) {
    snow_settings how = *settings;
    snow_image *values = NULL, *made = NULL;
    if (!l->volume)
        return SNOW_STATUS_OK;
    if (snow_transfer_label(l->transfer, 0))
        how.kernel = SNOW_KERNEL_BOX; /* numbers of labels are not mixed */
    snow_status status =
        snow_slice_render(l->volume, index, NULL, view, &how, &values);
    if (status == SNOW_STATUS_OK)
        status = snow_image_new(context, snow_image_width(values),
                                snow_image_height(values), 4, &made);
    if (status == SNOW_STATUS_OK) {
        lay(l->transfer, cover_of(opts, l->transfer), values, *image, made);
        snow_image_free(*image);
        *image = made;
    }
    snow_image_free(values);
    return status;
}
