/* parallel/internal.h - one picture by many processors: what its steps share.
 *
 *   ranks.c          what a frame keeps
 *   clock.c          their time, which stands while another picture is drawn
 *   pipeline.c       which pictures are under way
 *   render.c         the combiner of many ranks: its operations
 *   exchange.c       local images to pieces, these to the picture on rank 0
 *   deterministic.c  the exchange of deterministic pictures
 *   modes.c          what modes other than over and depths add to it
 *   region.c         a rank's piece of the combined image to pixels of the
 *                    picture, and these to rank 0 */
#ifndef SNOW_PARALLEL_INTERNAL_H
#define SNOW_PARALLEL_INTERNAL_H

#include "combine/exchange.h"
#include "image/image.h"
#include "render/picture.h"
#include "render/shear_warp/warping.h"

/* The local image of a rank: in shear-warp an intermediate image; else
 * pixels of the picture, without tiles. */
typedef struct snow_local {
    snow_shear_warp_image image;
    snow_composite_op composite_op;        /* of other modes than over */
    snow_rectangle drawn[SNOW_NODES_MOST]; /* of layers, and all else is
                                              transparent */
} snow_local;

/* One picture on its way.  The driver (frame.c) knows the picture in it only,
 * which is its first member. */
typedef struct snow_in_flight {
    snow_picture picture;
    snow_ranks *ranks;
    snow_ranks_options how;
    snow_volume *held; /* while it is drawn; or NULL */
    /* Copied from the volume, which may be freed before they are sent. */
    snow_extent part;
    snow_left_out left_out;
    uint64_t generation;
    snow_local local;         /* what is exchanged of picture.local */
    snow_image_region region; /* of the combined image, this rank's */
    /* On ranks that keep pixels: what is not the picture yet, its pairs
     * (snow_modes_value_weight) or one axis' share. */
    snow_image *gathered;
    unsigned char *bytes;
    double mark, mark_cpu; /* when this call began, */
    double drawn_cpu;      /* and when its local image was */
    double overlapped;     /* seconds it was drawn that the clock stood */
    bool turn;             /* depths: alphas of those in front have come */
    /* What became of it: on this rank, or, when it is done, on all. */
    snow_status status;
    char message[SNOW_MESSAGE_BYTES]; /* of a failure */
    bool done;
} snow_in_flight;

static inline snow_in_flight *snow_in_flight_of(snow_picture *picture) {
    return (snow_in_flight *)picture;
}

/* Pictures under way at the same time: one is combined, one is drawn. */
#define SNOW_PICTURES_MOST 2

/* What a frame keeps for pictures by many ranks. */
struct snow_ranks {
    snow_context *context;
    snow_comm *comm; /* that all below is for */
    snow_combiner *combiner;
    snow_in_flight *pictures; /* SNOW_PICTURES_MOST, in turn */
    int first, in_flight;     /* the oldest; how many */
    snow_in_flight *drawn; /* not ended yet, in waits for messages; or NULL */
    double overlapped;     /* seconds of that, of all pictures */
    double overlapped_cpu; /* the same in processor time */
    bool standing;         /* the clock, since then: */
    double since, since_cpu;
    double begin_at; /* where drawing begins (snow_shear_warp_params) */
    /* Every rank's part, shared when one has changed. */
    uint64_t generation; /* of the volume that `parts` were shared for */
    snow_extent *parts;
    snow_box *boxes;
    int *order;         /* ranks from front to back, */
    snow_viewer viewer; /* for him, */
    uint64_t ordered;   /* of the parts of that generation; 0: of none */
    /* Pieces of the combined image, pixels. */
    int64_t *firsts, *counts;
    /* The range of values that all have agreed on, for a volume of which this
     * rank has the generation; 0: it is not known. */
    snow_data_range values;
    uint64_t values_of;
    bool apart; /* the last picture was begun ahead by some ranks only */
    /* Active pixels of the picture before (snow_exchange_counts). */
    int64_t group_counts[SNOW_COUNTS_MOST];
    int groups;             /* 0: it was not counted */
    snow_message *messages; /* 2 for each rank */
    int rank, ranks;
    /* Layers that were sent and that came, the piece made of them, its halves;
     * lines around a piece; footprint methods' images of nodes. */
    char *sent, *came;
    float *region, *lines, *images;
    size_t *offsets; /* in `sent` and `came`, per rank */
    /* This rank's pixels of the picture: runs, and pixels packed. */
    snow_pixel_run *runs;
    unsigned char *packed;
    float *rows; /* of the threads */
    size_t run_count;
};

/* Collective.  Makes frame->ranks that of a communicator. */
snow_status snow_ranks_of(snow_frame *frame, snow_comm *comm);

/* The n-th picture under way, the oldest first. */
static inline snow_in_flight *snow_in_flight_at(const snow_ranks *r, int n) {
    return &r->pictures[(r->first + n) % SNOW_PICTURES_MOST];
}

/* Ends its drawing, and what it was made with. */
void snow_in_flight_end(snow_in_flight *in_flight);

/* Returns whether pictures are under way whose local images the frame holds. */
bool snow_ranks_busy(const snow_ranks *ranks);

/* The communicator's clock, which stands while pictures are drawn ahead, or
 * while they are exchanged. */
double snow_ranks_clock(const snow_ranks *ranks);

/* Processor time for a picture (snow_ranks_stats.cpu_splat), which stands
 * alike. */
double snow_in_flight_cpu(const snow_in_flight *in_flight);

/* Figure 8's driver (frame.c) makes pictures between these.  Opens a place for
 * one, whose combiner is that of one process where there is one rank. */
snow_status snow_pipeline_open(snow_frame *frame, snow_comm *comm,
                               const snow_settings *settings,
                               const snow_ranks_options *how,
                               snow_picture **picture);

