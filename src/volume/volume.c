/* volume/volume.c - making, checking and closing a volume.
 *
 * What a header says is checked here, in one place, before any voxel gets its
 * memory: every reader goes through snow_volume_new. */
#include "volume/volume.h"

#include "volume/clip_planes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

SNOW_RECORD_OF_ZEROS(snow_volume_info);
SNOW_RECORD_OF_ZEROS(snow_volume_options);
SNOW_RECORD_OF_ZEROS(snow_extent);
SNOW_RECORD_OF_ZEROS(snow_volume_statistics);

/* The largest count of bytes that an int64_t can address. */
#define MOST_BYTES ((uint64_t)INT64_MAX)

/* What a file that says nothing means: unit voxels at the origin, values as
 * they are. */
snow_volume_info snow_volume_info_default(const char *format) {
    snow_volume_info info = {.size = sizeof info,
                             .dims = {1, 1, 1},
                             .spacing = {1, 1, 1},
                             .slope = 1,
                             .format = format,
                             .times = 1,
                             .components = 1,
                             .time_value = NAN};
    for (int i = 0; i < 4; i++)
        info.matrix[i][i] = 1;
    return info;
}

/* Voxels before bytes: each product is checked by itself, for three sizes of
 * 2^31 overflow 64 bits long before the type counts. */
bool snow_volume_count(const int64_t dims[3], snow_type type, int64_t *voxels,
                       uint64_t *bytes) {
    uint64_t count = 1, size;
    for (int i = 0; i < 3; i++)
        if (dims[i] < 1 || !snow_mul_u64(count, (uint64_t)dims[i], &count))
            return false;
    if (!snow_type_size(type) ||
        !snow_mul_u64(count, snow_type_size(type), &size) || size > MOST_BYTES)
        return false;
    *voxels = (int64_t)count;
    *bytes = size;
    return true;
}

/* The farthest that a voxel may lie from the origin, and 1 by the shortest side
 * that it may have: squares of lengths are doubles. */
#define FARTHEST 1e100

static bool is_measurable(const snow_volume_info *info) {
    for (int i = 0; i < 3; i++) {
        double far = fabs(info->matrix[i][3]), side = 0;
        for (int j = 0; j < 3; j++) {
            far += fabs(info->matrix[i][j]) * (double)info->dims[j];
            side = fmax(side, fabs(info->matrix[j][i]));
        }
        if (!(far <= FARTHEST) || side < 1 / FARTHEST)
            return false;
    }
    return true;
}

/* In the order of dependence: the type has a size before bytes are counted.
 * Spacings are not looked at here, they are the columns of the matrix. */
snow_status snow_volume_info_check(snow_context *context,
                                   const snow_volume_info *info) {
    int64_t voxels;
    uint64_t bytes;
    double inverse[3][3];
    const int64_t *dims = info->dims;
    if (!snow_type_size(info->type))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "unknown scalar type: must be one of int8 to float64");
    if (dims[0] < 1 || dims[1] < 1 || dims[2] < 1)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "a volume of %lldx%lldx%lld voxels is empty: every "
                         "size must be at least 1",
                         (long long)dims[0], (long long)dims[1],
                         (long long)dims[2]);
    if (!snow_volume_count(dims, info->type, &voxels, &bytes))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "a volume of %lldx%lldx%lld voxels is larger than any "
                         "file; check the sizes",
                         (long long)dims[0], (long long)dims[1],
                         (long long)dims[2]);
    /* The last row is checked too: every later stage takes it for 0 0 0 1. */
    const double(*m)[4] = info->matrix;
    bool good = m[3][0] == 0 && m[3][1] == 0 && m[3][2] == 0 && m[3][3] == 1;
    for (int i = 0; i < 16; i++)
        good = good && isfinite(m[i / 4][i % 4]);
    if (!good || !snow_matrix_invert3(info->matrix, inverse))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "invalid spacing or directions of the axes: zero, not "
                         "finite, or in one plane; correct them");
    if (!is_measurable(info))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "its voxels are smaller than %g or lie farther than "
                         "%g from the origin; correct spacing and origin",
                         1 / FARTHEST, FARTHEST);
    if (!isfinite(info->slope) || !isfinite(info->intercept) ||
        info->slope == 0)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "invalid slope %g and intercept %g; give finite "
                         "numbers, and a slope "
                         "other than 0",
                         info->slope, info->intercept);
    return SNOW_STATUS_OK;
}

