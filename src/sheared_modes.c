/* sheared_modes.c - the sheared method without order and opacity: mip, minip,
 * mean and sum on the slices' own lattice (transform/shear.h).
 *
 * Nearly every voxel counts here, and none hides another, so that rows are
 * worked on as a whole instead of tiles, one number a pixel:
 *
 *   slice k, row j of voxels        ring of rows            line of the image
 *   EA, IA --spread--> floats --along u--> a row a phase --along v--> largest,
 *                                                                     or sum
 *
 * The weights that a pixel finds in a slice are known without voxels: those of
 * a whole grid (splat/cover.h).  Rows without a voxel above 0 cost nothing.  A
 * thread takes a band of lines through all slices; bands share nothing. */
#include "sheared_modes.h"

#include "base/parallel.h"
#include "composite/reduce.h"
#include "sheared_parts.h"
#include "splat/cover.h"
#include "splat/rows.h"

#include <math.h>
#include <string.h>

#define RING 64 /* rows at most that a line needs; a power of 2 */
#define PAD 64  /* zeros on either side of a row of voxels */
#define BAND_CELLS 32

/* How one slice lies on the lattice. */
typedef struct slice_place {
    const snow_comb *u, *v;
    int64_t first_row;             /* of cell 0, but for leads */
    snow_cover across[2], down[2]; /* per phase */
    /* Per phase and end along u: one over the weights that its pixels find. */
    float ends[2][2][SNOW_TAPS_MOST];
    int range[2][2]; /* per phase along u: pixels that find enough */
} slice_place;

/* One picture in the making. */
typedef struct modes_pass {
    const snow_sheared_order *order;
    snow_sheared *sheared;
    bool largest;
    snow_shear shear;
    snow_taper taper[2]; /* along u and v */
    int taps[2];
    int64_t slices;
    slice_place *places;
    const snow_window_fns *windows;
    const snow_row_fns *fns;
    float scale, start; /* of codes */
    int code_bytes;
    int within[2][2]; /* per phase along v: cells within all slices */
    int pixels[2];    /* cells along u and v: pixels of a phase */
    int cells;        /* of a band */
    int64_t bands;
    size_t row;    /* floats of a row of a phase */
    size_t dense;  /* of a row of voxels, pads included */
    size_t ring;   /* rows that are kept; a power of 2 */
    size_t stride; /* floats of a line of the plane */
    size_t scratch_bytes;
    float *plane;
} modes_pass;

/* A filtered row: pixels that may differ from 0, in any phase. */
typedef struct ring_row {
    int first, end;
} ring_row;

/* A worker's own memory, laid out in snow_sheared.scratch. */
typedef struct modes_scratch {
    uint64_t *bits; /* of the rows of a slice */
    uint32_t *rank;
    uint64_t *any;
    snow_span *spans;
    float *dense; /* a row of voxels */
    float *split; /* the same, where strides are 2: every second one, and the
                     others */
    float *ring;  /* [slot][phase][pixel] */
    float *zero;  /* a row of zeros */
    float *lines; /* of the band: [line][phase][pixel] */
    double *rise; /* of the weights along a line: [phase][pixel + 1] */
    float *weights, *usual; /* of a line: [phase][pixel] */
} modes_scratch;

/* A band on its way through the slices. */
typedef struct modes_stroke {
    const modes_pass *pass;
    modes_scratch scratch;
    snow_mask_rows rows;
    ring_row extents[RING];
    int first_cell, cells;
    bool weighed;        /* usual weights are there */
    size_t spread[2];    /* columns of the row of voxels that are not 0 */
    ring_row used[RING]; /* pixels of the ring that are not 0 */
    int filtered;        /* rows of the slice that went through the ring */
    const slice_place *place;
} modes_stroke;

bool snow_sheared_modes_fits(const snow_placement *placement) {
    return !placement->perspective;
}

/* --- rows ------------------------------------------------------------------
 */