/* It is begun: one that is ahead is drawn from now on while others wait. */
void snow_pipeline_begun(snow_picture *picture, snow_status status);

/* The oldest picture that is not done, or NULL; and the oldest one, unless it
 * is done. */
snow_picture *snow_pipeline_waiting(const snow_frame *frame);
snow_picture *snow_pipeline_oldest(const snow_frame *frame);

/* Collective.  Before the rest of it is made: what became of its beginning on
 * this rank; and after that. */
snow_status snow_pipeline_resume(snow_picture *picture);
void snow_pipeline_done(snow_picture *picture, snow_status status);

/* The oldest picture is the caller's. */
snow_status snow_pipeline_take(snow_frame *frame, snow_image **image);

/* Draws a band of the picture in flight; false when no band is left to begin.
 * The clock of the exchange is stopped meanwhile, and the time is recorded. */
bool snow_ranks_draw(snow_ranks *ranks);
double snow_ranks_pause(snow_ranks *ranks);

/* Ends its drawing: its turn has come, or another's to be drawn. */
void snow_ranks_drain(snow_ranks *ranks);

/* The combiner of many ranks. */
extern const snow_combine_ops snow_combine_ranks;

/* Returns whether this rank keeps pixels of the picture. */
static inline bool snow_in_flight_keeps(const snow_in_flight *f) {
    return f->ranks->rank == 0 || f->how.scattered;
}

/* Local work: what is exchanged of the local image of a job, its order among
 * the ranks, and room. */
snow_status snow_in_flight_prepare(snow_in_flight *in_flight,
                                   const snow_job *job);

/* Collective.  Local images to pieces: lines 14 to 18. */
snow_status snow_in_flight_exchange(snow_in_flight *in_flight,
                                    const snow_job *job);

/* Collective.  Pieces to pixels of rank 0's `image`, of job->channels. */
snow_status snow_in_flight_deliver(snow_in_flight *in_flight,
                                   const snow_job *job, int pixel_bits,
                                   snow_image *image);

/* Local work: ranks->order for a view, kept from picture to picture.  Errors:
 * those of snow_order_boxes. */
snow_status snow_ranks_put_in_order(snow_ranks *ranks,
                                    const snow_placement *placement);

/* Cleared room in ranks->images for layers of a job's local pixels. */
snow_status snow_in_flight_capacity(snow_in_flight *in_flight,
                                    const snow_job *job, int layers);

/* Collective.  The range of all parts into the frame's identity transfer
 * function. */
snow_status snow_in_flight_agree_range(snow_in_flight *in_flight);

/* Collective.  The range of all parts, for shear-warp. */
snow_status snow_in_flight_agree_values(snow_in_flight *in_flight);

/* Returns whether it is known already: the same on all ranks, unless only some
 * have a new volume. */
bool snow_in_flight_knows_values(const snow_in_flight *in_flight);

/* Local work: makes it known for a picture without asking the others. */
snow_status snow_in_flight_recall_values(snow_in_flight *in_flight);

/* Local work: colours or values of the pairs that were gathered. */
snow_status snow_in_flight_paint(snow_in_flight *in_flight);

/* Rounds pixels as if they had travelled as bytes. */
static inline void snow_round_pixels(snow_image *image) {
    size_t count =
        (size_t)image->width * (size_t)image->height * (size_t)image->channels;
    for (size_t n = 0; n < count; n++)
        image->pixels[n] =
            (float)(unsigned char)(image->pixels[n] * 255 + 0.5f) / 255;
}

/* Collective.  Depths of over: a place for the local ones and alphas from the
 * rank in front, if no rank has failed; alphas to the one behind. */
snow_status snow_in_flight_take_turn(snow_in_flight *in_flight,
                                     snow_status status);
snow_status snow_in_flight_give_turn(snow_in_flight *in_flight,
                                     snow_status status);

/* Collective.  The nearest of the ranks' depths to rank 0's picture. */
snow_status snow_in_flight_combine_depths(snow_in_flight *in_flight);

/* Local work: makes room for the exchange of layers, which are this rank's
 * nodes.  `ranks->boxes` are slabs along the slice axis. */
snow_status snow_layers_prepare(snow_ranks *ranks, const snow_local *local,
                                const snow_placement *placement);

/* Collective.  Lays all layers over one another by the tree of groups; pieces
 * are equal runs of lines.  Errors: those of the transport. */
snow_status snow_layers_exchange(snow_ranks *ranks, const snow_local *local,
                                 const snow_placement *placement,
                                 snow_image_region *out);

/* Local work: room for the lines around a piece. */
snow_status snow_lines_prepare(snow_ranks *ranks,
                               const snow_shear_warp_image *image);

/* Collective.  Puts this rank's piece, and the lines around it that its warp
 * may read, into the place of its intermediate image.  Errors: those of the
 * transport. */
snow_status snow_lines_exchange(snow_ranks *ranks,
                                const snow_shear_warp_image *image,
                                const snow_image_region *region);

/* Local work: this rank's pixels of the picture, into ranks->runs and packed:
 * of an intermediate image, or of a piece of the picture itself. */
snow_status snow_pixels_warp(snow_ranks *ranks,
                             const snow_shear_warp_image *image,
                             const snow_job *job,
                             const snow_image_region *region, int pixel_bits);
snow_status snow_pixels_copy(snow_ranks *ranks, const snow_job *job,
                             const snow_image_region *region, int pixel_bits);

/* Collective.  Brings them to rank 0's `image`, which is transparent, as bytes
 * (pixel_bits 8) or floats (0). */
snow_status snow_pixels_gather(snow_in_flight *in_flight, const snow_job *job,
                               int pixel_bits, snow_image *image);

#endif
