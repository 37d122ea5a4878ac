/* encode/fetch.c - see fetch.h.
 *
 * The block of a band holds the same rows of some slices one after another:
 *
 *   slice s    row 0 | row 1 | ... | row 31
 *   slice s+1  row 0 | row 1 | ... | row 31
 *   ...
 *
 * Row r of all of them comes from one plane of the volume, where their voxels
 * lie side by side: it is the transpose of that plane's strip. */
#include "encode/fetch.h"

#include <string.h>

/* Columns of a tile. */
#define TILE 64

static size_t row_pitch(size_t columns, size_t size) {
    return (columns * size + 63) / 64 * 64;
}

static bool is_transposed(const snow_placement *placement) {
    return placement->u_axis != 0;
}

/* With slices between there is always one more in the block, the partner of
 * the last one. */
static int64_t block_slices_of(size_t size, bool between) {
    return SNOW_FETCH_LINE / (int64_t)size + between;
}

size_t snow_fetch_bytes(const snow_volume *volume,
                        const snow_placement *placement, int64_t rows,
                        bool between) {
    size_t size = snow_type_size(volume->info.type);
    size_t pitch = row_pitch((size_t)placement->columns, size);
    size_t lines = between ? 1 : 0;
    if (is_transposed(placement))
        lines += (size_t)(block_slices_of(size, between) * rows);
    return lines * pitch;
}

void snow_fetch_begin(snow_fetch *fetch, const snow_volume *volume,
                      const snow_placement *placement, int64_t first_slice,
                      int64_t slices, int64_t first_row, int64_t rows,
                      bool between, void *scratch) {
    size_t size = snow_type_size(volume->info.type);
    *fetch = (snow_fetch){
        .volume = volume,
        .placement = placement,
        .size = size,
        .first_row = first_row,
        .rows = rows,
        .first_slice = first_slice,
        .slices = slices,
        .transposed = is_transposed(placement),
        .between = between,
        .pitch = row_pitch((size_t)placement->columns, size),
        .block_slices = block_slices_of(size, between),
        .mean = scratch,
    };
    fetch->block = fetch->mean + (between ? fetch->pitch : 0);
}

/* out[n][u] = in[u][n] for `count` slices n and `columns` columns u. */
#define TRANSPOSE(type)                                                   \
    static void transpose_##type(const unsigned char *in, size_t stride,  \
                                 size_t count, size_t columns,            \
                                 unsigned char *out, size_t pitch) {      \
        for (size_t u = 0; u < columns; u++)                              \
            for (size_t n = 0; n < count; n++)                            \
                memcpy(out + n * pitch + u * sizeof(type),                \
                       in + u * stride + n * sizeof(type), sizeof(type)); \
    }

TRANSPOSE(uint8_t)
TRANSPOSE(uint16_t)
TRANSPOSE(uint32_t)
TRANSPOSE(uint64_t)

static void transpose(size_t size, const unsigned char *in, size_t stride,
                      size_t count, size_t columns, unsigned char *out,
                      size_t pitch) {
    switch (size) {
    case 1:
        transpose_uint8_t(in, stride, count, columns, out, pitch);
        break;
    case 2:
        transpose_uint16_t(in, stride, count, columns, out, pitch);
        break;
    case 4:
        transpose_uint32_t(in, stride, count, columns, out, pitch);
        break;
    default:
        transpose_uint64_t(in, stride, count, columns, out, pitch);
        break;
    }
}

/* Row `row` of the block's slices. */
static void fill_row(snow_fetch *f, int64_t row) {
    size_t columns = (size_t)f->placement->columns;
    int64_t stride;
    const unsigned char *in = snow_row_voxels(f->volume, f->placement,
                                              f->first_slice + f->block_first,
                                              f->first_row + row, &stride);
    size_t bytes = (size_t)stride * f->size;
    unsigned char *out = f->block + (size_t)row * f->pitch;
    for (size_t u = 0; u < columns; u += TILE)
        transpose(f->size, in + u * bytes, bytes, (size_t)f->block_count,
                  columns - u < TILE ? columns - u : TILE, out + u * f->size,
                  (size_t)f->rows * f->pitch);
}

/* Makes the block hold slices from `slice` on. */
static void fill_block(snow_fetch *f, int64_t slice) {
    int64_t left = f->slices - slice;
    f->block_first = slice;
    f->block_count = left < f->block_slices ? left : f->block_slices;
    for (int64_t row = 0; row < f->rows; row++)
        fill_row(f, row);
}

/* A row of a slice of the volume; the block begins with slice `begin` when it
 * has to be filled. */
static const void *volume_row(snow_fetch *f, int64_t slice, int64_t row,
                              int64_t begin) {
    if (!f->transposed) {
        int64_t stride;
        return snow_row_voxels(f->volume, f->placement, f->first_slice + slice,
                               f->first_row + row, &stride);
    }
    if (slice < f->block_first || slice >= f->block_first + f->block_count)
        fill_block(f, begin);
    return f->block +
           (size_t)((slice - f->block_first) * f->rows + row) * f->pitch;
}

/* The mean of two values; of integers without overflow, halves rounded up. */
#define MEAN_INTEGER(a, b) ((a >> 1) + (b >> 1) + ((a | b) & 1))
#define MEAN_FLOAT(a, b) (a / 2 + b / 2)

#define MEAN_ROW(NAME_, type, MEAN)                                        \
    static void mean_##NAME_(const void *a, const void *b, size_t columns, \
                             void *out) {                                  \
        const type *p = a, *q = b;                                         \
        type *mean = out;                                                  \
        for (size_t n = 0; n < columns; n++)                               \
            mean[n] = (type)MEAN(p[n], q[n]);                              \
    }

MEAN_ROW(INT8, int8_t, MEAN_INTEGER)
MEAN_ROW(UINT8, uint8_t, MEAN_INTEGER)
MEAN_ROW(INT16, int16_t, MEAN_INTEGER)
MEAN_ROW(UINT16, uint16_t, MEAN_INTEGER)
MEAN_ROW(INT32, int32_t, MEAN_INTEGER)
MEAN_ROW(UINT32, uint32_t, MEAN_INTEGER)
MEAN_ROW(INT64, int64_t, MEAN_INTEGER)
MEAN_ROW(UINT64, uint64_t, MEAN_INTEGER)
MEAN_ROW(FLOAT32, float, MEAN_FLOAT)
MEAN_ROW(FLOAT64, double, MEAN_FLOAT)

typedef void mean_fn(const void *a, const void *b, size_t columns, void *out);

static mean_fn *const means[] = {
#define MEAN_ENTRY(name, type, text) [SNOW_##name] = mean_##name,
    SNOW_TYPE_MAP(MEAN_ENTRY)};

const void *snow_fetch_row(snow_fetch *f, int64_t slice, int64_t row) {
    if (!f->between)
        return volume_row(f, slice, row, slice);
    const void *a = volume_row(f, slice / 2, row, slice / 2);
    if (slice % 2 == 0)
        return a;
    /* Filling the block for the second must not take the first away. */
    const void *b = volume_row(f, slice / 2 + 1, row, slice / 2);
    a = volume_row(f, slice / 2, row, slice / 2);
    means[f->volume->info.type](a, b, (size_t)f->placement->columns, f->mean);
    return f->mean;
}
