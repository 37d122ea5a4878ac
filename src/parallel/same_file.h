/* parallel/same_file.h - whether all ranks see one file under a name. */
#ifndef SNOW_PARALLEL_SAME_FILE_H
#define SNOW_PARALLEL_SAME_FILE_H

#include "comm/comm.h"
#include "parallel/part.h"

/* Collective.  Compares what a file has (`whole`), its size, some of its blocks
 * and those of its mask; with `open` a few rows of voxels too where they lie
 * beside the file.  Rank 0 warns where the file was changed at other times
 * only: it is a copy then.  Errors: SNOW_STATUS_BAD_INPUT, those of opening;
 * agreed on. */
snow_status snow_ranks_compare_file(snow_comm *comm, snow_open_fn *open,
                                    const char *path,
                                    const snow_volume_options *options,
                                    const snow_volume_info *whole);

#endif