/* Columns extent[0] .. extent[1] - 1 of row j hold all its voxels. */
static void find_extent(const modes_stroke *stroke, int j, size_t extent[2]) {
    const uint64_t *bits = stroke->rows.bits + j;
    size_t first = SNOW_WINDOW_PAD / 64, last = stroke->rows.words - 1;
    while (!bits[first * SNOW_WINDOW_ROWS])
        first++;
    while (!bits[last * SNOW_WINDOW_ROWS])
        last--;
    extent[0] = first * 64 - SNOW_WINDOW_PAD;
    extent[1] = last * 64 + 64 - SNOW_WINDOW_PAD;
}

/* Row j as floats, with zeros around it. */
static void spread_row(modes_stroke *stroke, int j, const size_t extent[2]) {
    const modes_pass *pass = stroke->pass;
    float *row = stroke->scratch.dense + PAD;
    size_t *old = stroke->spread;
    const uint64_t *bits =
        stroke->rows.bits + j +
        (extent[0] + SNOW_WINDOW_PAD) / 64 * SNOW_WINDOW_ROWS;
    if (old[0] < extent[0] || old[1] > extent[1])
        memset(row + old[0], 0, (old[1] - old[0]) * sizeof *row);
    old[0] = extent[0];
    old[1] = extent[1];
    (pass->code_bytes == 1 ? pass->fns->spread8 : pass->fns->spread16)(
        bits, SNOW_WINDOW_ROWS, (extent[1] - extent[0]) / 64,
        stroke->rows.codes[j], pass->scale, pass->start, row + extent[0]);
    if (pass->shear.u.stride == 1)
        return;
    size_t half = pass->dense / 2;
    for (size_t n = extent[0] / 2; n < (extent[1] + 2 * PAD) / 2; n++) {
        stroke->scratch.split[n] = stroke->scratch.dense[2 * n];
        stroke->scratch.split[n + half] = stroke->scratch.dense[2 * n + 1];
    }
}

/* The first pixel of a phase that lies at or behind a voxel. */
static int pixel_behind(const snow_cover *cover, int64_t voxel, int pixels) {
    int64_t ahead = voxel - cover->start;
    int64_t n = ahead > 0 ? (ahead + cover->stride - 1) / cover->stride : 0;
    return n < pixels ? (int)n : pixels;
}

/* Pixels at one end of a slice that find a part of their weights; where it is
 * thin, all are at the first end. */
static void end_pixels(const snow_cover *cover, int side, int range[2]) {
    int in = cover->in < cover->to ? cover->in : cover->to;
    range[0] = side == 0 ? cover->from : cover->out > in ? cover->out : in;
    range[1] = side == 0 ? in : cover->to;
}

/* Makes up for the weights that pixels at the ends do not find. */
static void fill_ends(const slice_place *place, int phase, ring_row row,
                      float *pixels) {
    for (int side = 0; side < 2; side++) {
        int range[2];
        end_pixels(&place->across[phase], side, range);
        const float *factors = place->ends[phase][side] - range[0];
        int from = range[0] > row.first ? range[0] : row.first;
        int to = range[1] < row.end ? range[1] : row.end;
        for (int n = from; n < to; n++)
            pixels[n] *= factors[n];
    }
}

/* Sets the weights of a job: those of one or two phases. */
static void aim(snow_rows_job *job, const snow_cover *covers, int lead) {
    job->taps = covers[0].taps;
    job->lead = lead;
    job->weights[0] = covers[0].weights;
    job->weights[1] = covers[1].weights;
}

/* Where the voxels of the taps lie for pixel `n`: one more, for the lead. */
static void find_taps(const modes_stroke *stroke, int n, snow_rows_job *job) {
    const modes_pass *pass = stroke->pass;
    const snow_cover *cover = stroke->place->across;
    int64_t at = PAD + cover->start + (int64_t)n * cover->stride;
    for (int m = 0; m <= cover->taps; m++, at++)
        job->rows[m] = cover->stride == 1 ? stroke->scratch.dense + at
                                          : stroke->scratch.split + at / 2 +
                                                (at % 2 ? pass->dense / 2 : 0);
}

