/* slab.c - implements slab.h. */
#include "slice/slab.h"
#include "commands/world.h"
#include "run/log.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const names[] = {"max", "mean", "min"};

/* --- which slices --------------------------------------------------------- */

/* The distance of slices in the world, which may be sheared; and the axis of
 * the world that is nearest to it. */
static double measure_step(const snow_volume_info *info, int axis, int *world) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double normal[3], length = 0, step = 0;
    *world = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = info->matrix[j][u] * info->matrix[k][v] -
                    info->matrix[k][u] * info->matrix[j][v];
        length += normal[i] * normal[i];
        step += normal[i] * info->matrix[i][axis];
        if (fabs(normal[i]) > fabs(normal[*world]))
            *world = i;
    }
    return fabs(step) / sqrt(length);
}

static bool read_kind(const char *text, slab_kind *out) {
    for (int n = 0; n < 3; n++)
        if (strcmp(text, names[n]) == 0) {
            *out = (slab_kind)n;
            return true;
        }
    return false;
}

/* The thickness in slices; NaN: none. */
static double read_thickness(const char *text, const snow_volume_info *info,
                             int axis) {
    int world;
    const double step = measure_step(info, axis, &world);
    char *end = NULL;
    const double number = strtod(text, &end);
    if (end == text || !(number > 0) || !isfinite(number))
        return NAN;
    if (!*end)
        return number;
    const double ratio = world_ratio(info, world, end);
    return ratio > 0 ? number * ratio * fabs(world_length(info, world)) / step
                     : NAN;
}

int slab_read(const char *text, const snow_volume_info *info, int axis,
              slab *out) {
    *out = (slab){.kind = SLAB_MAX};
    if (!text)
        return CONTINUE;
    const char *colon = strchr(text, ':');
    const size_t length = colon ? (size_t)(colon - text) : strlen(text);
    char number[40] = "";
    if (length < sizeof number)
        memcpy(number, text, length);
    const double slices = read_thickness(number, info, axis);
    if ((colon && !read_kind(colon + 1, &out->kind)) || !isfinite(slices))
        return fail_usage("--slab: '%.60s' is no thickness above 0 with max, "
                          "mean or min; give such as 10%s:mean, or 5 for five "
                          "slices",
                          text, *info->unit ? info->unit : "");
    const double most = (double)info->dims[axis];
    out->half = (int64_t)floor(fmin(slices / 2 + 1e-9, most));
    return CONTINUE;
}

int slab_check(const slab *s, const snow_transfer *transfer) {
    if (s->kind != SLAB_MEAN || !s->half || !transfer ||
        !snow_transfer_label(transfer, 0))
        return CONTINUE;
    return fail_usage("--slab: labels have no mean: give max or min");
}

slab_slices slab_around(const slab *s, const snow_volume_info *info, int axis,
                        int64_t index) {
    const int64_t last = info->dims[axis] - 1;
    const int64_t from = index > s->half ? index - s->half : 0;
    const int64_t to = index < last - s->half ? index + s->half : last;
    return (slab_slices){axis, from, to - from + 1};
}

void slab_describe(const slab *s, int64_t count, char *out, size_t size) {
    static const char *const words[] = {"maximum", "mean", "minimum"};
    snprintf(out, size, "%s of %" PRId64 " slice%s", words[s->kind], count,
             count == 1 ? "" : "s");
}

/* --- the projection ------------------------------------------------------- */

/* Stored values of a row, `step` voxels from one another. */
static void read_row(const void *voxels, snow_type type, int64_t from,
                     int64_t step, int64_t count, double *out) {
    switch (type) {
#define ROW(name, type_, text)                                         \
    case SNOW_TYPE_##name:                                             \
        for (int64_t i = 0; i < count; i++)                            \
            out[i] = (double)((const type_ *)voxels)[from + i * step]; \
        break;
        SNOW_TYPE_MAP(ROW)
#undef ROW
    case SNOW_TYPE_NONE:
        break;
    }
}

/* What is no value does not count: a mean is a sum and the number of its values
 * before it is divided. */
static void add_row(slab_kind kind, const double *row, int64_t count,
                    double *sum, double *known) {
    for (int64_t i = 0; i < count; i++) {
        const double value = row[i];
        if (!isfinite(value))
            continue;
        if (kind == SLAB_MEAN)
            sum[i] += value;
        else if (known[i] < 1 ||
                 (kind == SLAB_MAX ? value > sum[i] : value < sum[i]))
            sum[i] = value;
        known[i]++;
    }
}

