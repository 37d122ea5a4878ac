/* picture/settings.h - the library's records of settings and view, from the
 * options. */
#ifndef PICTURE_SETTINGS_H
#define PICTURE_SETTINGS_H

#include "options/options.h"

/* Fills the settings from the options, except the opacity length, which depends
 * on the volume's unit. */
void fill_settings(const options *opts, snow_settings *out);

/* Make the settings and the view that the options request.  Return CONTINUE or
 * an exit code. */
int make_settings(const options *opts, const snow_volume_info *info,
                  snow_settings *out);
int make_view(snow_context *context, const options *opts,
              const snow_volume_info *info, snow_view *out);

#endif
