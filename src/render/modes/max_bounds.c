/* render/modes/max_bounds.c - what largest values may reach: bounds for every
 * four places along a row of voxels (splat/separable/rows.h), from which
 * maximum.c finds the slices that cannot change a tile.
 *
 *   row of voxels    v0   v1   v2   v3   v4 ...
 *   places          0   1    2    3    4    5 ...      place n lies between
 *   blocks         |  largest of 4   |  of the         voxels n - 1 and n
 *
 * A sheet of cubic B-splines is a spline itself, and between two voxels not
 * above the largest of its Bezier coefficients, along u and then along v: of
 * noise that is far below the largest voxel.  A wider kernel's weights are such
 * means of splines whose four voxels are all among its own, so that the places
 * of these bound it (a test looks for sheets that are above).  Near the ends,
 * where voxels are missing, and for other kernels it is the largest voxel in
 * reach. */
#include "render/modes/internal.h"

#include "base/thread_pool.h"

#include <string.h>

/* Rows and blocks that may be read before the first and behind the last.
 * Beyond the ends lie other rows, whose bounds are at worst too large; behind
 * each row are some blocks of 0. */
#define ROWS_BEYOND (SNOW_TAPS_MOST + 4)
#define BLOCKS_BEYOND 128
#define BLOCKS_BETWEEN 4

/* Bytes of bounds that a byte of the encoding may cost, and what is little
 * anyhow. */
#define BYTES_FOR_ONE 4
#define SMALL (1 << 20)

/* Zeros around a row of voxels. */
#define PAD 16

typedef struct blocks_job {
    const projection_pass *pass;
    char *scratch;
    size_t scratch_bytes;
} blocks_job;

/* A worker's own memory. */
typedef struct blocks_scratch {
    snow_mask_rows rows;
    snow_span *spans;
    float *row, *places; /* of a row: voxels, bounds */
    float *ring;         /* of four rows: bounds of blocks */
    float *zero, *both;
} blocks_scratch;

int64_t snow_block_columns(const snow_bands *bands) {
    return bands->columns / SNOW_BLOCK_COLUMNS + 1 + BLOCKS_BETWEEN;
}

int64_t snow_block_rows(const snow_bands *bands) {
    return bands->rows + 1;
}

static size_t lay_out(const snow_bands *bands, char *base, blocks_scratch *s) {
    size_t at = 0, floats = 64 * snow_decode_words(bands->columns) + 2 * PAD;
    size_t blocks = (size_t)snow_block_columns(bands);
    snow_mask_rows_lay_out(&s->rows, bands->columns, base, &at);
    s->rows.fetch = false;
    s->spans = snow_lay_out(
        base, &at, ((size_t)bands->columns / 2 + 1) * sizeof *s->spans);
    s->row = snow_lay_out(base, &at, floats * sizeof *s->row);
    s->places = snow_lay_out(base, &at, floats * sizeof *s->places);
    s->ring = snow_lay_out(base, &at, 4 * blocks * sizeof *s->ring);
    s->zero = snow_lay_out(base, &at, blocks * sizeof *s->zero);
    s->both = snow_lay_out(base, &at, blocks * sizeof *s->both);
    return at;
}

/* The largest of the voxels in reach of place n that there are. */
static float largest_near(const float *row, int64_t count, int64_t n) {
    int64_t first = n > 2 ? n - 2 : 0, last = n + 1 < count ? n + 1 : count - 1;
    float most = 0;
    for (; first <= last; first++)
        most = row[first] > most ? row[first] : most;
    return most;
}

/* Bounds of a row's blocks. */
static void bound_row(const blocks_job *job, const blocks_scratch *s, int n,
                      float *bounds) {
    const projection_pass *pass = job->pass;
    int64_t columns = pass->shear_warp->bands.columns;
    int64_t blocks = snow_block_columns(&pass->shear_warp->bands);
    float *row = s->row + PAD;
    (pass->code_bytes == 1 ? pass->fns->spread8 : pass->fns->spread16)(
        s->rows.bits + n + SNOW_DECODE_ROWS, SNOW_DECODE_ROWS,
        s->rows.words - 2, s->rows.codes[n], pass->scale, pass->start, row);
    if (!pass->hull) {
        pass->fns->fours(row, blocks, bounds);
        return;
    }
    const float *taps[4] = {row - 2, row - 1, row, row + 1};
    pass->fns->hull(taps, columns + 1, s->places);
    for (int64_t end = 0; end < 2; end++) {
        s->places[end] = largest_near(row, columns, end);
        s->places[columns - end] = largest_near(row, columns, columns - end);
    }
    pass->fns->fours(s->places, blocks, bounds);
}

/* The levels of a place between rows, out of the bounds of the rows near it;
 * those that are not there are zeros. */
static void bound_place(const blocks_job *job, const blocks_scratch *s,
                        const float *const *rows, bool end, uint16_t *out) {
    const projection_pass *pass = job->pass;
    const snow_bands *bands = &pass->shear_warp->bands;
    int64_t blocks = snow_block_columns(bands);
    const float *both = s->both;
    if (!pass->hull)
        both = rows[2];
    else if (!end)
        pass->fns->hull(rows, blocks, s->both);
    else
        for (int64_t n = 0; n < blocks; n++) {
            const float four[] = {rows[0][n], rows[1][n], rows[2][n],
                                  rows[3][n]};
            pass->fns->fours(four, 1, s->both + n);
        }
    pass->fns->blocks(both, blocks, out);
}

