/* encode/rows.h - the inner loop of encoding: rows of native voxels become
 * masks of the interesting ones, and their contiguous codes.
 *
 *   voxels   12 200 201  3  90 ...     masks   bits 1, 2, 4 ... of 64-bit words
 *                                      codes   200 201 90 ...
 *
 * There is one instance for each instruction set of simd/isa.h; all give the
 * same bytes. */
#ifndef SNOW_ROWS_H
#define SNOW_ROWS_H

#include "classify/codes.h"
#include "simd/isa.h"

typedef struct snow_row_encoder snow_row_encoder;

/* Native voxels: each row is contiguous, and the next begins `stride` bytes
 * later. Voxels needed next, for prefetching, lie `ahead` bytes further; 0 if
 * there are none. */
typedef struct snow_rows {
    const unsigned char *voxels;
    size_t stride, ahead;
    size_t columns, rows;
} snow_rows;

/* Each row's mask has a word for each 64 columns; bits beyond the last column
 * are 0. `codes` has SNOW_ROW_MARGIN bytes more than the codes of all voxels.
 * Returns the number of interesting voxels. */
#define SNOW_ROW_MARGIN 128
typedef size_t snow_encode_rows_fn(const snow_row_encoder *encoder,
                                   const snow_rows *rows, uint64_t *masks,
                                   void *codes);

/* A quantizer prepared for rows. */
struct snow_row_encoder {
    const snow_quantizer *quantizer;
    snow_encode_rows_fn *encode_rows;
    uint16_t bias;    /* native + bias is the code, modulo its size */
    double low, high; /* no native value outside is interesting */
};

/* The encoder keeps a pointer to the quantizer. `isa` is resolved. */
void snow_row_encoder_init(const snow_quantizer *quantizer, snow_isa isa,
                           snow_row_encoder *out);

/* Writes the columns of the set bits of `words` mask words, rising; returns
 * their number. */
size_t snow_columns_of_masks(const uint64_t *masks, size_t words,
                             uint32_t *columns);

#endif
