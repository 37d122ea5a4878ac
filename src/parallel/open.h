/* parallel/open.h - opens a file on many ranks. */
#ifndef SNOW_PARALLEL_OPEN_H
#define SNOW_PARALLEL_OPEN_H

#include "comm/comm.h"
#include "volume/stream.h"

#include <snowglass/ranks.h>

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

#endif
