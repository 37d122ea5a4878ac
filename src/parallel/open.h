/* parallel/open.h - parts that are cut anew: what open.c has for others. */
#ifndef SNOW_PARALLEL_OPEN_H
#define SNOW_PARALLEL_OPEN_H

#include "parallel/partition.h"
#include "volume/stream.h"

/* The name of format `index` (snow_format_name). */
typedef const char *snow_format_name_fn(size_t index);

/* As snow_ranks_open, by a function that opens files, which this folder does
 * not know. */
snow_status snow_ranks_open_by(snow_open_fn *open,
                               snow_format_name_fn *format_name,
                               snow_comm *comm, const char *path,
                               const snow_volume_options *options,
                               const snow_look *look, const snow_view *view,
                               const snow_settings *settings,
                               const snow_ranks_options *how,
                               snow_volume **volume, snow_transfer **transfer);

/* Whether this rank's part gives its share of a picture. */
bool snow_part_serves(const snow_volume *volume,
                      const snow_partition_params *order);

/* Collective.  Voxels of the whole, of which all ranks hold a part, go where
 * the boxes say; NULL: where the order says.  *volume is closed and replaced,
 * unless it fails. */
snow_status
snow_ranks_distribute(snow_comm *comm, const snow_volume_info *whole,
                      const snow_partition_params *order, const snow_box *boxes,
                      const snow_transfer *transfer, snow_volume **volume);

#endif
