/* render/modes/isosurface.c - mode iso, ray by ray.
 *
 * A ray is a straight line through index space in both projections, and meets
 * the slices one after another.  Where it meets one the value is the weighted
 * mean of the voxels in a window (render/modes/interpolate.h), which cannot
 * reach the iso value unless one of them does: those are the voxels that are
 * encoded, and their spans give a map of the windows worth a look
 * (splat/separable/occupancy.h).
 *
 *   slices     k-2      k-1        k
 *   ray    ----o--------o----x-----o---->     value below, below, not below:
 *                                             the surface is met at x, where
 *                                             the value is linear in depth
 *
 * Method original looks at every window.  Lines of the picture are dealt out to
 * threads; rays share nothing. */
#include "render/modes/isosurface.h"
#include "base/thread_pool.h"
#include "base/vec3.h"
#include "composite/projection.h"
#include "render/modes/depth.h"
#include "render/modes/interpolate.h"
#include "render/picture.h"
#include "render/shear_warp/internal.h"
#include "splat/separable/occupancy.h"
#include "volume/volume.h"

#include <math.h>
#include <string.h>

/* So that rounding does not decide where a value is just the iso value: a part
 * of the data's range. */
#define MARGIN 1e-6

/* The kernel on a slice, along u or v. */
typedef struct iso_kernel {
    snow_scaled_kernel scaled_kernel;
    bool cubic;                     /* the cubic B-spline itself, not widened */
    snow_scaled_kernel_table table; /* but for the box */
} iso_kernel;

struct snow_iso {
    snow_context *context;
    iso_kernel *kernels; /* along u and v; in perspective of each slice */
    size_t kernels_capacity;
    int64_t kernel_count; /* that were ever made */
    int taps[2];
    snow_occupancy reached;
    uint64_t occupancy_of; /* the encoding that it maps; 0: none */
    snow_first_hit first;
};

typedef struct iso_pass {
    const snow_job *job;
    const snow_iso *iso;
    const snow_occupancy *reached; /* NULL: every window is looked at */
    const snow_first_hit *first;   /* NULL: in perspective, or the same */
    bool near;                     /* the volume has no holes */
    snow_cubic_grid grid;
    snow_shader shader;
    double level, margin; /* data units */
    double slope[2];      /* of all rays, where there is `first` */
    float rgb[3];
    double depth[4]; /* of index position (u, v, k): [0..2], and a constant */
} iso_pass;

/* A ray: at slice k it is at (at[0] + k slope[0], at[1] + k slope[1]); it meets
 * slices first, first + step ... up to last. */
typedef struct iso_ray {
    double at[2], slope[2];
    int64_t first, last, step;
    bool meets;
} iso_ray;

/* Where a ray meets the surface. */
typedef struct iso_hit {
    double slice;       /* not a whole number */
    double gradient[3]; /* in index space */
} iso_hit;

void snow_iso_free(snow_iso *iso) {
    if (!iso)
        return;
    for (int64_t n = 0; n < iso->kernel_count; n++)
        snow_release(iso->context, iso->kernels[n].table.cells);
    snow_release(iso->context, iso->kernels);
    snow_release(iso->context, iso->reached.bits);
    snow_release(iso->context, iso->first.slices);
    snow_release(iso->context, iso->first.found);
    snow_release(iso->context, iso);
}

/* --- kernels -------------------------------------------------------------- */

static const iso_kernel *kernel_of(const iso_pass *pass, int64_t slice,
                                   int axis) {
    bool many = pass->job->placement.perspective;
    return &pass->iso->kernels[2 * (many ? slice : 0) + axis];
}

static double weight_of(const iso_kernel *kernel, double t) {
    if (!snow_scaled_kernel_covers(&kernel->scaled_kernel, t))
        return 0;
    return kernel->scaled_kernel.kernel == SNOW_KERNEL_BOX
               ? (double)snow_scaled_kernel_box(&kernel->scaled_kernel, t)
               : (double)snow_scaled_kernel_look_up(&kernel->table, (float)t);
}

