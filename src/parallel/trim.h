/* parallel/trim.h - parts without the voxels of which a look shows nothing. */
#ifndef SNOW_PARALLEL_TRIM_H
#define SNOW_PARALLEL_TRIM_H

#include "parallel/partition.h"
#include "volume/volume.h"

/* Collective.  What of this rank's box is kept, with all that a picture of the
 * look needs, and what is known of the rest; `left` begins as that of the
 * volume held.  Where little would be left out, nothing is.  Errors:
 * SNOW_STATUS_NO_MEMORY, SNOW_STATUS_STOPPED, SNOW_STATUS_BAD_USAGE (voxels
 * that the order needs were left out before), of the transport; agreed on. */
snow_status snow_ranks_trim(snow_comm *comm, const snow_partition_params *order,
                            const snow_box *boxes, const snow_volume *held,
                            const snow_transfer *transfer, snow_box *own,
                            snow_left_out *left);

/* The bounding box of some voxels; none: `last` is below `first`. */
typedef struct snow_bounds {
    int64_t first[3], last[3];
} snow_bounds;

/* A box and layers around it, within another one. */
snow_box snow_box_widen(const snow_box *box, const int64_t layers[3],
                        const snow_box *within);

/* For each rank's box: of what the volume held answers for within the ring
 * around the box, the voxels that are not of the range that is left out.
 * Errors: SNOW_STATUS_NO_MEMORY, SNOW_STATUS_STOPPED. */
snow_status snow_bounds_find(const snow_volume *held, const snow_left_out *left,
                             const snow_box *boxes, int ranks, int threads,
                             snow_bounds *out);

#endif
