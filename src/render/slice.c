/* render/slice.c - a slice of the grid as a picture, seen straight on, as the
 * view axial, coronal or sagittal that faces it most sees it.
 *
 * A pixel is the mean of the slice's own voxels, weighted by a tent of two
 * voxels, or of two pixels where these are larger. */
#include "render/slice.h"
#include "base/thread_pool.h"
#include "base/vec3.h"
#include "image/image.h"
#include "transfer/transfer.h"
#include "transform/transform.h"
#include "volume/volume.h"

#include <snowglass/snowglass.h>

#include <math.h>
#include <string.h>
#include <strings.h>

/* Places in a slice are rounded to parts of a voxel, so that rounding errors do
 * not decide which voxel is the nearest. */
#define PARTS 0x1p20

/* --- the view ------------------------------------------------------------- */

/* The grid axis of a name and the view that faces it, or the reverse. */
static snow_status find_axis(snow_context *context,
                             const snow_volume_info *info, const char *name,
                             snow_view *view, int *found) {
    static const char *const names[] = {"x",        "y",       "z",
                                        "sagittal", "coronal", "axial"};
    double best = -1;
    for (int n = 0; n < 9; n++) {
        const char *side = names[3 + n % 3];
        double normal[3];
        snow_view named = *view;
        if (strcasecmp(name, names[n / 3]) && strcasecmp(name, side))
            continue;
        SNOW_TRY(snow_view_from_name(context, snow_view_name_for(info, side),
                                     &named));
        snow_slice_normal(info, n / 3, normal);
        double cosine = snow_dot(normal, named.back);
        if (fabs(cosine) <= best + 1e-6)
            continue;
        best = fabs(cosine);
        *found = n / 3;
        memcpy(view->up, named.up, sizeof view->up);
        for (int i = 0; i < 3; i++)
            view->back[i] = copysign(1, cosine) * normal[i];
    }
    if (best >= 0)
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "unknown axis '%.40s' of slices: must be x, y, z, axial, "
                     "coronal or sagittal",
                     name);
}

/* Up is the slice's grid axis that rises most in the view. */
static void look_up(double steps[2][3], snow_view *view) {
    double rise[2], length[2];
    for (int i = 0; i < 2; i++) {
        rise[i] = snow_dot(steps[i], view->up);
        length[i] = snow_length(steps[i]);
    }
    int up = fabs(rise[1]) / length[1] > fabs(rise[0]) / length[0];
    for (int i = 0; i < 3; i++)
        view->up[i] = copysign(1, rise[up]) * steps[up][i] / length[up];
}

double snow_slice_measure(const snow_volume_info *info, int axis,
                          snow_view *view, double extent[2]) {
    double steps[2][3], right[3], pitch = INFINITY;
    for (int n = 0; n < 6; n++)
        steps[n / 3][n % 3] = info->matrix[n % 3][(axis + 1 + n / 3) % 3];
    look_up(steps, view);
    snow_cross(view->up, view->back, right);
    extent[0] = extent[1] = 0;
    for (int n = 0; n < 2; n++) {
        double count = (double)info->dims[(axis + 1 + n) % 3];
        extent[0] += count * fabs(snow_dot(steps[n], right));
        extent[1] += count * fabs(snow_dot(steps[n], view->up));
        pitch = fmin(pitch, snow_length(steps[n]));
    }
    return pitch;
}

void snow_slice_scale(const snow_volume_info *info, double pitch,
                      snow_view *view) {
    view->zoom = 2 * snow_volume_radius(info) /
                 (pitch * fmin(snow_view_room(view), view->height));
}

/* The whole slice in a picture of a given size, or of its own. */
static void frame_slice(const snow_volume_info *info, int axis,
                        snow_view *view) {
    double extent[2], pitch = snow_slice_measure(info, axis, view, extent);
    if (view->width > 0 && view->height > 0) {
        pitch =
            fmax(extent[0] / snow_view_room(view), extent[1] / view->height);
    } else {
        const double wide = extent[0] / (1 - view->strip);
        pitch = fmax(pitch, fmax(wide, extent[1]) / SNOW_IMAGE_SIDE);
        view->width = (int)fmax(rint(wide / pitch), 1);
        view->height = (int)fmax(rint(extent[1] / pitch), 1);
    }
    snow_slice_scale(info, pitch, view);
}

snow_status snow_slice_view(snow_context *context, const snow_volume_info *info,
                            const char *axis, snow_view *view, int *found) {
    snow_view seen;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &seen));
    SNOW_TRY(find_axis(context, info, axis, &seen, found));
    frame_slice(info, *found, &seen);
    return SNOW_RECORD_FILL(context, snow_view, &seen, view);
}

/* --- the picture ---------------------------------------------------------- */

typedef struct slice_job {
    const snow_volume *volume;
    const snow_transfer *transfer; /* NULL: values */
    snow_image *image;
    snow_placement place;
    int64_t first, step[2], count[2]; /* voxels: of the slice; along u, v */
    double reach[2]; /* half a tent's width; infinite: the nearest voxel */
    bool labels;     /* of the transfer function */
} slice_job;

