/* splat/dense.c - decompresses a slice; see splat/dense.h.
 *
 * From slice to slice only what differs is written: a row keeps its extent, the
 * span outside of which it is zero, and only gaps within are cleared. */
#include "splat/dense.h"

#include <string.h>

#define WORD 32

static size_t all_rows(const snow_dense_shape *shape) {
    return (size_t)shape->rows + 2 * (size_t)shape->taps_v;
}

static size_t row_floats(const snow_dense_shape *shape) {
    size_t voxels = (size_t)shape->columns + (size_t)shape->taps_u +
                    (size_t)shape->padded_u;
    return voxels * (size_t)shape->channels;
}

static size_t map_words(const snow_dense_shape *shape) {
    return ((size_t)shape->columns + (size_t)shape->taps_u + WORD) / WORD;
}

static size_t map_rows(const snow_dense_shape *shape) {
    return (size_t)shape->rows + (size_t)shape->taps_v + 1;
}

bool snow_dense_serves(const snow_dense_shape *shape) {
    if (shape->columns >= INT32_MAX / 8 || shape->rows >= INT32_MAX / 8)
        return false;
    return row_floats(shape) * all_rows(shape) < INT32_MAX &&
           map_words(shape) * map_rows(shape) < INT32_MAX;
}

uint64_t snow_dense_bytes(const snow_dense_shape *shape) {
    return (row_floats(shape) * all_rows(shape) +
            2 * map_words(shape) * map_rows(shape)) *
           sizeof(float);
}

static bool same_shape(const snow_dense_shape *a, const snow_dense_shape *b) {
    return a->columns == b->columns && a->rows == b->rows &&
           a->channels == b->channels && a->taps_u == b->taps_u &&
           a->taps_v == b->taps_v && a->padded_u == b->padded_u;
}

snow_status snow_dense_make(snow_context *context,
                            const snow_dense_shape *shape, snow_dense *d) {
    if (same_shape(&d->shape, shape))
        return SNOW_STATUS_OK;
    size_t rows = (size_t)shape->rows;
    size_t samples = row_floats(shape) * all_rows(shape);
    size_t map_row = map_words(shape);
    d->shape = (snow_dense_shape){0}; /* invalid if memory runs out */
    SNOW_TRY(SNOW_RESERVE(context, d->samples, 0, samples));
    SNOW_TRY(SNOW_RESERVE(context, d->row_bits, 0, rows * map_row));
    SNOW_TRY(SNOW_RESERVE(context, d->reached, 0, map_rows(shape) * map_row));
    SNOW_TRY(SNOW_RESERVE(context, d->extents, 0, rows));
    memset(d->samples, 0, samples * sizeof *d->samples);
    memset(d->extents, 0, rows * sizeof *d->extents);
    d->stride = row_floats(shape);
    d->words = map_words(shape);
    d->shape = *shape;
    return SNOW_STATUS_OK;
}

void snow_dense_fini(snow_context *context, snow_dense *d) {
    snow_release(context, d->samples);
    snow_release(context, d->row_bits);
    snow_release(context, d->reached);
    snow_release(context, d->extents);
    *d = (snow_dense){0};
}

/* Sets bits first .. end - 1. */
static void set_bits(uint32_t *bits, size_t first, size_t end) {
    size_t word = first / WORD, last = (end - 1) / WORD;
    uint32_t from = UINT32_MAX << first % WORD;
    uint32_t upto = UINT32_MAX >> (WORD - 1 - (end - 1) % WORD);
    if (word == last) {
        bits[word] |= from & upto;
        return;
    }
    bits[word] |= from;
    while (++word < last)
        bits[word] = UINT32_MAX;
    bits[last] |= upto;
}

void snow_dense_begin(snow_dense *d) {
    d->walked = 0;
    d->c0 = d->shape.columns;
    d->r0 = d->shape.rows;
    d->c1 = d->r1 = 0;
}

/* Clears columns begin .. end - 1 of a row, if there are any. */
static void clear(float *row, size_t begin, size_t end, size_t channels) {
    if (begin < end)
        memset(row + begin * channels, 0,
               (end - begin) * channels * sizeof *row);
}

void snow_dense_add_row(snow_dense *d, const snow_span *spans, size_t count,
                        const float *samples) {
    size_t n = (size_t)d->walked++, channels = (size_t)d->shape.channels;
    size_t margin = (size_t)d->shape.taps_u;
    float *row = d->samples + (n + (size_t)d->shape.taps_v) * d->stride +
                 margin * channels;
    uint32_t *bits = d->row_bits + n * d->words;
    size_t at = d->extents[n].column, old_end = at + d->extents[n].length;
    memset(bits, 0, d->words * sizeof *bits);
    for (size_t s = 0; s < count; s++) {
        size_t first = spans[s].column, end = first + spans[s].length;
        clear(row, at, first < old_end ? first : old_end, channels);
        memcpy(row + first * channels, samples,
               (end - first) * channels * sizeof *row);
        samples += (end - first) * channels;
        set_bits(bits, first + 1, end + margin);
        at = end;
    }
    clear(row, at, old_end, channels);
    d->extents[n] = (snow_span){0, 0};
    if (!count)
        return;
    int64_t first = spans[0].column;
    d->extents[n] =
        (snow_span){(uint32_t)first, (uint32_t)at - (uint32_t)first};
    d->c0 = first < d->c0 ? first : d->c0;
    d->c1 = (int64_t)at > d->c1 ? (int64_t)at : d->c1;
    d->r0 = (int64_t)n < d->r0 ? (int64_t)n : d->r0;
    d->r1 = (int64_t)n + 1;
}

/* A window at row n holds voxel rows n - taps .. n - 1. */
void snow_dense_end(snow_dense *d) {
    int64_t taps = d->shape.taps_v, rows = d->shape.rows;
    for (int64_t n = 0; n <= rows + taps; n++) {
        uint32_t *out = d->reached + (size_t)n * d->words;
        memset(out, 0, d->words * sizeof *out);
        int64_t from = n - taps > d->r0 ? n - taps : d->r0;
        for (int64_t row = from; row < n && row < d->r1; row++) {
            const uint32_t *bits = d->row_bits + (size_t)row * d->words;
            for (size_t w = 0; w < d->words; w++)
                out[w] |= bits[w];
        }
    }
}
