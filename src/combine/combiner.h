/* combine/combiner.h - the internals of a combiner: plans and buffers of the
 * exchange, and those of the gather. */
#ifndef SNOW_COMBINER_H
#define SNOW_COMBINER_H

#include "combine/active.h"
#include "combine/region_bounds.h"
#include "combine/rounds.h"

/* Message buffers of one rank and one round. Two are used alternately, since
 * what was received in one round is merged into what is sent in the next. */
typedef struct snow_traffic {
    unsigned char *bytes;
    snow_message *messages;
    snow_loan *loans; /* of the messages to and from ranks of this node */
    int count;
    snow_message *returns; /* of what was shared */
    int shared;
} snow_traffic;

/* Pixels first .. last - 1. */
typedef struct snow_stretch {
    int64_t first, last;
} snow_stretch;

/* A part of this rank's image that a round has not sent yet, the share of the
 * rounds that it goes to, and, when it is written, its message and counts. */
#define SNOW_SHARE_NONE (-1)
typedef struct snow_part_to_send {
    snow_stretch part;
    int share;
    unsigned char *message;
    size_t bytes;
    int64_t active, scanned, laid;
} snow_part_to_send;

/* The most threads of a rank that composite; more would wait for memory. */
#define SNOW_COMBINE_THREADS 16

/* The exchange that is under way. */
typedef struct snow_exchange_state {
    snow_exchange_params order;
    size_t pixel_bytes;
    bool ended;               /* without a failure */
    bool divided;             /* regions are known */
    int level;                /* the round */
    int awaited;              /* of combiner->parts */
    size_t used;              /* bytes of the round's buffer */
    int64_t sent;             /* bytes, in the first round */
    int layer_count;          /* of combiner->layers, to merge */
    const unsigned char *own; /* the message to oneself */
    size_t own_bytes;
} snow_exchange_state;

/* Bytes that the busiest position needs: a view changes the positions of ranks,
 * which alone must not change buffers. Rounds with even and odd numbers have
 * separate buffers. */
#define SNOW_NEEDS 6
typedef union snow_exchange_needs {
    size_t bytes[SNOW_NEEDS];
    struct {
        size_t in[2], out[2], words, region;
    };
} snow_exchange_needs;

/* The buffers of a gather (gather.c). */
typedef struct snow_gather_state {
    int radix; /* as set; 0: chosen */
    /* The picture of the buffers; width 0: no buffers. */
    int width, height, used_radix;
    size_t pixel_bytes;
    int *children;           /* ranks that send to this one */
    int child_count, parent; /* parent -1: the display processor */
    unsigned char *bytes; /* blocks, this rank's first; NULL without children */
    unsigned char *own;   /* this rank's block in bytes; initially NULL */
    unsigned char *slots; /* the beginning of each child's message */
    snow_message *messages; /* of each child: its beginning, its rest */
    size_t *places;         /* offset of each child's blocks in bytes */
    int *queue;             /* children with long messages, in order */
} snow_gather_state;

struct snow_combiner {
    snow_comm *comm;
    snow_exchange_params shape; /* of the buffers; width 0: there are none.
                                   What it points to may be gone */
    snow_exchange_needs needs;  /* capacities of the buffers */
    const snow_pixel_loops *loops;
    snow_rounds rounds;
    bool filled; /* `rounds` has its lists, for its rank position and display */
    snow_region_bounds bounds;
    int64_t counts[SNOW_BINS_MOST]; /* snow_exchange_counts */
    int counted_bins;
    int *ranks;               /* by position, as in the last params */
    int *table;               /* of snow_rounds_fill */
    snow_part_to_send *parts; /* of one round, not yet sent */
    snow_active *layers;      /* of one round, for each thread */
    int layer_room;           /* of one thread */
    uint64_t *words;          /* their masks */
    uint64_t *part;           /* masks of parts to send, or of the region */
    snow_traffic in[2], out[2];
    bool lends; /* out[] has its bytes in the communicator's shared memory */
    float *region;
    snow_exchange_state exchange; /* and the last one's params */
    snow_exchange_figures figures;
    snow_gather_state gather;
};

/* --- combiner.c ---

 * Collective. Checks the params and makes a plan for them: rounds, the order
 * of lines, loops for pixels. Errors: as for snow_exchange. */
snow_status snow_combiner_plan(snow_combiner *combiner,
                               const snow_exchange_params *order);

/* Collective. Allocates buffers for the borders of regions as they are now. */
snow_status snow_combiner_fit(snow_combiner *combiner);

/* --- traffic.c ---

 * Starts the receive of message `i` of a round from a rank, into `bytes`. */
snow_status snow_traffic_receive(snow_combiner *combiner, snow_traffic *in,
                                 int i, int from, unsigned char *bytes,
                                 size_t capacity);

/* Returns where message `i` is and how long, when it has come; NULL: it is no
 * valid loan. */
const unsigned char *snow_traffic_message(const snow_combiner *combiner,
                                          const snow_traffic *in, int i,
                                          int from, const unsigned char *bytes,
                                          size_t *count);

/* Sends or lends a message to a rank. */
snow_status snow_traffic_send(snow_combiner *combiner, snow_traffic *out,
                              const unsigned char *bytes, size_t count, int to);

/* Returns what was borrowed in the round `level`. */
snow_status snow_traffic_return(snow_combiner *combiner, int level);

/* Waits until all messages of a round are sent; until what was shared in it has
 * been returned; and the latter for all rounds. */
snow_status snow_traffic_await_sent(snow_combiner *combiner, snow_traffic *out);
snow_status snow_traffic_await_return(snow_combiner *combiner,
                                      snow_traffic *out);
snow_status snow_traffic_await_returns(snow_combiner *combiner);

/* --- parts.c ---

 * How many threads share the work on so many pixels. */
int snow_parts_workers(const snow_combiner *combiner, int64_t pixels);

/* Writes the messages of the first `count` awaited parts, and counts them. */
void snow_parts_write(snow_combiner *combiner, int count, int workers);

/* After combiner->layers are made: gives every thread its places in them. */
void snow_parts_copy_layers(snow_combiner *combiner);

/* Composites and unpacks the layers of the last round, and counts it. */
void snow_parts_composite(snow_combiner *combiner, snow_stretch region);

/* --- counts.c ---

 * Whether counts came with the params; otherwise the local image is counted,
 * for which it must be finished. */
bool snow_counts_given(const snow_combiner *combiner);

/* Collective. Divides the picture by counts. */
snow_status snow_counts_divide(snow_combiner *combiner);

/* Adds a part of the local image, and its mask, to the counts for the next
 * picture. */
void snow_counts_add(snow_combiner *combiner, snow_stretch part,
                     const uint64_t *words);

/* --- gather.c --- */

void snow_gather_free(snow_combiner *combiner);

#endif