/* The blocks of a slice: place n along v has rows n - 2 to n + 1 in reach. */
static void bound_slice(void *of, int64_t slice, int worker) {
    const blocks_job *job = of;
    const projection_pass *pass = job->pass;
    const snow_bands *bands = &pass->shear_warp->bands;
    int64_t blocks = snow_block_columns(bands), places = snow_block_rows(bands);
    blocks_scratch s;
    lay_out(bands, job->scratch + (size_t)worker * job->scratch_bytes, &s);
    uint16_t *out = snow_maximum_bounds(pass, slice);
    const float *near[4] = {s.zero, s.zero, s.zero, s.zero};
    for (int64_t row = 0; row <= places; row++) {
        int n = (int)(row % SNOW_DECODE_ROWS);
        float *bounds = s.ring + row % 4 * blocks;
        if (n == 0)
            pass->windows->read(bands, slice, row, ~UINT64_C(0), s.spans,
                                &s.rows);
        memmove(near, near + 1, 3 * sizeof *near);
        near[3] = s.zero;
        if (s.rows.held >> n & 1) {
            bound_row(job, &s, n, bounds);
            near[3] = bounds;
        }
        bool some = false;
        for (int m = 0; m < 4; m++)
            some |= near[m] != s.zero;
        if (some && row > 0)
            bound_place(job, &s, near, row < 3 || row + 1 > bands->rows,
                        out + (row - 1) * blocks);
    }
}

/* Blocks before those of the first slice. */
static size_t blocks_beyond(const snow_bands *bands) {
    return (size_t)snow_block_columns(bands) * ROWS_BEYOND + BLOCKS_BEYOND;
}

/* Whether bounds are worth their *bytes: not where they would take far more
 * than the voxels, which are so few then that no bounds are needed, nor where
 * memory is what is short. */
static bool are_worth(const projection_pass *pass, uint64_t *bytes) {
    const snow_bands *bands = &pass->shear_warp->bands;
    return !pass->params->volume->stream &&
           snow_mul_u64((uint64_t)snow_block_columns(bands),
                        (uint64_t)snow_block_rows(bands), bytes) &&
           snow_mul_u64(*bytes, (uint64_t)bands->slices, bytes) &&
           snow_mul_u64(*bytes + 2 * blocks_beyond(bands), sizeof(uint16_t),
                        bytes) &&
           *bytes <= SIZE_MAX &&
           *bytes / BYTES_FOR_ONE <=
               bands->ea_bytes + bands->ia_bytes + bands->pa_bytes + SMALL;
}

static snow_status make_room(snow_shear_warp *s, uint64_t bytes) {
    s->blocks_of = 0;
    SNOW_TRY(snow_reserve(s->context, &s->blocks, &s->blocks_capacity, 0,
                          (size_t)bytes));
    memset(s->blocks, 0, (size_t)bytes);
    return SNOW_STATUS_OK;
}

uint16_t *snow_maximum_bounds(const projection_pass *pass, int64_t slice) {
    const snow_bands *bands = &pass->shear_warp->bands;
    return pass->shear_warp->blocks + blocks_beyond(bands) +
           (size_t)slice * (size_t)snow_block_columns(bands) *
               (size_t)snow_block_rows(bands);
}

snow_status snow_maximum_prepare(projection_pass *pass,
                                 const snow_value_scale *scale) {
    snow_shear_warp *s = pass->shear_warp;
    const snow_bands *bands = &s->bands;
    const snow_settings *settings = pass->params->settings;
    int threads = settings->threads;
    uint64_t bytes = 0;
    pass->bounded = true;
    pass->hull =
        settings->kernel == SNOW_KERNEL_BSPLINE && settings->footprint == 4;
    if (s->blocks_of == s->encodings && s->blocks_hull == pass->hull &&
        s->blocks_scale.from == scale->from &&
        s->blocks_scale.step == scale->step)
        return SNOW_STATUS_OK;
    pass->bounded = are_worth(pass, &bytes);
    if (!pass->bounded)
        return SNOW_STATUS_OK;
    SNOW_TRY(make_room(s, bytes));
    blocks_scratch unused;
    blocks_job job = {pass, NULL, lay_out(bands, NULL, &unused)};
    job.scratch =
        snow_allocate_array(s->context, (uint64_t)threads, job.scratch_bytes);
    if (!job.scratch)
        return SNOW_STATUS_NO_MEMORY;
    memset(job.scratch, 0, (size_t)threads * job.scratch_bytes);
    snow_status status =
        snow_parallel(s->context, threads, bands->slices, bound_slice, &job);
    snow_release(s->context, job.scratch);
    SNOW_TRY(status);
    s->blocks_of = s->encodings;
    s->blocks_hull = pass->hull;
    s->blocks_scale = *scale;
    return SNOW_STATUS_OK;
}
