/* encode/encode.h - the encoding stage (E in figure 7): the sparse matrix of
 * section 3, figure 3.
 *
 *   PA[slice] = { ea, ia }     slice pointers: any slice in constant time
 *                  |   |
 *   EA  ...........+.......    places of the interesting voxels, as one of
 *                      |       three schemes writes them (crs, bitmap, rle)
 *   IA  ...............+...    samples of the interesting voxels, the same
 *                              for all schemes: slice, row, column order
 *
 * All schemes are read back as the same spans: maximal runs of interesting
 * voxels within a row, so that what is splatted, and its order, and every bit
 * of the picture are the same. */
#ifndef SNOW_ENCODE_H
#define SNOW_ENCODE_H

#include "classify/classify.h"

/* Interesting voxels column .. column + length - 1 of a row. */
typedef struct snow_span {
    uint32_t column, length;
} snow_span;

/* An element of PA: where a slice begins in EA (bytes) and in IA (voxels). */
typedef struct snow_slice_pointer {
    uint64_t ea, ia;
} snow_slice_pointer;

typedef struct snow_scheme snow_scheme;

/* A volume's interesting voxels.  Slices are appended in order; the buffers
 * are kept when it is begun again. */
typedef struct snow_sparse {
    snow_context *context;
    const snow_scheme *scheme;
    int channels;          /* floats of a sample: 2 or 4 */
    int64_t columns, rows; /* of a slice */

    int64_t filled;    /* slices ended so far */
    unsigned char *ea; /* with 8 bytes beyond its end, to be read past */
    size_t ea_bytes, ea_capacity;
    /* IA holds samples (footprint), or codes and normals (encode/bands.h). */
    float *ia;
    size_t ia_voxels, ia_capacity; /* capacity in bytes */
    unsigned char *codes;
    uint16_t *normals;
    size_t codes_capacity, normals_capacity; /* bytes */
    int code_bytes;
    snow_slice_pointer *pa;        /* one more than slices */
    size_t pa_capacity;
    int64_t row; /* next row of the slice being encoded */
    /* RLE, while encoding: the run that is still growing. */
    uint64_t run;
    bool run_interesting;
} snow_sparse;

/* A walk through the rows of one slice. */
typedef struct snow_walk {
    const snow_sparse *sparse;
    const unsigned char *ea; /* the slice's first byte, or the next run */
    size_t voxel;            /* the next row's first voxel in IA */
    int64_t row;             /* the next row */
    /* RLE: voxels left in the current run, its kind, whether there is one. */
    uint32_t run;
    bool run_interesting, started;
} snow_walk;

/* A way to write EA (section 3.2). */
struct snow_scheme {
    /* Begins a slice, appends its rows (columns of the interesting voxels,
     * rising), ends it.  Errors: SNOW_NO_MEMORY. */
    snow_status (*begin_slice)(snow_sparse *sparse);
    snow_status (*add_row)(snow_sparse *sparse, const uint32_t *columns,
                           size_t count);
    snow_status (*end_slice)(snow_sparse *sparse);
    /* Reads the next row's spans into `spans`, which has room for
     * (columns + 1) / 2; returns their number. */
    size_t (*next_row)(snow_walk *walk, snow_span *spans);
};

extern const snow_scheme snow_scheme_crs;
extern const snow_scheme snow_scheme_bitmap;
extern const snow_scheme snow_scheme_rle;

/* The scheme of an encoding other than AUTO. */
const snow_scheme *snow_scheme_of(snow_encoding encoding);

/* The encoding that walks fastest: CRS below 5 % interesting voxels (the
 * other two must look at what is empty), RLE when runs are long (16 voxels
 * and more), else the bit-map, whose cost does not depend on the data. */
snow_encoding snow_encoding_choose(uint64_t voxels, uint64_t interesting,
                                   uint64_t runs);

/* Begins a sparse volume anew.  Errors: SNOW_BAD_USAGE (a slice of 2^32 voxels
 * or more), SNOW_NO_MEMORY. */
snow_status snow_sparse_begin(snow_sparse *sparse, const snow_scheme *scheme,
                              const snow_placement *placement, int channels);

snow_status snow_sparse_begin_slice(snow_sparse *sparse);

/* Lends the strip the end of IA, with room for `voxels` samples, so that they
 * need not be copied there; until the next call for the sparse matrix.  Errors:
 * SNOW_NO_MEMORY. */
snow_status snow_sparse_lend(snow_sparse *sparse, size_t voxels,
                             float **samples);

/* Appends the rows of a strip; strips come in order of rows. */
snow_status snow_sparse_add_strip(snow_sparse *sparse, const snow_strip *strip);

snow_status snow_sparse_end_slice(snow_sparse *sparse);

/* Frees the buffers; the record may be all zeros but for its context. */
void snow_sparse_fini(snow_sparse *sparse);

/* Sets a walk to the beginning of a slice, in constant time. */
void snow_walk_begin(snow_walk *walk, const snow_sparse *sparse, int64_t slice);

/* Passes over rows without telling their spans. */
void snow_walk_skip(snow_walk *walk, int64_t rows);

/* The next row: its spans, and the place of its first voxel in IA; returns the
 * number of spans. */
size_t snow_walk_row(snow_walk *walk, snow_span *spans, size_t *voxel);

/* Appends `size` bytes to EA, cleared, for the schemes. */
snow_status snow_sparse_grow_ea(snow_sparse *sparse, size_t size);

/* Adds voxels to a row's spans: the last span grows where they touch it, or a
 * new one begins. */
static inline size_t snow_span_append(snow_span *spans, size_t count,
                                      uint32_t column, uint32_t length) {
    if (count && spans[count - 1].column + spans[count - 1].length == column) {
        spans[count - 1].length += length;
        return count;
    }
    spans[count] = (snow_span){column, length};
    return count + 1;
}

/* The spans of a row whose kept columns are known. */
size_t snow_spans_of_columns(const uint32_t *columns, size_t count,
                             snow_span *spans);

#endif