/* The pixels that voxels of an extent reach. */
static ring_row reached(const modes_stroke *stroke, const size_t extent[2]) {
    const modes_pass *pass = stroke->pass;
    ring_row reached = {pass->pixels[0], 0};
    for (int phase = 0; phase < pass->shear.u.phases; phase++) {
        const snow_cover *cover = &stroke->place->across[phase];
        int first = pixel_behind(cover, (int64_t)extent[0] - cover->taps + 1,
                                 pass->pixels[0]);
        int end = pixel_behind(cover, (int64_t)extent[1], pass->pixels[0]);
        reached.first = first < reached.first ? first : reached.first;
        reached.end = end > reached.end ? end : reached.end;
    }
    return reached;
}

/* Row j of the slice, combed along u, into its slot of the ring. */
static void filter_row(modes_stroke *stroke, int j) {
    const modes_pass *pass = stroke->pass;
    const snow_cover *covers = stroke->place->across;
    const int phases = pass->shear.u.phases;
    size_t slot = (size_t)j & (pass->ring - 1), extent[2];
    ring_row *told = &stroke->extents[slot];
    float *row = stroke->scratch.ring + slot * (size_t)phases * pass->row;
    *told = (ring_row){0, 0};
    if (!(stroke->rows.held >> j & 1))
        return;
    find_extent(stroke, j, extent);
    ring_row to = reached(stroke, extent);
    if (to.first >= to.end)
        return;
    spread_row(stroke, j, extent);
    snow_rows_job job; /* not as zeros: it is large */
    aim(&job, covers, stroke->place->u->lead[1]);
    job.first = 0;
    job.end = to.end - to.first;
    job.lines[0] = row + to.first;
    job.lines[1] = phases == 2 ? row + pass->row + to.first : NULL;
    ring_row *used = &stroke->used[slot];
    if (used->first < to.first || used->end > to.end)
        for (int phase = 0; phase < phases; phase++)
            memset(row + (size_t)phase * pass->row + used->first, 0,
                   (size_t)(used->end - used->first) * sizeof *row);
    *used = to;
    find_taps(stroke, to.first, &job);
    pass->fns->set(&job);
    if (pass->largest)
        for (int phase = 0; phase < phases; phase++)
            fill_ends(stroke->place, phase, to,
                      row + (size_t)phase * pass->row);
    *told = to;
}

/* --- lines -----------------------------------------------------------------
 */

/* The rows of one or two lines, out of the ring: phase 0 along u.  False where
 * all of them are empty. */
static bool find_rows(const modes_stroke *stroke, int first, int count,
                      snow_rows_job *job) {
    const modes_pass *pass = stroke->pass;
    size_t step = (size_t)pass->shear.u.phases * pass->row;
    job->first = pass->pixels[0];
    job->end = 0;
    for (int m = 0; m < count; m++) {
        size_t slot = (size_t)(first + m) & (pass->ring - 1);
        const ring_row *told = &stroke->extents[slot];
        if (told->first >= told->end) {
            job->rows[m] = stroke->scratch.zero;
            continue;
        }
        job->rows[m] = stroke->scratch.ring + slot * step;
        job->first = told->first < job->first ? told->first : job->first;
        job->end = told->end > job->end ? told->end : job->end;
    }
    return job->first < job->end;
}

/* Lines 08 to 13 for the lines of a job, in all phases along u.  `found` is
 * what they find of weights along v, alike if they are two. */
