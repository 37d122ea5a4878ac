/* render/modes/first_hit.c - where parallel rays begin to meet something
 * (splat/separable/occupancy.h).
 *
 * A row of cells takes the rows of all slices, the nearest first, as words of
 * bits: those that are set for the first time get the slice's number. */
#include "splat/separable/occupancy.h"

#include "base/thread_pool.h"

#include <math.h>
#include <string.h>

typedef struct first_job {
    const snow_occupancy *reached;
    snow_first_hit *first;
    const double *slope;
    bool rising;
    size_t words; /* of a row of cells */
} first_job;

static int64_t moved(double slope, int64_t slice) {
    return (int64_t)floor(slope * (double)slice);
}

/* 64 bits of a row of places from place `at` on, which may be outside. */
static uint64_t bits_at(const uint64_t *row, int64_t words, int64_t at) {
    int64_t word = at >> 6;
    int shift = (int)(at & 63);
    uint64_t low = word >= 0 && word < words ? row[word] : 0;
    uint64_t high = word + 1 >= 0 && word + 1 < words ? row[word + 1] : 0;
    return shift ? low >> shift | high << (64 - shift) : low;
}

/* The cells of a row that slice `number` from the front is the first of. */
static void take_row(const first_job *job, const uint64_t *row, int64_t at,
                     int32_t number, uint64_t *found, int32_t *slices) {
    for (size_t word = 0; word < job->words; word++, at += 64) {
        uint64_t bits = bits_at(row, (int64_t)job->reached->words, at);
        bits &= ~found[word];
        found[word] |= bits;
        for (; bits; bits &= bits - 1)
            slices[word * 64 + (size_t)__builtin_ctzll(bits)] = number;
    }
}

static void find_row(void *of, int64_t y, int worker) {
    const first_job *job = of;
    const snow_occupancy *r = job->reached;
    snow_first_hit *first = job->first;
    uint64_t *found = first->found + (size_t)worker * job->words;
    int32_t *slices = first->slices + (size_t)y * job->words * 64;
    memset(found, 0, job->words * sizeof *found);
    memset(slices, -1, job->words * 64 * sizeof *slices);
    for (int64_t n = 0; n < r->slices; n++) {
        int64_t k = job->rising ? n : r->slices - 1 - n;
        int64_t v = first->low[1] + y + moved(job->slope[1], k);
        if (v >= 0 && v < r->places[1])
            take_row(job, r->bits + (size_t)(k * r->places[1] + v) * r->words,
                     first->low[0] + moved(job->slope[0], k), (int32_t)n, found,
                     slices);
    }
}

/* floor(a + k s) is floor(a) + floor(k s), or 1 more: each cell takes the
 * nearest of four.  As unsigned numbers, of which none, -1, is the largest. */
static void join_cells(snow_first_hit *first) {
    size_t width = (size_t)first->cells[0];
    uint32_t *row = (uint32_t *)first->slices;
    for (int64_t y = 0; y < first->cells[1]; y++, row += width) {
        const uint32_t *below = y + 1 < first->cells[1] ? row + width : row;
        for (size_t x = 0; x < width; x++)
            row[x] = row[x] < below[x] ? row[x] : below[x];
        for (size_t x = 0; x + 1 < width; x++)
            row[x] = row[x] < row[x + 1] ? row[x] : row[x + 1];
    }
}

snow_status snow_first_hit_make(snow_context *context,
                                const snow_occupancy *reached,
                                const double slope[2], bool rising, int threads,
                                snow_first_hit *first) {
    first_job job = {reached, first, slope, rising, 0};
    uint64_t bytes;
    for (int axis = 0; axis < 2; axis++) {
        int64_t far = moved(slope[axis], reached->slices - 1);
        first->low[axis] = (far > 0 ? -far : 0) - 1;
        first->cells[axis] = reached->places[axis] + (far > 0 ? far : -far) + 2;
    }
    job.words = (size_t)(first->cells[0] + 63) / 64;
    first->cells[0] = (int64_t)job.words * 64;
    if (!snow_mul_u64(job.words * 64, (uint64_t)first->cells[1], &bytes) ||
        !snow_mul_u64(bytes, sizeof *first->slices, &bytes) || bytes > SIZE_MAX)
        return snow_fail(context, SNOW_STATUS_NO_MEMORY,
                         "out of memory for the map of first hits");
    SNOW_TRY(snow_reserve(context, &first->slices, &first->capacity, 0,
                          (size_t)bytes));
    SNOW_TRY(snow_reserve(context, &first->found, &first->found_capacity, 0,
                          job.words * (size_t)threads * sizeof *first->found));
    SNOW_TRY(snow_parallel(context, threads, first->cells[1], find_row, &job));
    join_cells(first);
    return SNOW_STATUS_OK;
}
