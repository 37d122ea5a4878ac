/* files/channel_mix.h - the channels of a file that its first picture mixes. */
#ifndef SNOW_CHANNEL_MIX_H
#define SNOW_CHANNEL_MIX_H

#include <snowglass/channels.h>

/* The first of each is that of a volume alone where there are none. */
typedef struct channel_mix {
    int count;
    int64_t channel[SNOW_CHANNELS_MAX];
    snow_volume *volumes[SNOW_CHANNELS_MAX];
    snow_transfer *looks[SNOW_CHANNELS_MAX];
} channel_mix;

/* Those that the file shows; none where that is its first channel as it is, or
 * where settings exclude several. */
void snow_mix_choose(const snow_volume_info *info,
                     const snow_settings *settings, channel_mix *mix);

/* Their looks, for volumes that are open. */
snow_status snow_mix_look(const snow_settings *settings, channel_mix *mix);

/* Mixed in depth, or light added to light where these are projections. */
snow_status snow_mix_draw(snow_frame *frame, const channel_mix *mix,
                          const snow_view *view, const snow_settings *settings,
                          snow_image **image);

void snow_mix_close(channel_mix *mix);

#endif