static snow_status make_kernel(snow_iso *iso, const snow_settings *settings,
                               double width, iso_kernel *kernel) {
    kernel->scaled_kernel =
        snow_scaled_kernel_make(settings->kernel, settings->footprint, width);
    if (snow_comb_taps(&kernel->scaled_kernel) > SNOW_INTERPOLATE_MOST)
        return snow_fail(iso->context, SNOW_STATUS_BAD_USAGE,
                         "pixels are too many voxels wide for mode iso; use a "
                         "larger picture, or zoom");
    kernel->cubic = settings->kernel == SNOW_KERNEL_BSPLINE &&
                    settings->footprint == 4 && kernel->scaled_kernel.wide == 1;
    if (settings->kernel == SNOW_KERNEL_BOX)
        return SNOW_STATUS_OK;
    return snow_scaled_kernel_table_make(iso->context, &kernel->scaled_kernel,
                                         &kernel->table);
}

/* All kernels of a view, and the most voxels in reach of one. */
static snow_status make_kernels(snow_iso *iso, const snow_job *job,
                                int taps[2]) {
    const snow_placement *p = &job->placement;
    int64_t slices = p->perspective ? p->slices : 1;
    size_t size = sizeof *iso->kernels;
    if (2 * slices > iso->kernel_count) {
        SNOW_TRY(snow_reserve(
            iso->context, &iso->kernels, &iso->kernels_capacity,
            (size_t)iso->kernel_count * size, 2 * (size_t)slices * size));
        memset(iso->kernels + iso->kernel_count, 0,
               (size_t)(2 * slices - iso->kernel_count) * size);
        iso->kernel_count = 2 * slices;
    }
    taps[0] = taps[1] = 0;
    for (int64_t k = 0; k < slices; k++) {
        double width[2] = {hypot(p->inverse[0][0], p->inverse[0][1]),
                           hypot(p->inverse[1][0], p->inverse[1][1])};
        if (p->perspective)
            snow_perspective_pixel_width(p, (double)k, width);
        for (int axis = 0; axis < 2; axis++) {
            iso_kernel *kernel = &iso->kernels[2 * k + axis];
            SNOW_TRY(make_kernel(iso, &job->settings, width[axis], kernel));
            int reach = snow_comb_taps(&kernel->scaled_kernel);
            taps[axis] = reach > taps[axis] ? reach : taps[axis];
        }
    }
    return SNOW_STATUS_OK;
}

/* --- a point of a slice --------------------------------------------------- */

/* The window around (u, v) on a slice, as far as it is stored; false where it
 * is outside. */
static bool place_window(const iso_pass *pass, int64_t slice,
                         const double at[2], snow_interpolate_window *probe) {
    const int64_t *stored = pass->job->clip.stored;
    const int64_t *size = pass->job->clip.size;
    probe->slice = slice - stored[2];
    if (probe->slice < 0 || probe->slice >= size[2])
        return false;
    for (int axis = 0; axis < 2; axis++) {
        const iso_kernel *kernel = kernel_of(pass, slice, axis);
        int taps = snow_comb_taps(&kernel->scaled_kernel);
        double base = floor(at[axis]) - taps / 2 + 1;
        double low = (double)stored[axis], high = low + (double)size[axis];
        if (!(base > low - taps && base < high))
            return false;
        int64_t first = (int64_t)base, end = first + taps;
        first = first > stored[axis] ? first : stored[axis];
        end = end < stored[axis] + size[axis] ? end : stored[axis] + size[axis];
        probe->first[axis] = first - stored[axis];
        probe->count[axis] = (int)(end - first);
        for (int64_t n = first; n < end; n++)
            probe->weights[axis][n - first] =
                weight_of(kernel, at[axis] - (double)n);
    }
    return true;
}

