/* snowglass/ranks.h - one picture by many processors: section 4 of the paper.
 *
 * Every rank holds a part of the volume (snow_extent), splats it into a local
 * image, and the local images are combined.  All calls are collective
 * (snowglass/comm.h): every rank makes them with the same arguments. */
#ifndef SNOWGLASS_RANKS_H
#define SNOWGLASS_RANKS_H

#include <snowglass/comm.h>
#include <snowglass/render.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How the volume is cut. */
typedef enum snow_partition {
    SNOW_PARTITION_AUTO =
        0,                /* by count; into bricks where slabs would be thin */
    SNOW_PARTITION_EQUAL, /* the paper's slabs: as equal as can be */
    SNOW_PARTITION_COUNTED, /* slabs of about equally many interesting voxels */
    SNOW_PARTITION_BRICKS,  /* boxes of about equally many interesting voxels */
    SNOW_PARTITION_MEASURED /* as AUTO, and for later pictures by the time that
                         the first ones took (snow_ranks_rebalance) */
} snow_partition;

/* How local images are combined. */
typedef enum snow_combine {
    SNOW_COMBINE_AUTO = 0, /* by the number of ranks and the image's size */
    SNOW_COMBINE_TREE,     /* the paper's hierarchy */
    SNOW_COMBINE_SWAP,     /* binary swap */
    SNOW_COMBINE_DIRECT,   /* direct send */
    SNOW_COMBINE_RADIX     /* radix-k */
} snow_combine;

/* Zeros are the defaults. */
typedef struct snow_ranks_options {
    size_t size;
    snow_partition cut;
    snow_combine combining;
    int radix;      /* of SNOW_COMBINE_RADIX, 2 to 64; 0: chosen */
    int pixel_bits; /* 8: the picture's channels are rounded to whole steps of
                       1/255 before they travel to rank 0 (a quarter of the
                       bytes); 0: floats travel */
    bool turns;     /* pictures from other sides will follow, at this
                       zoom; parts get ghost voxels enough for all of them */
    bool scattered; /* the picture stays where it is made: each rank's
                       image has the pixels that are its own, and the others
                       transparent; together they are the picture */
    const snow_transfer *transfer; /* for snow_ranks_open: what pictures will be
                       drawn by, the same on all ranks, as with a look that all
                       steps of a movie share; it counts voxels by it and makes
                       none.  NULL: it makes the one that the look asks for */
} snow_ranks_options;
SNOW_RECORD(snow_ranks_options);

/* Opens this rank's part of a volume (snow_volume_get_extent), with the ghost
 * voxels around it that kernels of the view and gradients reach.  The cut
 * depends on the view (slabs lie along its slice axis) and, where it is by
 * count, on transfer function and threshold.
 *
 * No rank reads or stores the whole.  For equal slabs each reads its box of the
 * file; for other cuts each reads an equal share of the slices, which is
 * counted, and then voxels change hands, so that the file is read once.  A
 * packed file is unpacked by all, each keeping its share.  A pipe or standard
 * input is read by rank 0, which then needs the memory for all.
 *
 * The transfer function is the one that `look` asks for on the whole volume, to
 * the bit, on all ranks; NULL where `how` has one.  All results are new, and
 * the caller's.  Errors, on all ranks: those of snow_volume_open,
 * snow_transfer_new_for_volume and snow_frame_render; SNOW_STATUS_BAD_INPUT
 * where ranks see different files. */
SNOW_API snow_status snow_ranks_open(
    snow_comm *comm, const char *path, const snow_volume_options *options,
    const snow_look *look, const snow_view *view, const snow_settings *settings,
    const snow_ranks_options *how, snow_volume **volume,
    snow_transfer **transfer);

/* Sees to it that the parts serve another view, or other settings: where slabs
 * lie along another axis than its slices, or ghost voxels are too few, the
 * volume is cut anew and voxels change hands; no file is read.  *volume is then
 * closed and replaced.  Where nothing has to change, nothing but one small
 * message round is done.  `transfer` is the same on all ranks. */
SNOW_API snow_status snow_ranks_repartition(snow_comm *comm,
                                            const snow_transfer *transfer,
                                            const snow_view *view,
                                            const snow_settings *settings,
                                            const snow_ranks_options *how,
                                            snow_volume **volume);

/* The same before one of many pictures, of which `left` are to come, this one
 * with them; called before each of a frame.  With SNOW_PARTITION_MEASURED parts
 * are also cut anew where the ranks' last pictures took unequally long, in
 * processor time up to the local image, and where that is made good within the
 * pictures that are left: an interesting voxel then costs what those of its
 * rank took. Pictures are those of any other cut, within what snow_ranks_render
 * says. Parts of deterministic pictures, and with any other cut, are not
 * touched by time.  One small message round more. */
SNOW_API snow_status snow_ranks_rebalance(snow_frame *frame, snow_comm *comm,
                                          const snow_transfer *transfer,
                                          const snow_view *view,
                                          const snow_settings *settings,
                                          const snow_ranks_options *how,
                                          int64_t left, snow_volume **volume);

/* snow_transfer_new_for_volume for the whole that the ranks' volumes are parts
 * of. */
