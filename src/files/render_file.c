/* files/render_file.c - snow_render_file: a file to a picture in one call, that
 * of the tool without options.  It joins the readers of formats/ and the
 * renderer, neither of which knows the other. */
#include "base/base.h"
#include "image/image.h"

#include <snowglass/snowglass.h>

/* What a picture is made of, in the order in which it is made. */
typedef struct request {
    snow_context *context;
    snow_volume *volume;
    snow_transfer *transfer;
    snow_settings settings;
    snow_view view;
    snow_image *image;
} request;

/* Behind shaded objects, whose dark sides stand out from it. */
#define DARK (20 / 255.0)

static bool has_surfaces(const request *r) {
    return r->settings.mode == SNOW_MODE_OVER ||
           r->settings.mode == SNOW_MODE_ISO;
}

/* From the histogram; of projections grey over the file's window, or all values
 * but a few far off, or above the noise. */
static snow_status choose_look(request *r) {
    const snow_volume_info *info = snow_volume_get_info(r->volume);
    snow_look look;
    snow_look_init(&look);
    if (!has_surfaces(r)) {
        const snow_mode mode = r->settings.mode;
        look.preset = "linear";
        look.colormap = mode == SNOW_MODE_MIP ? snow_colormap_for(info) : NULL;
        look.range = mode == SNOW_MODE_MINIP ? SNOW_RANGE_LEAST
                     : mode == SNOW_MODE_MIP && (info->light || look.colormap)
                         ? SNOW_RANGE_SIGNAL
                         : SNOW_RANGE_ROBUST;
    }
    return snow_transfer_new_for_volume(r->volume, &look, &r->transfer);
}

/* From where the volume is usually seen, so that what the look shows fills the
 * picture. */
static snow_status choose_view(request *r) {
    snow_view_init(&r->view);
    SNOW_TRY(snow_view_default(r->volume, &r->view));
    return snow_view_fit(NULL, r->volume, r->transfer, &r->settings, NULL, 0,
                         &r->view);
}

static snow_status draw(request *r) {
    snow_frame *frame = NULL;
    SNOW_TRY(snow_frame_new(r->context, &frame));
    snow_status status = snow_frame_render(frame, r->volume, r->transfer,
                                           &r->view, &r->settings, &r->image);
    snow_frame_free(frame);
    return status;
}

/* What files of levels show besides: a dark background, and a patient's
 * sides. */
static snow_status dress(const request *r) {
    const snow_volume_info *info = snow_volume_get_info(r->volume);
    double ground[3] = {DARK, DARK, DARK};
    snow_overlay *letters = NULL;
    snow_status status = SNOW_STATUS_OK;
    if (info->medical)
        status = snow_overlay_new(r->context, r->view.width, r->view.height,
                                  &letters);
    if (letters)
        status = snow_overlay_orientation(letters, info, &r->view);
    if (!has_surfaces(r))
        snow_mode_background(r->settings.mode, r->transfer, ground);
    snow_image_dress(r->image, ground, letters);
    return status;
}

static snow_status make(request *r, const char *path, const snow_view *view,
                        const snow_settings *settings) {
    SNOW_TRY(
        SNOW_RECORD_READ(r->context, snow_settings, settings, &r->settings));
    SNOW_TRY(snow_volume_open(r->context, path, NULL, &r->volume));
    if (!settings)
        r->settings.mode = snow_mode_for(snow_volume_get_info(r->volume));
    SNOW_TRY(choose_look(r));
    if (!settings && snow_transfer_is_unshaded(r->transfer))
        r->settings.shade = SNOW_SHADE_NONE;
    SNOW_TRY(view ? SNOW_RECORD_READ(r->context, snow_view, view, &r->view)
                  : choose_view(r));
    SNOW_TRY(draw(r));
    return dress(r);
}

snow_status snow_render_file(snow_context *context, const char *path,
                             const snow_view *view,
                             const snow_settings *settings,
                             snow_image **image) {
    request r = {.context = context};
    snow_status status = make(&r, path, view, settings);
    if (status == SNOW_STATUS_OK)
        *image = r.image;
    else
        snow_image_free(r.image);
    snow_transfer_free(r.transfer);
    snow_volume_close(r.volume);
    return status;
}
