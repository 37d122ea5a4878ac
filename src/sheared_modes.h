/* sheared_modes.h - the sheared method in modes whose order does not matter
 * (composite/reduce.h), of parallel views; those in perspective are
 * sheared_seen.c's. */
#ifndef SNOW_SHEARED_MODES_H
#define SNOW_SHEARED_MODES_H

#include "sheared.h"

/* Lines 03 to 13 up to the intermediate image, which snow_sheared_warp takes to
 * pairs (value, weight): for mip and minip, where `largest`, as told there; for
 * sums divided by the number of slices, so that they are of 0 to 1 as well.
 * The volume has no holes, the order's transfer function leaves out nothing but
 * voxels whose number is 0, and its settings do not shade.  Errors:
 * SNOW_BAD_USAGE, SNOW_NO_MEMORY. */
snow_status snow_sheared_reduce(snow_sheared *sheared,
                                const snow_sheared_order *order, bool largest,
                                const snow_value_scale *scale,
                                snow_stats *stats, snow_sheared_image *out);

#endif
