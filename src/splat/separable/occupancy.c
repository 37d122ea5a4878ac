/* splat/separable/occupancy.c - see occupancy.h. A voxel at column c is in the
 * windows at places c + 1 to c + taps: doubling spreads its bit over them. */
#include "splat/separable/occupancy.h"

#include "base/thread_pool.h"

#include <string.h>

/* The input of the slices' maps. */
typedef struct occupancy_job {
    const snow_bands *bands;
    const snow_decode_fns *windows;
    snow_occupancy *reached;
    char *scratch; /* of all workers */
    size_t scratch_bytes;
} occupancy_job;

/* Ors a row of bits, shifted up by `shift`, into itself. */
static void smear(uint64_t *row, size_t words, int shift) {
    for (size_t n = words; n-- > 0;) {
        uint64_t below = n > 0 ? row[n - 1] >> (64 - shift) : 0;
        row[n] |= row[n] << shift | below;
    }
}

/* The places along u whose windows hold a voxel of a row. */
static void spread_row(const occupancy_job *job, const snow_mask_rows *rows,
                       int row, uint64_t *out) {
    const snow_occupancy *r = job->reached;
    const uint64_t *bits = rows->bits + row + SNOW_DECODE_ROWS;
    uint64_t below = 0;
    for (size_t n = 0; n < r->words; n++) {
        uint64_t word = n + 1 < rows->words ? bits[n * SNOW_DECODE_ROWS] : 0;
        out[n] = word << 1 | below; /* place c + 1 is the first */
        below = word >> 63;
    }
    for (int have = 1; have < r->taps[0];) {
        int more = r->taps[0] - have < have ? r->taps[0] - have : have;
        more = more < 63 ? more : 63;
        smear(out, r->words, more);
        have += more;
    }
}

/* Ors the places of a voxel row into the rows of places of its windows. */
static void add_row(const occupancy_job *job, int64_t slice, int64_t row,
                    const uint64_t *spread) {
    const snow_occupancy *r = job->reached;
    uint64_t *to =
        r->bits + (size_t)(slice * r->places[1] + row + 1) * r->words;
    for (int n = 0; n < r->taps[1]; n++, to += r->words)
        for (size_t word = 0; word < r->words; word++)
            to[word] |= spread[word];
}

/* A worker's memory; returns how much that is. */
static size_t lay_out(const occupancy_job *job, char *base,
                      snow_mask_rows *rows, snow_span **spans,
                      uint64_t **spread) {
    size_t at = 0, columns = (size_t)job->bands->columns;
    snow_mask_rows_lay_out(rows, job->bands->columns, base, &at);
    *spans = snow_lay_out(base, &at, (columns / 2 + 1) * sizeof **spans);
    *spread = snow_lay_out(base, &at, job->reached->words * sizeof **spread);
    return at;
}

static void make_slice(void *of, int64_t slice, int worker) {
    const occupancy_job *job = of;
    snow_mask_rows rows = {.fetch = false};
    snow_span *spans;
    uint64_t *spread;
    lay_out(job, job->scratch + (size_t)worker * job->scratch_bytes, &rows,
            &spans, &spread);
    for (int64_t row = 0; row < job->bands->rows; row += SNOW_DECODE_ROWS) {
        job->windows->read(job->bands, slice, row, ~UINT64_C(0), spans, &rows);
        for (uint64_t held = rows.held; held; held &= held - 1) {
            int n = __builtin_ctzll(held);
            spread_row(job, &rows, n, spread);
            add_row(job, slice, row + n, spread);
        }
    }
}

snow_status snow_occupancy_make(const snow_bands *bands, const int taps[2],
                                const snow_decode_fns *windows, int threads,
                                snow_occupancy *r) {
    snow_context *context = bands->context;
    uint64_t rows, bytes;
    r->taps[0] = taps[0];
    r->taps[1] = taps[1];
    r->places[0] = bands->columns + taps[0] + 1;
    r->places[1] = bands->rows + taps[1] + 1;
    r->slices = bands->slices;
    r->words = (size_t)r->places[0] / 64 + 1;
    if (!snow_mul_u64((uint64_t)r->places[1], (uint64_t)r->slices, &rows) ||
        !snow_mul_u64(rows, r->words * sizeof *r->bits, &bytes) ||
        bytes > SIZE_MAX)
        return snow_fail(context, SNOW_STATUS_NO_MEMORY,
                         "out of memory for the occupancy map: free memory or "
                         "render a smaller part of the volume");
    SNOW_TRY(snow_reserve(context, &r->bits, &r->capacity, 0, (size_t)bytes));
    if (bytes) /* a part may have no slices */
        memset(r->bits, 0, (size_t)bytes);
    occupancy_job job = {bands, windows, r, NULL, 0};
    snow_mask_rows unused;
    snow_span *spans;
    uint64_t *spread;
    job.scratch_bytes = lay_out(&job, NULL, &unused, &spans, &spread);
    job.scratch =
        snow_allocate_array(context, (uint64_t)threads, job.scratch_bytes);
    if (!job.scratch)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status =
        snow_parallel(context, threads, r->slices, make_slice, &job);
    snow_release(context, job.scratch);
    return status;
}
