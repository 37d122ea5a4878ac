/* encode/encode.h - the encoding stage (E in figure 7): the sparse matrix of
 * section 3, figure 3.
 *
 *   PA[slice] = { ea, ia }     slice pointers: any slice in constant time
 *                  |   |
 *   EA  ...........+.......    positions of the interesting voxels, written by
 *                      |       one of three schemes (crs, bitmap, rle)
 *   IA  ...............+...    samples of the interesting voxels, the same
 *                              for all schemes: slice, row, column order
 *
 * All schemes are read as the same spans, maximal runs of interesting voxels
 * within a row. So the splatted voxels, their order and every bit of the
 * picture are the same. */
#ifndef SNOW_ENCODE_H
#define SNOW_ENCODE_H

#include "classify/classify.h"

#include <string.h>

/* Interesting voxels column .. column + length - 1 of a row. */
typedef struct snow_span {
    uint32_t column, length;
} snow_span;

/* An element of PA: the start of a slice in EA (bytes) and in IA (voxels). */
typedef struct snow_slice_pointer {
    uint64_t ea, ia;
} snow_slice_pointer;

typedef struct snow_scheme snow_scheme;

/* A volume's interesting voxels, or those of a band of rows
 * (encode/shear_warp/active.c). Slices are appended in order; beginning again
 * reuses the buffers. Their form is that of the paper's figures 4 to 6; a slice
 * of a band without interesting voxels takes no bytes of EA. */
typedef struct snow_sparse {
    snow_context *context;
    const snow_scheme *scheme;
    int channels;          /* floats of a sample: 2 or 4 */
    int64_t columns, rows; /* of a slice */

    int64_t filled;    /* slices ended so far */
    unsigned char *ea; /* readable beyond its end */
    size_t ea_bytes;
    /* IA holds samples (footprint method), or the quantized values of a band.
     */
    float *ia;
    int16_t *quantized;
    size_t ia_voxels;
    snow_slice_pointer *pa; /* one more than slices */
    int64_t row;            /* next row of the slice being encoded */
    uint64_t *mask;         /* of a row */
    /* RLE, while encoding: the current run, which may still grow. */
    uint64_t run;
    bool run_interesting;
} snow_sparse;

/* A walk through the rows of one slice. */
typedef struct snow_walk {
    const snow_sparse *sparse;
    const unsigned char *slice; /* its first byte in EA; NULL: it has none */
    const unsigned char *ea;    /* RLE: the next run to read */
    size_t voxel;               /* the next row's first voxel in IA */
    int64_t row;                /* the next row */
    /* RLE: voxels left in the run, its kind, and whether there is one. */
    uint32_t run;
    bool run_interesting, started;
} snow_walk;

/* A way to write EA (section 3.2). */
struct snow_scheme {
    /* Begins a slice, appends its rows, ends it. A row is snow_mask_words words
     * with a bit for each voxel, lowest first; 0 behind the last. Errors:
     * SNOW_STATUS_NO_MEMORY. */
    snow_status (*begin_slice)(snow_sparse *sparse);
    snow_status (*add_row)(snow_sparse *sparse, const uint64_t *mask);
    snow_status (*end_slice)(snow_sparse *sparse); /* or NULL */
    /* Reads the next row's spans into `spans`, which has room for (columns + 1)
     * / 2; returns their number. The caller advances voxel and row. */
    size_t (*next_row)(snow_walk *walk, snow_span *spans);
};

extern const snow_scheme snow_scheme_crs;
extern const snow_scheme snow_scheme_bitmap;
extern const snow_scheme snow_scheme_rle;

/* The scheme of an encoding other than AUTO. */
const snow_scheme *snow_scheme_of(snow_encoding encoding);

/* Chooses the encoding that is read fastest, or else takes the fewest bytes.
 * The bit-map is the default, as its cost does not depend on the data. Below 5
 * % interesting voxels, where it must scan what is empty: RLE if runs are long
 * (16 voxels or more), for a run takes fewer bytes than a few columns, else
 * CRS. */
snow_encoding snow_encoding_choose(uint64_t voxels, uint64_t interesting,
                                   uint64_t runs);

/* Errors: SNOW_STATUS_BAD_USAGE (a slice of 2^32 voxels or more). */
snow_status snow_slice_check(snow_context *context,
                             const snow_placement *placement);

