/* classify/values/value_range.c - see value_range.h. */
#include "classify/values/value_range.h"

#include "base/thread_pool.h"
#include "volume/clip_planes.h"

#include <math.h>

/* --- the range of the data -------------------------------------------------
 */

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
    int64_t voxels;
    found_range *found; /* of each worker */
} range_job;

static void look_at(found_range *found, const double *natives, size_t count) {
    double low = found->low, high = found->high;
    bool holes = false;
    for (size_t n = 0; n < count; n++) {
        double value = natives[n];
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
static void take_natives(const range_job *job, double *natives, size_t count) {
    const snow_volume_info *info = &job->volume->info;
    if (!job->log)
        return;
    for (size_t n = 0; n < count; n++) {
        double value = info->slope * natives[n] + info->intercept;
        natives[n] = value > 0 ? value : NAN;
    }
}

/* Native values of one or two bytes. */
#define LOOK_NARROW(name, type)                                         \
    static void look_at_##name(found_range *found, const type *natives, \
                               size_t count) {                          \
        type low = natives[0], high = natives[0];                       \
        for (size_t n = 0; n < count; n++) {                            \
            low = natives[n] < low ? natives[n] : low;                  \
            high = natives[n] > high ? natives[n] : high;               \
        }                                                               \
        found->low = low < found->low ? low : found->low;               \
        found->high = high > found->high ? high : found->high;          \
    }
LOOK_NARROW(int8, int8_t)
LOOK_NARROW(uint8, uint8_t)
LOOK_NARROW(int16, int16_t)
LOOK_NARROW(uint16, uint16_t)

/* False where the voxels have another type, or logarithms are wanted. */
static bool look_at_narrow(const range_job *job, found_range *found,
                           int64_t first, size_t count) {
    const unsigned char *voxels = job->volume->voxels;
    snow_type type = job->volume->info.type;
    const void *at = voxels + (size_t)first * snow_type_size(type);
    if (job->log)
        return false;
    if (type == SNOW_TYPE_INT8)
        look_at_int8(found, at, count);
    else if (type == SNOW_TYPE_UINT8)
        look_at_uint8(found, at, count);
    else if (type == SNOW_TYPE_INT16)
        look_at_int16(found, at, count);
    else if (type == SNOW_TYPE_UINT16)
        look_at_uint16(found, at, count);
    else
        return false;
    return true;
}

static void look_at_item(void *of, int64_t item, int worker) {
    const range_job *job = of;
    int64_t first = item * ITEM, end = first + ITEM;
    end = end < job->voxels ? end : job->voxels;
    if (look_at_narrow(job, &job->found[worker], first, (size_t)(end - first)))
        return;
    for (; first < end; first += BLOCK) {
        double natives[BLOCK];
        size_t count = end - first < BLOCK ? (size_t)(end - first) : BLOCK;
        snow_volume_natives(job->volume, first, count, natives);
        take_natives(job, natives, count);
        look_at(&job->found[worker], natives, count);
    }
}

/* Voxels beyond clip planes whose values are kept. */
static void look_at_clipped(const range_job *job) {
    const snow_clip_planes *clip = job->volume->clip;
    for (size_t n = 0; clip && n < clip->voxel_count; n++) {
        double native = clip->voxels[n].native;
        take_natives(job, &native, 1);
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
    bool any = all.low <= all.high;
    *out = (snow_data_range){any ? fmin(a + from, b + from) : INFINITY,
                             any ? fmax(a + from, b + from) : -INFINITY,
                             job->log, all.holes};
}

snow_status snow_data_range_measure(const snow_volume *volume, bool log,
                                    int threads, snow_data_range *out) {
    const int64_t *dims = volume->info.dims;
    range_job job = {
        .volume = volume, .log = log, .voxels = dims[0] * dims[1] * dims[2]};
    int64_t items = (job.voxels + ITEM - 1) / ITEM;
    threads = threads < items ? threads : (int)items;
    job.found = snow_allocate_array(volume->context, (uint64_t)threads,
                                    sizeof *job.found);
    if (!job.found)
        return SNOW_STATUS_NO_MEMORY;
    for (int n = 0; n < threads; n++)
        job.found[n] = (found_range){.low = INFINITY, .high = -INFINITY};
    snow_status status =
        snow_parallel(volume->context, threads, items, look_at_item, &job);
    look_at_clipped(&job);
    if (status == SNOW_STATUS_OK)
        put_together(&job, threads, out);
    snow_release(volume->context, job.found);
    return status;
}

/* --- the scale of a look ---------------------------------------------------
 */

/* A point of a look on the range's scale. */
static double point_of(const snow_data_range *data, double value) {
    return data->log ? log10(value) : value;
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

snow_value_scale14 snow_value_scale_of(const snow_data_range *data,
                                       const snow_transfer *transfer) {
    snow_value_scale14 scale = {data->low, data->high, data->log};
    double visible[2];
    find_visible(data, transfer, visible);
    double length = visible[1] - visible[0];
    if (!(length > 0) || length * 64 >= data->high - data->low)
        return scale;
    scale.low = fmax(data->low, visible[0] - 4 * length);
    scale.high = fmin(data->high, visible[1] + 4 * length);
    return scale;
}

/* --- numbers ----------------------------------------------------------------
 */

/* To the nearest integer, halves to the even one: adding this leaves no bit for
 * fractions. */
static inline double nearest(double x) {
    const double big = 0x1.8p52;
    return x + big - big;
}

static inline int16_t number_of(double low, double high, double value) {
    value = value < low ? low : value;
    value = value > high ? high : value;
    return (int16_t)(int)nearest((value - low) * SNOW_VALUE_MOST /
                                 (high - low));
}

int16_t snow_value_number(const snow_value_scale14 *scale, double value) {
    if (isnan(value) || (scale->log && !(value > 0)))
        return SNOW_VALUE_HOLE;
    if (!(scale->high > scale->low))
        return 0;
    return number_of(scale->low, scale->high,
                     scale->log ? log10(value) : value);
}

double snow_value_of(const snow_value_scale14 *scale, double v) {
    double x = scale->low + v * (scale->high - scale->low) / SNOW_VALUE_MOST;
    return scale->log ? pow(10, x) : x;
}

/* The number of a data value, or of the label that it is. */
static int16_t coded(const snow_value_coder *coder, double value) {
    int low = 0, high = coder->name_count;
    if (!coder->names)
        return snow_value_number(&coder->scale, value);
    while (low < high) {
        int middle = (low + high) / 2;
        if (coder->names[middle] < value)
            low = middle + 1;
        else
            high = middle;
    }
    return (int16_t)low;
}

static bool is_wide(snow_type type) {
    return snow_type_size(type) > 2;
}

/* The number at a place of a straight table: vectors compute it sooner than
 * they load it. */
static inline int16_t straight_number(const snow_value_coder *coder,
                                      uint8_t place) {
    place = place > coder->first ? place : coder->first;
    place = place < coder->last ? place : coder->last;
    uint16_t n = (uint16_t)(place - coder->first);
    uint32_t part = (uint32_t)n * coder->part;
    return (int16_t)(uint16_t)(n * coder->whole + (part >> 16) +
                               ((uint16_t)part >> 15));
}

static bool find_straight(snow_value_coder *coder) {
    const int16_t *numbers = coder->numbers;
    int first = 0, last = 255;
    while (first < 255 && numbers[first + 1] == 0)
        first++;
    while (last > first && numbers[last - 1] == SNOW_VALUE_MOST)
        last--;
    double slope = (double)SNOW_VALUE_MOST / (last > first ? last - first : 1);
    coder->first = (uint8_t)first;
    coder->last = (uint8_t)last;
    coder->whole = (uint16_t)slope;
    coder->part = (uint16_t)((slope - floor(slope)) * 65536 + 0.5);
    for (int n = 0; n < 256; n++)
        if (straight_number(coder, (uint8_t)n) != numbers[n])
            return false;
    return true;
}

snow_status snow_value_coder_make(const snow_volume *volume,
                                  const snow_value_scale14 *scale,
                                  snow_value_coder *coder) {
    const snow_volume_info *info = &volume->info;
    size_t count = (size_t)1 << 8 * (snow_type_size(info->type) & 3);
    coder->scale = *scale;
    coder->type = info->type;
    coder->slope = info->slope;
    coder->intercept = info->intercept;
    coder->straight = false;
    if (is_wide(info->type))
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_reserve(volume->context, &coder->numbers, &coder->capacity, 0,
                          count * sizeof *coder->numbers));
    coder->lowest = info->type == SNOW_TYPE_INT8    ? INT8_MIN
                    : info->type == SNOW_TYPE_INT16 ? INT16_MIN
                                                    : 0;
    for (size_t n = 0; n < count; n++)
        coder->numbers[n] =
            coded(coder, info->slope * (double)((int32_t)n + coder->lowest) +
                             info->intercept);
    coder->straight = snow_type_size(info->type) == 1 && find_straight(coder);
    return SNOW_STATUS_OK;
}

void snow_value_coder_fini(snow_context *context, snow_value_coder *coder) {
    snow_release(context, coder->numbers);
    *coder = (snow_value_coder){0};
}

/* Native values of 8 bits; those with a sign lie `flip` from their places. */
static void code_straight(const snow_value_coder *all, const uint8_t *natives,
                          size_t count, int16_t *restrict out) {
    const snow_value_coder coder = *all;
    const uint8_t flip = coder.type == SNOW_TYPE_INT8 ? 0x80 : 0;
    for (size_t n = 0; n < count; n++)
        out[n] = straight_number(&coder, natives[n] ^ flip);
}

#define CODE_NARROW(name, type)                                                \
    static void code_##name(const snow_value_coder *coder,                     \
                            const type *natives, size_t count, int16_t *out) { \
        const int16_t *numbers = coder->numbers - coder->lowest;               \
        for (size_t n = 0; n < count; n++)                                     \
            out[n] = numbers[natives[n]];                                      \
    }

CODE_NARROW(INT8, int8_t)
CODE_NARROW(UINT8, uint8_t)
CODE_NARROW(INT16, int16_t)
CODE_NARROW(UINT16, uint16_t)

#define CODE_WIDE(name, type)                                                  \
    static void code_##name(const snow_value_coder *coder,                     \
                            const type *natives, size_t count, int16_t *out) { \
        const snow_value_scale14 scale = coder->scale;                         \
        const double slope = coder->slope, intercept = coder->intercept;       \
        const bool plain =                                                     \
            scale.high > scale.low && !scale.log && !coder->names;             \
        for (size_t n = 0; n < count; n++) {                                   \
            double value = slope * (double)natives[n] + intercept;             \
            out[n] = plain && value == value                                   \
                         ? number_of(scale.low, scale.high, value)             \
                         : coded(coder, value);                                \
        }                                                                      \
    }