static void reduce_lines(const modes_stroke *stroke, const snow_rows_job *lines,
                         float found) {
    const modes_pass *pass = stroke->pass;
    snow_rows_job job;
    memcpy(job.rows, lines->rows,
           (size_t)(lines->taps + lines->lead) * sizeof *job.rows);
    memcpy(job.weights, lines->weights, sizeof job.weights);
    memcpy(job.lines, lines->lines, sizeof job.lines);
    job.taps = lines->taps;
    job.lead = lines->lead;
    for (int phase = 0; phase < pass->shear.u.phases; phase++) {
        int range[2] = {stroke->place->range[phase][0],
                        stroke->place->range[phase][1]};
        if (pass->largest && found < 1)
            snow_cover_range(&stroke->place->across[phase],
                             SNOW_WEIGHT_ENOUGH / found, range);
        job.first = lines->first;
        job.end = lines->end;
        if (pass->largest) {
            job.first = range[0] > job.first ? range[0] : job.first;
            job.end = range[1] < job.end ? range[1] : job.end;
        }
        if (job.first < job.end)
            (pass->largest ? pass->fns->most : pass->fns->add)(&job);
        for (int m = 0; m < job.taps + job.lead; m++)
            if (job.rows[m] != stroke->scratch.zero)
                job.rows[m] += pass->row;
        job.lines[0] += pass->row;
        if (job.lines[1])
            job.lines[1] += pass->row;
    }
}

/* One line of a cell, near an end of the slice: weights that it does not find
 * are made up for. */
static void reduce_line(const modes_stroke *stroke, int cell, int phase,
                        float *line) {
    const modes_pass *pass = stroke->pass;
    const snow_cover *cover = &stroke->place->down[phase];
    float weights[SNOW_TAPS_MOST], found;
    snow_rows_job job;
    job.taps = cover->taps;
    job.lead = 0;
    job.weights[0] = weights;
    job.weights[1] = NULL;
    job.lines[0] = line;
    job.lines[1] = NULL;
    found = snow_cover_at(cover, stroke->first_cell + cell);
    if (!(found > 0) || (pass->largest && found < SNOW_WEIGHT_ENOUGH))
        return;
    if (!find_rows(stroke, cell * cover->stride + stroke->place->v->lead[phase],
                   cover->taps, &job))
        return;
    for (int m = 0; m < cover->taps; m++)
        weights[m] = cover->weights[m] / (pass->largest ? found : 1);
    reduce_lines(stroke, &job, found);
}

/* The lines of one cell. */
static void reduce_cell(modes_stroke *stroke, int cell) {
    const modes_pass *pass = stroke->pass;
    const snow_lattice *v = &pass->shear.v;
    const snow_cover *covers = stroke->place->down;
    int lead = stroke->place->v->lead[1], at = stroke->first_cell + cell;
    int row = cell * v->stride, count = pass->taps[1] + lead;
    size_t floats = (size_t)pass->shear.u.phases * pass->row;
    float *line = stroke->scratch.lines + (size_t)(cell * v->phases) * floats;
    for (; stroke->filtered < row + count; stroke->filtered++)
        filter_row(stroke, stroke->filtered);
    if (v->phases == 1 || snow_cover_at(&covers[0], at) < 1 ||
        snow_cover_at(&covers[1], at) < 1) {
        for (int phase = 0; phase < v->phases; phase++)
            reduce_line(stroke, cell, phase, line + (size_t)phase * floats);
        return;
    }
    snow_rows_job job;
    aim(&job, covers, lead);
    job.lines[0] = line;
    job.lines[1] = line + floats;
    if (find_rows(stroke, row, count, &job))
        reduce_lines(stroke, &job, 1);
}

/* Rows of the slice's first `row` rows that no line needs are passed over. */
static void reduce_slice(modes_stroke *stroke, int64_t slice) {
    const modes_pass *pass = stroke->pass;
    const snow_lattice *v = &pass->shear.v;
    stroke->place = &pass->places[slice];
    int reach = stroke->place->v->lead[1] + pass->taps[1];
    int64_t first =
        stroke->place->first_row + (int64_t)stroke->first_cell * v->stride;
    pass->windows->read(&pass->sheared->bands, slice, first,
                        ~UINT64_C(0) >>
                            (64 - ((stroke->cells - 1) * v->stride + reach)),
                        stroke->scratch.spans, &stroke->rows);
    if (!stroke->rows.held)
        return;
    stroke->filtered = 0;
    for (int cell = 0; cell < stroke->cells; cell++) {
        int row = cell * v->stride;
        if (stroke->filtered < row) /* between cells, where strides are 2 */
            stroke->filtered = row;
        reduce_cell(stroke, cell);
    }
}

