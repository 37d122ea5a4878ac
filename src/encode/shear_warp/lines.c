/* encode/shear_warp/lines.c - see lines.h. */
#include "encode/shear_warp/lines.h"

static snow_fetch_params fetch_params(const snow_value_store_params *params,
                                      int64_t first, int64_t rows) {
    return (snow_fetch_params){.volume = params->volume,
                               .placement = params->placement,
                               .slices = params->placement->slices,
                               .first_row = first,
                               .rows = rows,
                               .isa = params->isa};
}

static size_t line_bytes(const snow_value_store_params *params) {
    return snow_value_line(params->placement->columns,
                           snow_value_margin(params)) *
           sizeof(int16_t);
}

size_t snow_value_lines_bytes(const snow_value_store_params *params,
                              int64_t rows) {
    const snow_fetch_params from = fetch_params(params, 0, rows);
    size_t one =
        snow_align(snow_fetch_bytes(&from)) + snow_align(line_bytes(params));
    return params->cubic ? 3 * one : one;
}

void snow_value_lines_begin(snow_value_lines *lines,
                            const snow_value_store_params *params,
                            int64_t first, int64_t rows, void *scratch) {
    const snow_fetch_params from = fetch_params(params, first, rows);
    size_t line = snow_align(line_bytes(params)) / sizeof(int16_t);
    int count = params->cubic ? 3 : 1;
    int16_t *at = (int16_t *)scratch;
    *lines = (snow_value_lines){.quantizer = params->quantizer,
                                .volume = params->volume,
                                .placement = params->placement,
                                .cubic = params->cubic,
                                .slices = params->placement->slices,
                                .first = first,
                                .rows = rows,
                                .all_rows = params->placement->rows,
                                .columns = params->placement->columns,
                                .margin = snow_value_margin(params),
                                .spare = at,
                                .beside = {at + line, at + 2 * line}};
    unsigned char *own_scratch = (unsigned char *)(at + (size_t)count * line);
    for (int n = 0; n < count;
         n++, own_scratch += snow_align(snow_fetch_bytes(&from)))
        snow_fetch_begin(&lines->fetch[n], &from, own_scratch);
}

void snow_value_lines_slice(snow_value_lines *lines, int64_t slice) {
    lines->number = slice;
    snow_fetch_slice(&lines->fetch[0], slice, &lines->slice[0]);
    if (lines->cubic && slice > 0)
        snow_fetch_slice(&lines->fetch[1], slice - 1, &lines->slice[1]);
    if (lines->cubic && slice + 1 < lines->slices)
        snow_fetch_slice(&lines->fetch[2], slice + 1, &lines->slice[2]);
}

/* Columns 0 and columns - 1 are there, and those beside them if there are any:
 * writes the margin of a line. */
static void continue_line(int16_t *line, int64_t columns, int margin,
                          bool labels) {
    int16_t *first = line + margin, *last = first + columns - 1;
    int step = columns > 1;
    int16_t before = snow_value_beyond(first[0], first[step], labels);
    int16_t behind = snow_value_beyond(last[0], last[-step], labels);
    for (int n = 1; n <= margin; n++) {
        first[-n] = before;
        last[n] = behind;
    }
}

/* A row of the slice (0), of that before (1) or behind it (2). */
static void code_row(const snow_value_lines *lines, int of, int64_t row,
                     int16_t *out) {
    static const int steps[] = {0, -1, 1};
    const snow_placement *p = lines->placement;
    const snow_rows *slice = &lines->slice[of];
    const unsigned char *stored =
        slice->voxels + (size_t)(row - lines->first) * slice->stride;
    snow_quantize_row(lines->quantizer, stored, (size_t)lines->columns, out);
    if (lines->volume->clip) {
        int64_t at[3] = {0};
        at[p->v_axis] = row;
        at[p->slice_axis] = lines->number + steps[of];
        snow_quantize_clipped(lines->quantizer, lines->volume, at, p->u_axis,
                              (size_t)lines->columns, out);
    }
}

/* The cubic B-spline along P.  At the volume's ends it is the voxel itself, for
 * beyond them the reflection is odd. */
static void smooth_row(const snow_value_lines *lines, int64_t row,
                       int16_t *out) {
    if (lines->number == 0 || lines->number + 1 == lines->slices)
        return;
    for (int n = 0; n < 2; n++)
        code_row(lines, n + 1, row, lines->beside[n]);
    for (int64_t c = 0; c < lines->columns; c++) {
        int here = out[c], a = lines->beside[0][c], b = lines->beside[1][c];
        a = a == SNOW_VALUE_HOLE ? here : a;
        b = b == SNOW_VALUE_HOLE ? here : b;
        if (here != SNOW_VALUE_HOLE)
            out[c] = (int16_t)((a + 4 * here + b + 3) / 6);
    }
}

static void read_row(const snow_value_lines *lines, int64_t row, int16_t *out) {
    code_row(lines, 0, row, out + lines->margin);
    if (lines->cubic)
        smooth_row(lines, row, out + lines->margin);
    continue_line(out, lines->columns, lines->margin, lines->quantizer->names);
}

void snow_value_lines_read(snow_value_lines *lines, int64_t row, int16_t *out) {
    int64_t last = lines->all_rows - 1;
    int64_t border = row < 0 ? 0 : row > last ? last : row;
    int64_t inner = row < 0 ? 1 : last - 1;
    read_row(lines, border, out);
    if (border == row || last == 0)
        return;
    read_row(lines, inner, lines->spare);
    for (int64_t c = lines->margin; c < lines->columns + lines->margin; c++)
        out[c] =
            snow_value_beyond(out[c], lines->spare[c], lines->quantizer->names);
}