static void ray_at(const iso_ray *ray, double slice, double at[2]) {
    at[0] = ray->at[0] + slice * ray->slope[0];
    at[1] = ray->at[1] + slice * ray->slope[1];
}

/* Weights of four voxels around a point, `part` behind the second. */
static inline void cubic_weights(float part, float weights[4]) {
    float rest = 1 - part, square = part * part, cube = square * part;
    const float third = 1.0f / 3, sixth = 1.0f / 6;
    weights[0] = rest * rest * rest * sixth;
    weights[1] = cube / 2 - square + 2 * third;
    weights[2] = (part + square - cube) / 2 + sixth;
    weights[3] = cube * sixth;
}

/* The usual window, where it and what is around it is in the grid; of a part
 * it is stored, as are the ghosts that iso asks for. */
static bool place_cubic_window(const iso_pass *pass, int64_t slice,
                               const double at[2], snow_cubic_window *near) {
    const snow_placement *p = &pass->job->placement;
    const int64_t sides[2] = {p->columns, p->rows};
    const int64_t *stored = pass->job->clip.stored;
    const int64_t *size = pass->job->clip.size;
    near->at = (slice - stored[2]) * pass->grid.steps[2];
    if (slice < stored[2] || slice >= stored[2] + size[2])
        return false;
    for (int axis = 0; axis < 2; axis++) {
        if (!(at[axis] >= 2 && at[axis] < (double)(sides[axis] - 3)) ||
            !kernel_of(pass, slice, axis)->cubic)
            return false;
        int64_t whole = (int64_t)at[axis];
        if (whole - 1 < stored[axis] || whole + 3 > stored[axis] + size[axis])
            return false;
        cubic_weights((float)(at[axis] - (double)whole), near->weights[axis]);
        near->at += (whole - 1 - stored[axis]) * pass->grid.steps[axis];
    }
    return true;
}

/* What a ray meets on a slice. */
typedef struct iso_point {
    int64_t slice;
    bool near; /* the window is the usual one */
    snow_cubic_window window;
    double value; /* data units */
} iso_point;

/* A thread's own. */
typedef struct iso_eye {
    snow_interpolate_window probe;
    iso_point here, before;
} iso_eye;

/* The value where a ray meets a slice; false where less than half a voxel's
 * weight is there. */
static bool find_value(const iso_pass *pass, const iso_ray *ray, int64_t slice,
                       snow_interpolate_window *probe, iso_point *point) {
    const snow_volume_info *info = &pass->job->volume->info;
    double at[2], sums[2];
    if (slice < 0 || slice >= pass->job->placement.slices)
        return false;
    ray_at(ray, (double)slice, at);
    point->slice = slice;
    point->near =
        pass->near && place_cubic_window(pass, slice, at, &point->window);
    if (point->near) {
        double native =
            (double)snow_interpolate_cubic(&pass->grid, &point->window, 0) +
            pass->grid.base;
        point->value = info->slope * native + info->intercept;
        return true;
    }
    if (!place_window(pass, slice, at, probe))
        return false;
    snow_interpolate(probe, sums);
    if (!(sums[1] >= (double)SNOW_WEIGHT_ENOUGH))
        return false;
    point->value = info->slope * (sums[0] / sums[1]) + info->intercept;
    return true;
}

/* Whether a sample is the part's (transform/clip.h). */
static bool is_own(const iso_pass *pass, const double at[2]) {
    const snow_clip *clip = &pass->job->clip;
    return !clip->cuts || (at[0] >= clip->low[0] && at[0] < clip->high[0] &&
                           at[1] >= clip->low[1] && at[1] < clip->high[1]);
}

