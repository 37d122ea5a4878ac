/* tests/support/scenario.h - one picture by many processors, which are threads
 * here, beside the one by one process; and scenes for it, in which everything
 * varies with a number. */
#ifndef SNOW_TEST_SUPPORT_SCENARIO_H
#define SNOW_TEST_SUPPORT_SCENARIO_H

#include "reference/model.h"
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

/* --- scenes --------------------------------------------------------------- */

/* Slices along all axes from both sides, oblique, some in perspective; all
 * types, spacings, qualities, encodings, densities, shades and looks, labels,
 * holes, gradient opacities and pictures of few pixels.  Free the voxels with
 * scenario_free_scene. */
reference_scene scenario_scene(int n, int64_t depth);

/* Another volume for its picture, of labels or values: on the grid, with half
 * the voxels along each axis, or along x the other way. */
reference_scene scenario_front(const reference_scene *base, int n);

void scenario_free_scene(reference_scene *scene);

/* --- pictures ------------------------------------------------------------- */

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

/* Of a scene, whose transfer function it takes over. */
scenario scenario_of(const reference_scene *scene, int n,
                     const snow_transfer *transfer);

size_t scenario_floats(const scenario *p);

/* Gives each rank a box. */
void scenario_partition(snow_context *context, scenario *p, int ranks);

/* What a rank draws with, or one process. */
typedef struct scenario_rank {
    void *voxels; /* of its part */
    snow_volume *volume, *layer;
    snow_transfer *transfer, *look;
    snow_frame *frame;
} scenario_rank;

/* Opens a box with its ghosts, or (NULL) the whole volume; the layer is in its
 * file for ranks, and in memory, on the volume's grid, for one process.
 * Nothing is left where it fails. */
snow_status scenario_enter(snow_context *context, const scenario *p,
                           const snow_box *box, scenario_rank *r);
void scenario_leave(scenario_rank *r);

/* The picture by one process, to be freed; its strongest opacity. */
float *scenario_alone(snow_context *context, scenario *p, double *strongest);

/* What each rank does; `user` is the scenario. */
snow_status scenario_perform(snow_comm *comm, void *user);

/* Renders by so many ranks; p->picture is to be freed. */
void scenario_by_ranks(snow_context *context, scenario *p, int ranks);

/* The largest difference of two pictures; of projections (`relative`) as a part
 * of the largest value.  Infinite where one of both has no value. */
double scenario_difference(const float *a, const float *b, size_t count,
                           bool relative);

/* Fails unless the ranks have counted what one process has: voxels of borders,
 * which several ranks hold, count for their owner only. */
void scenario_check_counts(const scenario *p, int ranks);

#endif
