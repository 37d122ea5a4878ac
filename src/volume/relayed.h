/* volume/relayed.h - a file that several unpack in turn (base/relay.h).
 */
#ifndef SNOW_VOLUME_RELAYED_H
#define SNOW_VOLUME_RELAYED_H

#include "base/relay.h"
#include "volume/volume.h"

/* Opens a file with a relay, or without one where it cannot be used; as
 * snow_open_fn otherwise. */
typedef snow_status snow_open_relayed_fn(snow_context *context,
                                         const char *path, snow_relay *relay,
                                         const snow_volume_options *options,
                                         snow_volume_info *info,
                                         snow_volume **out);

/* Opens a regular file without a mask; where `out` is NULL, reads its header.
 */
snow_status snow_volume_open_relayed(snow_context *context, const char *path,
                                     snow_relay *relay,
                                     const snow_volume_options *options,
                                     snow_volume_info *info, snow_volume **out);

#endif
