/* encode/rows.h - the inner loop of encoding: rows of native voxels become
 * masks of the interesting ones, and their codes one after another.
 *
 *   voxels   12 200 201  3  90 ...     masks   bits 1, 2, 4 ... of 64-bit words
 *                                      codes   200 201 90 ...
 *
 * There is one instance for each level of simd/isa.h, and all give the same
 * bytes. */
#ifndef SNOW_ROWS_H
#define SNOW_ROWS_H

#include "classify/codes.h"
#include "simd/isa.h"

typedef struct snow_row_encoder snow_row_encoder;

/* Native voxels: each row is contiguous, and the next one `stride` bytes on.
 * `ahead` bytes further lie those that will be asked for next, for the cache;
 * 0 where there are none. */
typedef struct snow_rows {
    const unsigned char *voxels;
    size_t stride, ahead;
    size_t columns, rows;
} snow_rows;

/* Each row's mask has a word for each 64 columns, with bits beyond the last one
 * set 0; `codes` takes SNOW_ROW_MARGIN bytes more than the codes of all voxels.
 * Returns how many voxels are interesting. */
#define SNOW_ROW_MARGIN 128
typedef size_t snow_encode_rows_fn(const snow_row_encoder *encoder,
                                   const snow_rows *rows, uint64_t *masks,
                                   void *codes);

/* A coder made ready for rows. */
struct snow_row_encoder {
    const snow_coder *coder;
    snow_encode_rows_fn *encode_rows;
    uint16_t bias;    /* native + bias is the code, modulo its size */
    double low, high; /* no native value outside is interesting */
};

/* The encoder points to the coder.  `isa` is resolved. */
void snow_row_encoder_init(const snow_coder *coder, snow_isa isa,
                           snow_row_encoder *out);

/* The columns of the bits of `words` mask words, rising; returns their
 * number. */
size_t snow_columns_of_masks(const uint64_t *masks, size_t words,
                             uint32_t *columns);

#endif
