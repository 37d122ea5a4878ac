/* volume/downsample.c - means of voxels, a row at a time, at the speed of
 * memory.
 *
 * Rows of a voxel's height and depth are added up to a line first, and the line
 * is halved; beside it goes a line of extremes.  Where all weights are one, as
 * with even counts, sums of the small types are whole numbers and exact.
 * Values that are not numbers are rare and spoil the sum that they are in, by
 * which they are found: such a voxel is made again, of the values that are
 * there. */
#include "volume/downsample.h"
#include "base/thread_pool.h"

#include <math.h>
#include <string.h>

/* Rows of an output slice that are made at once. */
#define ROWS_AT_ONCE 16

/* How `from` voxels of the whole become `to`: as many, or (from + 1) / 2. */
typedef struct axis_taps {
    int64_t from, to;
    int taps;             /* the most voxels that one is made of */
    int64_t stored, made; /* the first voxel that is stored, that is made */
} axis_taps;

/* The voxels of a row that one is made of; weights add up to 1. */
typedef struct column_taps {
    int64_t first;
    int count;
    double weights[3];
} column_taps;

/* A worker's own lines, of the rows' length. */
typedef struct scratch_lines {
    void *work, *extremes;
} scratch_lines;

typedef struct downsampling downsampling;
typedef struct row_taps row_taps;

typedef void row_fn(const downsampling *h, const row_taps *rows,
                    const scratch_lines *lines, void *out);

/* A volume being halved. */
struct downsampling {
    const snow_volume *volume;
    snow_volume *out;
    axis_taps axes[3];
    int lean;
    bool even;            /* all weights are one */
    int shift;            /* then: a mean is of 2^shift voxels */
    int64_t blocks;       /* of rows, of a slice */
    size_t size;          /* bytes of a voxel */
    int64_t left, width;  /* the stored columns that are looked at */
    column_taps *columns; /* of those */
    char *lines;
    size_t line_bytes;
    row_fn *row; /* makes one of rows */
};

/* The rows that a row is made of; weights add up to 1. */
struct row_taps {
    int count;
    int64_t first[9]; /* linear index of the first voxel that is looked at */
    double weights[9];
};

/* The stored voxels that voxel `at` of those to be made is made of: returns how
 * many, from *first on, and their weights, which add up to 1.  Of the whole it
 * covers [at, at + 1) from / to. */
static int taps_at(const axis_taps *axis, int64_t at, int64_t *first,
                   double weights[3]) {
    int64_t n = axis->from, m = axis->to;
    at += axis->made;
    if (n == m) {
        *first = at - axis->stored;
        weights[0] = 1;
        return 1;
    }
    /* In units of a voxel / m, where all borders are whole. */
    int64_t low = at * n, high = low + n;
    int count = 0;
    *first = low / m - axis->stored;
    for (int64_t voxel = low / m; voxel * m < high; voxel++) {
        int64_t from = voxel * m > low ? voxel * m : low;
        int64_t end = (voxel + 1) * m < high ? (voxel + 1) * m : high;
        weights[count++] = (double)(end - from) / (double)n;
    }
    return count;
}

static void rows_at(const downsampling *h, int64_t j, int64_t k,
                    row_taps *out) {
    const int64_t *dims = h->volume->info.dims;
    int64_t row, slice;
    double across[3], deep[3];
    int rows = taps_at(&h->axes[1], j, &row, across);
    int slices = taps_at(&h->axes[2], k, &slice, deep);
    out->count = 0;
    for (int z = 0; z < slices; z++)
        for (int y = 0; y < rows; y++) {
            out->first[out->count] =
                ((slice + z) * dims[1] + row + y) * dims[0] + h->left;
            out->weights[out->count++] = deep[z] * across[y];
        }
}

static const void *row_of(const downsampling *h, const row_taps *rows, int n) {
    return (const char *)h->volume->voxels + (size_t)rows->first[n] * h->size;
}

