/* classify/shear_warp/range.c - see range.h. */
#include "classify/shear_warp/range.h"

#include "base/thread_pool.h"
#include "volume/clip_planes.h"

#include <math.h>

/* --- the range of the data ------------------------------------------------ */

/* Voxels of a work item, and of a block within it. */
#define ITEM ((int64_t)1 << 18)
#define BLOCK 1024

/* What the items of one worker have found, in native values, or in data values
 * that have a logarithm. */
typedef struct found_range {
    double low, high;
    bool holes;
    char apart[40]; /* workers write to different cache lines */
} found_range;

typedef struct range_job {
    const snow_volume *volume;
    bool log;
    double linear;
    int64_t voxels;
    found_range *found; /* of each worker */
} range_job;

static void look_at(found_range *found, const double *stored, size_t count) {
    double low = found->low, high = found->high;
    bool holes = false;
    for (size_t n = 0; n < count; n++) {
        double value = stored[n];
        bool finite = value - value == 0;
        low = finite && value < low ? value : low;
        high = finite && value > high ? value : high;
        holes |= value != value;
    }
    found->low = low;
    found->high = high;
    found->holes |= holes;
}

/* Native values as what a range is measured of. */
static void take_stored(const range_job *job, double *stored, size_t count) {
    const snow_volume_info *info = &job->volume->info;
    if (!job->log)
        return;
    for (size_t n = 0; n < count; n++) {
        double value = info->slope * stored[n] + info->intercept;
        stored[n] = value > 0 ? value : NAN;
    }
}

/* False where the voxels have another type, or logarithms are wanted. */
static bool look_at_narrow(const range_job *job, found_range *found,
                           int64_t first, size_t count) {
    int32_t low, high;
    if (job->log ||
        !snow_volume_extremes(job->volume, first, count, &low, &high))
        return false;
    found->low = fmin(found->low, low);
    found->high = fmax(found->high, high);
    return true;
}

static void look_at_item(void *of, int64_t item, int worker) {
    const range_job *job = of;
    int64_t first = item * ITEM, end = first + ITEM;
    end = end < job->voxels ? end : job->voxels;
    const bool full =
        snow_type_size(job->volume->info.type) == 1 && !job->log &&
        job->found[worker].high - job->found[worker].low == UINT8_MAX;
    if (full)
        return;
    if (look_at_narrow(job, &job->found[worker], first, (size_t)(end - first)))
        return;
    for (; first < end; first += BLOCK) {
        double stored[BLOCK];
        size_t count = end - first < BLOCK ? (size_t)(end - first) : BLOCK;
        snow_volume_stored(job->volume, first, count, stored);
        take_stored(job, stored, count);
        look_at(&job->found[worker], stored, count);
    }
}

/* Voxels beyond clip planes whose values are kept, and the ends of what a part
 * lacks. */
static void look_at_missing(const range_job *job) {
    const snow_clip_planes *clip = job->volume->clip;
    const snow_left_out *left = &job->volume->left_out;
    double ends[2] = {left->low, left->high};
    if (left->any) {
        take_stored(job, ends, 2);
        look_at(job->found, ends, 2);
    }
    for (size_t n = 0; clip && n < clip->voxel_count; n++) {
        double native = clip->voxels[n].native;
        take_stored(job, &native, 1);
        look_at(job->found, &native, 1);
    }
}

/* What all workers have found, as data values or logarithms. */
static void put_together(const range_job *job, int threads,
                         snow_data_range *out) {
    const snow_volume_info *info = &job->volume->info;
    found_range all = {.low = INFINITY, .high = -INFINITY};
    for (int n = 0; n < threads; n++) {
        all.low = fmin(all.low, job->found[n].low);
        all.high = fmax(all.high, job->found[n].high);
        all.holes |= job->found[n].holes;
    }
    double a = job->log ? log10(all.low) : info->slope * all.low;
    double b = job->log ? log10(all.high) : info->slope * all.high;
    double from = job->log ? 0 : info->intercept;
    if (job->linear > 0) {
        a = snow_place_of(job->linear, a + from);
        b = snow_place_of(job->linear, b + from);
        from = 0;
    }
    bool any = all.low <= all.high;
    *out = (snow_data_range){any ? fmin(a + from, b + from) : INFINITY,
                             any ? fmax(a + from, b + from) : -INFINITY,
                             job->log,
                             all.holes,
                             job->linear,
                             job->volume->masked};
}