snow_status snow_volume_over(snow_context *context,
                             const snow_volume_info *info, const void *voxels,
                             snow_volume **out) {
    snow_volume *volume = snow_allocate_clear(context, sizeof *volume);
    if (!volume)
        return SNOW_STATUS_NO_MEMORY;
    volume->context = context;
    volume->info = *info;
    volume->voxels = voxels;
    snow_volume_info_measure(&volume->info);
    volume->info.size = sizeof volume->info;
    *out = volume;
    return SNOW_STATUS_OK;
}

/* Room for voxels: the last slab's where that is large enough, for new pages
 * cost more than reading into them. */
static void *take_voxels(snow_context *context, uint64_t bytes) {
    void *spare = context->spare;
    context->spare = NULL;
    if (snow_block_bytes(spare) >= bytes)
        return spare;
    snow_release(context, spare);
    return snow_allocate_array(context, bytes, 1);
}

/* The voxels come first and the record second, because the voxels are what is
 * likely to fail. */
snow_status snow_volume_new(snow_context *context, const snow_volume_info *info,
                            snow_volume **out) {
    int64_t count;
    uint64_t bytes;
    SNOW_TRY(snow_volume_info_check(context, info));
    snow_volume_count(info->dims, info->type, &count, &bytes);
    void *voxels = take_voxels(context, bytes);
    if (!voxels)
        return SNOW_STATUS_NO_MEMORY;
    snow_volume *volume;
    snow_status status = snow_volume_over(context, info, voxels, &volume);
    if (status != SNOW_STATUS_OK) {
        snow_release(context, voxels);
        return status;
    }
    volume->owned = voxels;
    snow_volume_freeze(volume);
    *out = volume;
    return SNOW_STATUS_OK;
}

void snow_volume_freeze(snow_volume *volume) {
    volume->generation = ++volume->context->generations;
}

/* Returns whether `count` voxels from `first` on lie within `room` from
 * `begin` on; written so that nothing overflows. */
static bool lies_within(int64_t first, int64_t count, int64_t begin,
                        int64_t capacity) {
    return first >= begin && first - begin <= capacity && count >= 0 &&
           count <= capacity - (first - begin);
}

static snow_status check_part(const snow_volume *volume,
                              const snow_extent *part) {
    bool none = !part->count[0] || !part->count[1] || !part->count[2];
    for (int axis = 0; axis < 3; axis++) {
        int64_t stored = volume->info.dims[axis];
        if (part->dims[axis] < 1 ||
            !lies_within(part->stored[axis], stored, 0, part->dims[axis]) ||
            (!none && !lies_within(part->first[axis], part->count[axis],
                                   part->stored[axis], stored)))
            return snow_fail(
                volume->context, SNOW_STATUS_BAD_USAGE,
                "along axis %d a part of %lld voxels from %lld, stored as %lld "
                "from %lld, is not inside %lld voxels; correct its boxes",
                axis, (long long)part->count[axis],
                (long long)part->first[axis], (long long)stored,
                (long long)part->stored[axis], (long long)part->dims[axis]);
    }
    return SNOW_STATUS_OK;
}

snow_status snow_volume_need_voxels(const snow_volume *volume) {
    if (!volume->stream)
        return SNOW_STATUS_OK;
    return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                     "%s: the voxels stay in the file, but this call needs all "
                     "of them; open the volume in memory (snow_volume_open)",
                     volume->path);
}

