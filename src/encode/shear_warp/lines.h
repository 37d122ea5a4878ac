/* encode/shear_warp/lines.h - lines of quantized values from native voxels,
 * whatever the slice axis. */
#ifndef SNOW_ENCODE_SHEAR_WARP_LINES_H
#define SNOW_ENCODE_SHEAR_WARP_LINES_H

#include "encode/fetch.h"
#include "encode/shear_warp/store.h"

/* Some rows of all slices, for one thread. */
typedef struct snow_value_lines {
    /* Of the slice that is read; with kernel bspline also of those before and
     * behind it. */
    snow_fetch fetch[3];
    snow_rows slice[3];
    bool cubic;
    int64_t slices;
    const snow_quantizer *quantizer;
    const snow_volume *volume;
    const snow_placement *placement;
    int64_t number; /* of the slice */
    int64_t first, rows, all_rows, columns;
    int margin;
    int16_t *spare, *beside[2]; /* room for lines */
} snow_value_lines;

/* Quantized values of a line, with its margins, in whole rows of 32. */
static inline size_t snow_value_line(int64_t columns, int margin) {
    return ((size_t)columns + 2 * (size_t)margin + 31) / 32 * 32;
}

size_t snow_value_lines_bytes(const snow_value_store_params *params,
                              int64_t rows);

/* Rows first .. first + rows - 1; scratch of that many bytes, aligned to 64. */
void snow_value_lines_begin(snow_value_lines *lines,
                            const snow_value_store_params *params,
                            int64_t first, int64_t rows, void *scratch);

/* Slices come in order. */
void snow_value_lines_slice(snow_value_lines *lines, int64_t slice);

/* Line `row` of the slice, which may be one beyond the volume's first and last
 * one, if the two beside it are among the rows: out[margin + c] is column c. */
void snow_value_lines_read(snow_value_lines *lines, int64_t row, int16_t *out);

/* Row `row` of the slice as stored values. */
static inline const unsigned char *
snow_value_lines_stored(const snow_value_lines *lines, int64_t row) {
    const snow_rows *slice = &lines->slice[0];
    return slice->voxels + (size_t)(row - lines->first) * slice->stride;
}

#endif