CODE_WIDE(INT32, int32_t)
CODE_WIDE(UINT32, uint32_t)
CODE_WIDE(INT64, int64_t)
CODE_WIDE(UINT64, uint64_t)
CODE_WIDE(FLOAT32, float)
CODE_WIDE(FLOAT64, double)

void snow_value_code_row(const snow_value_coder *coder, const void *natives,
                         size_t count, int16_t *out) {
    if (coder->straight) {
        code_straight(coder, natives, count, out);
        return;
    }
    switch (coder->type) {
#define CODE_CASE(name, type, text)              \
    case SNOW_TYPE_##name:                       \
        code_##name(coder, natives, count, out); \
        break;
        SNOW_TYPE_MAP(CODE_CASE)
#undef CODE_CASE
    case SNOW_TYPE_NONE:
        break;
    }
}

void snow_value_code_clipped(const snow_value_coder *coder,
                             const snow_volume *volume, const int64_t at[3],
                             int axis, size_t count, int16_t *out) {
    int64_t here[3] = {at[0], at[1], at[2]};
    for (size_t n = 0; n < count; n++, here[axis]++) {
        if (out[n] != SNOW_VALUE_HOLE)
            continue;
        double native =
            snow_clip_planes_value_at(volume->clip, volume->info.dims, here);
        out[n] = snow_value_number(&coder->scale,
                                   coder->slope * native + coder->intercept);
    }
}