/* `row` has the room of two. */
static void project_row(const snow_volume_info *whole, slab_kind kind,
                        const slab_slices *slices, const void *voxels,
                        int64_t from, double *row, double *out) {
    const int64_t *dims = whole->dims;
    const int64_t steps[3] = {1, dims[0], dims[0] * dims[1]};
    const int u = slices->axis == 0;
    const int64_t count = dims[u];
    double *known = row + count;
    for (int64_t i = 0; i < count; i++)
        out[i] = known[i] = 0;
    for (int64_t k = 0; k < slices->count; k++) {
        read_row(voxels, whole->type,
                 from + (slices->first + k) * steps[slices->axis], steps[u],
                 count, row);
        add_row(kind, row, count, out, known);
    }
    for (int64_t i = 0; i < count; i++)
        out[i] = known[i] < 1        ? NAN
                 : kind == SLAB_MEAN ? out[i] / known[i]
                                     : out[i];
}

static void project(const snow_volume_info *whole, slab_kind kind,
                    const slab_slices *slices, const void *voxels, double *row,
                    double *out) {
    const int64_t *dims = whole->dims;
    const int u = slices->axis == 0, v = slices->axis == 2 ? 1 : 2;
    const int64_t step = v == 1 ? dims[0] : dims[0] * dims[1];
    if (whole->slope < 0 && kind != SLAB_MEAN) /* of stored values */
        kind = kind == SLAB_MAX ? SLAB_MIN : SLAB_MAX;
    for (int64_t b = 0; b < dims[v]; b++)
        project_row(whole, kind, slices, voxels, b * step, row,
                    out + b * dims[u]);
}

static snow_status project_one(snow_context *context, const slab *s,
                               const snow_volume *volume, int axis,
                               int64_t index, void **voxels,
                               snow_volume **out) {
    snow_volume_info info = *snow_volume_get_info(volume);
    const snow_volume_info whole = info;
    const slab_slices slices = slab_around(s, &info, axis, index);
    const void *from = snow_volume_voxels(volume);
    if (!from)
        return SNOW_STATUS_BAD_USAGE; /* it stays in its file */
    info.dims[axis] = 1;
    info.type = SNOW_TYPE_FLOAT64; /* of stored values, too */
    for (int row = 0; row < 3; row++)
        info.matrix[row][3] += info.matrix[row][axis] * (double)index;
    const int64_t count = info.dims[0] * info.dims[1] * info.dims[2];
    double *row = malloc(2 * sizeof *row * (size_t)info.dims[axis == 0]);
    double *made = *voxels = malloc(sizeof *made * (size_t)count);
    snow_status status = SNOW_STATUS_NO_MEMORY;
    if (row && made) {
        project(&whole, s->kind, &slices, from, row, made);
        status = snow_volume_wrap(context, &info, made, out);
    }
    free(row);
    return status;
}

snow_status slab_project(snow_context *context, const slab *s,
                         snow_volume *const *volumes, int count, int axis,
                         int64_t index, slab_volumes *out) {
    snow_status status = SNOW_STATUS_OK;
    *out = (slab_volumes){.volumes = {NULL}};
    for (int n = 0; n < count && status == SNOW_STATUS_OK; n++)
        status = project_one(context, s, volumes[n], axis, index,
                             &out->voxels[n], &out->volumes[n]);
    if (status != SNOW_STATUS_OK)
        slab_free(out);
    return status;
}

void slab_free(slab_volumes *made) {
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++) {
        snow_volume_close(made->volumes[n]);
        free(made->voxels[n]);
    }
    *made = (slab_volumes){.volumes = {NULL}};
}

snow_status slab_see(snow_context *context, const snow_volume *volume,
                     const slab_volumes *made, int axis, const snow_view *view,
                     snow_view *out) {
    static const char *const axes[] = {"x", "y", "z"};
    snow_view all = *view, one = *view;
    int found;
    snow_status status = snow_slice_view(context, snow_volume_get_info(volume),
                                         axes[axis], &all, &found);
    if (status == SNOW_STATUS_OK)
        status =
            snow_slice_view(context, snow_volume_get_info(made->volumes[0]),
                            axes[axis], &one, &found);
    *out = *view;
    out->zoom *= one.zoom / all.zoom;
    return status;
}
