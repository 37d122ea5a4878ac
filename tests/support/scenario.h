/* tests/support/scenario.h - one picture by many processors, which are threads
 * here, beside the one by one process. */
#ifndef SNOW_TEST_SUPPORT_SCENARIO_H
#define SNOW_TEST_SUPPORT_SCENARIO_H

#include "support/support.h"

#include "decompose/partition.h"
#include "transfer/transfer.h"
#include "volume/volume.h"

#include <snowglass/ranks.h>

/* The most ranks. */
#define SCENARIO_RANKS 33

/* How it is cut. */
typedef enum partitioning {
    ALONG_SLICES, /* slabs along the view's slice axis */
    ALONG_OTHER,  /* along another axis */
    BRICKS,       /* a k-d tree */
    UNEVEN,       /* another one, of large and small bricks */
    GROUPED,      /* slabs along the slice axis, of whole groups */
    PARTITIONINGS
} partitioning;

/* A scene that ranks share. */
typedef struct scenario {
    snow_volume_info info;
    const void *voxels;
    bool masked;                   /* NaN is what a mask has left out */
    const snow_transfer *transfer; /* whose points every rank copies */
    const char *layer; /* file of another volume in the picture, or NULL: */
    const snow_transfer *layer_look;
    snow_view view;
    snow_settings settings;
    snow_ranks_options how;
    partitioning cut;
    snow_box boxes[SCENARIO_RANKS];
    int pictures; /* one after another, with one frame */
    float *picture;
    int channels;
    float *depths;                   /* NULL: not asked for */
    snow_stats stats;                /* of rank 0 */
    int ranks;                       /* by snow_ranks_stats of rank 0 */
    snow_stats each[SCENARIO_RANKS]; /* of every rank */
    /* Of the serial picture. */
    int64_t interesting, voxels_drawn;
} scenario;

size_t scenario_floats(const scenario *p);

/* Gives each rank a box. */
void scenario_partition(snow_context *context, scenario *p, int ranks);

/* A box with its ghosts, as a volume; its voxels are to be freed. */
snow_status scenario_open_part(snow_context *context, const scenario *p,
                               const snow_box *box, void **voxels,
                               snow_volume **volume);

snow_status scenario_copy_transfer(snow_context *context,
                                   const snow_transfer *t, snow_transfer **out);

/* Gives a frame the layer: of one process in memory, on the volume's grid; of
 * ranks in its file.  Both are to be freed, NULL where there is none. */
snow_status scenario_add_layer(const scenario *p, snow_frame *frame,
                               const snow_volume *grid, snow_volume **volume,
                               snow_transfer **look);

/* The picture by one process, to be freed; its strongest opacity. */
float *scenario_alone(snow_context *context, scenario *p, double *strongest);

/* What each rank does; `user` is the scenario. */
snow_status scenario_perform(snow_comm *comm, void *user);

/* Renders by so many ranks; p->picture is to be freed. */
void scenario_by_ranks(snow_context *context, scenario *p, int ranks);

/* The largest difference of the ranks' picture from another one. */
double scenario_gap(const scenario *p, const float *serial);

/* Fails unless the ranks have counted what one process has: voxels of borders,
 * which several ranks hold, count for their owner only. */
void scenario_check_counts(const scenario *p, int ranks);

#endif
