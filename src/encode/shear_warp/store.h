/* encode/shear_warp/store.h - the encoding of shear-warp: the active voxels and
 * their neighbours of what a look shows, for one slice axis, whatever the view.
 *
 *   volume --> cells   of 2x2 voxels of a slice, a bit each: not wholly within
 *                      an transparent interval (one plane for each interval)
 *          --> active  the voxels that the samples and gradients of a slab with
 *                      such a cell need: EA, IA, PA (encode.h) by bands of rows
 *          --> rows    IA once more, row by row from the first to the last
 *                      voxel of the active voxels and their neighbours, so that
 * 32 samples are two loads
 *
 * Where voxels are integers that become quantized values by a fixed-point
 * quantizer (classify/shear_warp/range.h), and no encoding is asked for, there
 * are masks alone, and rows are stored values: along z and y those of the
 * volume, in place; along x a copy that is turned.
 *
 * Beyond each side of the volume there are `margin` more columns and rows,
 * which continue it oddly: v[-1] = 2 v[0] - v[1], and the same farther out.
 * Rows of stored values have none: whoever reads them makes them.
 * Cell (c, r) has voxels c, c + 1 of rows r, r + 1.
 *
 * Holes are SNOW_VALUE_HOLE in IA and in rows.  They show nothing; cells that
 * have one are marked in one plane more, for samples there take weights. */
#ifndef SNOW_ENCODE_SHEAR_WARP_STORE_H
#define SNOW_ENCODE_SHEAR_WARP_STORE_H

#include "classify/shear_warp/quantizer.h"
#include "classify/shear_warp/table.h"
#include "encode/encode.h"
#include "transform/transform.h"

#include <string.h>

/* Rows of a tile, and of zeros beside the masks. */
#define SNOW_VALUE_ROWS 32
/* Rows of cells that share a bit of the coarse mask. */
#define SNOW_VALUE_COARSE 8
/* Slices that share a coarse mask of their own. */
#define SNOW_VALUE_EIGHT 8
/* The most voxels that a ray may move aside from one slice to the next. */
#define SNOW_VALUE_REACH_MOST 24

/* What rows hold. */
typedef enum snow_value_kind {
    SNOW_VALUE_QUANTIZED, /* of 16 bits, with margins */
    SNOW_VALUE_BYTES,     /* native values, unsigned, of 8 bits */
    SNOW_VALUE_SHORTS,    /* native values of 16 bits */
} snow_value_kind;

/* Stored values first .. first + width, which may go round beyond the largest
 * of their type; none: there are no such. */
typedef struct snow_value_stored_range {
    uint16_t first, width;
    bool none;
} snow_value_stored_range;

/* Ranges of stored values that are counted, at most. */
#define SNOW_VALUE_SEEN 4

typedef struct snow_value_store {
    snow_context *context;
    int64_t columns, rows, slices;
    int reach;  /* voxels that a ray moves aside */
    int margin; /* snow_value_margin */
    snow_transparent_interval intervals[SNOW_VALUE_RUNS];
    int interval_count;
    bool labels; /* quantized values are labels */
    bool cubic;  /* of kernel bspline: slices are smoothed along P, and cells
                    are those of 4x4 voxels */
    bool holes;  /* there are some: plane `interval_count` of the masks is of
                    them */
    /* A word of 32 columns from column -32 - margin on; rows from that on. */
    uint32_t *masks; /* [interval][slice][word][row] */
    size_t mask_words, mask_rows;
    /* A bit for each SNOW_VALUE_COARSE rows of these; those of all slices lie
     * together, for a tile looks at few words of them:
     * [interval][word][slice][row / SNOW_VALUE_COARSE / 64]. */
    uint64_t *coarse;
    size_t coarse_words;
    uint64_t *eights; /* the same for each SNOW_VALUE_EIGHT slices */
    int64_t eight_count;
    /* EA, IA and PA. */
    snow_sparse *bands;
    int64_t band_count;
    snow_encoding encoding;
    snow_value_stored_range
        counted[SNOW_VALUE_SEEN]; /* stored values that are counted, */
    int counted_ranges;           /* ... 0: none */
    int64_t *seen;                /* and how many, by bands */
    uint64_t voxels, ea_bytes, ia_bytes, pa_bytes;
    snow_value_kind kind;
    bool in_place;              /* rows are stored values at regular steps */
    bool turned;                /* in a copy */
    snow_fixed_quantizer fixed; /* from stored values to quantized values */
    /* In place voxel (c, r) of slice k is stored value k slice_step + r
     * row_step + c of native_count. */
    const unsigned char *stored;
    int64_t slice_step, row_step, native_count;
    /* Else it is value at[k][r] + c of `values` or of the copy; elsewhere
     * anything may be read. */
    unsigned char *copy;
    int16_t *values;
    int64_t *at;            /* [slice][row + margin] */
    int32_t (*ends)[2];     /* of the rows: first column, and behind the last */
    unsigned char *scratch; /* of the threads, while encoding */
    int step;               /* that is under way, of those in store.c */
    int64_t made;           /* items of it */
} snow_value_store;

