/* combine/combiner.h - the inside of a combiner: plans and buffers of the
 * exchange, and those of the gather. */
#ifndef SNOW_COMBINER_H
#define SNOW_COMBINER_H

#include "combine/active.h"
#include "combine/borders.h"
#include "combine/rounds.h"

/* Buffers of messages: one rank's, of one round.  Two take turns, since what
 * came in one round is merged into what goes out in the next. */
typedef struct snow_traffic {
    unsigned char *bytes;
    snow_message *messages;
    int count;
} snow_traffic;

/* Pixels first .. last - 1, and the share of the rounds that they go to. */
typedef struct snow_parcel {
    int64_t first, last;
    int share;
} snow_parcel;

/* What all sizes of buffers depend on; the same on all ranks, so that all take
 * memory at the same time and can agree on it. */
typedef struct snow_exchange_shape {
    int width, height, channels, radix, grain;
    snow_combining method;
    snow_pieces pieces;
    bool whole;
} snow_exchange_shape;

/* Bytes that the busiest seat of all needs: views change seats, and seats alone
 * shall change no buffer.  Rounds with even and with odd numbers have buffers
 * of their own. */
#define SNOW_NEEDS 6
typedef union snow_exchange_needs {
    size_t bytes[SNOW_NEEDS];
    struct {
        size_t in[2], out[2], words, piece;
    };
} snow_exchange_needs;

/* The buffers of a gather (gather.c). */
typedef struct snow_gather_state {
    int radix; /* as told; 0: chosen */
    /* What the buffers are for; width 0: there are none. */
    int width, height, used_radix;
    size_t pixel_bytes;
    int *children;           /* ranks that send to this one */
    int child_count, parent; /* parent -1: the display processor */
    unsigned char *bytes;    /* blocks, this rank's first; NULL where no child
                                is */
    size_t room;
    unsigned char *own; /* this rank's block there; at first NULL */
    size_t own_room;
    unsigned char *slots;   /* the beginning of each child's message */
    snow_message *messages; /* of each child: its beginning, its rest */
    size_t *places;         /* where each child's blocks lie in bytes */
    int *queue;             /* children with long messages, in order */
    /* Of snow_gather_piece: the piece's active pixels, for so many pixels. */
    snow_pixel_run *runs;
    unsigned char *packed;
    int64_t packed_room;
    size_t packed_bytes; /* a pixel */
} snow_gather_state;

struct snow_combiner {
    snow_comm *comm;
    snow_exchange_shape shape; /* width 0: there are no buffers */
    snow_exchange_needs needs; /* what buffers have room for */
    const snow_pixel_loops *loops;
    snow_rounds rounds;
    bool filled; /* the lists of `rounds`, for its seat and display */
    snow_borders borders;
    int64_t counts[SNOW_BINS_MOST]; /* snow_exchange_counts */
    int counted_bins;
    int *lines;           /* the order of lines, NULL for the picture's */
    int *ranks;           /* of seats, as in the last order */
    int *table;           /* of snow_rounds_fill */
    snow_parcel *parcels; /* of one round, that are not sent yet */
    snow_active *layers;  /* of one round */
    uint64_t *words;      /* their masks */
    uint64_t *part;       /* the mask of what is about to be sent */
    snow_traffic in[2], out[2];
    float *piece;
    snow_exchange_figures figures;
    double scan_seconds, blend_seconds; /* of the last order */
    snow_gather_state gather;
};

void snow_gather_free(snow_combiner *combiner);

#endif
