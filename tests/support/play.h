/* tests/support/play.h - one picture by many processors, which are threads
 * here, beside the one by one process. */
#ifndef SNOW_TEST_SUPPORT_PLAY_H
#define SNOW_TEST_SUPPORT_PLAY_H

#include "support/support.h"

#include "decompose/partition.h"
#include "transfer/transfer.h"
#include "volume/volume.h"

#include <snowglass/ranks.h>

/* The most ranks. */
#define PLAY_RANKS 33

/* How it is cut. */
typedef enum cutting {
    ACROSS,  /* slabs along the view's slice axis */
    BESIDE,  /* along another axis */
    BRICKS,  /* a k-d tree */
    GROUPED, /* slabs along the slice axis, of whole groups */
    CUTTINGS
} cutting;

/* A scene that ranks share. */
typedef struct play {
    snow_volume_info info;
    const void *voxels;
    const snow_transfer *transfer; /* whose points every rank copies */
    snow_view view;
    snow_settings settings;
    snow_ranks_options how;
    cutting cut;
    snow_box boxes[PLAY_RANKS];
    int pictures; /* one after another, with one frame */
    float *picture;
    int channels;
    float *depths;               /* NULL: not asked for */
    snow_stats stats;            /* of rank 0 */
    int ranks;                   /* by snow_ranks_stats of rank 0 */
    snow_stats each[PLAY_RANKS]; /* of every rank */
    /* Of the serial picture. */
    int64_t interesting, voxels_drawn;
} play;

size_t play_floats(const play *p);

/* Gives each rank a box. */
void play_cut(snow_context *context, play *p, int ranks);

/* A box with its ghosts, as a volume; its voxels are to be freed. */
snow_status play_open_part(snow_context *context, const play *p,
                           const snow_box *box, void **voxels,
                           snow_volume **volume);

snow_status play_copy_transfer(snow_context *context, const snow_transfer *t,
                               snow_transfer **out);

/* The picture by one process, to be freed; its strongest opacity. */
float *play_alone(snow_context *context, play *p, double *strongest);

/* What each rank does; `user` is the play. */
snow_status play_perform(snow_comm *comm, void *user);

/* Renders by so many ranks; p->picture is to be freed. */
void play_by_ranks(snow_context *context, play *p, int ranks);

/* The largest difference of the ranks' picture from another one. */
double play_gap(const play *p, const float *serial);

/* Fails unless the ranks have counted what one process has: voxels of borders,
 * which several ranks hold, count for their owner only. */
void play_check_counts(const play *p, int ranks);

#endif
