/* snowglass/channels.h - looks of the channels that one picture mixes. */
#ifndef SNOWGLASS_CHANNELS_H
#define SNOWGLASS_CHANNELS_H

#include <snowglass/ranks.h>

/* Whether a volume is a picture: five slices at most, much wider and higher. */
SNOW_API bool snow_channels_are_flat(const snow_volume_info *whole);
/* Whether red, green and blue lie on a white ground: most at the border of
 * slice `index` across z are bright in all. *white is the share of `levels`
 * from which on they are ground, for snow_look; or 0. */
SNOW_API snow_status snow_channels_ground(const snow_volume *const parts[3],
    const double levels[3][2], int64_t index, double *white);
/* `look` from black to `rgb` (NULL: with its map), no more opaque than others
 * need; of a projection or slice, or of a volume. `comm` (or NULL): of ranks.
 */
SNOW_API snow_status snow_channels_look(snow_comm *comm, const snow_volume *,
    const snow_volume_info *whole, int64_t channel, bool projected,
    const double rgb[3], const snow_look *look, snow_transfer **out);
#endif
