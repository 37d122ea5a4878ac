/* iso.c - mode iso, ray by ray.
 *
 * A ray is a straight line through index space in both projections, and meets
 * the slices one after another.  Where it meets one the value is the weighted
 * mean of the voxels in a window (classify/probe.h), which cannot reach the iso
 * value unless one of them does: those are the voxels that are encoded, and
 * their spans give a map of the windows worth a look (splat/reached.h).
 *
 *   slices     k-2      k-1        k
 *   ray    ----o--------o----x-----o---->     value below, below, not below:
 *                                             the surface is met at x, where
 *                                             the value is linear in depth
 *
 * Method original looks at every window.  Lines of the picture are dealt out to
 * threads; rays share nothing. */
#include "iso.h"
#include "base/parallel.h"
#include "base/vec3.h"
#include "classify/probe.h"
#include "composite/reduce.h"
#include "depth.h"
#include "frame.h"
#include "image/image.h"
#include "sheared_parts.h"
#include "splat/reached.h"
#include "volume/volume.h"

#include <math.h>
#include <string.h>

/* So that rounding does not decide where a value is just the iso value: a part
 * of the data's range. */
#define MARGIN 1e-6

/* The kernel on a slice, along u or v. */
typedef struct iso_kernel {
    snow_taper taper;
    snow_taper_table table; /* but for the box */
} iso_kernel;

struct snow_iso {
    snow_context *context;
    iso_kernel *kernels; /* along u and v; in perspective of each slice */
    size_t kernels_capacity;
    int64_t kernel_count; /* that were ever made */
    snow_reached reached;
};

typedef struct iso_pass {
    const snow_job *job;
    const snow_iso *iso;
    const snow_reached *reached; /* NULL: every window is looked at */
    snow_shader shader;
    double level, margin; /* data units */
    float rgb[3];
    double depth[4]; /* of index position (u, v, k): [0..2], and a constant */
    snow_image *image, *depths;
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
    snow_release(iso->context, iso);
}

/* --- kernels ---------------------------------------------------------------
 */

static const iso_kernel *kernel_of(const iso_pass *pass, int64_t slice,
                                   int axis) {
    bool many = pass->job->placement.perspective;
    return &pass->iso->kernels[2 * (many ? slice : 0) + axis];
}

static double weight_of(const iso_kernel *kernel, double t) {
    if (!snow_taper_covers(&kernel->taper, t))
        return 0;
    return kernel->taper.kernel == SNOW_KERNEL_BOX
               ? (double)snow_taper_box(&kernel->taper, t)
               : (double)snow_taper_look_up(&kernel->table, (float)t);
}

static snow_status make_kernel(snow_iso *iso, const snow_settings *settings,
                               double width, iso_kernel *kernel) {
    kernel->taper =
        snow_taper_make(settings->kernel, settings->footprint, width);
    if (snow_comb_taps(&kernel->taper) > SNOW_PROBE_MOST)
        return snow_fail(iso->context, SNOW_BAD_USAGE,
                         "pixels are too many voxels wide for mode iso; take "
                         "a larger picture or zoom");
    if (settings->kernel == SNOW_KERNEL_BOX)
        return SNOW_OK;
    return snow_taper_table_make(iso->context, &kernel->taper, &kernel->table);
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
            snow_eye_pixel_width(p, (double)k, width);
        for (int axis = 0; axis < 2; axis++) {
            iso_kernel *kernel = &iso->kernels[2 * k + axis];
            SNOW_TRY(make_kernel(iso, &job->settings, width[axis], kernel));
            int reach = snow_comb_taps(&kernel->taper);
            taps[axis] = reach > taps[axis] ? reach : taps[axis];
        }
    }
    return SNOW_OK;
}

/* --- a point of a slice ----------------------------------------------------
 */

