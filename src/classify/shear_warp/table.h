/* classify/shear_warp/table.h - the colours of a slab between two resampled
 * slices of values: pre-integrated (Engel, Kraus, Ertl 2001), with attenuation
 * inside of the slab.
 *
 * Entry [f][b] is what a ray collects on its way through one slab while its
 * value goes from node f straight to node b: N equal steps, composited. */
#ifndef SNOW_CLASSIFY_SHEAR_WARP_TABLE_H
#define SNOW_CLASSIFY_SHEAR_WARP_TABLE_H

#include "classify/shear_warp/range.h"
#include "simd/isa.h"

/* Entries of one row of the table, of which `nodes` are used. */
#define SNOW_VALUE_PITCH 256
/* Entries that are made at once. */
#define SNOW_VALUE_ENTRIES 16

/* The most quantized values from one node of a table to the next
 * (docs/model.md, V4). */
#define SNOW_VALUE_NODE_MOST 256

/* An interval of quantized values whose slabs are all invisible. */
typedef struct snow_transparent_interval {
    int16_t first, last;
} snow_transparent_interval;
#define SNOW_VALUE_RUNS 4
#define SNOW_VALUE_NO_RUN ((snow_transparent_interval){1, 0})

/* What a table is made for. */
typedef struct snow_value_look {
    const snow_transfer *transfer;
    snow_value_scale14 scale;
    double threshold; /* opacity 0 to 255; what is not above it is invisible */
    double exponent;  /* length of a ray in a slab, in reference lengths */
    int nodes, steps; /* 129 or 256; of an entry */
    bool placed;      /* with the place of the opacity, for gradients */
    int threads;
    snow_isa isa; /* resolved; of no effect on the table */
} snow_value_look;

typedef struct snow_value_table {
    /* Premultiplied colour and alpha, lowest first, words of 15 bits.  In one
     * with places the top bits are the place of the opacity in sixteenths of
     * the slab, lowest bit first. */
    uint64_t *entries; /* [front * SNOW_VALUE_PITCH + back] */
    int16_t scale;     /* the node of V is (V scale + 2^14) / 2^15, or: */
    uint8_t *nodes;    /* by V; NULL: all evenly placed */
    uint8_t *node_of;  /* by V, always */
    bool measured;     /* nodes are placed by what the look changes */
    double *at;        /* V of each node */
    double *logs;      /* of 1 - opacity, and colours, by V */
    float *plain;
    float *looks; /* premultiplied RGBA of a step, by V */
    /* The same where nodes are evenly placed: [channel][look % (2 steps)][node
     * + SNOW_VALUE_ENTRIES], with zeros beside the nodes. */
    float *planes;
    int plane_pitch;
    double step; /* quantized values between two of these looks */
    size_t look_count;
    int look_of[SNOW_VALUE_PITCH]; /* the place of each node among them */
    snow_transparent_interval
        intervals[SNOW_VALUE_RUNS]; /* the longest ones, rising */
    int interval_count;
    bool faint; /* the words count parts of 2^-15 / 2^n, for slabs show little:
                 */
    float unit, full; /* the alpha of a word of 1; the word of an alpha of 1 */
    /* What was made last. */
    snow_value_look made;
    double *key, *next_key;
    size_t key_count;
} snow_value_table;

/* Makes the table, unless it is there already.  `table` begins as zeros or was
 * made before.  Errors: SNOW_STATUS_NO_MEMORY, SNOW_STATUS_STOPPED. */
snow_status snow_value_table_make(snow_context *context,
                                  const snow_value_look *look,
                                  snow_value_table *table);
/* Sets the unit of words of which the largest is an alpha of `most`: a smaller
 * one below `faintest`. */
void snow_value_table_scale(snow_value_table *table, double most,
                            double faintest);

/* A table without entries, of labels and of values that have no colours yet: no
 * number is invisible until it is hidden.  Intervals rise. */
void snow_value_table_begin(const snow_value_look *look,
                            snow_value_table *table);
void snow_value_table_hide(snow_value_table *table,
                           snow_transparent_interval interval);

/* Looks of a step and nodes; where they are `known`, those of other rays need
 * only new alphas, and nodes placed by them. */
snow_status snow_value_looks_make(snow_context *context,
                                  const snow_value_look *look, bool known,
                                  snow_value_table *table);

void snow_value_table_fini(snow_context *context, snow_value_table *table);

#endif