/* --- weights ---------------------------------------------------------------
 */

/* Adds a slice's weights, times those along v, to the rises along a line. */
static void add_weights(const snow_cover *cover, double found, double *rise) {
    int in = cover->in < cover->to ? cover->in : cover->to;
    int out = cover->out > in ? cover->out : in;
    for (int n = cover->from; n < cover->to; n = n + 1 == in ? out : n + 1) {
        double weight = found * (double)snow_cover_at(cover, n);
        rise[n] += weight;
        rise[n + 1] -= weight;
    }
    rise[in] += found;
    rise[out] -= found;
}

/* How the weights of all slices rise along a line of the band: their sum, or
 * how many slices find enough. */
static void weigh_line(const modes_stroke *stroke, int cell, int down) {
    const modes_pass *pass = stroke->pass;
    size_t row = (size_t)pass->pixels[0] + 1;
    double *rise = stroke->scratch.rise;
    memset(rise, 0, (size_t)pass->shear.u.phases * row * sizeof *rise);
    for (int64_t k = 0; k < pass->slices; k++) {
        const slice_place *place = &pass->places[k];
        float found = snow_cover_at(&place->down[down], cell);
        if (!(found > 0) || (pass->largest && found < SNOW_WEIGHT_ENOUGH))
            continue;
        for (int phase = 0; phase < pass->shear.u.phases; phase++) {
            double *rises = rise + (size_t)phase * row;
            int range[2] = {place->range[phase][0], place->range[phase][1]};
            if (!pass->largest) {
                add_weights(&place->across[phase], (double)found, rises);
                continue;
            }
            if (found < 1)
                snow_cover_range(&place->across[phase],
                                 SNOW_WEIGHT_ENOUGH / found, range);
            if (range[0] >= range[1])
                continue;
            rises[range[0]] += 1;
            rises[range[1]] -= 1;
        }
    }
}

/* The weights of a line's pixels, out of their rises. */
static void sum_rises(const modes_pass *pass, const double *rise,
                      float *weights) {
    double share = 1 / (double)pass->slices;
    for (int phase = 0; phase < pass->shear.u.phases; phase++) {
        double sum = 0;
        for (int n = 0; n < pass->pixels[0]; n++) {
            sum += rise[n];
            weights[n] = (float)(pass->largest ? sum > 0.5 : share * sum);
        }
        rise += pass->pixels[0] + 1;
        weights += pass->row;
    }
}

/* The weights of a line; most lines lie within all slices, and have the same.
 */
static const float *weights_of(modes_stroke *stroke, int cell, int down) {
    const modes_pass *pass = stroke->pass;
    bool within = cell >= pass->within[down][0] && cell < pass->within[down][1];
    if (!within || !stroke->weighed) {
        weigh_line(stroke, cell, down);
        sum_rises(pass, stroke->scratch.rise,
                  within ? stroke->scratch.usual : stroke->scratch.weights);
        stroke->weighed |= within;
    }
    return within ? stroke->scratch.usual : stroke->scratch.weights;
}

/* Lines of the plane, out of their phases and weights. */
static void finish_band(modes_stroke *stroke) {
    const modes_pass *pass = stroke->pass;
    const snow_lattice *v = &pass->shear.v;
    const int phases = pass->shear.u.phases;
    size_t floats = (size_t)phases * pass->row;
    float share = 1 / (float)pass->slices;
    for (int n = 0; n < stroke->cells * v->phases; n++) {
        int at = stroke->first_cell * v->phases + n;
        float *line = stroke->scratch.lines + (size_t)n * floats;
        if (at >= v->count)
            break;
        const float *weights = weights_of(
            stroke, stroke->first_cell + n / v->phases, n % v->phases);
        for (size_t i = 0; i < floats; i++)
            line[i] *= pass->largest ? weights[i] : share;
        const float *values[2] = {line, line + pass->row};
        const float *found[2] = {weights, weights + pass->row};
        pass->fns->weave(values, found, phases, pass->pixels[0],
                         pass->plane + (size_t)at * pass->stride);
    }
}