/* The voxels within reach of a place along u or v; false outside. */
static bool find_near(const slice_job *job, int i, double at, int64_t near[2]) {
    double reach = job->reach[i], last = (double)job->count[i] - 1;
    double from = isinf(reach) ? floor(at + 0.5) : floor(at - reach) + 1;
    double to = isinf(reach) ? from : ceil(at + reach) - 1;
    near[0] = (int64_t)fmin(fmax(from, 0), last);
    near[1] = (int64_t)fmax(fmin(to, last), 0);
    return at >= -0.5 && at <= last + 0.5;
}

/* NaN outside, and where most of the weight is of voxels without a value. */
static double value_at(const slice_job *job, const double at[2]) {
    const snow_volume_info *info = &job->volume->info;
    int64_t near[2][2];
    double sum = 0, known = 0, all = 0;
    if (!find_near(job, 0, at[0], near[0]) ||
        !find_near(job, 1, at[1], near[1]))
        return NAN;
    for (int64_t v = near[1][0]; v <= near[1][1]; v++)
        for (int64_t u = near[0][0]; u <= near[0][1]; u++) {
            double weight = (1 - fabs((double)u - at[0]) / job->reach[0]) *
                            (1 - fabs((double)v - at[1]) / job->reach[1]);
            double value = snow_volume_native(
                job->volume, job->first + u * job->step[0] + v * job->step[1]);
            all += weight;
            if (!isfinite(value))
                continue;
            known += weight;
            sum += weight * (info->slope * value + info->intercept);
        }
    return known >= 0.5 * all ? sum / known : NAN;
}

static void draw_line(void *of, int64_t y, int worker) {
    const slice_job *job = of;
    const snow_transfer *transfer = job->transfer;
    const snow_placement *p = &job->place;
    int width = job->image->width, channels = job->image->channels;
    float *pixel = job->image->pixels + y * width * channels;
    (void)worker;
    for (int x = 0; x < width; x++, pixel += channels) {
        double right = x + 0.5 - p->origin[0], at[2], rgb[3], rgba[4];
        double down = (double)y + 0.5 - p->origin[1];
        for (int i = 0; i < 2; i++)
            at[i] = rint(PARTS *
                         (p->inverse[i][0] * right + p->inverse[i][1] * down)) /
                    PARTS;
        double value = value_at(job, at);
        if (!transfer)
            *pixel = (float)value;
        if (!transfer || isnan(value) || (transfer->log && !(value > 0)))
            continue;
        if (job->labels) /* what is hidden is clear */
            snow_transfer_evaluate(transfer, value, rgba);
        if (job->labels && !(rgba[3] > 0))
            continue;
        snow_transfer_color(transfer, value, rgb);
        for (int c = 0; c + 1 < channels; c++)
            pixel[c] = (float)rgb[c];
        pixel[channels - 1] = 1;
    }
}

/* Every slice lies where the middle one is seen: they may be sheared. */
static snow_status place_slice(int64_t index, const snow_view *view,
                               bool nearest, slice_job *job) {
    const snow_volume_info *info = &job->volume->info;
    snow_placement *p = &job->place;
    const int64_t steps[3] = {1, info->dims[0], info->dims[0] * info->dims[1]};
    SNOW_TRY(snow_placement_make(job->volume->context, info, view, p));
    if (index < 0 || index >= p->slices)
        return snow_fail(job->volume->context, SNOW_STATUS_BAD_USAGE,
                         "there is no slice %lld: must be 0 to %lld",
                         (long long)index, (long long)p->slices - 1);
    const int axes[2] = {p->u_axis, p->v_axis};
    job->first = index * steps[p->slice_axis];
    for (int i = 0; i < 2; i++) {
        p->origin[i] += ((double)p->slices - 1) / 2 * p->step_slice[i];
        job->step[i] = steps[axes[i]];
        job->count[i] = info->dims[axes[i]];
        job->reach[i] =
            nearest ? INFINITY
                    : fmax(1, hypot(p->inverse[i][0], p->inverse[i][1]));
    }
    return SNOW_STATUS_OK;
}

snow_status snow_slice_render(const snow_volume *volume, int64_t index,
                              const snow_transfer *transfer,
                              const snow_view *view,
                              const snow_settings *settings, snow_image **out) {
    snow_context *context = volume->context;
    slice_job job = {.volume = volume, .transfer = transfer};
    snow_settings how;
    snow_view seen;
    SNOW_TRY(snow_volume_need_voxels(volume));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &seen));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_settings, settings, &how));
    bool nearest =
        how.kernel == SNOW_KERNEL_BOX ||
        (transfer && snow_transfer_has_labels(transfer, &volume->info));
    job.labels = nearest && transfer && transfer->label_count > 0;
    SNOW_TRY(place_slice(index, &seen, nearest, &job));
    SNOW_TRY(snow_image_new(context, seen.width, seen.height,
                            !transfer        ? 1
                            : transfer->grey ? 2
                                             : 4,
                            &job.image));
    int threads = how.threads > 0 ? how.threads : snow_processors();
    snow_status status =
        snow_parallel(context, threads, seen.height, draw_line, &job);
    if (status == SNOW_STATUS_OK)
        *out = job.image;
    else
        snow_image_free(job.image);
    return status;
}
