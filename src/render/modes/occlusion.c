/* render/modes/occlusion.c - blurred opacity around what a picture shows.
 *
 *   box      of the voxels that are shown
 *   cells    of a few voxels: their opacities, summed up as whole numbers, so
 *            that slabs of a file and ranks change no bit
 *   fields   the means of cells, blurred at two radii
 *   pixels   the fields in front of where each one's depth lies */
#include "base/clear.h"
#include "base/monitor.h"
#include "base/vec3.h"
#include "classify/count_interesting.h"
#include "render/modes/depth.h"
#include "render/picture.h"

#include <math.h>
#include <string.h>

/* Deviations of the two blurs, of the longest side of the box. */
static const double deviations[] = {1.0 / 60, 1.0 / 25};
#define SPLINE (5.0 / 12) /* variance of a cell and its B-spline, in cells */
#define FLAT 0.97         /* a half space is this open, for cells are coarse */
#define MOST 0.85         /* of the light that may be taken away */
#define UNITS 65535       /* an opacity of 1 */

typedef struct occlusion {
    const snow_job *job;
    snow_interesting_walk walk;
    int64_t ends[6]; /* first voxels of the box, negated, and last ones */
    int64_t low[3];  /* the first */
    int64_t cell[3]; /* voxels a cell */
    int64_t cells[3], *sums;
    double deviation[2], spacing[3];
    double below; /* a surface its depth may be, along a ray: half a slice */
    double variance[2][3]; /* of the first blur, and what the second adds */
    int passes[2], reach;
    int64_t dims[3]; /* of the fields: `reach` more cells on all sides */
    float *fields[2], *open; /* open: of pixels, the light that is left */
    const snow_image *depth;
    double of[4]; /* depths of positions (depth.h) */
} occlusion;

/* --- cells ---------------------------------------------------------------- */

static void bound_row(void *of, const snow_interesting_row *row) {
    occlusion *o = of;
    const int64_t ends[] = {-row->stored - row->columns[0],
                            -row->y,
                            -row->z,
                            row->stored + row->columns[row->count - 1],
                            row->y,
                            row->z};
    for (int n = 0; n < 6; n++)
        o->ends[n] = ends[n] > o->ends[n] ? ends[n] : o->ends[n];
}

static void add_row(void *of, const snow_interesting_row *row) {
    const occlusion *o = of;
    const int64_t shift = row->stored - o->low[0];
    int64_t *sums = o->sums + ((row->z - o->low[2]) / o->cell[2] * o->cells[1] +
                               (row->y - o->low[1]) / o->cell[1]) *
                                  o->cells[0];
    for (size_t n = 0; n < row->count;) {
        int64_t cell = (row->columns[n] + shift) / o->cell[0], sum = 0;
        const int64_t end = (cell + 1) * o->cell[0] - shift;
        for (; n < row->count && row->columns[n] < end; n++)
            sum += (int64_t)(row->opacities[n * row->stride] * UNITS + 0.5F);
        sums[cell] += sum;
    }
}

static snow_status visit_slab(const snow_volume *slab, void *user) {
    occlusion *o = user;
    o->walk.volume = slab;
    return snow_visit_interesting(&o->walk, o->sums ? add_row : bound_row, o);
}

static snow_status sum_up(snow_picture *p, occlusion *o, int64_t *values,
                          size_t count, snow_reduce by) {
    const snow_slab_cut cut = {
        .ghosts = snow_transfer_has_gradient_opacity(o->walk.transfer)};
    snow_status status =
        values ? snow_slabs_visit(o->job->volume, &cut, visit_slab, o)
               : SNOW_STATUS_NO_MEMORY;
    SNOW_TRY(p->combiner->agree(p, status));
    return p->combiner->reduce(p, values, count, by);
}

/* Sizes of cells and fields, and how far blurs must go. */
static void lay_out(occlusion *o) {
    double side = 0, most[2] = {0, 0};
    for (int n = 0; n < 3; n++) {
        o->low[n] = -o->ends[n];
        o->cells[n] = o->ends[n + 3] + o->ends[n] + 1; /* voxels as yet */
        side = fmax(side, (double)o->cells[n] * o->spacing[n]);
    }
    for (int i = 0; i < 2; i++)
        o->deviation[i] = deviations[i] * side;
    o->walk.exponent = o->deviation[0] / o->job->settings.opacity_length;
    for (int n = 0; n < 3; n++) {
        o->cell[n] = (int64_t)fmax(1, o->deviation[0] / o->spacing[n]);
        o->cells[n] = (o->cells[n] - 1) / o->cell[n] + 1;
        for (int i = 0; i < 2; i++) {
            double cells =
                o->deviation[i] / ((double)o->cell[n] * o->spacing[n]);
            o->variance[i][n] =
                fmax(0, cells * cells - SPLINE) - (i ? o->variance[0][n] : 0);
            most[i] = fmax(most[i], o->variance[i][n]);
        }
    }
    o->passes[0] = (int)ceil(most[0] * 3 / 2);
    o->passes[1] = (int)ceil(most[1] * 3 / 8);
    o->reach = o->passes[0] + 2 * o->passes[1] + 2;
    for (int n = 0; n < 3; n++)
        o->dims[n] = o->cells[n] + 2 * o->reach;
}