/* The window around (u, v) on a slice; false where it is outside. */
static bool place_window(const iso_pass *pass, int64_t slice,
                         const double at[2], snow_probe *probe) {
    const snow_placement *p = &pass->job->placement;
    const int64_t sides[2] = {p->columns, p->rows};
    probe->slice = slice;
    for (int axis = 0; axis < 2; axis++) {
        const iso_kernel *kernel = kernel_of(pass, slice, axis);
        int taps = snow_comb_taps(&kernel->taper);
        double base = floor(at[axis]) - taps / 2 + 1;
        if (!(base > -taps && base < (double)sides[axis]))
            return false;
        int64_t first = (int64_t)base, end = first + taps;
        first = first > 0 ? first : 0;
        end = end < sides[axis] ? end : sides[axis];
        probe->first[axis] = first;
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

/* The value where a ray meets a slice; false where less than half a voxel's
 * weight is there. */
static bool find_value(const iso_pass *pass, const iso_ray *ray, int64_t slice,
                       snow_probe *probe, double *value) {
    const snow_volume_info *info = &pass->job->volume->info;
    double at[2], sums[2];
    if (slice < 0 || slice >= pass->job->placement.slices)
        return false;
    ray_at(ray, (double)slice, at);
    if (!place_window(pass, slice, at, probe))
        return false;
    snow_probe_value(probe, sums);
    if (!(sums[1] >= (double)SNOW_WEIGHT_ENOUGH))
        return false;
    *value = info->slope * (sums[0] / sums[1]) + info->intercept;
    return true;
}

/* Whether a window may hold what is looked for. */
static bool worth_a_look(const iso_pass *pass, const iso_ray *ray,
                         int64_t slice) {
    const snow_reached *r = pass->reached;
    double at[2];
    if (!r)
        return true;
    ray_at(ray, (double)slice, at);
    double u = at[0] + r->taps[0] / 2 + 1, v = at[1] + r->taps[1] / 2 + 1;
    if (!(u >= 0 && v >= 0 && u < (double)r->places[0] &&
          v < (double)r->places[1]))
        return false;
    return snow_reached_at(r, slice, (int64_t)u, (int64_t)v);
}

/* --- rays ------------------------------------------------------------------
 */

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

/* The ray through the middle of pixel (x, y). */
static iso_ray make_ray(const iso_pass *pass, int x, int y) {
    const snow_placement *p = &pass->job->placement;
    iso_ray ray = {.step = p->nearest_first ? 1 : -1};
    double range[2] = {0, (double)(p->slices - 1)};
    const double sides[2] = {(double)p->columns, (double)p->rows};
    double direction[3], x0 = x + 0.5 - p->origin[0],
                         y0 = y + 0.5 - p->origin[1];
    if (p->perspective) {
        snow_eye_ray(&p->eye, x + 0.5, y + 0.5, direction);
        ray.step = direction[2] > 0 ? 1 : -1;
        cut_slices(-p->eye.at[2], 1, ray.step > 0 ? SNOW_EDGE_ON : -INFINITY,
                   ray.step > 0 ? INFINITY : -SNOW_EDGE_ON, range);
    }
    for (int axis = 0; axis < 2; axis++) {
        const double *row = p->inverse[axis];
        if (p->perspective) {
            ray.slope[axis] = direction[axis] / direction[2];
            ray.at[axis] = p->eye.at[axis] - p->eye.at[2] * ray.slope[axis];
        } else {
            ray.slope[axis] =
                -row[0] * p->step_slice[0] - row[1] * p->step_slice[1];
            ray.at[axis] = row[0] * x0 + row[1] * y0;
        }
        if (!isfinite(ray.slope[axis]) || !isfinite(ray.at[axis]))
            return ray;
        /* Where a window finds half of its weights. */
        cut_slices(ray.at[axis], ray.slope[axis], -1, sides[axis], range);
    }
    if (!(range[0] <= range[1]))
        return ray;
    int64_t low = (int64_t)ceil(range[0] - 1e-9);
    int64_t high = (int64_t)floor(range[1] + 1e-9);
    ray.first = ray.step > 0 ? low : high;
    ray.last = ray.step > 0 ? high : low;
    ray.meets = low <= high;
    return ray;
}

/* The gradient where a ray meets a slice. */
static void find_gradient(const iso_pass *pass, const iso_ray *ray,
                          int64_t slice, snow_probe *probe,
                          double gradient[3]) {
    double at[2];
    ray_at(ray, (double)slice, at);
    place_window(pass, slice, at, probe);
    snow_probe_gradient(probe, gradient);
}

/* The surface between a slice that is not below the value, and the one before
 * it, if that is. */
static void find_surface(const iso_pass *pass, const iso_ray *ray,
                         int64_t slice, double value, snow_probe *probe,
                         iso_hit *hit) {
    double before, share = 0, near[3];
    bool shaded = pass->job->settings.shade == SNOW_SHADE_PHONG;
    if (find_value(pass, ray, slice - ray->step, probe, &before) &&
        before < pass->level && value > before)
        share = fmin(fmax((value - pass->level) / (value - before), 0), 1);
    hit->slice = (double)slice - share * (double)ray->step;
    if (!shaded)
        return;
    find_gradient(pass, ray, slice, probe, hit->gradient);
    if (share == 0)
        return;
    find_gradient(pass, ray, slice - ray->step, probe, near);
    for (int n = 0; n < 3; n++)
        hit->gradient[n] += share * (near[n] - hit->gradient[n]);
}

static bool follow_ray(const iso_pass *pass, const iso_ray *ray,
                       snow_probe *probe, iso_hit *hit) {
    if (!ray->meets)
        return false;
    for (int64_t k = ray->first;; k += ray->step) {
        double value;
        if (worth_a_look(pass, ray, k) &&
            find_value(pass, ray, k, probe, &value) &&
            value >= pass->level - pass->margin) {
            find_surface(pass, ray, k, value, probe, hit);
            return true;
        }
        if (k == ray->last)
            return false;
    }
}

/* --- lines -----------------------------------------------------------------
 */

/* Pixels whose surface is found, to be shaded together. */
typedef struct iso_batch {
    double gradients[3][SNOW_SHADE_BLOCK];
    int x[SNOW_SHADE_BLOCK];
    int count;
} iso_batch;

static void shade_batch(const iso_pass *pass, iso_batch *batch, float *line) {
    float samples[4 * SNOW_SHADE_BLOCK];
    int channels = pass->image->channels;
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
        memcpy(line + (size_t)batch->x[n] * (size_t)channels,
               samples + n * channels, (size_t)channels * sizeof *samples);
    batch->count = 0;
}

static void find_line(void *of, int64_t y, int worker) {
    const iso_pass *pass = of;
    const snow_placement *p = &pass->job->placement;
    int width = pass->image->width;
    float *line = pass->image->pixels +
                  (size_t)y * (size_t)width * (size_t)pass->image->channels;
    float *depths =
        pass->depths ? pass->depths->pixels + (size_t)y * (size_t)width : NULL;
    iso_batch batch = {.count = 0};
    snow_probe probe = {.volume = pass->job->volume,
                        .axes = {p->u_axis, p->v_axis, p->slice_axis}};
    (void)worker;
    for (int x = 0; x < width; x++) {
        iso_hit hit;
        double at[2];
        iso_ray ray = make_ray(pass, x, (int)y);
        if (depths)
            depths[x] = NAN;
        if (!follow_ray(pass, &ray, &probe, &hit))
            continue;
        ray_at(&ray, hit.slice, at);
        if (depths)
            depths[x] =
                (float)(pass->depth[0] * at[0] + pass->depth[1] * at[1] +
                        pass->depth[2] * hit.slice + pass->depth[3]);
        for (int n = 0; n < 3; n++)
            batch.gradients[n][batch.count] = hit.gradient[n];
        batch.x[batch.count++] = x;
        if (batch.count == SNOW_SHADE_BLOCK)
            shade_batch(pass, &batch, line);
    }
    shade_batch(pass, &batch, line);
}

/* --- a picture -------------------------------------------------------------
 */

/* Encodes the voxels that are not below the value, and maps what is in their
 * reach. */
static snow_status map_voxels(snow_frame *frame, snow_job *job, snow_iso *iso,
                              const int taps[2]) {
    snow_job sparse = *job;
    snow_placement placement;
    snow_sheared_order order;
    snow_stats *stats = job->stats;
    SNOW_TRY(snow_ramp_above(job, &frame->ramp));
    sparse.transfer = frame->ramp.transfer;
    sparse.channels = 2;
    sparse.settings.shade = SNOW_SHADE_NONE;
    sparse.settings.threshold = 0;
    sparse.settings.quality = SNOW_QUALITY_NORMAL;
    SNOW_TRY(
        snow_job_order(&sparse, job->placement.slice_axis, &placement, &order));
    if (!frame->sheared[0])
        SNOW_TRY(snow_sheared_new(frame->context, &frame->sheared[0]));
    double mark = snow_seconds();
    SNOW_TRY(snow_sheared_encode(frame->sheared[0], &order, stats));
    stats->seconds_encode += snow_seconds() - mark;
    snow_sheared_fill_figures(frame->sheared[0], stats);
    return snow_reached_make(&frame->sheared[0]->bands, taps,
                             snow_window_fns_of(job->settings.isa),
                             job->settings.threads, &iso->reached);
}

static snow_status find_surfaces(snow_frame *frame, snow_job *job,
                                 snow_image *image) {
    snow_iso *iso = frame->iso;
    iso_pass pass = {.job = job,
                     .iso = iso,
                     .level = job->settings.iso,
                     .image = image,
                     .depths = frame->depth};
    double rgb[3];
    int taps[2];
    SNOW_TRY(make_kernels(iso, job, taps));
    SNOW_TRY(snow_shader_init(job->context, job->volume, &job->placement,
                              &job->settings, &pass.shader));
    if (job->settings.method == SNOW_METHOD_FOOTPRINT) {
        SNOW_TRY(map_voxels(frame, job, iso, taps));
        pass.reached = &iso->reached;
    }
    pass.margin =
        MARGIN * (frame->ramp.high - frame->ramp.low) + 1e-9 * fabs(pass.level);
    snow_transfer_color(job->transfer, pass.level, rgb);
    for (int n = 0; n < 3; n++)
        pass.rgb[n] = (float)rgb[n];
    snow_depth_place(job, pass.depth);
    double mark = snow_seconds();
    snow_parallel(job->context, job->settings.threads, image->height, find_line,
                  &pass);
    job->stats->seconds_splat += snow_seconds() - mark;
    return SNOW_OK;
}

/* The bands that were encoded tell what the sheared method's would. */
static snow_status fill_figures(snow_frame *frame, const snow_job *job) {
    snow_job sparse = *job;
    sparse.settings.method = SNOW_METHOD_SHEARED;
    SNOW_TRY(snow_job_finish(frame, &sparse));
    job->stats->method = job->settings.method;
    return SNOW_OK;
}

snow_status snow_iso_render(snow_frame *frame, snow_job *job,
                            snow_image **out) {
    snow_image *image = NULL;
    if (job->settings.method != SNOW_METHOD_ORIGINAL)
        job->settings.method = SNOW_METHOD_FOOTPRINT;
    if (!frame->iso) {
        frame->iso = snow_allocate_clear(job->context, sizeof *frame->iso);
        if (!frame->iso)
            return SNOW_NO_MEMORY;
        frame->iso->context = job->context;
    }
    SNOW_TRY(snow_ramp_measure(job, &frame->ramp));
    SNOW_TRY(snow_image_new(job->context, job->view->width, job->view->height,
                            job->channels, &image));
    snow_status status = find_surfaces(frame, job, image);
    if (status == SNOW_OK)
        status = fill_figures(frame, job);
    if (status == SNOW_OK)
        *out = image;
    else
        snow_image_free(image);
    return status;
}
