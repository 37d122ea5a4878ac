/* ranks_parts.h - one picture by many processors: what its steps share.
 *
 *   ranks_flight.c   which pictures are under way
 *   ranks_render.c   the steps of one, and what ranks agree on
 *   ranks_layers.c   the exchange of deterministic pictures
 *   ranks_modes.c    pictures in modes other than over, and depths
 *   ranks_piece.c    a rank's piece of the combined image to pixels of the
 *                    picture, and these to rank 0 */
#ifndef SNOW_RANKS_PARTS_H
#define SNOW_RANKS_PARTS_H

#include "combine/exchange.h"
#include "frame.h"

/* The local image of a rank: in the sheared method an intermediate image. */
typedef struct snow_local {
    int width, height, channels;
    size_t stride; /* floats from line to line */
    const float *pixels;
    snow_laying laying; /* of other modes than over */
    /* Deterministic pictures have a layer for each node. */
    int layers;
    snow_group_node nodes[SNOW_NODES_MOST];
    size_t layer_floats;                   /* from layer to layer */
    snow_rectangle drawn[SNOW_NODES_MOST]; /* all else is transparent */
} snow_local;

/* One axis' share of a picture on its way. */
typedef struct snow_axis_work {
    snow_placement placement;
    snow_sheared_order order;
    snow_sheared *sheared;
    snow_sheared_image image;
    snow_local local;
} snow_axis_work;

/* One picture on its way. */
typedef struct snow_picture {
    snow_frame *frame;
    snow_ranks *ranks;
    snow_view view; /* as job.view */
    snow_job job;   /* without volume and transfer function while it draws */
    snow_ranks_options how;
    /* Of the volume, which may be gone when the others are told. */
    snow_part part;
    uint64_t serial;
    snow_image *image; /* on rank 0 */
    snow_image *depth; /* of it, for the frame; on rank 0 or NULL */
    unsigned char *bytes;
    snow_axis_work work; /* of a picture along one axis */
    snow_stats stats;
    double apart; /* seconds it was drawn that the clock stood */
    /* What became of it: on this rank, or, when it is done, on all. */
    snow_status status;
    char message[SNOW_MESSAGE_BYTES]; /* of a failure */
    bool ahead;   /* its local image is begun before it is asked for */
    bool drawing; /* which is not ended */
    bool done;
} snow_picture;

/* Pictures under way at the same time: one is combined, one is drawn. */
#define SNOW_PICTURES_MOST 2

/* What a frame keeps for pictures by many ranks. */
struct snow_ranks {
    snow_context *context;
    snow_comm *comm; /* that all below is for */
    snow_combiner *combiner;
    snow_picture *pictures; /* SNOW_PICTURES_MOST, in turn */
    int first, under_way;   /* the oldest; how many */
    snow_picture *drawn;    /* not ended yet, in waits for messages; or NULL */
    double apart;           /* seconds of that, of all pictures */
    double apart_cpu;       /* the same in processor time */
    bool standing;          /* the clock, since then: */
    double since, since_cpu;
    double begin_at; /* where drawing begins (snow_sheared_order) */
    /* Every rank's part, shared when one has changed. */
    uint64_t serial; /* of the volume that `parts` were shared for */
    snow_part *parts;
    snow_box *boxes;
    int *order; /* ranks from front to back */
    /* Pieces of the combined image, pixels. */
    int64_t *firsts, *counts;
    /* Active pixels of the picture before (snow_exchange_counts). */
    int64_t group_counts[SNOW_COUNTS_MOST];
    int groups;             /* 0: it was not counted */
    snow_message *messages; /* 2 for each rank */
    int rank, ranks;
    /* Layers that were sent and that came, the piece made of them, its halves;
     * lines around a piece; exact methods' images of nodes. */
    char *sent, *came;
    float *piece, *lines, *images;
    size_t sent_capacity, came_capacity, piece_capacity, lines_capacity,
        images_capacity; /* bytes, as all capacities */
    size_t *offsets;     /* in `sent` and `came`, per rank */
    /* This rank's pixels of the picture: runs, and pixels packed. */
    snow_pixel_run *runs;
    unsigned char *packed;
    float *rows; /* of the threads */
    size_t runs_capacity, packed_capacity, rows_capacity;
    size_t run_count;
};

void snow_ranks_free(snow_ranks *ranks);