/* --- types ---------------------------------------------------------------- */

/* Shifts round down, and so sums of a half more to the nearest. */
#define WHOLE(s, shift) \
    (TYPE)((SUM)((s) + (SUM)((1 << (shift)) >> 1)) >> (shift))
/* Above the lowest value truncation rounds down. */
#define ROUNDED(x) (TYPE)((int32_t)((double)(x) + 32768.5) - 32768)
/* Doubles that were integers may have been rounded up beyond their type. */
#define WITHIN(x, low, high) (TYPE) fmin(fmax(floor((x) + 0.5), low), high)

#define TYPE uint8_t
#define SUM uint16_t
#define SHARE(s, shift) WHOLE(s, shift)
#define WORK float
#define REAL(x) ROUNDED(x)
#define NAME(word) word##_u8
#include "volume/downsample.tmpl.h"

#define TYPE int8_t
#define SUM int16_t
#define SHARE(s, shift) WHOLE(s, shift)
#define WORK float
#define REAL(x) ROUNDED(x)
#define NAME(word) word##_i8
#include "volume/downsample.tmpl.h"

#define TYPE uint16_t
#define SUM uint32_t
#define SHARE(s, shift) WHOLE(s, shift)
#define WORK float
#define REAL(x) ROUNDED(x)
#define NAME(word) word##_u16
#include "volume/downsample.tmpl.h"

#define TYPE int16_t
#define SUM int32_t
#define SHARE(s, shift) WHOLE(s, shift)
#define WORK float
#define REAL(x) ROUNDED(x)
#define NAME(word) word##_i16
#include "volume/downsample.tmpl.h"

#define TYPE float
#define SUM float
#define SHARE(s, shift) ((s) * (1 / (float)(1 << (shift))))
#define WORK float
#define REAL(x) (x)
#define NAME(word) word##_f32
#include "volume/downsample.tmpl.h"

#define TYPE double
#define WORK double
#define REAL(x) (x)
#define NAME(word) word##_f64
#include "volume/downsample.tmpl.h"

#define TYPE uint32_t
#define WORK double
#define REAL(x) WITHIN(x, 0, UINT32_MAX)
#define NAME(word) word##_u32
#include "volume/downsample.tmpl.h"

#define TYPE int32_t
#define WORK double
#define REAL(x) WITHIN(x, INT32_MIN, INT32_MAX)
#define NAME(word) word##_i32
#include "volume/downsample.tmpl.h"

#define TYPE uint64_t
#define WORK double
#define REAL(x) WITHIN(x, 0, 0x1p64 - 2048)
#define NAME(word) word##_u64
#include "volume/downsample.tmpl.h"

#define TYPE int64_t
#define WORK double
#define REAL(x) WITHIN(x, -0x1p63, 0x1p63 - 1024)
#define NAME(word) word##_i64
#include "volume/downsample.tmpl.h"

/* --- values that are none ------------------------------------------------- */

/* Of what is there. */
static double value_of(const downsampling *h, const row_taps *rows, int64_t i) {
    const column_taps *x = &h->columns[i];
    double sum = 0, total = 0, extreme = NAN;
    for (int row = 0; row < rows->count; row++)
        for (int n = 0; n < x->count; n++) {
            double value =
                snow_volume_native(h->volume, rows->first[row] + x->first + n);
            double weight = rows->weights[row] * x->weights[n];
            if (isnan(value))
                continue;
            sum += weight * value;
            total += weight;
            extreme = h->lean > 0 ? fmax(extreme, value) : fmin(extreme, value);
        }
    double mean = total > 0 ? sum / total : NAN;
    return h->lean && isfinite(mean)
               ? mean + SNOW_DOWNSAMPLE_LEAN * (extreme - mean)
               : mean;
}

