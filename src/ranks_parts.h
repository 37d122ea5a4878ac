/* ranks_parts.h - one picture by many processors: what its steps share.
 *
 *   ranks_render.c   the steps, and what ranks agree on
 *   ranks_layers.c   the exchange of deterministic pictures
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
    /* Deterministic pictures have a layer for each node. */
    int layers;
    snow_group_node nodes[SNOW_NODES_MOST];
    size_t layer_floats;                   /* from layer to layer */
    snow_rectangle drawn[SNOW_NODES_MOST]; /* all else is transparent */
} snow_local;

/* What a frame keeps for pictures by many ranks. */
struct snow_ranks {
    snow_context *context;
    snow_comm *comm; /* that all below is for */
    snow_combiner *combiner;
    /* Every rank's part, shared when one has changed. */
    uint64_t serial; /* of the volume that `parts` were shared for */
    snow_part *parts;
    snow_box *boxes;
    int *order; /* ranks from front to back */
    /* Pieces of the combined image, pixels. */
    int64_t *firsts, *counts;
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
