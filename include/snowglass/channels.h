/* snowglass/channels.h - transfer functions of channels that one picture
 * mixes. */
#ifndef SNOWGLASS_CHANNELS_H
#define SNOWGLASS_CHANNELS_H

#include <snowglass/ranks.h>

/* Returns whether a volume is flat as a picture: it has at most five slices,
 * and is much wider and higher. */
SNOW_API bool snow_channels_are_flat(const snow_volume_info *whole);

/* Finds whether red, green and blue lie on a white ground: most voxels at the
 * border of slice `index` across z are bright in all three. *white is the share
 * of `levels` (low, high of each) from which on they are ground, for
 * snow_look.white; 0 where the ground is not white. */
SNOW_API snow_status snow_channels_ground(const snow_volume *const parts[3],
    const double levels[3][2], int64_t index, double *white);

/* Makes the transfer function of a channel: `look` from black to `rgb` (NULL:
 * with its colour map), no more opaque than the other channels need. `whole` is
 * the volume that the channel is of; `projected`: for a projection or a slice,
 * else for a volume. `comm` (or NULL) is that of ranks, which all call it. */
SNOW_API snow_status snow_channels_look(snow_comm *comm,
    const snow_volume *volume, const snow_volume_info *whole, int64_t channel,
    bool projected, const double rgb[3], const snow_look *look,
    snow_transfer **out);

#endif