snow_status snow_data_range_measure(const snow_volume *volume, snow_scale scale,
                                    int threads, snow_data_range *out) {
    const int64_t *dims = volume->info.dims;
    range_job job = {.volume = volume,
                     .log = scale.log,
                     .linear = scale.linear,
                     .voxels = dims[0] * dims[1] * dims[2]};
    int64_t items = (job.voxels + ITEM - 1) / ITEM;
    threads = threads < items ? threads : (int)items;
    SNOW_TRY(SNOW_RESERVE(volume->context, job.found, 0, threads));
    for (int n = 0; n < threads; n++)
        job.found[n] = (found_range){.low = INFINITY, .high = -INFINITY};
    snow_status status =
        snow_parallel(volume->context, threads, items, look_at_item, &job);
    look_at_missing(&job);
    if (status == SNOW_STATUS_OK)
        put_together(&job, threads, out);
    snow_release(volume->context, job.found);
    return status;
}

/* --- the scale of a look -------------------------------------------------- */

/* A point of a look on the range's scale. */
static double point_of(const snow_data_range *data, double value) {
    return data->log ? log10(value) : snow_place_of(data->linear, value);
}

/* The hull of the data's values that have an opacity, but for those beyond the
 * look's points, where it is constant. */
static void find_visible(const snow_data_range *data,
                         const snow_transfer *transfer, double visible[2]) {
    const snow_opacity_point *p = transfer->opacities;
    const snow_color_point *c = transfer->colors;
    size_t count = transfer->opacity_count;
    double first = fmin(p[0].value, c[0].value);
    double last = fmax(p[count - 1].value, c[transfer->color_count - 1].value);
    visible[0] = INFINITY;
    visible[1] = -INFINITY;
    for (size_t n = 0; n <= count; n++) {
        double a = point_of(data, n > 0 ? p[n - 1].value : first);
        double b = point_of(data, n < count ? p[n].value : last);
        bool seen =
            (n > 0 && p[n - 1].opacity > 0) || (n < count && p[n].opacity > 0);
        if (!seen || a > data->high || b < data->low)
            continue;
        visible[0] = fmin(visible[0], fmax(a, data->low));
        visible[1] = fmax(visible[1], fmin(b, data->high));
    }
}

/* The rule for stored values bottom .. top, which are different; *unit is the
 * data value of a number. */
static snow_fixed_quantizer fixed_of(int32_t bottom, int32_t top, double slope,
                                     double *unit) {
    snow_fixed_quantizer fixed = {
        .bottom = bottom, .top = top, .weight = INT16_MAX};
    int32_t range = top - bottom, first = slope < 0 ? top : bottom;
    int32_t factor = range <= 2047 ? SNOW_VALUE_MOST / range : 1;
    *unit = fabs(slope) / factor;
    if (range > 2047) {
        while (range * factor * 2 < 32768)
            factor *= 2;
        fixed.shift = range >= 32768;
        int32_t most = range * factor >> fixed.shift;
        fixed.weight = (int16_t)(SNOW_VALUE_MOST * 32768 / most);
        *unit = fabs(slope) * 32768 * (1 << fixed.shift) /
                ((double)fixed.weight * factor);
    }
    factor = slope < 0 ? -factor : factor;
    fixed.factor = (uint16_t)factor;
    fixed.offset = (uint16_t)(-first * factor);
    return fixed;
}

/* The scale of integers, from that of all quantized values. */
static void make_whole(snow_value_scale14 *scale,
                       const snow_volume_info *info) {
    double a = (scale->low - info->intercept) / info->slope, unit;
    double b = (scale->high - info->intercept) / info->slope;
    int32_t bottom = (int32_t)floor(fmin(a, b) + 1e-6);
    int32_t top = (int32_t)ceil(fmax(a, b) - 1e-6);
    if (top <= bottom)
        return;
    scale->whole = true;
    scale->fixed = fixed_of(bottom, top, info->slope, &unit);
    scale->low =
        info->slope * (info->slope < 0 ? top : bottom) + info->intercept;
    scale->high = scale->low + SNOW_VALUE_MOST * unit;
}

snow_value_scale14 snow_value_scale_of(const snow_data_range *data,
                                       const snow_transfer *transfer,
                                       const snow_volume_info *info) {
    snow_value_scale14 scale = {.low = data->low,
                                .high = data->high,
                                .log = data->log,
                                .linear = data->linear};
    double visible[2] = {data->low, data->high};
    if (transfer)
        find_visible(data, transfer, visible);
    double length = visible[1] - visible[0];
    if (length > 0 && length * 64 < data->high - data->low) {
        scale.low = fmax(data->low, visible[0] - 4 * length);
        scale.high = fmin(data->high, visible[1] + 4 * length);
        scale.clamps = true;
    }
    if (snow_type_size(info->type) <= 2 && !data->log && !(data->linear > 0))
        make_whole(&scale, info);
    return scale;
}

double snow_value_of(const snow_value_scale14 *scale, double v) {
    double x = scale->low + v * (scale->high - scale->low) / SNOW_VALUE_MOST;
    if (scale->linear > 0)
        return snow_scale_value((snow_scale){false, scale->linear}, x);
    return scale->log ? pow(10, x) : x;
}
