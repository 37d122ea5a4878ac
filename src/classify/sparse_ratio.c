/* classify/sparse_ratio.c - the sparse ratio of a volume: the share of voxels
 * that are not interesting (Table 1 of the paper). */
#include "classify/count_interesting.h"

snow_status snow_transfer_sparse_ratio(const snow_transfer *transfer,
                                       const snow_volume *volume,
                                       double threshold, double *ratio) {
    int64_t interesting;
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    SNOW_TRY(snow_count_interesting(volume, transfer, threshold, SNOW_ISA_AUTO,
                                    &interesting));
    double voxels =
        (double)part.count[0] * (double)part.count[1] * (double)part.count[2];
    *ratio = voxels > 0 ? 1 - (double)interesting / voxels : 1;
    return SNOW_STATUS_OK;
}