/* Whether a window may hold what is looked for. */
static bool worth_a_look(const iso_pass *pass, const iso_ray *ray,
                         int64_t slice) {
    const snow_occupancy *r = pass->reached;
    double at[2];
    ray_at(ray, (double)slice, at);
    if (!is_own(pass, at))
        return false;
    if (!r)
        return true;
    const int64_t *stored = pass->job->clip.stored;
    double u = at[0] - (double)stored[0] + r->taps[0] / 2 + 1;
    double v = at[1] - (double)stored[1] + r->taps[1] / 2 + 1;
    if (!(u >= 0 && v >= 0 && u < (double)r->places[0] &&
          v < (double)r->places[1]))
        return false;
    return snow_occupancy_at(r, slice - pass->job->slab.first, (int64_t)u,
                             (int64_t)v);
}

/* --- rays ----------------------------------------------------------------- */

/* Cuts the slices to those where at + k slope lies within (low, high). */
static void cut_slices(double at, double slope, double low, double high,
                       double range[2]) {
    if (slope == 0) {
        if (!(at > low && at < high))
            range[1] = -INFINITY;
        return;
    }
    double a = (low - at) / slope, b = (high - at) / slope;
    range[0] = fmax(range[0], fmin(a, b));
    range[1] = fmin(range[1], fmax(a, b));
}

/* The same of a parallel view, but for where it leaves the volume: windows
 * beyond hold nothing. */
static void make_parallel(const iso_pass *pass, int x, int y, iso_ray *ray) {
    const snow_placement *p = &pass->job->placement;
    const snow_occupancy *r = pass->reached;
    const snow_clip *clip = &pass->job->clip;
    const snow_slab slab = pass->job->slab;
    double x0 = x + 0.5 - p->origin[0], y0 = y + 0.5 - p->origin[1], at[2];
    for (int axis = 0; axis < 2; axis++) {
        ray->slope[axis] = pass->slope[axis];
        ray->at[axis] = p->inverse[axis][0] * x0 + p->inverse[axis][1] * y0;
    }
    ray_at(ray, (double)slab.first, at);
    int32_t passed = snow_first_hit_of(
        pass->first, at[0] - (double)clip->stored[0] + r->taps[0] / 2 + 1,
        at[1] - (double)clip->stored[1] + r->taps[1] / 2 + 1);
    ray->step = p->nearest_first ? 1 : -1;
    ray->first =
        slab.first + (ray->step > 0 ? passed : slab.count - 1 - passed);
    ray->last = slab.first + (ray->step > 0 ? slab.count - 1 : 0);
    ray->meets = passed >= 0;
}

/* The ray through the middle of pixel (x, y). */
static void make_ray(const iso_pass *pass, int x, int y, iso_ray *ray) {
    const snow_placement *p = &pass->job->placement;
    ray->step = p->nearest_first ? 1 : -1;
    ray->meets = false;
    const snow_slab slab = pass->job->slab;
    double range[2] = {(double)slab.first,
                       (double)(slab.first + slab.count - 1)};
    const double sides[2] = {(double)p->columns, (double)p->rows};
    double direction[3] = {0, 0, 1}, x0 = x + 0.5 - p->origin[0],
           y0 = y + 0.5 - p->origin[1];
    if (p->perspective) {
        snow_perspective_ray(&p->eye, x + 0.5, y + 0.5, direction);
        ray->step = direction[2] > 0 ? 1 : -1;
        cut_slices(-p->eye.at[2], 1, ray->step > 0 ? SNOW_EDGE_ON : -INFINITY,
                   ray->step > 0 ? INFINITY : -SNOW_EDGE_ON, range);
    }
    for (int axis = 0; axis < 2; axis++) {
        const double *row = p->inverse[axis];
        if (p->perspective) {
            ray->slope[axis] = direction[axis] / direction[2];
            ray->at[axis] = p->eye.at[axis] - p->eye.at[2] * ray->slope[axis];
        } else {
            ray->slope[axis] =
                -row[0] * p->step_slice[0] - row[1] * p->step_slice[1];
            ray->at[axis] = row[0] * x0 + row[1] * y0;
        }
        if (!isfinite(ray->slope[axis]) || !isfinite(ray->at[axis]))
            return;
        /* Where a window finds half of its weights. */
        cut_slices(ray->at[axis], ray->slope[axis], -1, sides[axis], range);
    }
    if (!(range[0] <= range[1]))
        return;
    int64_t low = (int64_t)ceil(range[0] - 1e-9);
    int64_t high = (int64_t)floor(range[1] + 1e-9);
    ray->first = ray->step > 0 ? low : high;
    ray->last = ray->step > 0 ? high : low;
    ray->meets = low <= high;
}

