/* encode/fetch.c - see fetch.h.
 *
 * The block of a band holds the same rows of several slices:
 *
 *   slice s    row 0 | row 1 | ... | row 31 | one unused cache line
 *   slice s+1  row 0 | row 1 | ... | row 31 |
 *   ...
 *
 * Row r of all of them comes from one plane of the volume, where their voxels
 * are adjacent: it is the transpose of a strip of that plane. The unused line
 * puts the same position of different slices into different cache sets. */
#include "encode/fetch.h"

#include <string.h>

#define TILE SNOW_TILE_LINES
#define LINE SNOW_TILE_BYTES

/* Fewer slices than this are not worth a tile. */
#define TILE_WORTH 8

static void measure_steps(snow_fetch *f, const snow_fetch_params *params) {
    const snow_placement *p = params->placement;
    size_t size = snow_type_size(params->volume->info.type);
    int64_t steps[3];
    snow_volume_steps(params->volume, steps);
    *f = (snow_fetch){
        .column_step = size * (size_t)steps[p->u_axis],
        .row_step = size * (size_t)steps[p->v_axis],
        .slice_step = size * (size_t)steps[p->slice_axis],
        .type = params->volume->info.type,
        .size = size,
        .columns = (size_t)p->columns,
        .rows = (size_t)params->rows,
        .slices = params->slices,
        .transposed = p->u_axis != 0,
    };
    f->pitch = (f->columns + TILE - 1) / TILE * TILE * size;
    f->slice_pitch = f->rows * f->pitch + LINE;
    f->capacity = LINE / (int64_t)size;
}

size_t snow_fetch_bytes(const snow_fetch_params *params) {
    snow_fetch f;
    measure_steps(&f, params);
    return f.transposed ? (size_t)f.capacity * f.slice_pitch : 0;
}

void snow_fetch_begin(snow_fetch *f, const snow_fetch_params *params,
                      void *scratch) {
    measure_steps(f, params);
    int64_t stride;
    f->voxels =
        snow_row_voxels(params->volume, params->placement, params->first_slice,
                        params->first_row, &stride);
    f->transpose = snow_transpose_of(f->size, params->isa);
    f->block = scratch;
}

/* --- slices along x ------------------------------------------------------- */

/* Copies row `row` of `count` slices from `slice` on, at most one cache line,
 * into `out`, tile by tile.  The block has room for a whole tile. */
static void fill_row(const snow_fetch *f, int64_t slice, size_t row,
                     size_t count, unsigned char *out) {
    const unsigned char *in =
        f->voxels + (size_t)slice * f->slice_step + row * f->row_step;
    out += row * f->pitch;
    for (size_t u = 0; u < f->columns; u += TILE) {
        size_t lines = f->columns - u < TILE ? f->columns - u : TILE;
        const unsigned char *from = in + u * f->column_step;
        unsigned char *to = out + u * f->size;
        /* The tile after that of columns `u` on: in the same row, or the first
         * of the next. */
        const unsigned char *next =
            u + 2 * TILE <= f->columns ? from + TILE * f->column_step
            : row + 1 < f->rows && TILE <= f->columns ? in + f->row_step
                                                      : in;
        if (lines == TILE && count * f->size == LINE)
            f->transpose(from, f->column_step, to, f->slice_pitch, next);
        else if (count < TILE_WORTH) {
            for (size_t n = 0; n < count; n++)
                for (size_t k = 0; k < lines; k++)
                    memcpy(to + n * f->slice_pitch + k * f->size,
                           from + k * f->column_step + n * f->size, f->size);
        } else { /* nothing is read beyond the lines, and they are padded */
            unsigned char tile[TILE * LINE] = {0};
            for (size_t k = 0; k < lines; k++)
                memcpy(tile + k * LINE, from + k * f->column_step,
                       count * f->size);
            f->transpose(tile, LINE, to, f->slice_pitch, tile);
        }
    }
}

/* --- slices --------------------------------------------------------------- */

static void slice_of_volume(snow_fetch *f, int64_t slice, snow_rows *out) {
    *out = (snow_rows){.columns = f->columns, .rows = f->rows};
    if (f->transposed) {
        out->voxels =
            f->block + (size_t)(slice - f->block_first) * f->slice_pitch;
        out->stride = f->pitch;
        return;
    }
    out->voxels = f->voxels + (size_t)slice * f->slice_step;
    out->stride = f->row_step;
    out->ahead = slice + 1 < f->slices ? f->slice_step : 0;
}

void snow_fetch_slice(snow_fetch *f, int64_t slice, snow_rows *out) {
    if (f->transposed && slice >= f->block_first + f->block_count) {
        /* Fills the block with slices from `slice` on. */
        int64_t left = f->slices - slice, line = LINE / (int64_t)f->size;
        f->block_first = slice;
        f->block_count = left < f->capacity ? left : f->capacity;
        for (int64_t n = 0; n < f->block_count; n += line) {
            int64_t some =
                f->block_count - n < line ? f->block_count - n : line;
            for (size_t row = 0; row < f->rows; row++)
                fill_row(f, slice + n, row, (size_t)some,
                         f->block + (size_t)n * f->slice_pitch);
        }
    }
    slice_of_volume(f, slice, out);
}
