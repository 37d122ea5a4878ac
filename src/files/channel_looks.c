/* files/channel_looks.c - the looks of channels that one picture mixes. */
#include "base/base.h"
#include "volume/volume.h"

#include <snowglass/channels.h>

#include <math.h>
#include <string.h>

bool snow_channels_are_flat(const snow_volume_info *whole) {
    const int64_t *n = whole->dims;
    for (int i = 0; i < 3; i++)
        if (n[i] <= 5 && n[(i + 1) % 3] >= (n[i] > 1 ? 16 * n[i] : 2) &&
            n[(i + 2) % 3] >= (n[i] > 1 ? 16 * n[i] : 2))
            return true;
    return false;
}

/* The least brightness in mode over, where what is dim is transparent. */
#define DIM 0.5

typedef struct channel_colors {
    snow_color_point colors[2];
    snow_opacity_point opacities[4];
} channel_colors;

/* Colours and, where no histogram is asked, opacities: those of a projection,
 * and of voxels that are colours: faint enough that the colour is not that of
 * the border, where values are between; but a picture is what it is, and on a
 * white ground the darkest is as opaque. */
static void take_color(const snow_volume_info *whole, bool own, bool projected,
                       const double rgb[3], channel_colors *scratch,
                       snow_look *look) {
    static const snow_opacity_point opacities[3][4] = {
        {{0, 0}, {0.04, 0}, {0.15, 0.25}, {1, 0.3}},
        {{0, 1}, {0.04, 1}, {0.15, 1}, {1, 1}},
        {{0, 0.6}, {0.04, 0.6}, {0.15, 0.6}, {1, 0.6}}};
    const int ground = snow_channels_are_flat(whole) ? 1
                       : look->white > 0             ? 2
                                                     : 0;
    const double dim = projected || own ? 0 : DIM;
    scratch->colors[0] =
        (snow_color_point){0, dim * rgb[0], dim * rgb[1], dim * rgb[2]};
    scratch->colors[1] = (snow_color_point){1, rgb[0], rgb[1], rgb[2]};
    look->colors = scratch->colors;
    look->color_count = 2;
    look->domain = SNOW_DOMAIN_RANGE;
    memcpy(scratch->opacities, opacities[ground], sizeof opacities[0]);
    if (projected)
        scratch->opacities[1] = (snow_opacity_point){1, 1};
    if (projected || own)
        look->opacities = scratch->opacities;
    look->opacity_count = projected ? 2 : own ? 4 : 0;
}

/* One value everywhere is nothing to see: it would hide the other channels.
 * Its range begins there instead of ending there. */
static snow_status hide_constant(snow_comm *comm, const snow_volume *volume,
                                 snow_look *look, snow_transfer **made) {
    const snow_look automatic = {.size = sizeof automatic};
    snow_transfer *seen = NULL;
    double low, high;
    snow_transfer_domain(*made, &low, &high);
    if (low < 0 || low > 0 || look->range == SNOW_RANGE_FULL ||
        look->range == SNOW_RANGE_VALUES ||
        look->range == SNOW_RANGE_PERCENTILES)
        return SNOW_STATUS_OK;
    snow_status status =
        snow_ranks_new_transfer(comm, volume, &automatic, &seen);
    if (status == SNOW_STATUS_OK &&
        strstr(snow_transfer_description(seen), "one value only")) {
        snow_transfer_free(*made);
        *made = NULL;
        look->range = SNOW_RANGE_VALUES;
        look->low = high;
        look->high = high + fmax(1, high);
        status = snow_ranks_new_transfer(comm, volume, look, made);
    }
    snow_transfer_free(seen);
    return status;
}

snow_status snow_channels_look(snow_comm *comm, const snow_volume *volume,
                               const snow_volume_info *whole, int64_t channel,
                               bool projected, const double rgb[3],
                               const snow_look *given, snow_transfer **out) {
    snow_context *context = volume->context;
    snow_volume_info info;
    snow_look look;
    channel_colors scratch;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, whole, &info));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_look, given, &look));
    if (rgb)
        take_color(&info,
                   channel < SNOW_CHANNELS_MAX && info.channel[channel].own,
                   projected, rgb, &scratch, &look);
    else if (projected)
        look.preset = "linear";
    snow_transfer *made = NULL;
    snow_status status = snow_ranks_new_transfer(comm, volume, &look, &made);
    if (status == SNOW_STATUS_OK)
        status = hide_constant(comm, volume, &look, &made);
    if (status == SNOW_STATUS_OK)
        *out = made;
    else
        snow_transfer_free(made);
    return status;
}
