/* render/bytes.c - whether a picture can be made as bytes of the caller. */
#include "render/picture.h"

snow_status snow_picture_check_bytes(snow_context *context,
                                     const snow_request *request,
                                     const snow_bytes *bytes) {
    snow_view view;
    snow_settings settings;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, request->view, &view));
    SNOW_TRY(
        SNOW_RECORD_READ(context, snow_settings, request->settings, &settings));
    if (bytes->stride / 4 < (size_t)(view.width > 0 ? view.width : 0))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "a row of %d pixels does not fit %zu bytes; use a "
                         "stride of 4 bytes a pixel or more",
                         view.width, bytes->stride);
    for (int n = 0; bytes->background && n < 3; n++)
        if (!(bytes->background[n] >= 0 && bytes->background[n] <= 1))
            return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                             "the background has a channel of %g; use 0 to 1",
                             bytes->background[n]);
    if (settings.mode == SNOW_MODE_MEAN || settings.mode == SNOW_MODE_SUM)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "mode %s makes data values, not colours; use "
                         "snow_frame_render and snow_image_apply_colormap",
                         snow_mode_name(settings.mode));
    return SNOW_STATUS_OK;
}