/* --- a band ----------------------------------------------------------------
 */

/* The parts of a worker's memory, each aligned to 64 bytes; returns the bytes
 * that they take.  With a NULL base nothing but the sum counts. */
static size_t lay_out(const modes_pass *pass, char *base, modes_scratch *out) {
    size_t at = 0, phases = (size_t)pass->shear.u.phases;
    int64_t columns = pass->sheared->bands.columns;
    size_t words = snow_window_words(columns) * SNOW_WINDOW_ROWS;
    size_t row = pass->row * sizeof(float);
#define PART(field, bytes)                              \
    do {                                                \
        out->field = base ? (void *)(base + at) : NULL; \
        at += ((bytes) + 63) / 64 * 64;                 \
    } while (0)
    PART(bits, words * sizeof *out->bits);
    PART(rank, words * sizeof *out->rank);
    PART(any, words / SNOW_WINDOW_ROWS * sizeof *out->any);
    PART(spans, ((size_t)columns / 2 + 1) * sizeof *out->spans);
    PART(dense, pass->dense * sizeof(float));
    PART(split, pass->dense * sizeof(float));
    PART(ring, pass->ring * phases * row);
    PART(zero, row);
    PART(lines, (size_t)(pass->cells * pass->shear.v.phases) * phases * row);
    PART(rise, phases * ((size_t)pass->pixels[0] + 1) * sizeof *out->rise);
    PART(weights, phases * row);
    PART(usual, phases * row);
#undef PART
    return at;
}

static void reduce_band(void *of, int64_t item, int worker) {
    const modes_pass *pass = of;
    modes_stroke stroke = {.pass = pass};
    size_t words = snow_window_words(pass->sheared->bands.columns);
    lay_out(pass, pass->sheared->scratch + (size_t)worker * pass->scratch_bytes,
            &stroke.scratch);
    stroke.rows.bits = stroke.scratch.bits;
    stroke.rows.rank = stroke.scratch.rank;
    stroke.rows.any = stroke.scratch.any;
    stroke.rows.words = words;
    stroke.first_cell = (int)item * pass->cells;
    int left = pass->pixels[1] - stroke.first_cell;
    stroke.cells = left < pass->cells ? left : pass->cells;
    size_t row = (size_t)pass->shear.u.phases * pass->row;
    memset(stroke.scratch.zero, 0, pass->row * sizeof(float));
    memset(stroke.scratch.dense, 0, pass->dense * sizeof(float));
    memset(stroke.scratch.ring, 0, pass->ring * row * sizeof(float));
    memset(stroke.scratch.lines, 0,
           (size_t)(stroke.cells * pass->shear.v.phases) * row * sizeof(float));
    for (int64_t k = 0; k < pass->slices; k++)
        reduce_slice(&stroke, k);
    finish_band(&stroke);
}

/* --- setting up ------------------------------------------------------------
 */

/* Pixels a voxel, or voxels a pixel.  Largest values have edges where one slice
 * gives way to another, so that they are taken as finely as over's (sheared.c).
 * Sums are smooth: of Engine and CThead, warped from a pixel a voxel, they are
 * 70 dB and more from the exact ones. */
static void choose_pitch(const snow_taper *taper, bool largest, bool draft,
                         int *phases, int *stride) {
    *phases = largest && !draft && taper->wide < 1.2 ? 2 : 1;
    *stride = taper->wide >= (draft ? 2 : 2.5) ? 2 : 1;
}

