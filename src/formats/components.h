/* formats/components.h - voxels with several values: one of them, or the
 * magnitude of all. */
#ifndef SNOW_FORMATS_COMPONENTS_H
#define SNOW_FORMATS_COMPONENTS_H

#include "formats/format.h"

/* Errors: SNOW_STATUS_BAD_USAGE for a component that does not exist, unless
 * they are named, or beside a channel. */
snow_status snow_component_check(snow_context *context, bool named,
                                 const snow_volume_options *options);

/* Reads one component of a volume: that which the options name. */
typedef snow_status snow_component_fn(void *user,
                                      const snow_volume_options *options,
                                      snow_volume_info *info,
                                      snow_volume **out);

/* Reads a volume and, if its reader asks for the magnitude
 * (snow_volume_pick_component), its other components too.  `once` means that
 * the input cannot be read again: then the first component is taken, with a
 * note, or the explicit wish refused. */
snow_status snow_components_read(snow_context *context, snow_component_fn *read,
                                 void *user, bool once,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out);

#endif
