/* layers_slice.c - the overlay of a slice, laid over its picture. */
#include "picture/layers.h"
#include "picture/light.h"

snow_status layers_lay_slice(const options *opts, const layers *l,
                             int64_t index, const snow_view *view,
                             const snow_settings *settings,
                             snow_context *context, snow_image **image) {
    const point_list *asked = &opts->overlay_look.opacity;
    const double factor =
        points_are_factor(asked) ? asked->points[0].opacity : -1;
    const bool outline = opts->overlay_look.outline;
    if (!l->volume)
        return SNOW_STATUS_OK;
    return light_lay_slice(
        context, l->volume, l->transfer,
        light_cover(l->transfer, asked->count > 0, factor, outline), outline,
        index, view, settings, image);
}
