/* files/channel_mix.c - see channel_mix.h. */
#include "files/channel_mix.h"
#include "base/base.h"
#include "image/image.h"
#include "volume/volume.h"

#include <math.h>
#include <string.h>

static bool is_excluded(const snow_settings *s) {
    return (s->mode != SNOW_MODE_OVER && s->mode != SNOW_MODE_MIP &&
            s->mode != SNOW_MODE_MINIP) ||
           s->method == SNOW_METHOD_ORIGINAL ||
           s->method == SNOW_METHOD_FOOTPRINT ||
           s->kernel == SNOW_KERNEL_GAUSS || s->kernel == SNOW_KERNEL_BOX ||
           s->depth || s->depth_darkening > 0 || s->occlusion > 0;
}

void snow_mix_choose(const snow_volume_info *info,
                     const snow_settings *settings, channel_mix *mix) {
    mix->count = 0;
    for (int n = 0; n < SNOW_CHANNELS_MAX && n < info->channels; n++)
        if (info->channel[n].shown)
            mix->channel[mix->count++] = n;
    if ((mix->count == 1 && mix->channel[0] == 0) || is_excluded(settings))
        mix->count = 0;
}

/* --- looks ---------------------------------------------------------------- */

static bool are_light(const channel_mix *mix, const snow_volume_info *info) {
    bool all = !info->directions;
    for (int n = 0; n < mix->count; n++)
        all = all && !info->channel[mix->channel[n]].own &&
              (info->light >> mix->channel[n] & 1);
    return all;
}

/* Of colours of voxels: the share of their levels from which on they are a
 * white ground, or 0. */
static snow_status find_white(const channel_mix *mix, double *white) {
    const snow_volume_info *info = snow_volume_get_info(mix->volumes[0]);
    double levels[3][2];
    bool own = mix->count == 3 && !snow_channels_are_flat(info);
    *white = 0;
    for (int n = 0; n < 3 && own; n++) {
        own = mix->channel[n] == n && info->channel[n].own;
        memcpy(levels[n], info->channel[n].window, sizeof levels[n]);
    }
    return own ? snow_channels_ground((const snow_volume *const *)mix->volumes,
                                      (const double(*)[2])levels,
                                      info->dims[2] / 2, white)
               : SNOW_STATUS_OK;
}

/* The file's, in eight bits, else those of napari, for one, two, three and more
 * channels; below 0 the map "hot".  Of light blue is paler: it is too dark to
 * be seen. */
static int color_of(const snow_channel *of, int n, int count, bool light) {
    static const int usual[4][SNOW_CHANNELS_MAX] = {
        {0xffffff},
        {0xff00ff, 0x00ff00},
        {0xff0000, 0x00ff00, 0x0000ff},
        {0x00ffff, 0xffff00, 0xff00ff, 0xff0000, 0x00ff00, 0x0000ff, 0xffffff,
         -1}};
    int color = 0;
    for (int c = 0; c < 3; c++)
        color = color << 8 | ((int)lround(255 * of->color[c]) & 255);
    if (!(of->color[0] >= 0))
        color = usual[count < 4 ? count - 1 : 3][n];
    return light && color == 0x0000ff ? 0x4d4dff : color;
}

snow_status snow_mix_look(const snow_settings *settings, channel_mix *mix) {
    const snow_volume_info *info = snow_volume_get_info(mix->volumes[0]);
    const bool projected = settings->mode != SNOW_MODE_OVER;
    const bool light = settings->mode == SNOW_MODE_MIP && are_light(mix, info);
    snow_look look = {.size = sizeof look};
    snow_status status =
        projected ? SNOW_STATUS_OK : find_white(mix, &look.white);
    for (int n = 0; n < mix->count && status == SNOW_STATUS_OK; n++) {
        const snow_channel *of = &info->channel[mix->channel[n]];
        const int color = color_of(of, n, mix->count, light);
        const double rgb[3] = {(color >> 16 & 255) / 255.0,
                               (color >> 8 & 255) / 255.0,
                               (color & 255) / 255.0};
        look.colormap = color < 0 ? "hot" : NULL;
        look.low = of->window[0];
        look.high = of->window[1];
        look.range = look.low < look.high ? SNOW_RANGE_VALUES
                     : light              ? SNOW_RANGE_SIGNAL
                     : projected          ? SNOW_RANGE_ROBUST
                                          : SNOW_RANGE_AUTO;
        status = snow_channels_look(
            NULL, mix->volumes[n], info, mix->channel[n], projected,
            color < 0 ? NULL : rgb, &look, &mix->looks[n]);
    }
    return status;
}

/* --- the picture ---------------------------------------------------------- */

/* Adds light and what it covers, which limits it after the last picture. */
static void add(const snow_image *one, bool last, snow_image *sum) {
    const size_t count = (size_t)one->width * (size_t)one->height;
    const float *from = one->pixels;
    float *to = sum->pixels;
    for (size_t n = 0; n < count; n++, from += one->channels, to += 4) {
        to[3] = fmaxf(to[3], from[one->channels - 1]);
        for (int c = 0; c < 3; c++) {
            to[c] += from[one->channels == 4 ? c : 0];
            to[c] = last ? fminf(to[c], to[3]) : to[c];
        }
    }
}

static snow_status add_up(snow_frame *frame, const channel_mix *mix,
                          const snow_view *view, const snow_settings *settings,
                          snow_image *sum) {
    for (int n = 0; n < mix->count; n++) {
        snow_image *one = NULL;
        SNOW_TRY(snow_frame_render(frame, mix->volumes[n], mix->looks[n], view,
                                   settings, &one));
        add(one, n == mix->count - 1, sum);
        snow_image_free(one);
    }
    return SNOW_STATUS_OK;
}

snow_status snow_mix_draw(snow_frame *frame, const channel_mix *mix,
                          const snow_view *view, const snow_settings *settings,
                          snow_image **image) {
    if (mix->count && settings->mode != SNOW_MODE_OVER) {
        SNOW_TRY(snow_image_new(mix->volumes[0]->context, view->width,
                                view->height, 4, image));
        return add_up(frame, mix, view, settings, *image);
    }
    snow_layer layers[SNOW_CHANNELS_MAX];
    for (int n = 1; n < mix->count; n++)
        layers[n - 1] = (snow_layer){mix->volumes[n], mix->looks[n], true};
    SNOW_TRY(snow_frame_set_layers(frame, layers,
                                   mix->count > 1 ? mix->count - 1 : 0));
    return snow_frame_render(frame, mix->volumes[0], mix->looks[0], view,
                             settings, image);
}

void snow_mix_close(channel_mix *mix) {
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++) {
        snow_transfer_free(mix->looks[n]);
        snow_volume_close(mix->volumes[n]);
        mix->looks[n] = NULL;
        mix->volumes[n] = NULL;
    }
}
