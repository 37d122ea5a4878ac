/* snowglass/ranks.h - one picture by many processors: section 4 of the paper.
 *
 * Every rank holds a part of the volume (snow_extent), splats it into a local
 * image, and the local images are combined. All calls but those marked are
 * collective (snowglass/comm.h), with the same arguments on all ranks; errors
 * are the same on all. docs/scaling.md and docs/combining.md explain them. */
#ifndef SNOWGLASS_RANKS_H
#define SNOWGLASS_RANKS_H

#include <snowglass/comm.h>
#include <snowglass/render.h>

typedef enum snow_partition { /* how the volume is partitioned */
    SNOW_PARTITION_AUTO = 0,  /* counted; bricks where slabs would be thin */
    SNOW_PARTITION_EQUAL,     /* the paper's slabs: as equal as can be */
    SNOW_PARTITION_COUNTED, /* slabs of about equally many interesting voxels */
    SNOW_PARTITION_BRICKS,  /* boxes of about equally many interesting voxels */
    SNOW_PARTITION_MEASURED /* auto, later by the time that pictures took */
} snow_partition;

typedef enum snow_combine { /* how local images are combined */
    SNOW_COMBINE_AUTO = 0,  /* by the number of ranks and the image's size */
    SNOW_COMBINE_TREE,      /* the paper's hierarchy */
    SNOW_COMBINE_SWAP,      /* binary swap */
    SNOW_COMBINE_DIRECT,    /* direct send */
    SNOW_COMBINE_RADIX      /* radix-k */
} snow_combine;

typedef struct snow_ranks_options {
    size_t size;
    snow_partition cut;
    snow_combine combining;
    int radix;      /* of SNOW_COMBINE_RADIX, 2 to 64; 0: chosen */
    int pixel_bits; /* 8: levels travel to rank 0; 0: floats */
    bool turns;     /* parts get ghost voxels for all directions at this zoom */
    bool scattered; /* each rank's image has its own pixels; they add up */
    const snow_transfer *transfer; /* for snow_ranks_open, instead of a look */
} snow_ranks_options;
SNOW_RECORD(snow_ranks_options);

/* Opens this rank's part of a volume, with the ghost voxels that the view
 * needs. No rank holds the whole, but rank 0 of a pipe; a file is read once.
 * The transfer function is that of the whole, to the bit; NULL where `how` has
 * one. Errors: of snow_volume_open, snow_transfer_new_for_volume,
 * snow_frame_render; BAD_INPUT (ranks see different files). */
SNOW_API snow_status snow_ranks_open(snow_comm *comm, const char *path,
    const snow_volume_options *options, const snow_look *look,
    const snow_view *view, const snow_settings *settings,
    const snow_ranks_options *how, snow_volume **volume,
    snow_transfer **transfer);

/* Makes the parts serve another view or settings: voxels move where they do
 * not, and *volume is closed and replaced. */
SNOW_API snow_status snow_ranks_repartition(snow_comm *comm,
    const snow_transfer *transfer, const snow_view *view,
    const snow_settings *settings, const snow_ranks_options *how,
    snow_volume **volume);

/* The same before each picture of a frame, `left` of which are to come, this
 * one included; with SNOW_PARTITION_MEASURED also where ranks' times differ. */
SNOW_API snow_status snow_ranks_rebalance(snow_frame *frame, snow_comm *comm,
    const snow_transfer *transfer, const snow_view *view,
    const snow_settings *settings, const snow_ranks_options *how, int64_t left,
    snow_volume **volume);

/* Of the whole, whose parts the ranks' volumes are. */
SNOW_API snow_status snow_ranks_new_transfer(snow_comm *comm,
    const snow_volume *volume, const snow_look *look, snow_transfer **out);

/* Moves a view's target and multiplies its zoom so that what a look shows from
 * each azimuth (NULL: the view's) fills the picture but for 4 % at the edges
 * (docs/model.md, point 2). Collective, unless `comm` is NULL. */
SNOW_API snow_status snow_view_fit(snow_comm *comm, const snow_volume *volume,
    const snow_transfer *transfer, const snow_settings *settings,
    const double *azimuths, size_t count, snow_view *view);

/* Not collective: the boxes of `ranks` ranks along `slice_axis` (0 to 2),
 * without ghosts, and their interesting voxels; either may be NULL. */
SNOW_API snow_status snow_ranks_partition(const snow_volume *volume,
    const snow_transfer *transfer, double threshold, snow_partition cut,
    int slice_axis, int ranks, snow_box *parts, int64_t *loads);

/* The picture, on rank 0; NULL on the others, unless it is scattered. Parts are
 * boxes with an order from front to back and the ghosts that the view needs; a
 * rank may own none. The picture is that of snow_frame_render within 1/255; to
 * the bit with settings->deterministic and parts of snow_ranks_open. Free the
 * frame before the communicator. Errors: of snow_frame_render; BAD_USAGE (parts
 * that overlap, leave voxels out, have too few ghosts or no order). */
SNOW_API snow_status snow_ranks_render(snow_frame *frame, snow_comm *comm,
    const snow_volume *volume, const snow_transfer *transfer,
    const snow_view *view, const snow_settings *settings,
    const snow_ranks_options *how, snow_image **image);

/* The same bits in two halves: begin 0; begin 1, finish 0; begin 2, finish 1;
 * and so on. A picture is combined while the next is splatted; at most two are
 * in flight. All but frame and communicator may change after begin, which
 * leaves failures of the picture to finish. Errors: of snow_ranks_render. */
SNOW_API snow_status snow_ranks_begin(snow_frame *frame, snow_comm *comm,
    const snow_volume *volume, const snow_transfer *transfer,
    const snow_view *view, const snow_settings *settings,
    const snow_ranks_options *how);
SNOW_API snow_status snow_ranks_finish(snow_frame *frame, snow_image **image);

/* Not collective: what the last picture by several ranks took on this one, with
 * processor time of the calling thread (threads 1) or of the process. */
typedef struct snow_ranks_stats {
    size_t size;
    int ranks; /* that made the picture; 1 of snow_frame_render */
    double seconds_combine, seconds_gather; /* stages of several ranks */
    double seconds_hidden; /* of splatting, done in place of waiting */
    double cpu_splat;      /* all up to the local image; of one rank, all */
    double cpu_combine, cpu_warp, cpu_gather;
    int rounds, radices[16]; /* ranks that exchange at once in each round */
    int64_t active_pixels;   /* of this rank's local image */
    uint64_t bytes_early;    /* of it, sent while the rest was still drawn */
} snow_ranks_stats;
SNOW_RECORD(snow_ranks_stats);
SNOW_API const snow_ranks_stats *snow_frame_ranks_stats(const snow_frame *);

#endif