static snow_status place_lattice(modes_pass *pass) {
    const snow_placement *p = pass->order->placement;
    const snow_settings *settings = pass->order->settings;
    bool draft = settings->quality == SNOW_QUALITY_DRAFT;
    snow_shear_options options;
    for (int axis = 0; axis < 2; axis++) {
        snow_taper *taper = &pass->taper[axis];
        *taper =
            snow_taper_make(settings->kernel, settings->footprint,
                            hypot(p->inverse[axis][0], p->inverse[axis][1]));
        pass->taps[axis] = snow_comb_taps(taper);
        choose_pitch(taper, pass->largest, draft, &options.phases[axis],
                     &options.stride[axis]);
        options.reach[axis] = snow_taper_reach(taper);
    }
    SNOW_TRY(
        snow_shear_make(pass->sheared->context, p, &options, &pass->shear));
    const snow_lattice *lattices[2] = {&pass->shear.u, &pass->shear.v};
    for (int axis = 0; axis < 2; axis++)
        pass->pixels[axis] =
            (lattices[axis]->count + lattices[axis]->phases - 1) /
            lattices[axis]->phases;
    pass->row = ((size_t)pass->pixels[0] + 15) / 16 * 16 + SNOW_ROWS_BEYOND;
    /* The warp may read a vector beyond the last pixel. */
    pass->stride =
        2 * ((size_t)pass->pixels[0] * (size_t)pass->shear.u.phases + 16);
    pass->dense =
        ((size_t)pass->sheared->bands.columns / 64 + 1) * 64 + 2 * PAD;
    int rows = SNOW_WINDOW_ROWS - pass->taps[1] - 1;
    pass->cells = rows / pass->shear.v.stride + 1;
    if (pass->cells > BAND_CELLS)
        pass->cells = BAND_CELLS;
    pass->bands = (pass->pixels[1] + pass->cells - 1) / pass->cells;
    for (pass->ring = 1; pass->ring < (size_t)pass->taps[1] + 1;)
        pass->ring *= 2;
    return SNOW_OK;
}

/* The kernels of all slices and what they cover. */
static void place_slice(modes_pass *pass, int64_t k) {
    snow_comb *combs = pass->sheared->combs + 2 * k;
    slice_place *place = &pass->places[k];
    const snow_lattice *lattices[2] = {&pass->shear.u, &pass->shear.v};
    const int64_t voxels[2] = {pass->sheared->bands.columns,
                               pass->sheared->bands.rows};
    place->u = &combs[0];
    place->v = &combs[1];
    for (int axis = 0; axis < 2; axis++) {
        const snow_lattice *lattice = lattices[axis];
        snow_comb_make(&pass->taper[axis], lattice, (double)k, &combs[axis]);
        int64_t first = lattice->first / lattice->phases * lattice->stride +
                        combs[axis].offset;
        if (axis == 1)
            place->first_row = first;
        for (int phase = 0; phase < lattice->phases; phase++)
            (axis == 0 ? place->across : place->down)[phase] = snow_cover_make(
                &combs[axis], phase, pass->taps[axis], first, lattice->stride,
                voxels[axis], pass->pixels[axis]);
    }
    for (int phase = 0; phase < pass->shear.u.phases; phase++) {
        snow_cover_range(&place->across[phase], SNOW_WEIGHT_ENOUGH,
                         place->range[phase]);
        for (int side = 0; side < 2; side++) {
            int range[2];
            end_pixels(&place->across[phase], side, range);
            for (int n = range[0]; n < range[1]; n++) {
                float found = snow_cover_at(&place->across[phase], n);
                place->ends[phase][side][n - range[0]] =
                    found > 0 ? 1 / found : 0;
            }
        }
    }
    for (int phase = 0; phase < pass->shear.v.phases; phase++) {
        int *within = pass->within[phase];
        const snow_cover *down = &place->down[phase];
        within[0] = down->in > within[0] ? down->in : within[0];
        within[1] = down->out < within[1] ? down->out : within[1];
    }
}