/* --- the fields ----------------------------------------------------------- */

/* A pass of blur i along each axis, by cells that are 1 or 2 apart.  What is
 * read across a border is 0. */
static void spread(const occlusion *o, int i, float **field, float **spare) {
    const int64_t count = o->dims[0] * o->dims[1] * o->dims[2];
    snow_monitor *monitor = o->job->context->monitor;
    int64_t step = i + 1;
    for (int axis = 0; axis < 3 && !snow_monitor_look(monitor, 0);
         step *= o->dims[axis++]) {
        const float w = (float)(o->variance[i][axis] /
                                (2 * o->passes[i] * (i + 1) * (i + 1)));
        const float *in = *field;
        float *out = *spare;
        for (int64_t n = step; n < count - step; n++)
            out[n] = in[n] + w * (in[n - step] - 2 * in[n] + in[n + step]);
        *spare = *field;
        *field = out;
    }
}

/* `field` and `spare` are zeros. */
static void make_fields(occlusion *o, float *field, float *spare,
                        float *second) {
    const int64_t *d = o->dims, *sum = o->sums;
    const double unit = (double)(o->cell[0] * o->cell[1] * o->cell[2]) * UNITS;
    for (int64_t z = o->reach; z < d[2] - o->reach; z++)
        for (int64_t y = o->reach; y < d[1] - o->reach; y++)
            for (int64_t x = o->reach; x < d[0] - o->reach; x++)
                field[(z * d[1] + y) * d[0] + x] =
                    (float)((double)*sum++ / unit);
    for (int n = 0; n < o->passes[0]; n++)
        spread(o, 0, &field, &spare);
    memcpy(second, field, (size_t)(d[0] * d[1] * d[2]) * sizeof *field);
    o->fields[0] = field;
    field = second;
    for (int n = 0; n < o->passes[1]; n++)
        spread(o, 1, &field, &spare);
    o->fields[1] = field;
}

/* The cubic B-spline of a field at voxel position `at`, and its slopes along x,
 * y and z, per cell. */
static void find_field(const occlusion *o, const float *field,
                       const double at[3], double out[4]) {
    double w[3][4], d[3][4];
    int64_t step = 1;
    memset(out, 0, 4 * sizeof *out);
    for (int n = 0; n < 3; step *= o->dims[n++]) {
        double place = (at[n] - (double)o->low[n] + 0.5) / (double)o->cell[n] -
                       0.5 + o->reach;
        double t = place - floor(place), u = 1 - t;
        const double weights[] = {
            u * u * u / 6, 2.0 / 3 - t * t + t * t * t / 2,
            2.0 / 3 - u * u + u * u * u / 2, t * t * t / 6};
        const double slopes[] = {-u * u / 2, 1.5 * t * t - 2 * t,
                                 2 * u - 1.5 * u * u, t * t / 2};
        if (!(place >= 1 && place < (double)(o->dims[n] - 2)))
            return;
        field += ((int64_t)place - 1) * step;
        memcpy(w[n], weights, sizeof weights);
        memcpy(d[n], slopes, sizeof slopes);
    }
    for (int z = 0; z < 4; z++) {
        double plane[3] = {0, 0, 0};
        for (int y = 0; y < 4; y++) {
            const float *row = field + (z * o->dims[1] + y) * o->dims[0];
            double sum = 0, slope = 0;
            for (int x = 0; x < 4; x++) {
                sum += w[0][x] * (double)row[x];
                slope += d[0][x] * (double)row[x];
            }
            plane[0] += w[1][y] * sum;
            plane[1] += w[1][y] * slope;
            plane[2] += d[1][y] * sum;
        }
        for (int n = 0; n < 3; n++)
            out[n] += w[2][z] * plane[n];
        out[3] += d[2][z] * plane[0];
    }
}

/* --- pixels --------------------------------------------------------------- */

/* How much light reaches a place; `toward` is the unit vector to the viewer.
 * The field's slope says how a half space would be turned. */
static double find_open(const occlusion *o, const double at[3],
                        const double toward[3]) {
    double field[4], slope[3], front[3], open = 1;
    find_field(o, o->fields[1], at, field);
    for (int n = 0; n < 3; n++)
        slope[n] = field[n + 1] / ((double)o->cell[n] * o->spacing[n]);
    double length = snow_length(slope);
    double facing = length > 0 ? fabs(snow_dot(slope, toward)) / length : 0;
    for (int i = 0; i < 2; i++) {
        double above = facing * fmax(0, 1 - o->below / o->deviation[i]);
        for (int n = 0; n < 3; n++)
            front[n] = at[n] + o->deviation[i] * toward[n] / o->spacing[n];
        find_field(o, o->fields[i], front, field);
        double flat = FLAT * erfc(-above / sqrt(2.0)) / 2;
        open *= fmin(1, (1 - field[0]) / flat);
    }
    return open * open * open * open;
}