/* What is encoded. */
typedef struct snow_value_store_params {
    const snow_volume *volume;
    const snow_placement *placement;
    const snow_quantizer *quantizer;
    const snow_transparent_interval *intervals; /* invisible quantized values */
    int interval_count;
    bool holes;
    int reach;              /* one more with kernel bspline */
    bool cubic;             /* kernel bspline */
    snow_encoding encoding; /* AUTO: chosen by the cells */
    snow_isa isa;           /* resolved */
    int threads;
    bool copied;   /* the volume may go before the picture is drawn */
    bool in_parts; /* between pictures: pages of memory come one by one */
    const snow_value_stored_range
        *seen;      /* ranges of stored values that are counted: */
    int seen_count; /* 0: none are; up to SNOW_VALUE_SEEN */
} snow_value_store_params;

/* Columns and rows beyond each side: those that rays and gradients reach.  A
 * single voxel has samples up to half a voxel beyond it besides. */
static inline int snow_value_margin(const snow_value_store_params *params) {
    const snow_placement *p = params->placement;
    return params->reach + 1 + (p->columns == 1 || p->rows == 1);
}

/* The stored values whose quantized values are in an interval. */
snow_value_stored_range
snow_value_stored_range_of(const snow_quantizer *quantizer,
                           snow_transparent_interval interval);

/* Whether cells are marked by stored values, which can be counted then. */
static inline bool
snow_value_store_by_stored(const snow_value_store_params *params) {
    return params->quantizer->is_fixed && !params->cubic && !params->holes;
}

/* Encodes; buffers are reused.  `store` begins as zeros but for its context.
 * Errors: SNOW_STATUS_BAD_USAGE (a slice of 2^32 voxels or more),
 * SNOW_STATUS_NO_MEMORY, SNOW_STATUS_STOPPED. */
snow_status snow_value_store_encode(snow_value_store *store,
                                    const snow_value_store_params *params);
void snow_value_store_fini(snow_value_store *store);

/* The same in parts: begins; makes so many bands more, of those that are left.
 * It is whole when none are.  `params` are those of the beginning, but
 * intervals and stored values to count are needed no more.  After an error it
 * is to be begun anew. Errors: as above. */
snow_status snow_value_store_begin(snow_value_store *store,
                                   const snow_value_store_params *params);
snow_status snow_value_store_go_on(snow_value_store *store,
                                   const snow_value_store_params *params,
                                   int64_t bands);
int64_t snow_value_store_left(const snow_value_store *store);

/* Bytes that it takes; that one would take at most. */
uint64_t snow_value_store_bytes(const snow_value_store *store);
uint64_t snow_value_store_expect(const snow_value_store_params *params);

/* Bytes of EA, IA and PA of `count` slices from `first` on. */
void snow_value_store_count(const snow_value_store *store, int64_t first,
                            int64_t count, uint64_t *ea, uint64_t *ia,
                            uint64_t *pa);

static inline size_t snow_value_mask_at(const snow_value_store *s, int interval,
                                        int64_t slice) {
    return ((size_t)interval * (size_t)s->slices + (size_t)slice) *
           s->mask_words * s->mask_rows;
}

/* In `coarse`, where a word of columns of a slice begins. */
static inline size_t snow_value_coarse_at(const snow_value_store *s,
                                          int interval, size_t word,
                                          int64_t slice) {
    return (((size_t)interval * s->mask_words + word) * (size_t)s->slices +
            (size_t)slice) *
           s->coarse_words;
}

/* The same in `eights`. */
static inline size_t snow_value_eight_at(const snow_value_store *s,
                                         int interval, size_t word,
                                         int64_t eight) {
    return (((size_t)interval * s->mask_words + word) * (size_t)s->eight_count +
            (size_t)eight) *
           s->coarse_words;
}

static inline const int64_t *snow_value_at(const snow_value_store *s,
                                           int64_t slice) {
    return s->at + slice * (s->rows + 2 * s->margin) + s->margin;
}

/* The number of a native value. */
static inline int16_t snow_value_of_native(const snow_value_store *s,
                                           int64_t place) {
    uint16_t word;
    if (s->kind == SNOW_VALUE_BYTES)
        return snow_quantize_fixed(&s->fixed, s->stored[place]);
    memcpy(&word, s->stored + 2 * place, sizeof word);
    return snow_quantize_fixed(&s->fixed, word);
}

#endif
