/* files/render_file.c - snow_render_file: a file to a picture in one call, that
 * of the tool without options.  It joins the readers of formats/ and the
 * renderer, neither of which knows the other. */
#include "base/base.h"
#include "files/channel_mix.h"
#include "image/image.h"
#include "io/source.h"

#include <snowglass/snowglass.h>

/* What a picture is made of, in the order in which it is made. */
typedef struct request {
    snow_context *context;
    const char *path;
    channel_mix mix;
    snow_settings settings;
    snow_view view;
    snow_image *image;
} request;

static const snow_volume_info *info_of(const request *r) {
    return snow_volume_get_info(r->mix.volumes[0]);
}

static bool has_surfaces(const request *r) {
    return r->settings.mode == SNOW_MODE_OVER ||
           r->settings.mode == SNOW_MODE_ISO;
}

/* Number n of those that are mixed; of none the file's first channel. */
static snow_status open_channel(request *r, int n) {
    const snow_volume_options options = {
        .size = sizeof options,
        .channel = r->mix.count ? r->mix.channel[n] : 0,
        .channel_given = r->mix.count > 0,
        .each_channel = true};
    return snow_volume_open(r->context, r->path, &options, &r->mix.volumes[n]);
}

/* What a picture leaves out. */
static void note_others(const request *r) {
    const snow_volume_info *info = info_of(r);
    if (info->channels > 1 && !r->mix.count)
        snow_notify(r->context,
                    "channel 0 of %lld (counted from 0) is used; "
                    "snow_volume_open selects another",
                    (long long)info->channels);
    else if (r->mix.count && info->channels > SNOW_CHANNELS_MAX)
        snow_notify(r->context,
                    "the file has %lld channels, of which the first %d are "
                    "taken",
                    (long long)info->channels, SNOW_CHANNELS_MAX);
    for (int64_t n = 0; n < info->channels && info->light && r->mix.count; n++)
        if (n < 64 && !(info->light >> n & 1))
            snow_notify(r->context,
                        "channel %lld is of transmitted light and is left out",
                        (long long)n);
}

/* The channels that are drawn, of a file that can be read again; the first is
 * open, and opened anew where it is another. */
static snow_status open_all(request *r) {
    channel_mix *mix = &r->mix;
    if (snow_source_is_stream(r->path))
        mix->count = 0;
    note_others(r);
    for (int n = 0; n < mix->count; n++) {
        if (n == 0 && mix->channel[0] == 0)
            continue;
        snow_volume_close(mix->volumes[n]);
        mix->volumes[n] = NULL;
        SNOW_TRY(open_channel(r, n));
    }
    return SNOW_STATUS_OK;
}

/* From the histogram; of projections grey over the file's window, or all values
 * but a few far off, or above the noise. */
static snow_status choose_look(request *r) {
    const snow_volume_info *info = info_of(r);
    snow_look look;
    snow_look_init(&look);
    if (r->mix.count)
        return snow_mix_look(&r->settings, &r->mix);
    if (!has_surfaces(r)) {
        const snow_mode mode = r->settings.mode;
        look.preset = "linear";
        look.colormap = mode == SNOW_MODE_MIP ? snow_colormap_for(info) : NULL;
        look.range = mode == SNOW_MODE_MINIP ? SNOW_RANGE_LEAST
                     : mode == SNOW_MODE_MIP && (info->light || look.colormap)
                         ? SNOW_RANGE_SIGNAL
                         : SNOW_RANGE_ROBUST;
    }
    return snow_transfer_new_for_volume(r->mix.volumes[0], &look,
                                        &r->mix.looks[0]);
}

/* From where the volume is usually seen, so that what the look shows fills the
 * picture; all of several channels. */
static snow_status choose_view(request *r) {
    const snow_volume *volume = r->mix.volumes[0];
    snow_view_init(&r->view);
    SNOW_TRY(snow_view_default(volume, &r->view));
    return snow_view_fit(NULL, volume,
                         r->mix.count > 1 ? NULL : r->mix.looks[0],
                         &r->settings, NULL, 0, &r->view);
}

static snow_status draw(request *r) {
    snow_frame *frame = NULL;
    SNOW_TRY(snow_frame_new(r->context, &frame));
    snow_status status =
        snow_mix_draw(frame, &r->mix, &r->view, &r->settings, &r->image);
    snow_frame_free(frame);
    return status;
}

/* What files of levels show besides: the background, that of light black, and a
 * patient's sides. */
static snow_status dress(const request *r) {
    const bool light = r->mix.count && !has_surfaces(r);
    const snow_volume_info *info = info_of(r);
    double ground[3];
    snow_overlay *letters = NULL;
    snow_status status = SNOW_STATUS_OK;
    if (info->medical)
        status = snow_overlay_new(r->context, r->view.width, r->view.height,
                                  &letters);
    if (letters)
        status = snow_overlay_orientation(letters, info, &r->view);
    snow_mode_background(r->settings.mode, light ? NULL : r->mix.looks[0],
                         ground);
    snow_image_dress(r->image, ground, letters);
    return status;
}

static snow_status make_picture(request *r, const snow_view *view,
                                const snow_settings *settings) {
    SNOW_TRY(open_all(r));
    SNOW_TRY(choose_look(r));
    if (!settings &&
        (r->mix.count || snow_transfer_is_unshaded(r->mix.looks[0])))
        r->settings.shade = SNOW_SHADE_NONE;
    SNOW_TRY(view ? SNOW_RECORD_READ(r->context, snow_view, view, &r->view)
                  : choose_view(r));
    SNOW_TRY(draw(r));
    return dress(r);
}

/* Where several channels need more memory than there is, of the first. */
static snow_status make(request *r, const snow_view *view,
                        const snow_settings *settings) {
    SNOW_TRY(
        SNOW_RECORD_READ(r->context, snow_settings, settings, &r->settings));
    SNOW_TRY(open_channel(r, 0));
    if (!settings)
        r->settings.mode = snow_mode_for(info_of(r));
    snow_mix_choose(info_of(r), &r->settings, &r->mix);
    snow_status status = make_picture(r, view, settings);
    if (status != SNOW_STATUS_NO_MEMORY || r->mix.count < 2)
        return status;
    snow_image_free(r->image);
    r->image = NULL;
    snow_mix_close(&r->mix);
    r->mix.count = 0;
    SNOW_TRY(open_channel(r, 0));
    return make_picture(r, view, settings);
}

snow_status snow_render_file(snow_context *context, const char *path,
                             const snow_view *view,
                             const snow_settings *settings,
                             snow_image **image) {
    request r = {.context = context, .path = path};
    snow_status status = make(&r, view, settings);
    if (status == SNOW_STATUS_OK)
        *image = r.image;
    else
        snow_image_free(r.image);
    snow_mix_close(&r.mix);
    return status;
}
