/* encode/values/value_lines.c - see value_lines.h. */
#include "encode/values/value_lines.h"

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
    return snow_value_line(params->placement->columns, params->reach + 1) *
           sizeof(int16_t);
}

size_t snow_value_lines_bytes(const snow_value_store_params *params,
                              int64_t rows) {
    const snow_fetch_params from = fetch_params(params, 0, rows);
    return (snow_fetch_bytes(&from) + 63) / 64 * 64 + line_bytes(params);
}

void snow_value_lines_begin(snow_value_lines *lines,
                            const snow_value_store_params *params,
                            int64_t first, int64_t rows, void *scratch) {
    const snow_fetch_params from = fetch_params(params, first, rows);
    unsigned char *at = scratch;
    *lines = (snow_value_lines){.coder = params->coder,
                                .volume = params->volume,
                                .placement = params->placement,
                                .first = first,
                                .rows = rows,
                                .all_rows = params->placement->rows,
                                .columns = params->placement->columns,
                                .margin = params->reach + 1,
                                .spare = (int16_t *)scratch};
    snow_fetch_begin(&lines->fetch, &from,
                     at + (line_bytes(params) + 63) / 64 * 64);
}

void snow_value_lines_slice(snow_value_lines *lines, int64_t slice) {
    snow_fetch_slice(&lines->fetch, slice, &lines->slice);
    lines->number = slice;
}

void snow_value_line_continue(int16_t *line, int64_t columns, int margin,
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

static void read_row(const snow_value_lines *lines, int64_t row, int16_t *out) {
    const snow_placement *p = lines->placement;
    const unsigned char *natives =
        lines->slice.voxels +
        (size_t)(row - lines->first) * lines->slice.stride;
    snow_value_code_row(lines->coder, natives, (size_t)lines->columns,
                        out + lines->margin);
    if (lines->volume->clip) {
        int64_t at[3] = {0};
        at[p->v_axis] = row;
        at[p->slice_axis] = lines->number;
        snow_value_code_clipped(lines->coder, lines->volume, at, p->u_axis,
                                (size_t)lines->columns, out + lines->margin);
    }
    snow_value_line_continue(out, lines->columns, lines->margin,
                             lines->coder->names);
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
            snow_value_beyond(out[c], lines->spare[c], lines->coder->names);
}
