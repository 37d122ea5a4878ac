/* info_volume.h - a volume as info opens and describes it. */
#ifndef INFO_VOLUME_H
#define INFO_VOLUME_H

#include "options/options.h"

#include <jansson.h>

/* Opens a volume, or with `out` NULL reads its header alone, also that of a
 * DICOM folder that other verbs open with --allow-gaps only. Returns CONTINUE
 * or an exit code. */
int info_open(snow_context *context, const options *opts, const char *path,
              snow_volume_info *info, snow_volume **out);

/* The geometry of a volume, for scripts. */
void info_set_geometry(json_t *object, const snow_volume_info *info);

/* To which sides of the patient the axes of the grid point, such as LPS. */
void info_axis_letters(const snow_volume_info *info, char letters[4]);

#endif
