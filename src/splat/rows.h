/* splat/rows.h - splatting of whole rows (R in figure 7), for modes that need
 * nearly every voxel: a row out of EA and IA is spread out, and rows are added
 * up with the weights of a comb (splat/comb.h), along u and then along v.
 *
 *   bits, codes   0 1 1 0 1   a b c
 *   spread        0 a b 0 c             values, as floats
 *   set           w0 row[n] + w1 row[n + 1] + ...        along u
 *   add, most     w0 row0[n] + w1 row1[n] + ... into a line, along v
 *
 * avx2 and avx512 make the same bits. */
#ifndef SNOW_ROWS_H
#define SNOW_ROWS_H

#include "simd/isa.h"
#include "splat/comb.h"

/* Floats that may be read, and but for `most` written, beyond the last. */
#define SNOW_ROWS_BEYOND 16

/* Sums of rows over n = first .. end - 1 for one or two phases: sum i, of
 * rows[i * lead + m][n] * weights[i][m] over m = 0 .. taps - 1, goes into
 * lines[i][n]. */
typedef struct snow_rows_job {
    const float *rows[SNOW_TAPS_MOST + 1];
    const float *weights[2];
    float *lines[2]; /* the second may be NULL: one phase */
    int taps, lead;  /* lead: 0 or 1 */
    int first, end;
} snow_rows_job;

typedef void snow_rows_fn(const snow_rows_job *job);

typedef struct snow_row_fns {
    /* Voxels of `words` words of bits, `step` apart, lowest bit first, into
     * as many times 64 floats: start + scale * code, and 0 where there is none.
     * Codes have one or two bytes. */
    void (*spread8)(const uint64_t *bits, size_t step, size_t words,
                    const unsigned char *codes, float scale, float start,
                    float *row);
    void (*spread16)(const uint64_t *bits, size_t step, size_t words,
                     const unsigned char *codes, float scale, float start,
                     float *row);
    snow_rows_fn *set;  /* the sum */
    snow_rows_fn *add;  /* the line and the sum */
    snow_rows_fn *most; /* the larger of the two */
    /* Pairs (value, weight) of `count` pixels of one or two phases, in turns.
     */
    void (*weave)(const float *const *values, const float *const *weights,
                  int phases, int count, float *pairs);
} snow_row_fns;

/* `isa` is resolved. */
const snow_row_fns *snow_row_fns_of(snow_isa isa);

#endif