static void find_open_line(void *of, int64_t y, int worker) {
    const occlusion *o = of;
    const snow_placement *p = &o->job->placement;
    const int axes[3] = {p->u_axis, p->v_axis, p->slice_axis};
    const float *depths = o->depth->pixels + y * o->depth->width;
    float *open = o->open + y * o->depth->width;
    (void)worker;
    for (int x = 0; x < o->depth->width; x++) {
        double place[3], away[3], at[3], toward[3];
        open[x] = 1;
        if (isnan(depths[x]))
            continue;
        snow_depth_find(p, o->of, x, (int)y, (double)depths[x], place, away);
        for (int n = 0; n < 3; n++) {
            at[axes[n]] = place[n];
            toward[axes[n]] = -away[n] * o->spacing[axes[n]];
        }
        snow_normalize(toward);
        open[x] = (float)find_open(o, at, toward);
    }
}

/* The less opaque a pixel is, the less of it lies at its depth. */
static void darken_pixels(const occlusion *o, snow_image *image) {
    const size_t count = (size_t)image->width * (size_t)image->height;
    const int channels = image->channels;
    float *pixel = image->pixels;
    for (size_t n = 0; n < count; n++, pixel += channels) {
        double seen = fmin(fmax(2 * (double)pixel[channels - 1] - 1, 0), 1);
        double taken = seen * (1 - (double)o->open[n]);
        for (int c = 0; c + 1 < channels; c++)
            pixel[c] *= (float)(1 - MOST * o->job->settings.occlusion * taken);
    }
}

static snow_status darken(const snow_picture *p, occlusion *o) {
    snow_context *context = o->job->context;
    const int width = p->view.width, height = p->view.height;
    const size_t pixels = (size_t)width * (size_t)height;
    const double voxel = /* its pixels */
        fmin(o->spacing[0], fmin(o->spacing[1], o->spacing[2])) /
        o->job->placement.pitch;
    const size_t count = (size_t)(o->dims[0] * o->dims[1] * o->dims[2]);
    if (!p->image || !p->depth)
        return SNOW_STATUS_OK;
    float *scratch =
        snow_allocate(context, (3 * count + 2 * pixels) * sizeof *scratch);
    if (!scratch)
        return SNOW_STATUS_NO_MEMORY;
    o->depth = p->depth;
    o->open = scratch + 3 * count;
    snow_depth_place(o->job, o->of);
    snow_status status =
        snow_clear(context, scratch, 2 * count * sizeof *scratch);
    if (status == SNOW_STATUS_OK) {
        make_fields(o, scratch, scratch + count, scratch + 2 * count);
        status = snow_parallel(context, o->job->settings.threads, height,
                               find_open_line, o);
    }
    if (status == SNOW_STATUS_OK)
        status = snow_blur_plane(context, o->open, o->open + pixels, width,
                                 height, voxel);
    if (status == SNOW_STATUS_OK)
        darken_pixels(o, p->image);
    snow_release(context, scratch);
    return status;
}

/* --- the picture ---------------------------------------------------------- */

static snow_status occlude(snow_picture *p, occlusion *o) {
    for (int n = 0; n < 6; n++)
        o->ends[n] = INT64_MIN;
    SNOW_TRY(sum_up(p, o, o->ends, 6, SNOW_REDUCE_MAX));
    if (o->ends[0] == INT64_MIN)
        return SNOW_STATUS_OK; /* nothing is shown */
    lay_out(o);
    const size_t cells = (size_t)(o->cells[0] * o->cells[1] * o->cells[2]);
    o->sums = snow_allocate_clear(o->job->context, cells * sizeof *o->sums);
    SNOW_TRY(sum_up(p, o, o->sums, cells, SNOW_REDUCE_SUM));
    return p->combiner->agree(p, darken(p, o));
}

snow_status snow_occlude(snow_picture *p) {
    const bool iso = p->job.settings.mode == SNOW_MODE_ISO;
    snow_volume_info whole;
    occlusion o = {.job = &p->job};
    snow_status status = SNOW_STATUS_OK;
    if (iso)
        status = snow_identity_transfer_above(&p->job, &p->frame->identity);
    SNOW_TRY(p->combiner->agree(p, status));
    snow_volume_whole(p->job.volume, &whole);
    memcpy(o.spacing, whole.spacing, sizeof o.spacing);
    o.below = p->job.placement.path / 2;
    o.walk = (snow_interesting_walk){
        .transfer = iso ? p->frame->identity.transfer : p->job.transfer,
        .exponent = 1,
        .threshold = iso ? 0 : p->job.settings.threshold,
        .isa = p->job.settings.isa};
    status = occlude(p, &o);
    snow_release(p->job.context, o.sums);
    return status;
}