/* Whether what is around a usual window is stored on all sides. */
static bool has_neighbours(const iso_pass *pass, const iso_point *point) {
    const snow_clip *clip = &pass->job->clip;
    return point->slice > clip->stored[2] &&
           point->slice + 1 < clip->stored[2] + clip->size[2];
}

/* The gradient there. */
static void find_gradient(const iso_pass *pass, const iso_ray *ray,
                          const iso_point *point,
                          snow_interpolate_window *probe, double gradient[3]) {
    double at[2];
    if (point->near && has_neighbours(pass, point)) {
        snow_interpolate_cubic_gradient(&pass->grid, &point->window, gradient);
        return;
    }
    ray_at(ray, (double)point->slice, at);
    place_window(pass, point->slice, at, probe);
    snow_interpolate_gradient(probe, gradient);
}

/* The surface between a slice that is not below the value, and the one before
 * it, if that is. */
static void find_surface(const iso_pass *pass, const iso_ray *ray, iso_eye *eye,
                         iso_hit *hit) {
    const iso_point *here = &eye->here, *before = &eye->before;
    double share = 0, near[3];
    bool shaded = pass->job->settings.shade == SNOW_SHADE_PHONG;
    if (find_value(pass, ray, here->slice - ray->step, &eye->probe,
                   &eye->before) &&
        before->value < pass->level && here->value > before->value)
        share = fmin(
            (here->value - pass->level) / (here->value - before->value), 1);
    share = share > 0 ? share : 0;
    hit->slice = (double)here->slice - share * (double)ray->step;
    if (!shaded)
        return;
    find_gradient(pass, ray, here, &eye->probe, hit->gradient);
    if (share == 0)
        return;
    find_gradient(pass, ray, before, &eye->probe, near);
    for (int n = 0; n < 3; n++)
        hit->gradient[n] += share * (near[n] - hit->gradient[n]);
}

static bool follow_ray(const iso_pass *pass, const iso_ray *ray, iso_eye *eye,
                       iso_hit *hit) {
    if (!ray->meets)
        return false;
    for (int64_t k = ray->first;; k += ray->step) {
        if (worth_a_look(pass, ray, k) &&
            find_value(pass, ray, k, &eye->probe, &eye->here) &&
            eye->here.value >= pass->level - pass->margin) {
            find_surface(pass, ray, eye, hit);
            return true;
        }
        if (k == ray->last)
            return false;
    }
}

/* --- blocks of pixels ------------------------------------------------------
 *
 * Rays side by side look at the same voxels, and so do those of the next line.
 */

#define BLOCK 16

/* Pixels whose surface is found, to be shaded together. */
typedef struct iso_batch {
    double gradients[3][SNOW_SHADE_BLOCK];
    size_t pixel[SNOW_SHADE_BLOCK];
    int count;
} iso_batch;

static void shade_batch(const iso_pass *pass, iso_batch *batch) {
    float samples[4 * SNOW_SHADE_BLOCK];
    int channels = pass->job->channels;
    for (int n = 0; n < batch->count; n++) {
        memcpy(samples + n * channels, pass->rgb,
               (size_t)(channels - 1) * sizeof *samples);
        samples[n * channels + channels - 1] = 1;
    }
    if (pass->job->settings.shade == SNOW_SHADE_PHONG)
        snow_shade_gradients(
            &pass->shader, (const double(*)[SNOW_SHADE_BLOCK])batch->gradients,
            batch->count, channels, samples);
    for (int n = 0; n < batch->count; n++)
        memcpy(pass->job->pixels + batch->pixel[n] * (size_t)channels,
               samples + n * channels, (size_t)channels * sizeof *samples);
    batch->count = 0;
}

