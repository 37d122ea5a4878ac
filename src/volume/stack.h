/* volume/stack.h - slices in files of their own. */
#ifndef SNOW_STACK_H
#define SNOW_STACK_H

#include "volume/volume.h"

/* Makes a volume of the files that a folder or a pattern names, in their order,
 * one slice each; as a format's `read`.  Messages need not begin with the path.
 * Errors: SNOW_BAD_INPUT (no files, files that are not alike or not numbered
 * without a gap, what is wrong with one of them), SNOW_BAD_USAGE,
 * SNOW_NO_MEMORY. */
snow_status snow_stack_read(snow_context *context, const char *path,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out);

#endif
