/* formats/image_series.h - volumes whose slices are files of their own. */
#ifndef SNOW_FORMATS_IMAGE_SERIES_H
#define SNOW_FORMATS_IMAGE_SERIES_H

#include "formats/format.h"

/* Makes a volume from the files that a folder or a pattern names, in their
 * order, one slice each; like a format's `read`.  Messages need not begin with
 * the path. Errors: SNOW_STATUS_BAD_INPUT (no files, files that differ or are
 * not numbered without a gap, errors in one of them), SNOW_STATUS_BAD_USAGE,
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_stack_read(snow_context *context, const char *path,
                            const snow_volume_options *options,
                            snow_format_finder *find, snow_volume_info *info,
                            snow_volume **out);

#endif
