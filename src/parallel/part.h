/* parallel/part.h - a rank's part of a volume. */
#ifndef SNOW_PARALLEL_PART_H
#define SNOW_PARALLEL_PART_H

#include "parallel/partition.h"
#include "volume/stream.h"

/* A rank's box, and with its ghosts. */
typedef struct snow_part_place {
    snow_box owned, stored;
} snow_part_place;

/* A rank without voxels stores one, since a volume has at least one. */
snow_part_place snow_part_place_of(const snow_volume_info *whole,
                                   const snow_box *owned,
                                   const int64_t layers[3]);

/* The same as a record. */
snow_extent snow_part_extent(const snow_volume_info *whole,
                             const snow_part_place *place);

/* Makes a volume the part of a whole, and *out that; closes it on failure. */
snow_status snow_part_set(snow_volume *volume, const snow_volume_info *whole,
                          const snow_part_place *place, snow_volume **out);

/* Room for a part; voxels that nobody sends are 0. */
snow_status snow_part_new(snow_context *context, const snow_volume_info *whole,
                          const snow_part_place *place, snow_volume **out);

/* Collective.  Cuts what all ranks hold as the order says; what is `spent` may
 * lose its voxels meanwhile, and is only to be closed. */
snow_status snow_part_cut(snow_comm *comm, const snow_volume_info *whole,
                          const snow_partition_params *order,
                          const snow_volume *held, bool spent,
                          const snow_transfer *transfer, snow_volume **out);

/* What a part answers for, with what it lacks. */
snow_box snow_part_box(const snow_volume *volume);

/* --- open.c ---

 * The name of format `index` (snow_format_name). */
typedef const char *snow_format_name_fn(size_t index);

/* Does what snow_ranks_open does, by functions that open files, which this
 * folder does not know. */
snow_status snow_ranks_open_by(snow_open_fn *open,
                               snow_format_name_fn *format_name,
                               snow_comm *comm, const char *path,
                               const snow_volume_options *options,
                               const snow_look *look, const snow_view *view,
                               const snow_settings *settings,
                               const snow_ranks_options *how,
                               snow_volume **volume, snow_transfer **transfer);

#endif
