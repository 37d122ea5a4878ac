/* render/settings_resolve.h - the settings of a picture, checked and made
 * definite for one volume. */
#ifndef SNOW_RENDER_SETTINGS_RESOLVE_H
#define SNOW_RENDER_SETTINGS_RESOLVE_H

#include "base/base.h"
#include "base/record.h"

/* Checks every setting and replaces what is 0 or AUTO by what is meant for
 * this volume, but for the encoding, which is measured later.
 * Errors: SNOW_STATUS_BAD_USAGE with the setting's name and range. */
snow_status snow_settings_resolve(snow_context *context,
                                  const snow_volume_info *info,
                                  snow_settings *settings);

/* Whether the value path draws a picture of these, which are resolved. */
static inline bool snow_draws_values(const snow_settings *settings) {
    return settings->method == SNOW_METHOD_VALUE ||
           (settings->method == SNOW_METHOD_SHEAR_WARP &&
            settings->mode == SNOW_MODE_OVER);
}

#endif
