/* render/modes/sums.c - the sheared method without order and opacity: mip,
 * minip, mean and sum on the slices' own lattice (transform/shear.h).
 *
 * Nearly every voxel counts in a sum, and none hides another, so that rows are
 * worked on as a whole instead of tiles, one number a pixel:
 *
 *   slice k, row j of voxels        ring of rows            line of the image
 *   EA, IA --spread--> floats --along u--> a row a phase --along v--> sum
 *
 * The weights that a pixel finds in a slice are known without voxels: those of
 * a whole grid (splat/separable/coverage.h).  Rows without a voxel above 0 cost
 * nothing.  A thread takes a band of lines through all slices; bands share
 * nothing. Largest values, of which most voxels can be none, are in maximum.c.
 */
#include "render/modes/internal.h"

#include "base/thread_pool.h"

#include <math.h>
#include <string.h>

#define RING 64 /* rows at most that a line needs; a power of 2 */
#define PAD 64  /* zeros on either side of a row of voxels */
#define BAND_CELLS 32

/* A filtered row: pixels that may differ from 0, in any phase. */
typedef struct ring_row {
    int first, end;
} ring_row;

/* A worker's own memory, laid out in snow_shear_warp.scratch. */
typedef struct modes_scratch {
    snow_mask_rows rows; /* of a slice */
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
typedef struct sum_band_task {
    const projection_pass *pass;
    modes_scratch scratch;
    ring_row extents[RING];
    int first_cell, cells;
    bool weighed;        /* usual weights are there */
    size_t spread[2];    /* columns of the row of voxels that are not 0 */
    ring_row used[RING]; /* pixels of the ring that are not 0 */
    int filtered;        /* rows of the slice that went through the ring */
    const snow_slice_place *place;
} sum_band_task;

/* --- rows ----------------------------------------------------------------- */

/* Columns extent[0] .. extent[1] - 1 of row j hold all its voxels. */
static void find_extent(const sum_band_task *stroke, int j, size_t extent[2]) {
    const uint64_t *bits = stroke->scratch.rows.bits + j;
    size_t first = SNOW_DECODE_PAD / 64, last = stroke->scratch.rows.words - 1;
    while (!bits[first * SNOW_DECODE_ROWS])
        first++;
    while (!bits[last * SNOW_DECODE_ROWS])
        last--;
    extent[0] = first * 64 - SNOW_DECODE_PAD;
    extent[1] = last * 64 + 64 - SNOW_DECODE_PAD;
}

/* Row j as floats, with zeros around it. */
static void spread_row(sum_band_task *stroke, int j, const size_t extent[2]) {
    const projection_pass *pass = stroke->pass;
    float *row = stroke->scratch.dense + PAD;
    size_t *old = stroke->spread;
    const uint64_t *bits =
        stroke->scratch.rows.bits + j +
        (extent[0] + SNOW_DECODE_PAD) / 64 * SNOW_DECODE_ROWS;
    if (old[0] < extent[0] || old[1] > extent[1])
        memset(row + old[0], 0, (old[1] - old[0]) * sizeof *row);
    old[0] = extent[0];
    old[1] = extent[1];
    (pass->code_bytes == 1 ? pass->fns->spread8 : pass->fns->spread16)(
        bits, SNOW_DECODE_ROWS, (extent[1] - extent[0]) / 64,
        stroke->scratch.rows.codes[j], pass->scale, pass->start,
        row + extent[0]);
    if (pass->shear.u.stride == 1)
        return;
    size_t half = pass->dense / 2;
    for (size_t n = extent[0] / 2; n < (extent[1] + 2 * PAD) / 2; n++) {
        stroke->scratch.split[n] = stroke->scratch.dense[2 * n];
        stroke->scratch.split[n + half] = stroke->scratch.dense[2 * n + 1];
    }
}

/* The first pixel of a phase that lies at or behind a voxel. */
static int pixel_behind(const snow_coverage *cover, int64_t voxel, int pixels) {
    int64_t ahead = voxel - cover->start;
    int64_t n = ahead > 0 ? (ahead + cover->stride - 1) / cover->stride : 0;
    return n < pixels ? (int)n : pixels;
}

/* Sets the weights of a job: those of one or two phases. */
static void aim(snow_rows_job *job, const snow_coverage *covers, int lead) {
    job->taps = covers[0].taps;
    job->lead = lead;
    job->weights[0] = covers[0].weights;
    job->weights[1] = covers[1].weights;
}

/* Where the voxels of the taps lie for pixel `n`: one more, for the lead. */
static void find_taps(const sum_band_task *stroke, int n, snow_rows_job *job) {
    const projection_pass *pass = stroke->pass;
    const snow_coverage *cover = stroke->place->across;
    int64_t at =
        PAD + cover->start - pass->stored[0] + (int64_t)n * cover->stride;
    for (int m = 0; m <= cover->taps; m++, at++)
        job->rows[m] = cover->stride == 1 ? stroke->scratch.dense + at
                                          : stroke->scratch.split + at / 2 +
                                                (at % 2 ? pass->dense / 2 : 0);
}

/* The pixels that voxels of an extent reach. */
static ring_row reached(const sum_band_task *stroke, const size_t extent[2]) {
    const projection_pass *pass = stroke->pass;
    ring_row reached = {pass->pixels[0], 0};
    for (int phase = 0; phase < pass->shear.u.phases; phase++) {
        const snow_coverage *cover = &stroke->place->across[phase];
        int first = pixel_behind(
            cover, pass->stored[0] + (int64_t)extent[0] - cover->taps + 1,
            pass->pixels[0]);
        int end = pixel_behind(cover, pass->stored[0] + (int64_t)extent[1],
                               pass->pixels[0]);
        reached.first = first < reached.first ? first : reached.first;
        reached.end = end > reached.end ? end : reached.end;
    }
    return reached;
}

/* Leaves nothing of a row beyond the part's own pixels. */
static void cut_row(const int own[2], ring_row row, float *pixels) {
    int end = row.end + SNOW_ROWS_BEYOND; /* the last vector's */
    for (int n = row.first; n < end; n++)
        if (n < own[0] || n >= own[1])
            pixels[n] = 0;
}

/* Row j of the slice, combed along u, into its slot of the ring. */
static void filter_row(sum_band_task *stroke, int j) {
    const projection_pass *pass = stroke->pass;
    const snow_coverage *covers = stroke->place->across;
    const int phases = pass->shear.u.phases;
    size_t slot = (size_t)j & (pass->ring - 1), extent[2];
    ring_row *given = &stroke->extents[slot];
    float *row = stroke->scratch.ring + slot * (size_t)phases * pass->row;
    *given = (ring_row){0, 0};
    if (!(stroke->scratch.rows.held >> j & 1))
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
    if (pass->params->clip.cuts)
        for (int phase = 0; phase < phases; phase++)
            cut_row(stroke->place->own[0][phase], to,
                    row + (size_t)phase * pass->row);
    *given = to;
}

/* --- lines ---------------------------------------------------------------- */

/* The rows of one or two lines, out of the ring: phase 0 along u.  False where
 * all of them are empty. */
static bool find_rows(const sum_band_task *stroke, int first, int count,
                      snow_rows_job *job) {
    const projection_pass *pass = stroke->pass;
    size_t step = (size_t)pass->shear.u.phases * pass->row;
    job->first = pass->pixels[0];
    job->end = 0;
    for (int m = 0; m < count; m++) {
        size_t slot = (size_t)(first + m) & (pass->ring - 1);
        const ring_row *given = &stroke->extents[slot];
        if (given->first >= given->end) {
            job->rows[m] = stroke->scratch.zero;
            continue;
        }
        job->rows[m] = stroke->scratch.ring + slot * step;
        job->first = given->first < job->first ? given->first : job->first;
        job->end = given->end > job->end ? given->end : job->end;
    }
    return job->first < job->end;
}

/* Lines 08 to 13 for the lines of a job, in all phases along u. */
static void project_lines(const sum_band_task *stroke, snow_rows_job *job) {
    const projection_pass *pass = stroke->pass;
    for (int phase = 0; phase < pass->shear.u.phases; phase++) {
        pass->fns->add(job);
        for (int m = 0; m < job->taps + job->lead; m++)
            if (job->rows[m] != stroke->scratch.zero)
                job->rows[m] += pass->row;
        job->lines[0] += pass->row;
        if (job->lines[1])
            job->lines[1] += pass->row;
    }
}

static bool is_own(const snow_slice_place *place, int phase, int cell) {
    return cell >= place->own[1][phase][0] && cell < place->own[1][phase][1];
}

/* One line of a cell, near an end of the slice. */
static void project_line(const sum_band_task *stroke, int cell, int phase,
                         float *line) {
    const snow_slice_place *place = stroke->place;
    const snow_coverage *cover = &place->down[phase];
    int at = stroke->first_cell + cell;
    snow_rows_job job;
    job.taps = cover->taps;
    job.lead = 0;
    job.weights[0] = cover->weights;
    job.weights[1] = NULL;
    job.lines[0] = line;
    job.lines[1] = NULL;
    if (is_own(place, phase, at) && at >= cover->from && at < cover->to &&
        find_rows(stroke, cell * cover->stride + place->v->lead[phase],
                  cover->taps, &job))
        project_lines(stroke, &job);
}

/* The lines of one cell. */
static void project_cell(sum_band_task *stroke, int cell) {
    const projection_pass *pass = stroke->pass;
    const snow_lattice *v = &pass->shear.v;
    const snow_slice_place *place = stroke->place;
    int lead = place->v->lead[1], at = stroke->first_cell + cell;
    int row = cell * v->stride, count = pass->taps[1] + lead;
    size_t floats = (size_t)pass->shear.u.phases * pass->row;
    float *line = stroke->scratch.lines + (size_t)(cell * v->phases) * floats;
    for (; stroke->filtered < row + count; stroke->filtered++)
        filter_row(stroke, stroke->filtered);
    if (v->phases == 1 || !is_own(place, 0, at) || !is_own(place, 1, at)) {
        for (int phase = 0; phase < v->phases; phase++)
            project_line(stroke, cell, phase, line + (size_t)phase * floats);
        return;
    }
    snow_rows_job job;
    aim(&job, place->down, lead);
    job.lines[0] = line;
    job.lines[1] = line + floats;
    if (find_rows(stroke, row, count, &job))
        project_lines(stroke, &job);
}

/* Rows of the slice's first `row` rows that no line needs are passed over. */
static void project_slice(sum_band_task *stroke, int64_t slice) {
    const projection_pass *pass = stroke->pass;
    const snow_lattice *v = &pass->shear.v;
    stroke->place = &pass->places[slice];
    int reach = stroke->place->v->lead[1] + pass->taps[1];
    int64_t first = stroke->place->first_row - pass->stored[1] +
                    (int64_t)stroke->first_cell * v->stride;
    pass->windows->read(&pass->shear_warp->bands, slice, first,
                        ~UINT64_C(0) >>
                            (64 - ((stroke->cells - 1) * v->stride + reach)),
                        stroke->scratch.spans, &stroke->scratch.rows);
    if (!stroke->scratch.rows.held)
        return;
    stroke->filtered = 0;
    for (int cell = 0; cell < stroke->cells; cell++) {
        int row = cell * v->stride;
        if (stroke->filtered < row) /* between cells, where strides are 2 */
            stroke->filtered = row;
        project_cell(stroke, cell);
    }
}

/* --- weights -------------------------------------------------------------- */

void snow_modes_range(const snow_slice_place *place, int phase, float found,
                      int range[2]) {
    const int *own = place->own[0][phase];
    snow_coverage_range(&place->across[phase], SNOW_WEIGHT_ENOUGH / found,
                        range);
    range[0] = own[0] > range[0] ? own[0] : range[0];
    range[1] = own[1] < range[1] ? own[1] : range[1];
}

/* Adds a slice's weights, times those along v, to the rises along a line. */
static void add_weights(const snow_coverage *cover, const int own[2],
                        double found, double *rise) {
    int from = cover->from > own[0] ? cover->from : own[0];
    int to = cover->to < own[1] ? cover->to : own[1];
    int in = cover->in > from ? cover->in : from;
    in = in < to ? in : to;
    int out = cover->out < to ? cover->out : to;
    out = out > in ? out : in;
    for (int n = from == in ? out : from; n < to;
         n = n + 1 == in ? out : n + 1) {
        double weight = found * (double)snow_coverage_at(cover, n);
        rise[n] += weight;
        rise[n + 1] -= weight;
    }
    rise[in] += found;
    rise[out] -= found;
}

/* How the weights of all slices rise along a line of the picture. */
static void weigh_slices(const projection_pass *pass, int cell, int down,
                         double *rise) {
    size_t row = (size_t)pass->pixels[0] + 1;
    memset(rise, 0, (size_t)pass->shear.u.phases * row * sizeof *rise);
    for (int64_t k = 0; k < pass->slices; k++) {
        const snow_slice_place *place = &pass->places[k];
        float found = snow_coverage_at(&place->down[down], cell);
        if (!(found > 0) || cell < place->own[1][down][0] ||
            cell >= place->own[1][down][1])
            continue;
        for (int phase = 0; phase < pass->shear.u.phases; phase++)
            add_weights(&place->across[phase], place->own[0][phase],
                        (double)found, rise + (size_t)phase * row);
    }
}

/* Out of the rises. */
static void weigh(const projection_pass *pass, int cell, int down, double *rise,
                  float *weights) {
    double share = 1 / (double)pass->params->placement->slices;
    weigh_slices(pass, cell, down, rise);
    for (int phase = 0; phase < pass->shear.u.phases; phase++) {
        double sum = 0;
        for (int n = 0; n < pass->pixels[0]; n++) {
            sum += rise[n];
            weights[n] = (float)(share * sum);
        }
        rise += pass->pixels[0] + 1;
        weights += pass->row;
    }
}

/* The weights of a line; most lines lie within all slices, and have the same.
 */
static const float *weights_of(sum_band_task *stroke, int cell, int down) {
    const projection_pass *pass = stroke->pass;
    bool within = cell >= pass->within[down][0] && cell < pass->within[down][1];
    if (!within || !stroke->weighed) {
        weigh(pass, cell, down, stroke->scratch.rise,
              within ? stroke->scratch.usual : stroke->scratch.weights);
        stroke->weighed |= within;
    }
    return within ? stroke->scratch.usual : stroke->scratch.weights;
}

/* Lines of the plane, out of their phases and weights. */
static void finish_band(sum_band_task *stroke) {
    const projection_pass *pass = stroke->pass;
    const snow_lattice *v = &pass->shear.v;
    const int phases = pass->shear.u.phases;
    size_t floats = (size_t)phases * pass->row;
    float share = 1 / (float)pass->params->placement->slices;
    for (int n = 0; n < stroke->cells * v->phases; n++) {
        int at = stroke->first_cell * v->phases + n;
        float *line = stroke->scratch.lines + (size_t)n * floats;
        if (at >= v->count)
            break;
        const float *weights = weights_of(
            stroke, stroke->first_cell + n / v->phases, n % v->phases);
        for (size_t i = 0; i < floats; i++)
            line[i] *= share;
        const float *values[2] = {line, line + pass->row};
        const float *found[2] = {weights, weights + pass->row};
        pass->fns->weave(values, found, phases, pass->pixels[0],
                         pass->plane + (size_t)at * pass->stride);
    }
}

/* --- a band --------------------------------------------------------------- */

/* The parts of a worker's memory, each aligned to 64 bytes; returns the bytes
 * that they take.  With a NULL base nothing but the sum counts. */
static size_t lay_out(const projection_pass *pass, char *base,
                      modes_scratch *out) {
    size_t at = 0, phases = (size_t)pass->shear.u.phases;
    int64_t columns = pass->shear_warp->bands.columns;
    size_t row = pass->row * sizeof(float);
#define PART(field, bytes) (out->field = snow_lay_out(base, &at, bytes))
    snow_mask_rows_lay_out(&out->rows, columns, base, &at);
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

static void project_band(void *of, int64_t item, int worker) {
    const projection_pass *pass = of;
    sum_band_task stroke = {.pass = pass};
    lay_out(pass,
            pass->shear_warp->scratch + (size_t)worker * pass->scratch_bytes,
            &stroke.scratch);
    stroke.first_cell = (int)item * pass->cells;
    int left = pass->pixels[1] - stroke.first_cell;
    stroke.cells = left < pass->cells ? left : pass->cells;
    size_t row = (size_t)pass->shear.u.phases * pass->row;
    memset(stroke.scratch.zero, 0, pass->row * sizeof(float));
    memset(stroke.scratch.dense, 0, pass->dense * sizeof(float));
    memset(stroke.scratch.ring, 0, pass->ring * row * sizeof(float));
    memset(stroke.scratch.lines, 0,
           (size_t)(stroke.cells * pass->shear.v.phases) * row * sizeof(float));
    for (int64_t k = 0; k < pass->slices &&
                        !snow_monitor_look(pass->shear_warp->monitor, worker);
         k++)
        project_slice(&stroke, k);
    finish_band(&stroke);
}

/* --- setting up ----------------------------------------------------------- */

/* Pixels a voxel, or voxels a pixel.  Largest values have edges where one slice
 * gives way to another, so that they are taken as finely as over's
 * (render/shear_warp/shear_warp.c). Sums are smooth: of Engine and CThead,
 * warped from a pixel a voxel, they are 70 dB and more from the exact ones. */
static void choose_pitch(const snow_scaled_kernel *scaled_kernel, bool largest,
                         bool draft, int *phases, int *stride) {
    *phases = largest && !draft && scaled_kernel->wide < 1.2 ? 2 : 1;
    *stride = scaled_kernel->wide >= (draft ? 2 : 2.5) ? 2 : 1;
}

static snow_status place_lattice(projection_pass *pass) {
    const snow_placement *p = pass->params->placement;
    const snow_settings *settings = pass->params->settings;
    bool draft = settings->quality == SNOW_QUALITY_DRAFT;
    snow_shear_options options;
    for (int axis = 0; axis < 2; axis++) {
        snow_scaled_kernel *scaled_kernel = &pass->scaled_kernel[axis];
        *scaled_kernel = snow_scaled_kernel_make(
            settings->kernel, settings->footprint,
            hypot(p->inverse[axis][0], p->inverse[axis][1]));
        pass->taps[axis] = snow_comb_taps(scaled_kernel);
        choose_pitch(scaled_kernel, pass->largest, draft, &options.phases[axis],
                     &options.stride[axis]);
        options.reach[axis] = snow_scaled_kernel_reach(scaled_kernel);
    }
    SNOW_TRY(
        snow_shear_make(pass->shear_warp->context, p, &options, &pass->shear));
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
        ((size_t)pass->shear_warp->bands.columns / 64 + 1) * 64 + 2 * PAD;
    int rows = SNOW_DECODE_ROWS - pass->taps[1] - 1;
    pass->cells = rows / pass->shear.v.stride + 1;
    /* What bands share is done twice; but threads want some each. */
    if (pass->cells > BAND_CELLS && (!pass->largest || settings->threads > 1))
        pass->cells = BAND_CELLS;
    pass->bands = (pass->pixels[1] + pass->cells - 1) / pass->cells;
    /* A window's columns are bits of a word. */
    bool wide = pass->shear.u.phases == 1 && pass->shear.u.stride == 1;
    pass->columns = wide ? SNOW_MAXIMUM_LINE : SNOW_MAXIMUM_LINE / 2;
    pass->tiles = (pass->pixels[0] + pass->columns - 1) / pass->columns;
    for (pass->ring = 1; pass->ring < (size_t)pass->taps[1] + 1;)
        pass->ring *= 2;
    return SNOW_STATUS_OK;
}

/* Pixels of a phase out of those of the lattice. */
static void pixels_of(const int range[2], int phase, int phases, int pixels,
                      int out[2]) {
    for (int end = 0; end < 2; end++) {
        int n = (range[end] - phase + phases - 1) / phases;
        out[end] = n < 0 ? 0 : n < pixels ? n : pixels;
    }
}

/* Which pixels of a slice are the part's own. */
static void find_own(const projection_pass *pass, double slice,
                     snow_slice_place *place) {
    const snow_clip *clip = &pass->params->clip;
    for (int axis = 0; axis < 2; axis++) {
        const snow_lattice *lattice = axis ? &pass->shear.v : &pass->shear.u;
        int range[2] = {0, lattice->count};
        if (clip->cuts)
            snow_clip_lattice(clip, axis, lattice, slice, range);
        if (range[1] == lattice->count) /* phases may have one beyond */
            range[1] += lattice->phases;
        for (int phase = 0; phase < lattice->phases; phase++)
            pixels_of(range, phase, lattice->phases, pass->pixels[axis],
                      place->own[axis][phase]);
    }
}

/* The kernels of all slices and what they cover. */
static void place_slice(projection_pass *pass, int64_t n) {
    const snow_placement *p = pass->params->placement;
    snow_comb *combs = pass->shear_warp->combs + 2 * n;
    snow_slice_place *place = &pass->places[n];
    const snow_lattice *lattices[2] = {&pass->shear.u, &pass->shear.v};
    const int64_t voxels[2] = {p->columns, p->rows};
    double slice = (double)(pass->params->slab.first + n);
    place->u = &combs[0];
    place->v = &combs[1];
    for (int axis = 0; axis < 2; axis++) {
        const snow_lattice *lattice = lattices[axis];
        snow_comb_make(&pass->scaled_kernel[axis], lattice, slice,
                       &combs[axis]);
        int64_t first = lattice->first / lattice->phases * lattice->stride +
                        combs[axis].offset;
        if (axis == 1)
            place->first_row = first;
        for (int phase = 0; phase < lattice->phases; phase++)
            (axis == 0 ? place->across : place->down)[phase] =
                snow_coverage_make(&combs[axis], phase, pass->taps[axis], first,
                                   lattice->stride, voxels[axis],
                                   pass->pixels[axis]);
    }
    find_own(pass, slice, place);
    for (int phase = 0; phase < pass->shear.u.phases; phase++)
        snow_modes_range(place, phase, 1, place->range[phase]);
    for (int phase = 0; phase < pass->shear.v.phases; phase++) {
        int *within = pass->within[phase];
        const snow_coverage *down = &place->down[phase];
        const int *own = place->own[1][phase];
        within[0] = down->in > within[0] ? down->in : within[0];
        within[0] = own[0] > within[0] ? own[0] : within[0];
        within[1] = down->out < within[1] ? down->out : within[1];
        within[1] = own[1] < within[1] ? own[1] : within[1];
    }
}

static snow_status reserve_buffers(projection_pass *pass) {
    snow_shear_warp *s = pass->shear_warp;
    const snow_settings *settings = pass->params->settings;
    modes_scratch unused;
    size_t slices = (size_t)pass->slices;
    int threads =
        settings->threads < pass->bands ? settings->threads : (int)pass->bands;
    pass->scratch_bytes = pass->largest ? snow_maximum_scratch(pass)
                                        : lay_out(pass, NULL, &unused);
    SNOW_TRY(snow_reserve(s->context, &s->scratch, &s->scratch_capacity, 0,
                          pass->scratch_bytes * (size_t)threads));
    SNOW_TRY(snow_reserve(s->context, &s->combs, &s->combs_capacity, 0,
                          2 * slices * sizeof *s->combs + 1));
    SNOW_TRY(snow_reserve(s->context, &s->teeth, &s->teeth_capacity, 0,
                          slices * sizeof *pass->places + 1));
    pass->places = (snow_slice_place *)(void *)s->teeth;
    snow_intermediate *intermediate = s->intermediate;
    SNOW_TRY(snow_reserve(s->context, &intermediate->plane,
                          &intermediate->plane_capacity, 0,
                          ((size_t)pass->shear.v.count + 1) * pass->stride *
                              sizeof *intermediate->plane));
    pass->plane = intermediate->plane;
    return snow_reserve(s->context, &intermediate->drawn,
                        &intermediate->drawn_capacity, 0, 1);
}

/* Values are linear in their codes: two codes give the scale. */
static void scale_codes(projection_pass *pass, const snow_value_scale *scale) {
    const snow_quantizer *quantizer = &pass->shear_warp->quantizer;
    double one = snow_quantizer_value(quantizer, 1),
           far = snow_quantizer_value(quantizer, 129);
    double slope = (far - one) / 128 / scale->step;
    pass->scale = (float)slope;
    pass->start = (float)((one - scale->from) / scale->step - slope);
    pass->code_bytes = quantizer->bytes;
}

/* One tile, all of which is drawn. */
static snow_shear_warp_image image_of(const projection_pass *pass) {
    const snow_intermediate *intermediate = pass->shear_warp->intermediate;
    int width = pass->shear.u.count, height = pass->shear.v.count;
    if (width == 0 || height == 0)
        return (snow_shear_warp_image){.channels = 2};
    intermediate->drawn[0] = 1;
    return (snow_shear_warp_image){.width = width,
                                   .height = height,
                                   .channels = 2,
                                   .pixels = pass->plane,
                                   .stride = pass->stride,
                                   .drawn = intermediate->drawn,
                                   .tile_width = width,
                                   .tile_height = height,
                                   .tiles = 1,
                                   .layers = 1,
                                   .layer_floats =
                                       (size_t)height * pass->stride,
                                   .layer_tiles = 1};
}

snow_status snow_shear_warp_project(snow_shear_warp *s,
                                    const snow_shear_warp_params *params,
                                    bool largest, const snow_value_scale *scale,
                                    snow_stats *stats,
                                    snow_shear_warp_image *out) {
    const snow_settings *settings = params->settings;
    projection_pass pass = {
        .params = params,
        .shear_warp = s,
        .largest = largest,
        .slices = params->slab.count,
        .stored = {params->clip.stored[0], params->clip.stored[1]},
        .windows = snow_decode_fns_of(settings->isa),
        .fns = snow_row_fns_of(settings->isa)};
    double mark = snow_seconds();
    snow_shear_warp_fill_figures(s, stats);
    scale_codes(&pass, scale);
    SNOW_TRY(place_lattice(&pass));
    SNOW_TRY(reserve_buffers(&pass));
    snow_shear_warp_warping_of(s, params, 2)->shear = pass.shear;
    *out = image_of(&pass);
    snow_shear_warp_attach(s, out);
    if (out->width == 0)
        return SNOW_STATUS_OK;
    for (int phase = 0; phase < 2; phase++)
        pass.within[phase][1] = pass.pixels[1];
    for (int64_t k = 0; k < pass.slices; k++)
        place_slice(&pass, k);
    if (largest)
        SNOW_TRY(snow_maximum_prepare(&pass, scale));
    s->monitor = s->context->monitor;
    snow_monitor_next(s->monitor, SNOW_STAGE_RENDER, 0, 0.9);
    SNOW_TRY(snow_parallel(s->context, settings->threads, pass.bands,
                           largest ? snow_maximum_band : project_band, &pass));
    stats->seconds_splat += snow_seconds() - mark;
    return SNOW_STATUS_OK;
}
