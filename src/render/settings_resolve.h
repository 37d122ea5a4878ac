/* render/settings_resolve.h - the settings of a picture, checked and made
 * definite for one volume. */
#ifndef SNOW_RENDER_SETTINGS_RESOLVE_H
#define SNOW_RENDER_SETTINGS_RESOLVE_H

#include "base/base.h"

/* Checks every setting and replaces what is 0 or AUTO by what is meant for
 * this volume, but for the encoding, which is measured later.
 * Errors: SNOW_STATUS_BAD_USAGE with the setting's name and range. */
snow_status snow_settings_resolve(snow_context *context,
                                  const snow_volume_info *info,
                                  snow_settings *settings);

#endif
