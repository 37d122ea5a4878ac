/* encode/shear_warp/rows.c - IA, decoded to rows that are read at any
 * column. */
#include "encode/shear_warp/encode.h"

#include <string.h>

/* Quantized values before the first row and behind the last, for what is read
 * beyond a row's ends: by lanes up to 8 voxels apart. */
static int64_t beyond(const snow_value_store *s) {
    return s->columns + 2 * s->margin + 512;
}

static int64_t row_number(const snow_value_store *s, int64_t slice,
                          int64_t row) {
    return slice * (s->rows + 2 * s->margin) + s->margin + row;
}

void snow_value_rows_measure(snow_value_store *s, int64_t number,
                             snow_span *spans) {
    const snow_sparse *band = &s->bands[number];
    int64_t first = number * SNOW_VALUE_BAND;
    for (int64_t slice = 0; slice < s->slices; slice++) {
        snow_walk walk;
        snow_walk_begin(&walk, band, slice);
        for (int64_t row = 0; row < band->rows; row++) {
            size_t voxel, count = snow_walk_row(&walk, spans, &voxel);
            int32_t *ends = s->ends[row_number(s, slice, first + row)];
            const snow_span *last = spans + count - (count > 0);
            ends[0] = count ? (int32_t)spans[0].column : 0;
            ends[1] = count ? (int32_t)(last->column + last->length) : 0;
        }
    }
}

/* Rows beyond a side have the columns that both rows beside them have. */
static void measure_border(snow_value_store *s, int64_t slice, int64_t border,
                           int64_t inner, int64_t beside) {
    const int32_t *a = s->ends[row_number(s, slice, border)];
    const int32_t *b = s->ends[row_number(s, slice, inner)];
    int32_t *ends = s->ends[row_number(s, slice, beside)];
    ends[0] = a[0] > b[0] ? a[0] : b[0];
    ends[1] = a[1] < b[1] ? a[1] : b[1];
    if (ends[1] <= ends[0])
        ends[0] = ends[1] = 0;
}

/* The place of a row that begins at *end. */
static int64_t place_row(const snow_value_store *s, const int32_t ends[2],
                         int64_t *end) {
    int64_t first = ends[0] ? ends[0] : -s->margin;
    int64_t last = ends[1] < s->columns ? ends[1] : s->columns + s->margin;
    if (ends[0] == ends[1])
        return beyond(s);
    int64_t at = *end - first;
    *end += last - first;
    return at;
}

/* All rows of a slice, and the rows farther out, which are as those beside. */
static void place_slice(snow_value_store *s, int64_t slice, int64_t *end) {
    int64_t inner = s->rows > 1, *at = s->at + row_number(s, slice, 0);
    measure_border(s, slice, 0, inner, -1);
    measure_border(s, slice, s->rows - 1, s->rows - 1 - inner, s->rows);
    for (int64_t row = -1; row <= s->rows; row++)
        at[row] = place_row(s, s->ends[row_number(s, slice, row)], end);
    for (int64_t n = 2; n <= s->margin; n++) {
        at[-n] = at[-1];
        at[s->rows - 1 + n] = at[s->rows];
    }
}

snow_status snow_value_rows_place(snow_value_store *s) {
    int64_t end = beyond(s);
    for (int64_t slice = 0; slice < s->slices; slice++)
        place_slice(s, slice, &end);
    size_t count = (size_t)(end + beyond(s));
    if (count * sizeof *s->values > snow_block_bytes(s->values))
        SNOW_DROP(s->context, s->values); /* not both at once */
    SNOW_TRY(SNOW_RESERVE(s->context, s->values, 0, count));
    memset(s->values, 0, (size_t)beyond(s) * sizeof *s->values);
    memset(s->values + end, 0, (size_t)beyond(s) * sizeof *s->values);
    return SNOW_STATUS_OK;
}

/* The margins of a row that reaches the volume's sides. */
static void continue_row(const snow_value_store *s, const int32_t ends[2],
                         int16_t *row) {
    int16_t *last = row + s->columns - 1;
    bool many = ends[1] - ends[0] > 1;
    for (int n = 1; ends[0] == 0 && n <= s->margin; n++)
        row[-n] = snow_value_beyond(row[0], row[many], s->labels);
    for (int n = 1; ends[1] == s->columns && n <= s->margin; n++)
        last[n] = snow_value_beyond(last[0], last[-(int)many], s->labels);
}

void snow_value_rows_fill(snow_value_store *s, int64_t number,
                          snow_span *spans) {
    const snow_sparse *band = &s->bands[number];
    const int16_t *quantized = band->quantized;
    int64_t first = number * SNOW_VALUE_BAND;
    for (int64_t slice = 0; slice < s->slices; slice++) {
        snow_walk walk;
        snow_walk_begin(&walk, band, slice);
        for (int64_t row = 0; row < band->rows; row++) {
            size_t voxel, count = snow_walk_row(&walk, spans, &voxel);
            int64_t here = row_number(s, slice, first + row);
            const int32_t *ends = s->ends[here];
            int16_t *to = s->values + s->at[here];
            if (!count)
                continue;
            memset(to + ends[0], 0, (size_t)(ends[1] - ends[0]) * sizeof *to);
            for (size_t n = 0; n < count; n++) {
                memcpy(to + spans[n].column, quantized + voxel,
                       spans[n].length * sizeof *to);
                voxel += spans[n].length;
            }
            continue_row(s, ends, to);
        }
    }
}

/* A row beyond a side: odd, and in its margins as the row beside it. */
static void fill_border(snow_value_store *s, int64_t slice, int64_t border,
                        int64_t inner, int64_t beside) {
    int64_t here = row_number(s, slice, beside);
    const int32_t *ends = s->ends[here];
    const int16_t *a = s->values + s->at[row_number(s, slice, border)];
    const int16_t *b = s->values + s->at[row_number(s, slice, inner)];
    int16_t *to = s->values + s->at[here];
    if (ends[0] == ends[1])
        return;
    for (int64_t c = ends[0]; c < ends[1]; c++)
        to[c] = snow_value_beyond(a[c], b[c], s->labels);
    for (int64_t c = -s->margin; ends[0] == 0 && c < 0; c++)
        to[c] = a[c];
    for (int64_t c = s->columns;
         ends[1] == s->columns && c < s->columns + s->margin; c++)
        to[c] = a[c];
}

void snow_value_rows_border(snow_value_store *s, int64_t slice) {
    int64_t inner = s->rows > 1, last = s->rows - 1;
    fill_border(s, slice, 0, inner, -1);
    fill_border(s, slice, last, last - inner, s->rows);
}