static void find_pixel(const iso_pass *pass, int x, int y, iso_eye *eye,
                       iso_batch *batch) {
    size_t pixel = (size_t)y * (size_t)pass->job->view->width + (size_t)x;
    float *depth = pass->job->depths ? pass->job->depths + pixel : NULL;
    iso_hit hit;
    iso_ray ray;
    double at[2];
    (pass->first ? make_parallel : make_ray)(pass, x, y, &ray);
    if (depth)
        *depth = NAN;
    if (!follow_ray(pass, &ray, eye, &hit))
        return;
    ray_at(&ray, hit.slice, at);
    if (depth)
        *depth = (float)(pass->depth[0] * at[0] + pass->depth[1] * at[1] +
                         pass->depth[2] * hit.slice + pass->depth[3]);
    for (int n = 0; n < 3; n++)
        batch->gradients[n][batch->count] = hit.gradient[n];
    batch->pixel[batch->count++] = pixel;
    if (batch->count == SNOW_SHADE_BLOCK)
        shade_batch(pass, batch);
}

static void find_lines(void *of, int64_t item, int worker) {
    const iso_pass *pass = of;
    const snow_placement *p = &pass->job->placement;
    int width = pass->job->view->width, top = (int)item * BLOCK;
    int height = pass->job->view->height;
    int end = top + BLOCK < height ? top + BLOCK : height;
    iso_batch batch = {.count = 0};
    iso_eye eye = {.probe = {.volume = pass->job->volume,
                             .axes = {p->u_axis, p->v_axis, p->slice_axis}}};
    for (int left = 0; left < width &&
                       !snow_monitor_look(pass->job->context->monitor, worker);
         left += BLOCK)
        for (int y = top; y < end; y++)
            for (int x = left; x < left + BLOCK && x < width; x++)
                find_pixel(pass, x, y, &eye, &batch);
    shade_batch(pass, &batch);
}

/* --- a picture ------------------------------------------------------------ */

static snow_status make_tables(snow_picture *p, snow_job *job) {
    snow_frame *frame = p->frame;
    if (!frame->iso)
        frame->iso = snow_allocate_clear(job->context, sizeof *frame->iso);
    if (!frame->iso)
        return SNOW_STATUS_NO_MEMORY;
    frame->iso->context = job->context;
    return make_kernels(frame->iso, job, frame->iso->taps);
}

/* Encodes the voxels that are not below the value, and maps what is in their
 * reach. */
static snow_status map_voxels(snow_picture *p, snow_job *job) {
    snow_frame *frame = p->frame;
    snow_iso *iso = frame->iso;
    snow_job sparse = *job;
    snow_placement placement;
    snow_shear_warp_params params;
    snow_stats *stats = job->stats;
    if (job->settings.method != SNOW_METHOD_FOOTPRINT)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_identity_transfer_above(job, &frame->identity));
    sparse.transfer = frame->identity.transfer;
    sparse.channels = 2;
    sparse.settings.shade = SNOW_SHADE_NONE;
    sparse.settings.threshold = 0;
    sparse.settings.quality = SNOW_QUALITY_NORMAL;
    SNOW_TRY(snow_job_shear_warp_params(&sparse, job->placement.slice_axis,
                                        &placement, &params));
    SNOW_TRY(snow_shear_warp_new(frame->context, &frame->shear_warp[0]));
    snow_shear_warp *shear_warp = frame->shear_warp[0];
    SNOW_TRY(snow_shear_warp_encode(shear_warp, &params, stats));
    snow_shear_warp_fill_figures(shear_warp, stats);
    if (iso->occupancy_of == shear_warp->encodings &&
        iso->reached.taps[0] == iso->taps[0] &&
        iso->reached.taps[1] == iso->taps[1])
        return SNOW_STATUS_OK;
    iso->occupancy_of = 0;
    SNOW_TRY(snow_occupancy_make(&shear_warp->bands, iso->taps,
                                 snow_decode_fns_of(job->settings.isa),
                                 job->settings.threads, &iso->reached));
    iso->occupancy_of = shear_warp->encodings;
    return SNOW_STATUS_OK;
}