/* Begins a sparse volume, empty. Errors: as snow_slice_check,
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_sparse_begin(snow_sparse *sparse, const snow_scheme *scheme,
                              const snow_placement *placement, int channels);

snow_status snow_sparse_begin_slice(snow_sparse *sparse);

/* Lends the end of IA to a row block, with room for `voxels` samples, so that
 * they need not be copied; valid until the next call for the sparse matrix.
 * Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_sparse_lend(snow_sparse *sparse, size_t voxels,
                             float **samples);

/* Appends the rows of a row block; blocks come in the order of rows. */
snow_status snow_sparse_add_row_block(snow_sparse *sparse,
                                      const snow_row_block *row_block);

snow_status snow_sparse_end_slice(snow_sparse *sparse);

/* Begins a band of `rows` rows, empty. IA is not written, but PA refers to
 * ia_voxels, which the caller counts. Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_sparse_begin_band(snow_sparse *sparse,
                                   const snow_scheme *scheme, int64_t columns,
                                   int64_t rows, int64_t slices);

/* 64-bit words of a row's mask. */
static inline size_t snow_mask_words(const snow_sparse *sparse) {
    return ((size_t)sparse->columns + 63) / 64;
}

/* Appends a slice of a band; `voxels` of it are interesting, and already
 * counted in ia_voxels. Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_sparse_add_masks(snow_sparse *sparse, const uint64_t *masks,
                                  size_t voxels);

/* Frees the buffers; the record may be all zeros except for its context. */
void snow_sparse_fini(snow_sparse *sparse);

/* Sets a walk to the beginning of a slice, in constant time. */
void snow_walk_begin(snow_walk *walk, const snow_sparse *sparse, int64_t slice);

/* Reads the next row: its spans, and the position of its first voxel in IA.
 * Returns the number of spans. */
size_t snow_walk_row(snow_walk *walk, snow_span *spans, size_t *voxel);

/* For the schemes: appends `size` bytes of zeros to EA. There are as many as
 * SNOW_EA_MARGIN more, which may be read and written. */
#define SNOW_EA_MARGIN 64
static inline snow_status snow_sparse_grow_ea(snow_sparse *s, size_t size) {
    SNOW_TRY(SNOW_RESERVE(s->context, s->ea, s->ea_bytes,
                          s->ea_bytes + size + SNOW_EA_MARGIN));
    memset(s->ea + s->ea_bytes, 0, size + SNOW_EA_MARGIN);
    s->ea_bytes += size;
    return SNOW_STATUS_OK;
}

/* Adds voxels to a row's spans: extends the last span if they touch it, or
 * begins a new one. */
static inline size_t snow_span_append(snow_span *spans, size_t count,
                                      uint32_t column, uint32_t length) {
    if (count && spans[count - 1].column + spans[count - 1].length == column) {
        spans[count - 1].length += length;
        return count;
    }
    spans[count] = (snow_span){column, length};
    return count + 1;
}

/* Adds the voxels of a mask whose lowest bit is `column`. */
static inline size_t snow_span_append_mask(snow_span *spans, size_t count,
                                           uint32_t column, uint64_t mask) {
    while (mask) {
        int skip = __builtin_ctzll(mask);
        uint64_t rest = ~(mask >> skip);
        int run = rest ? __builtin_ctzll(rest) : 64;
        count = snow_span_append(spans, count, column + (uint32_t)skip,
                                 (uint32_t)run);
        /* Adding the lowest bit carries through the run. */
        mask &= mask + (UINT64_C(1) << skip);
    }
    return count;
}

/* A 64-bit word as bytes, lowest first on every machine. */
static inline uint64_t snow_load_word(const unsigned char *at) {
    uint64_t word;
    memcpy(&word, at, sizeof word);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    word = __builtin_bswap64(word);
#endif
    return word;
}

static inline void snow_store_word(unsigned char *at, uint64_t word) {
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    word = __builtin_bswap64(word);
#endif
    memcpy(at, &word, sizeof word);
}

/* The spans of a row whose kept columns are known. */
size_t snow_spans_of_columns(const uint32_t *columns, size_t count,
                             snow_span *spans);

#endif
