/* files/render_file.c - snow_render_file: a file to a picture in one call.  It
 * joins the readers of formats/ and the renderer, neither of which knows the
 * other. */
#include "base/base.h"

#include <snowglass/snowglass.h>

static snow_status
render_volume(snow_context *context, const snow_volume *volume,
              const snow_transfer *transfer, const snow_view *view,
              const snow_settings *settings, snow_image **image) {
    snow_settings by_default;
    snow_view front;
    snow_frame *frame = NULL;
    snow_settings_init(&by_default);
    if (snow_transfer_is_unshaded(transfer))
        by_default.shade = SNOW_SHADE_NONE;
    snow_view_init(&front);
    SNOW_TRY(snow_view_default(volume, &front));
    SNOW_TRY(snow_frame_new(context, &frame));
    snow_status status =
        snow_frame_render(frame, volume, transfer, view ? view : &front,
                          settings ? settings : &by_default, image);
    snow_frame_free(frame);
    return status;
}

snow_status snow_render_file(snow_context *context, const char *path,
                             const snow_view *view,
                             const snow_settings *settings,
                             snow_image **image) {
    const snow_look look = {.size = sizeof look}; /* from the histogram */
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    SNOW_TRY(snow_volume_open(context, path, NULL, &volume));
    snow_status status = snow_transfer_new_for_volume(volume, &look, &transfer);
    if (status == SNOW_STATUS_OK)
        status =
            render_volume(context, volume, transfer, view, settings, image);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    return status;
}