/* Whether pictures are under way whose local images the frame holds. */
bool snow_ranks_busy(const snow_ranks *ranks);

/* The communicator's clock, which stands while pictures are drawn ahead, or
 * while they are exchanged. */
double snow_ranks_clock(const snow_ranks *ranks);

/* Processor time for a picture (snow_stats.cpu_splat), which stands alike. */
double snow_picture_cpu(const snow_picture *picture);

/* Not collective: the beginning of a picture, up to its local image where that
 * may be drawn ahead; `aside`: of another the local image is still needed. What
 * fails is left in the picture. */
void snow_picture_begin(snow_picture *picture, const snow_volume *volume,
                        const snow_transfer *transfer,
                        const snow_settings *settings, bool aside);

/* Draws a band of the picture that is drawn, while the clock stands; false:
 * none is left to begin.  Lets the clock go on, and tells for how long it
 * stood. */
bool snow_ranks_draw(snow_ranks *ranks);
double snow_ranks_pause(snow_ranks *ranks);

/* Ends its drawing: its turn has come, or another's to be drawn. */
void snow_ranks_settle(snow_ranks *ranks);

/* Collective.  All the rest.  What failed, on all ranks alike. */
snow_status snow_picture_combine(snow_picture *picture);

/* The steps of it: local work, whether there is an exchange of an intermediate
 * image, what it needs; collective, that and the warp, with all pixels of
 * `job.channels` to `image` of rank 0. */
snow_status snow_picture_prepare(snow_picture *picture, snow_axis_work *work);
snow_status snow_picture_combine_axis(snow_picture *picture,
                                      const snow_axis_work *work,
                                      int pixel_bits, snow_image *image);

/* The same of an exact local image. */
snow_status snow_picture_prepare_exact(snow_picture *picture,
                                       const snow_local *local);
snow_status snow_picture_combine_exact(snow_picture *picture,
                                       const snow_local *local, int pixel_bits,
                                       snow_image *image);

/* Not collective: whether a picture in the job's mode can be one of many
 * ranks. */
snow_status snow_picture_check_mode(const snow_picture *picture);

/* Collective.  A picture in a mode other than over, `picture->image` of which
 * is made but for mode iso. */
snow_status snow_picture_render_mode(snow_picture *picture);

/* Collective.  The depth of a picture in mode over that is made. */
snow_status snow_picture_render_depth(snow_picture *picture);

/* Keeps the present failure of the context. */
void snow_picture_fail(snow_picture *picture, snow_status status);

/* How pixels travel to rank 0. */
typedef struct snow_delivery {
    int pixel_bits;       /* 8: as bytes; 0: as floats */
    snow_image *image;    /* of rank 0, transparent; elsewhere NULL */
    unsigned char *bytes; /* of rank 0 where pixels are bytes, cleared */
    snow_stats *stats;
} snow_delivery;

/* Local work: makes room for the exchange of layers, which are this rank's
 * nodes.  `ranks->boxes` are slabs along `axis`. */
snow_status snow_layers_prepare(snow_ranks *ranks, const snow_local *local,
                                const snow_placement *placement);

/* Collective.  Lays all layers over one another by the tree of groups; pieces
 * are equal runs of lines.  Errors: those of the transport. */
snow_status snow_layers_exchange(snow_ranks *ranks, const snow_local *local,
                                 const snow_placement *placement,
                                 snow_piece *out);

/* Local work: room for the lines around a piece. */
snow_status snow_lines_prepare(snow_ranks *ranks, const snow_local *local);

/* Collective.  Puts this rank's piece, and the lines around it that its warp
 * may read, into the place of its intermediate image.  Errors: those of the
 * transport. */
snow_status snow_lines_exchange(snow_ranks *ranks,
                                const snow_sheared_image *image,
                                const snow_piece *piece);

/* Local work: this rank's pixels of the picture, into ranks->runs and packed:
 * of an intermediate image, or of a piece of the picture itself. */
snow_status snow_pixels_warp(snow_ranks *ranks, const snow_sheared_image *image,
                             const snow_job *job, const snow_piece *piece,
                             int pixel_bits);
snow_status snow_pixels_copy(snow_ranks *ranks, const snow_job *job,
                             const snow_piece *piece, int pixel_bits);

/* Collective.  Brings them to rank 0. */
snow_status snow_pixels_gather(snow_ranks *ranks, const snow_job *job,
                               const snow_delivery *delivery);

#endif
