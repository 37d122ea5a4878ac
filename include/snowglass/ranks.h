/* snowglass/ranks.h - one picture by many processors: the paper's section 4.
 *
 * Every rank holds a part of the volume (snow_extent) and renders it into a
 * local image; the local images are combined (docs/scaling.md,
 * docs/combining.md). All calls but those that say otherwise are collective,
 * with the same arguments on all ranks. */
#ifndef SNOWGLASS_RANKS_H
#define SNOWGLASS_RANKS_H

#include <snowglass/comm.h>
#include <snowglass/render.h>

/* How the volume is partitioned. */
typedef enum snow_partition {
    SNOW_PARTITION_AUTO = 0, /* counted; bricks where slabs would be thin */
    SNOW_PARTITION_EQUAL,    /* the paper's slabs: as equal as can be */
    SNOW_PARTITION_COUNTED,  /* slabs of about equal cost */
    SNOW_PARTITION_BRICKS    /* boxes of equally many interesting voxels */
} snow_partition;

/* How local images are combined. */
typedef enum snow_combine {
    SNOW_COMBINE_AUTO = 0, /* by the number of ranks and the image's size */
    SNOW_COMBINE_TREE,     /* the paper's hierarchy */
    SNOW_COMBINE_SWAP,     /* binary swap */
    SNOW_COMBINE_DIRECT,   /* direct send */
    SNOW_COMBINE_RADIX     /* radix-k */
} snow_combine;

/* How ranks share the work of a picture. */
typedef struct snow_ranks_options {
    size_t size;
    snow_partition cut;     /* the partition of the volume */
    snow_combine combining; /* of the local images */
    int radix;              /* of SNOW_COMBINE_RADIX, 2 to 64; 0: chosen */
    int pixel_bits;         /* 8: levels travel to rank 0; 0: floats */
    bool turns;     /* parts get ghost voxels for all directions at this zoom */
    bool scattered; /* each rank's image has its own pixels; they add up */
    const snow_transfer *transfer; /* for snow_ranks_open, instead of a look */
    bool one_look; /* parts may lack what the look of opening does not show */
} snow_ranks_options;
SNOW_RECORD(snow_ranks_options);

/* Opens this rank's part of a volume, with the ghost voxels that the view
 * needs; it stays in its file where a limit of memory has no room for it.
 * *transfer is the transfer function of the whole, or NULL where `how` has one.
 * Errors: of snow_volume_open, snow_frame_render and
 * snow_transfer_new_for_volume; BAD_INPUT (the ranks' files differ). */
SNOW_API snow_status snow_ranks_open(snow_comm *comm, const char *path,
    const snow_volume_options *options, const snow_look *look,
    const snow_view *view, const snow_settings *settings,
    const snow_ranks_options *how, snow_volume **volume,
    snow_transfer **transfer);

/* Makes the parts serve another view or settings. Where they do not, voxels
 * move between ranks, and *volume is closed and replaced. */
SNOW_API snow_status snow_ranks_repartition(snow_comm *comm,
    const snow_transfer *transfer, const snow_view *view,
    const snow_settings *settings, const snow_ranks_options *how,
    snow_volume **volume);

/* Makes the transfer function of the whole, whose parts the ranks' volumes are.
 * Errors: as snow_transfer_new_for_volume. */
SNOW_API snow_status snow_ranks_new_transfer(snow_comm *comm,
    const snow_volume *volume, const snow_look *look, snow_transfer **out);

/* Not collective. Finds the boxes of `ranks` ranks along `slice_axis` (0 to 2),
 * without ghost voxels, and their interesting voxels; either may be NULL. */
SNOW_API snow_status snow_ranks_partition(const snow_volume *volume,
    const snow_transfer *transfer, double threshold, snow_partition cut,
    int slice_axis, int ranks, snow_box *parts, int64_t *loads);

/* Renders a picture. It is on rank 0, and *image is NULL on the others; of a
 * scattered one each rank has its pixels. It is that of snow_frame_render
 * within 1/255, or to the bit with settings->deterministic and parts of
 * snow_ranks_open. A rank may own no part. Free the frame before the
 * communicator. Errors: of snow_frame_render; BAD_USAGE (parts that overlap,
 * leave voxels out, have too few ghosts or no order from front to back). */
SNOW_API snow_status snow_ranks_render(snow_frame *frame, snow_comm *comm,
    const snow_volume *volume, const snow_transfer *transfer,
    const snow_view *view, const snow_settings *settings,
    const snow_ranks_options *how, snow_image **image);

/* Begins a picture, which snow_ranks_finish completes, with the same bits as
 * snow_ranks_render. In the order begin 0, begin 1, finish 0, begin 2, finish 1
 * a picture is combined while the next one is splatted. All arguments but frame
 * and communicator may change after begin; failures are returned by finish. */
SNOW_API snow_status snow_ranks_begin(snow_frame *frame, snow_comm *comm,
    const snow_volume *volume, const snow_transfer *transfer,
    const snow_view *view, const snow_settings *settings,
    const snow_ranks_options *how);

/* Completes the oldest picture that was begun. Errors: of snow_ranks_render. */
SNOW_API snow_status snow_ranks_finish(snow_frame *frame, snow_image **image);

/* Figures of the last picture by several ranks, on this one. Processor time is
 * that of the calling thread (threads 1), else of the process. */
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

/* Not collective. Returns these figures, which are the frame's. */
SNOW_API const snow_ranks_stats *snow_frame_ranks_stats(
    const snow_frame *frame);

#endif