/* Makes again what came to no finite number. */
static void mend_row(const downsampling *h, const row_taps *rows, void *out) {
    int64_t n = h->out->info.dims[0];
    bool single = h->size == sizeof(float);
    float *floats = out;
    double *doubles = out, any = 0;
    for (int64_t i = 0; i < n; i++)
        any += single ? (double)(0 * floats[i]) : 0 * doubles[i];
    for (int64_t i = 0; any != 0 && i < n; i++) {
        if (isfinite(single ? (double)floats[i] : doubles[i]))
            continue;
        double value = value_of(h, rows, i);
        if (single)
            floats[i] = (float)value;
        else
            doubles[i] = value;
    }
}

/* --- a volume ------------------------------------------------------------- */

/* How even and other rows of a type are made. */
static row_fn *row_fn_of(snow_type type, bool even) {
    switch (type) {
    case SNOW_TYPE_INT8:
        return even ? even_row_i8 : odd_row_i8;
    case SNOW_TYPE_UINT8:
        return even ? even_row_u8 : odd_row_u8;
    case SNOW_TYPE_INT16:
        return even ? even_row_i16 : odd_row_i16;
    case SNOW_TYPE_UINT16:
        return even ? even_row_u16 : odd_row_u16;
    case SNOW_TYPE_INT32:
        return odd_row_i32;
    case SNOW_TYPE_UINT32:
        return odd_row_u32;
    case SNOW_TYPE_INT64:
        return odd_row_i64;
    case SNOW_TYPE_UINT64:
        return odd_row_u64;
    case SNOW_TYPE_FLOAT32:
        return even ? even_row_f32 : odd_row_f32;
    default:
        return odd_row_f64;
    }
}

static void downsample_block(void *job, int64_t item, int worker) {
    const downsampling *h = job;
    const int64_t *dims = h->out->info.dims;
    snow_type type = h->volume->info.type;
    char *own = h->lines + 2 * (size_t)worker * h->line_bytes;
    const scratch_lines lines = {own, own + h->line_bytes};
    int64_t first = item % h->blocks * ROWS_AT_ONCE, k = item / h->blocks;
    int64_t end =
        first + ROWS_AT_ONCE < dims[1] ? first + ROWS_AT_ONCE : dims[1];
    for (int64_t j = first; j < end; j++) {
        char *out = (char *)h->out->owned +
                    (size_t)((k * dims[1] + j) * dims[0]) * h->size;
        row_taps rows;
        rows_at(h, j, k, &rows);
        h->row(h, &rows, &lines, out);
        if (type == SNOW_TYPE_FLOAT32 || type == SNOW_TYPE_FLOAT64)
            mend_row(h, &rows, out);
    }
}

static axis_taps taps_of(int64_t from, int64_t to, int64_t stored,
                         int64_t made) {
    return (axis_taps){from, to, from == to ? 1 : 2 + (int)(from % 2), stored,
                       made};
}

snow_volume_info snow_downsampled_info(const snow_volume_info *info,
                                       bool axes[3]) {
    snow_volume_info out = *info;
    for (int axis = 0; axis < 3; axis++) {
        if (info->dims[axis] < SNOW_DOWNSAMPLE_LEAST)
            axes[axis] = false;
        if (!axes[axis])
            continue;
        out.dims[axis] = (info->dims[axis] + 1) / 2;
        double longer = (double)info->dims[axis] / (double)out.dims[axis];
        for (int row = 0; row < 3; row++) {
            double step = info->matrix[row][axis];
            out.matrix[row][axis] = step * longer;
            out.matrix[row][3] += step * (longer - 1) / 2;
        }
    }
    snow_volume_info_measure(&out);
    return out;
}

/* Of `from` voxels that become `to`: the first that begins where voxel `at`
 * does, or behind. */
static int64_t first_behind(int64_t at, int64_t from, int64_t to) {
    return (at * to + from - 1) / from;
}

