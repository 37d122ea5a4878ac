/* render/modes/sums.h - the sheared method in modes whose order does not matter
 * (composite/projection.h), of parallel views; those in perspective are
 * render/shear_warp/perspective.c's. */
#ifndef SNOW_RENDER_MODES_SUMS_H
#define SNOW_RENDER_MODES_SUMS_H

#include "render/shear_warp/shear_warp.h"

/* Lines 07 to 13, of what is encoded (snow_shear_warp_encode), up to the
 * intermediate image, which snow_shear_warp_warp takes to
 * pairs (value, weight): for mip and minip, where `largest`, as told there; for
 * sums divided by the number of slices, so that they are of 0 to 1 as well.
 * The volume has no holes, the order's transfer function leaves out nothing but
 * voxels whose number is 0, and its settings do not shade.  Errors:
 * SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY. */
snow_status snow_shear_warp_project(snow_shear_warp *shear_warp,
                                    const snow_shear_warp_params *params,
                                    bool largest, const snow_value_scale *scale,
                                    snow_stats *stats,
                                    snow_shear_warp_image *out);

#endif
