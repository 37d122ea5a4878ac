/* encode/rows.h - the inner loop of encoding: a row of native voxels becomes a
 * mask of the interesting ones, and their codes one after another.
 *
 *   voxels   12 200 201  3  90 ...     mask    bits 1, 2, 4 ... of 64-bit words
 *                                      codes   200 201 90 ...
 *
 * There is one instance for each level of simd/isa.h, and all give the same
 * bytes. */
#ifndef SNOW_ROWS_H
#define SNOW_ROWS_H

#include "classify/codes.h"
#include "simd/isa.h"

typedef struct snow_row_encoder snow_row_encoder;

/* `voxels` are contiguous; `masks` has a word for each 64 columns, whose bits
 * beyond the last column are set 0; `codes` takes SNOW_ROW_MARGIN bytes more
 * than the codes of all columns.  Returns how many voxels are interesting. */
#define SNOW_ROW_MARGIN 128
typedef size_t snow_encode_row_fn(const snow_row_encoder *encoder,
                                  const void *voxels, size_t columns,
                                  uint64_t *masks, void *codes);

/* A coder made ready for rows. */
struct snow_row_encoder {
    const snow_coder *coder;
    snow_encode_row_fn *encode_row;
    uint16_t bias; /* native + bias is the code, modulo its size */
};

/* The encoder points to the coder.  `isa` is resolved. */
void snow_row_encoder_init(const snow_coder *coder, snow_isa isa,
                           snow_row_encoder *out);

/* The columns of the bits of `words` mask words, rising; returns their
 * number. */
size_t snow_columns_of_masks(const uint64_t *masks, size_t words,
                             uint32_t *columns);

#endif