bool snow_downsampled_part(const snow_volume *volume, const int64_t dims[3],
                           snow_extent *out, int64_t stored[3]) {
    snow_extent part;
    bool any = true;
    snow_volume_find_extent(volume, &part);
    snow_extent_init(out);
    for (int axis = 0; axis < 3; axis++) {
        int64_t from = part.dims[axis], to = dims[axis];
        int64_t end = part.first[axis] + part.count[axis];
        int64_t stored_end = part.stored[axis] + volume->info.dims[axis];
        out->dims[axis] = to;
        out->stored[axis] = first_behind(part.stored[axis], from, to);
        stored[axis] = stored_end * to / from - out->stored[axis];
        out->first[axis] = first_behind(part.first[axis], from, to);
        out->count[axis] = first_behind(end, from, to) - out->first[axis];
        any = any && part.count[axis] > 0 && out->count[axis] > 0;
    }
    for (int axis = 0; axis < 3 && !any; axis++) {
        out->stored[axis] = out->first[axis] = out->count[axis] = 0;
        stored[axis] = 1;
    }
    return any;
}

/* A border between parts is followed within two voxels by the one that takes
 * its place, and voxels of the halved volume are two voxels long at most: below
 * a part that is 2 `layers`, above it less than 2 (`layers` + 1), or just so
 * many voxels where the last of them lies across. */
int64_t snow_downsampled_layers(int64_t dims, int64_t layers) {
    int64_t most = dims - 1;
    return layers < most / 2 ? 2 * layers + 1 + dims % 2 : most;
}

static void fill_columns(downsampling *h) {
    for (int64_t i = 0; i < h->out->info.dims[0]; i++) {
        column_taps *column = &h->columns[i];
        column->count =
            taps_at(&h->axes[0], i, &column->first, column->weights);
        column->first -= h->left;
    }
}

static size_t aligned(size_t bytes) {
    return (bytes + 63) / 64 * 64;
}

static snow_status make_room(downsampling *h, int threads,
                             snow_downsample_buffers *room) {
    size_t columns = aligned((size_t)h->out->info.dims[0] * sizeof *h->columns);
    h->line_bytes = aligned((size_t)h->width * sizeof(double));
    SNOW_TRY(snow_reserve(h->volume->context, &room->block, &room->capacity, 0,
                          columns + 2 * (size_t)threads * h->line_bytes));
    h->columns = room->block;
    h->lines = (char *)room->block + columns;
    return SNOW_STATUS_OK;
}

/* Which stored columns all that is made is made of. */
static void find_columns(downsampling *h) {
    double weights[3];
    int64_t first, last;
    taps_at(&h->axes[0], 0, &h->left, weights);
    last = taps_at(&h->axes[0], h->out->info.dims[0] - 1, &first, weights);
    h->width = first + last - h->left;
}

snow_status snow_volume_downsample(const snow_volume *volume,
                                   const bool axes[3], int lean, int threads,
                                   snow_downsample_buffers *room,
                                   snow_volume *out) {
    const int64_t *dims = out->info.dims;
    snow_extent whole, made;
    snow_volume_find_extent(volume, &whole);
    snow_volume_find_extent(out, &made);
    downsampling h = {.volume = volume,
                      .out = out,
                      .lean = lean,
                      .even = true,
                      .blocks = (dims[1] + ROWS_AT_ONCE - 1) / ROWS_AT_ONCE,
                      .size = snow_type_size(volume->info.type)};
    for (int axis = 0; axis < 3; axis++) {
        int64_t from = whole.dims[axis];
        h.axes[axis] = taps_of(from, made.dims[axis], whole.stored[axis],
                               made.stored[axis]);
        h.even = h.even && (!axes[axis] || from % 2 == 0);
        h.shift += axes[axis];
    }
    h.row = row_fn_of(volume->info.type, h.even);
    find_columns(&h);
    SNOW_TRY(make_room(&h, threads, room));
    fill_columns(&h);
    SNOW_TRY(snow_parallel(volume->context, threads, dims[2] * h.blocks,
                           downsample_block, &h));
    snow_volume_freeze(out);
    return SNOW_STATUS_OK;
}
