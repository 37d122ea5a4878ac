/* ranks_open.h - parts that are cut anew: what ranks_open.c has for others. */
#ifndef SNOW_RANKS_OPEN_H
#define SNOW_RANKS_OPEN_H

#include "ranks_cut.h"

/* Whether this rank's part gives its share of a picture. */
bool snow_part_serves(const snow_volume *volume, const snow_cut_order *order);

/* Collective.  Voxels of the whole, of which all ranks hold a part, go where
 * the boxes say; NULL: where the order says.  *volume is closed and replaced,
 * unless it fails. */
snow_status snow_ranks_deal(snow_comm *comm, const snow_volume_info *whole,
                            const snow_cut_order *order, const snow_box *boxes,
                            const snow_transfer *transfer,
                            snow_volume **volume);

#endif