static snow_status reserve_buffers(modes_pass *pass) {
    snow_sheared *s = pass->sheared;
    const snow_settings *settings = pass->order->settings;
    modes_scratch unused;
    size_t slices = (size_t)pass->slices;
    int threads =
        settings->threads < pass->bands ? settings->threads : (int)pass->bands;
    pass->scratch_bytes = lay_out(pass, NULL, &unused);
    SNOW_TRY(snow_reserve(s->context, &s->scratch, &s->scratch_capacity, 0,
                          pass->scratch_bytes * (size_t)threads));
    SNOW_TRY(snow_reserve(s->context, &s->combs, &s->combs_capacity, 0,
                          2 * slices * sizeof *s->combs));
    SNOW_TRY(snow_reserve(s->context, &s->teeth, &s->teeth_capacity, 0,
                          slices * sizeof *pass->places));
    pass->places = (slice_place *)(void *)s->teeth;
    snow_canvas *canvas = s->canvas;
    SNOW_TRY(snow_reserve(s->context, &canvas->plane, &canvas->plane_capacity,
                          0,
                          ((size_t)pass->shear.v.count + 1) * pass->stride *
                              sizeof *canvas->plane));
    pass->plane = canvas->plane;
    return snow_reserve(s->context, &canvas->drawn, &canvas->drawn_capacity, 0,
                        1);
}

/* Numbers of codes are on a straight line: any two tell of all. */
static void scale_codes(modes_pass *pass, const snow_value_scale *scale) {
    const snow_coder *coder = &pass->sheared->coder;
    double one = snow_coder_value(coder, 1), far = snow_coder_value(coder, 129);
    double slope = (far - one) / 128 / scale->step;
    pass->scale = (float)slope;
    pass->start = (float)((one - scale->from) / scale->step - slope);
    pass->code_bytes = coder->bytes;
}

static void keep_warping(modes_pass *pass) {
    const snow_settings *settings = pass->order->settings;
    snow_canvas *canvas = pass->sheared->canvas;
    snow_sheared_warping *w = &canvas->warping;
    w->perspective = false;
    w->shear = pass->shear;
    w->filter = settings->quality == SNOW_QUALITY_DRAFT ? SNOW_BILINEAR
                                                        : SNOW_CATMULL_ROM;
    w->warp = snow_warp_of(settings->isa, w->filter, 2);
    w->width = pass->order->view->width;
    w->height = pass->order->view->height;
    canvas->drawn[0] = 1;
    w->plane = (snow_plane){pass->plane,
                            pass->stride,
                            pass->shear.u.count,
                            pass->shear.v.count,
                            2,
                            canvas->drawn,
                            pass->shear.u.count,
                            pass->shear.v.count,
                            1};
}

snow_status snow_sheared_reduce(snow_sheared *s,
                                const snow_sheared_order *order, bool largest,
                                const snow_value_scale *scale,
                                snow_stats *stats, snow_sheared_image *out) {
    const snow_settings *settings = order->settings;
    modes_pass pass = {.order = order,
                       .sheared = s,
                       .largest = largest,
                       .slices = order->placement->slices,
                       .windows = snow_window_fns_of(settings->isa),
                       .fns = snow_row_fns_of(settings->isa)};
    double mark = snow_seconds();
    SNOW_TRY(snow_sheared_encode(s, order, stats));
    double encoded = snow_seconds();
    stats->seconds_encode += encoded - mark;
    snow_sheared_fill_figures(s, stats);
    scale_codes(&pass, scale);
    SNOW_TRY(place_lattice(&pass));
    SNOW_TRY(reserve_buffers(&pass));
    keep_warping(&pass);
    *out = (snow_sheared_image){.warping = &s->canvas->warping};
    if (pass.shear.u.count == 0 || pass.shear.v.count == 0)
        return SNOW_OK;
    for (int phase = 0; phase < 2; phase++)
        pass.within[phase][1] = pass.pixels[1];
    for (int64_t k = 0; k < pass.slices; k++)
        place_slice(&pass, k);
    snow_parallel(s->context, settings->threads, pass.bands, reduce_band,
                  &pass);
    stats->seconds_splat += snow_seconds() - encoded;
    return SNOW_OK;
}
