/* volume/mask.h - volumes that are opened with a mask or clipped. */
#ifndef SNOW_MASK_H
#define SNOW_MASK_H

#include "volume/volume.h"

/* Whether the options name a mask, labels of one, or planes; options may be
 * NULL. */
bool snow_mask_asked(const snow_volume_options *options);

/* As snow_volume_open with options that name these; where `out` is NULL, as
 * snow_volume_inspect.  Headers of both are compared before any voxel is read.
 * Errors: also SNOW_BAD_INPUT (another grid; whatever is wrong with the mask),
 * SNOW_BAD_USAGE (labels without a mask, or that are none). */
snow_status snow_mask_open(snow_context *context, const char *path,
                           const snow_volume_options *options,
                           snow_volume_info *info, snow_volume **out);

/* Tells that no voxel is left of a volume that was opened with these options,
 * by a mask of these values, or by planes alone. */
void snow_mask_remark(snow_context *context, const snow_volume_options *options,
                      const double mask_range[2]);

#endif
