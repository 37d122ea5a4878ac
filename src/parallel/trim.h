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

#endif
