/* encode/shear_warp/encode.h - the steps of encoding that
 * encode/shear_warp/encode_steps.c calls; each is an item of work for one
 * thread. */
#ifndef SNOW_ENCODE_SHEAR_WARP_ENCODE_H
#define SNOW_ENCODE_SHEAR_WARP_ENCODE_H

#include "encode/shear_warp/lines.h"

/* Voxel rows of a band. */
#define SNOW_VALUE_BAND 8

/* Loops of an instruction set (rows.tmpl.h). */
typedef struct snow_value_loops {
    void (*outside)(const int16_t *line, size_t words,
                    snow_transparent_interval interval, uint32_t *out);
    int16_t *(*pack)(const int16_t *line, const uint32_t *bits, size_t words,
                     int16_t *out);
    void (*outside_bytes)(const unsigned char *stored, size_t count, int by,
                          snow_value_stored_range range, uint32_t *out);
    void (*outside_words)(const unsigned char *stored, size_t count, int by,
                          snow_value_stored_range range, uint32_t *out);
    /* Bits that are set; cells of 2x2 voxels from the bits of two lines. */
    int64_t (*count)(const uint32_t *bits, size_t words);
    void (*cells)(const uint32_t *above, const uint32_t *below, size_t words,
                  uint32_t *out);
} snow_value_loops;

const snow_value_loops *snow_value_loops_of(snow_isa isa);

/* Planes of the masks. */
static inline int snow_value_planes(const snow_value_store *s) {
    return s->interval_count + s->holes;
}

/* Words of 32 columns of a line, margins included. */
static inline size_t snow_value_words(const snow_value_store *s) {
    return snow_value_line(s->columns, s->margin) / 32;
}

/* Words of all masks, and of the rows of zeros behind them. */
static inline size_t snow_value_masks_words(const snow_value_store *s) {
    return snow_value_mask_at(s, snow_value_planes(s), 0) + SNOW_VALUE_ROWS;
}

/* Marks the quantized values of a line that are outside of an interval, which
 * `range` is of, from a row of stored values. */
void snow_value_mark_stored(const snow_value_store *store,
                            const snow_value_store_params *params,
                            const snow_value_stored_range *range, int interval,
                            const unsigned char *stored, uint32_t *bits);

/* The stored values of a row that are in one of the ranges of what is seen;
 * `bits` is room for the bits of a line. */
int64_t snow_value_count_stored(const snow_value_store *store,
                                const snow_value_store_params *params,
                                const unsigned char *stored, uint32_t *bits);

/* The bytes of an encoding that is whole. */
void snow_value_store_add_up(snow_value_store *store);

size_t snow_value_cells_bytes(const snow_value_store *store,
                              const snow_value_store_params *params);

/* The masks of the rows of cells of a band; the last band's go on to the
 * volume's end. */
void snow_value_cells_band(snow_value_store *store,
                           const snow_value_store_params *params, int64_t band,
                           int worker, void *scratch);

/* The coarse masks of eight slices, once all their bands are there; with kernel
 * bspline cells grow before. */
void snow_value_cells_coarse(snow_value_store *store, int64_t eight);

/* An interval that, at an end of all quantized values, goes on to those beyond
 * a side, which are clamped before they are seen. */
snow_transparent_interval
snow_transparent_open(snow_transparent_interval interval);

size_t snow_value_active_bytes(const snow_value_store *store,
                               const snow_value_store_params *params);

/* EA, IA and PA of a band.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_value_active_band(snow_value_store *store,
                                   const snow_value_store_params *params,
                                   int64_t band, int worker, void *scratch);

/* The ends of the rows of a band; then, when they have places, their values. */
void snow_value_rows_measure(snow_value_store *store, int64_t band,
                             snow_span *spans);
void snow_value_rows_fill(snow_value_store *store, int64_t band,
                          snow_span *spans);

/* Places for all rows; then the rows beyond the sides of a slice.  Errors:
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_value_rows_place(snow_value_store *store);
void snow_value_rows_border(snow_value_store *store, int64_t slice);

#endif