/* Where rays of a parallel view begin. */
static snow_status map_starts(const snow_job *job, snow_iso *iso,
                              iso_pass *pass) {
    const snow_placement *p = &job->placement;
    for (int axis = 0; axis < 2; axis++) {
        const double *row = p->inverse[axis];
        pass->slope[axis] =
            -row[0] * p->step_slice[0] - row[1] * p->step_slice[1];
        if (!isfinite(pass->slope[axis]))
            return SNOW_STATUS_OK; /* to be found out ray by ray */
    }
    SNOW_TRY(snow_first_hit_make(job->context, &iso->reached, pass->slope,
                                 p->nearest_first, job->settings.threads,
                                 &iso->first));
    pass->first = &iso->first;
    return SNOW_STATUS_OK;
}

static snow_status find_surfaces(snow_picture *p, snow_job *job) {
    snow_iso *iso = p->frame->iso;
    const snow_identity_transfer *identity = &p->frame->identity;
    iso_pass pass = {.job = job, .iso = iso, .level = job->settings.iso};
    double rgb[3];
    SNOW_TRY(snow_shader_init(job->context, job->volume, &job->placement,
                              &job->settings, &pass.shader));
    if (job->settings.method == SNOW_METHOD_FOOTPRINT) {
        pass.reached = &iso->reached;
        if (!job->placement.perspective)
            SNOW_TRY(map_starts(job, iso, &pass));
    }
    const int axes[3] = {job->placement.u_axis, job->placement.v_axis,
                         job->placement.slice_axis};
    const snow_volume_info *info = &job->volume->info;
    pass.near = identity->whole && info->slope != 0;
    pass.grid = snow_cubic_grid_of(
        job->volume, axes,
        pass.near ? (pass.level - info->intercept) / info->slope : 0);
    pass.margin =
        MARGIN * (identity->high - identity->low) + 1e-9 * fabs(pass.level);
    snow_transfer_color(job->transfer, pass.level, rgb);
    for (int n = 0; n < 3; n++)
        pass.rgb[n] = (float)rgb[n];
    snow_depth_place(job, pass.depth);
    double mark = snow_seconds();
    snow_monitor_next(job->context->monitor, SNOW_STAGE_RENDER, 0, 1);
    SNOW_TRY(snow_parallel(job->context, job->settings.threads,
                           (job->view->height + BLOCK - 1) / BLOCK, find_lines,
                           &pass));
    job->stats->seconds_splat += snow_seconds() - mark;
    return SNOW_STATUS_OK;
}

/* The encoded bands have the counts of the shear-warp method; slabs of
 * a file have been counted one by one. */
static snow_status find_figures(snow_picture *p, snow_job *job) {
    snow_job sparse = *job;
    sparse.settings.method = SNOW_METHOD_SHEAR_WARP;
    if (job->settings.method == SNOW_METHOD_FOOTPRINT && !job->volume->stream) {
        sparse.transfer = p->frame->identity.transfer;
        sparse.settings.threshold = 0;
    }
    SNOW_TRY(snow_job_finish(p->frame, &sparse));
    job->stats->method = job->settings.method;
    return SNOW_STATUS_OK;
}

const snow_render_method snow_method_iso = {
    .classify_and_shade = make_tables,
    .encode = map_voxels,
    .splat_and_composite = find_surfaces,
    .figures = find_figures,
    .slabs = true,
};