SNOW_API snow_status snow_ranks_new_transfer(snow_comm *comm,
                                             const snow_volume *volume,
                                             const snow_look *look,
                                             snow_transfer **out);

/* Not collective: how a whole volume would be cut for `ranks` ranks with slices
 * along `slice_axis` (0 to 2).  `parts` (without ghosts) and `loads`, the
 * interesting voxels of each, have as many entries; either may be NULL.
 * Errors: SNOW_STATUS_BAD_USAGE (ranks below 1, no such axis or cut),
 * SNOW_STATUS_NO_MEMORY.
 */
SNOW_API snow_status snow_ranks_partition(const snow_volume *volume,
                                          const snow_transfer *transfer,
                                          double threshold, snow_partition cut,
                                          int slice_axis, int ranks,
                                          snow_box *parts, int64_t *loads);

/* Collective.  The picture, on rank 0; NULL on the others, unless it is
 * scattered.
 *
 * Every rank's volume is its part (snow_volume_set_extent) of one whole, with
 * the ghost voxels that the view needs; each voxel is one rank's own, and a
 * rank may own none.  Parts may be any boxes that have an order from front to
 * back: slabs, a grid, a k-d tree.  The picture is that of snow_frame_render of
 * the whole but for rounding, and where it is opaque within one step of 8 bits:
 * half a step may shine through where the sheared method gives up a pixel,
 * which parts do later than the whole.  Where quality high blends pictures
 * along several axes, floats travel and the blend is rank 0's.
 *
 * Parts of a local image by the sheared method travel while the rest of it is
 * splatted (snow_ranks_stats.bytes_early); that changes no bit.
 *
 * With settings->deterministic it is the same bit for bit as
 * snow_frame_render's, for any number of ranks: parts then are slabs across the
 * view's slices, cut at borders of groups of slices (1/32 of them each), and a
 * blend of several axes is refused where there are several ranks.
 *
 * The frame belongs to the communicator's context, keeps buffers for it, and is
 * freed before it.  Errors, on all ranks alike: those of snow_frame_render, and
 * SNOW_STATUS_BAD_USAGE (parts that overlap, leave voxels out, have too few
 * ghosts or no order). */
SNOW_API snow_status snow_ranks_render(snow_frame *frame, snow_comm *comm,
                                       const snow_volume *volume,
                                       const snow_transfer *transfer,
                                       const snow_view *view,
                                       const snow_settings *settings,
                                       const snow_ranks_options *how,
                                       snow_image **image);

/* What the last picture by several ranks took on this one; all else is in
 * snow_stats. Processor time is that of the calling thread where it renders
 * alone (threads 1), else of the process. */
typedef struct snow_ranks_stats {
    size_t size;
    int ranks;              /* that made the picture; 1 of snow_frame_render */
    double seconds_combine; /* local images composited */
    double seconds_gather;  /* the picture brought to rank 0 */
    double seconds_hidden;  /* of splatting and compositing, done while the
                               thread would have waited for messages */
    double cpu_splat;       /* all up to the local image, encoding too; of a
                               group of one rank, the warp too */
    double cpu_combine, cpu_warp, cpu_gather;
    int rounds, radices[16]; /* of the combination: ranks that exchange at once
                                in each round, of at most 16 */
    int64_t active_pixels;   /* of this rank's local image */
    uint64_t bytes_early;    /* of the local image, sent while the rest of it
                                was still drawn */
} snow_ranks_stats;
SNOW_RECORD(snow_ranks_stats);

/* Owned by the frame; zeros but for `ranks` before the first picture. */
SNOW_API const snow_ranks_stats *
snow_frame_ranks_stats(const snow_frame *frame);

/* The same in two halves, for pictures one after another: while one is combined
 * and brought to rank 0, the next is splatted.
 *
 *   begin 0;  begin 1, finish 0;  begin 2, finish 1;  ...  finish n
 *
 * Two pictures may be under way; finish answers for the one begun first.  Where
 * waiting for messages, of this communicator and whatever collective call, a
 * rank splats the other picture, and so do its other threads
 * (settings->threads) all the time: snow_ranks_stats.seconds_hidden tells how
 * long. Pictures are the same to the bit.  Only the sheared method's are
 * splatted ahead, and not those blended of several axes: the others are wholly
 * made when they are begun.
 *
 * All that is handed over may be freed or changed after the begin, but for the
 * frame, which has a second local image then, and the communicator.  A begin
 * leaves what goes wrong with its picture to the finish, and fails with
 * SNOW_STATUS_BAD_USAGE (two pictures are under way, or one of another
 * communicator) or SNOW_STATUS_NO_MEMORY; then nothing is begun.  Pictures that
 * nobody finishes end with the frame.  Errors of finish: those of
 * snow_ranks_render, and SNOW_STATUS_BAD_USAGE (no picture is under way). */
SNOW_API snow_status snow_ranks_begin(snow_frame *frame, snow_comm *comm,
                                      const snow_volume *volume,
                                      const snow_transfer *transfer,
                                      const snow_view *view,
                                      const snow_settings *settings,
                                      const snow_ranks_options *how);
SNOW_API snow_status snow_ranks_finish(snow_frame *frame, snow_image **image);

#ifdef __cplusplus
}
#endif
#endif
