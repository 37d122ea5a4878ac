/* parallel/partition.h - which cut of a volume a picture asks for, and its
 * boxes. */
#ifndef SNOW_PARALLEL_PARTITION_H
#define SNOW_PARALLEL_PARTITION_H

#include "base/monitor.h"
#include "comm/comm.h"
#include "decompose/deterministic.h"
#include "decompose/ray_grid.h"

typedef struct snow_partition_params {
    snow_partition cut; /* EQUAL, COUNTED or BRICKS */
    int ranks;
    snow_partition_grid grid; /* its borders are those below, of groups of
                           slices, where pictures are to have the same bits for
                           any number of ranks; else NULL */
    int64_t borders[SNOW_GROUPS + 1];
    int64_t layers[3]; /* of ghost voxels */
    bool slabs_only;   /* along the slices' axis: boxes of another kind would
                          not give the same bits, or were not asked for */
    bool trims;        /* ranks keep only what the look shows of their boxes */
    double threshold;
    snow_isa isa;
    int threads; /* that count; 0: one */
    int span; /* of the counts (decompose/partition.h); 0: voxels are counted */
    bool hides; /* slices of a slab hide those behind them from the rays */
    snow_ray_view rays;
    snow_stop_fn *stop; /* ends what is counted, or NULL; on any rank */
    void *stop_user;
} snow_partition_params;

/* What picture and ranks ask for; `slopes` as in render/ghosts.h.  Not to be
 * copied, for its borders. Errors: SNOW_STATUS_BAD_USAGE (view, settings,
 * options), SNOW_STATUS_BAD_INPUT. */
snow_status
snow_partition_params_make(snow_context *context, const snow_volume_info *whole,
                           const snow_view *view, const snow_settings *settings,
                           const snow_ranks_options *how, int slopes, int ranks,
                           snow_partition_params *out);

/* Begins the monitor of what is counted or measured, which is no stage of a
 * picture; snow_monitor_end ends it. */
void snow_partition_watch(snow_context *context,
                          const snow_partition_params *order,
                          snow_monitor *monitor);

/* The boxes of all ranks, and (unless NULL) their counts.  Counted are the
 * voxels that the volumes of all ranks of `comm` answer for; NULL: of this one.
 * Collective then. Errors: SNOW_STATUS_NO_MEMORY, SNOW_STATUS_STOPPED, those
 * of the transport; agreed on. */
snow_status snow_partition_boxes(snow_comm *comm,
                                 const snow_partition_params *order,
                                 const snow_volume *volume,
                                 const snow_transfer *transfer, snow_box *boxes,
                                 int64_t *loads);

#endif