snow_status snow_volume_set_extent(snow_volume *volume,
                                   const snow_extent *given) {
    snow_extent part;
    SNOW_TRY(SNOW_RECORD_READ(volume->context, snow_extent, given, &part));
    SNOW_TRY(snow_volume_need_voxels(volume));
    SNOW_TRY(check_part(volume, &part));
    volume->part = part;
    volume->is_part = true;
    if (volume->generation) /* what was encoded of it was of other slices */
        snow_volume_freeze(volume);
    return SNOW_STATUS_OK;
}

snow_status snow_volume_get_extent(const snow_volume *volume,
                                   snow_extent *out) {
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    return SNOW_RECORD_FILL(volume->context, snow_extent, &part, out);
}

void snow_volume_find_extent(const snow_volume *volume, snow_extent *out) {
    if (volume->is_part) {
        *out = volume->part;
        return;
    }
    snow_extent_init(out);
    memcpy(out->dims, volume->info.dims, sizeof out->dims);
    memcpy(out->count, volume->info.dims, sizeof out->count);
}

void snow_volume_whole(const snow_volume *volume, snow_volume_info *out) {
    *out = volume->info;
    if (!volume->is_part)
        return;
    memcpy(out->dims, volume->part.dims, sizeof out->dims);
    for (int row = 0; row < 3; row++)
        for (int axis = 0; axis < 3; axis++)
            out->matrix[row][3] -=
                out->matrix[row][axis] * (double)volume->part.stored[axis];
    for (int row = 0; row < 3 && volume->knows_origin; row++)
        out->matrix[row][3] = volume->origin[row];
}

snow_status snow_volume_set_whole(snow_volume *volume,
                                  const snow_volume_info *given) {
    snow_volume_info whole;
    SNOW_TRY(
        SNOW_RECORD_READ(volume->context, snow_volume_info, given, &whole));
    for (int row = 0; row < 3; row++)
        volume->origin[row] = whole.matrix[row][3];
    volume->knows_origin = true;
    if (!volume->is_part) {
        memcpy(volume->info.matrix, whole.matrix, sizeof whole.matrix);
        snow_volume_info_measure(&volume->info);
    }
    return SNOW_STATUS_OK;
}

snow_volume_info snow_volume_info_of_box(const snow_volume_info *whole,
                                         const int64_t first[3],
                                         const int64_t count[3]) {
    snow_volume_info info = *whole;
    for (int i = 0; i < 3; i++) {
        info.dims[i] = count[i];
        for (int j = 0; j < 3; j++)
            info.matrix[i][3] += info.matrix[i][j] * (double)first[j];
    }
    return info;
}

static int compare_labels(const void *a, const void *b) {
    double x = ((const snow_label *)a)->value;
    double y = ((const snow_label *)b)->value;
    return (x > y) - (x < y);
}

snow_status snow_volume_set_labels(snow_volume *volume,
                                   const snow_label *labels, size_t count) {
    volume->labelled = true;
    if (!count)
        return SNOW_STATUS_OK;
    SNOW_TRY(SNOW_RESERVE(volume->context, volume->labels, 0, count));
    memcpy(volume->labels, labels, count * sizeof *labels);
    qsort(volume->labels, count, sizeof *labels, compare_labels);
    volume->label_count = count;
    return SNOW_STATUS_OK;
}

snow_volume *snow_volume_hold(const snow_volume *volume) {
    snow_volume *held = (snow_volume *)volume;
    held->holders++;
    return held;
}

/* Shared voxels are not owned and stay. */
void snow_volume_close(snow_volume *volume) {
    if (volume && volume->holders-- == 0) {
        snow_clip_planes_free(volume->clip);
        snow_release(volume->context, volume->stream);
        snow_release(volume->context, volume->owned);
        snow_release(volume->context, volume->labels);
        snow_release(volume->context, volume);
    }
}

const snow_volume_info *snow_volume_get_info(const snow_volume *volume) {
    return &volume->info;
}

const char *snow_volume_patient(const snow_volume *volume) {
    return volume->patient;
}

const void *snow_volume_voxels(const snow_volume *volume) {
    return volume->voxels;
}
