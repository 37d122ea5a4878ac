/* formats/masked.h - volumes that are opened with a mask or clipped. */
#ifndef SNOW_FORMATS_MASKED_H
#define SNOW_FORMATS_MASKED_H

#include "volume/stream.h"

/* Does what snow_volume_open does with options that name a mask, labels or
 * planes; where `out` is NULL, as snow_volume_inspect. `open` opens each of
 * the two files, and never gets such options. Headers of both are compared
 * before any voxel is read. Errors: also SNOW_STATUS_BAD_INPUT (another grid;
 * whatever is wrong with the mask), SNOW_STATUS_BAD_USAGE (labels without a
 * mask, or that are none). */
snow_status snow_masked_open(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             snow_open_fn *open, snow_volume_info *info,
                             snow_volume **out);

/* Gives a volume the names and colours of a file.  Errors:
 * SNOW_STATUS_BAD_INPUT (no such file, or no table). */
snow_status snow_label_table_read(snow_context *context, const char *path,
                                  snow_volume *volume);

#endif
