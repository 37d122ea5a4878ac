/* volume/resample.c - a volume on the grid of another, through both matrices:
 * of labels and masks the nearest voxel, of other values tri-linear.
 *
 * Of both there may be boxes only.  Places are computed from indices of the
 * wholes, so that a box has the bits that it has in the whole. */
#include "volume/clip_planes.h"
#include "volume/stream_internal.h"

#include <math.h>
#include <string.h>

/* From indices of the new grid to those of the volume. */
typedef struct regrid {
    const snow_volume *from;
    snow_volume *to;
    double step[3][3], origin[3]; /* [volume's axis][new axis] */
    int64_t dims[3], grid[3];  /* of the wholes: of the volume, of the grid */
    int64_t skip[3], first[3]; /* the first voxels here of both */
    bool nearest;
} regrid;

static void find_steps(const snow_volume_info *a, const snow_volume_info *b,
                       double step[3][3], double origin[3]) {
    double inverse[3][3];
    snow_matrix_invert3(a->matrix, inverse);
    for (int axis = 0; axis < 3; axis++) {
        origin[axis] = 0;
        memset(step[axis], 0, sizeof step[axis]);
        for (int row = 0; row < 3; row++) {
            origin[axis] +=
                inverse[axis][row] * (b->matrix[row][3] - a->matrix[row][3]);
            for (int n = 0; n < 3; n++)
                step[axis][n] += inverse[axis][row] * b->matrix[row][n];
        }
    }
}

bool snow_volume_box_of(const snow_volume_info *volume,
                        const snow_volume_info *grid, const int64_t crop[3][2],
                        int64_t box[3][2]) {
    double step[3][3], origin[3];
    bool meets = true;
    find_steps(volume, grid, step, origin);
    for (int axis = 0; axis < 3; axis++) {
        double low = origin[axis], high = origin[axis];
        const double most = (double)volume->dims[axis] - 1;
        for (int n = 0; n < 3; n++) {
            int64_t end = crop[n][1] ? crop[n][1] : grid->dims[n];
            double a = step[axis][n] * (double)crop[n][0];
            double b = step[axis][n] * (double)(end - 1);
            low += fmin(a, b);
            high += fmax(a, b);
        }
        meets = meets && low <= most + 0.5 && high >= -0.5;
        box[axis][0] = (int64_t)fmin(fmax(floor(low) - 1, 0), most);
        box[axis][1] = (int64_t)fmin(fmax(ceil(high) + 1, 0), most) + 1;
    }
    return meets;
}

/* Within half a voxel of the volume's; rounding does not decide. */
static bool is_within(const int64_t dims[3], const double at[3]) {
    for (int axis = 0; axis < 3; axis++)
        if (!(at[axis] >= -0.5 - 1e-6) ||
            !(at[axis] <= (double)dims[axis] - 0.5 + 1e-6))
            return false;
    return true;
}

/* In the box that is here. */
static int64_t index_of(const regrid *r, const int64_t at[3]) {
    const int64_t *dims = r->from->info.dims, *skip = r->skip;
    return ((at[2] - skip[2]) * dims[1] + at[1] - skip[1]) * dims[0] + at[0] -
           skip[0];
}

/* The place is within, so that none is below 0. */
static int64_t nearest_to(const regrid *r, const double at[3]) {
    int64_t voxel[3];
    for (int axis = 0; axis < 3; axis++) {
        voxel[axis] = (int64_t)(at[axis] + 0.5 + 1e-6);
        if (voxel[axis] >= r->dims[axis])
            voxel[axis] = r->dims[axis] - 1;
    }
    return index_of(r, voxel);
}

/* The data value; NaN beside one. */
static double linear_at(const regrid *r, const double at[3]) {
    const snow_volume *from = r->from;
    double sum = 0;
    for (int corner = 0; corner < 8; corner++) {
        int64_t voxel[3];
        double weight = 1;
        for (int axis = 0; axis < 3; axis++) {
            double low = floor(at[axis]), part = at[axis] - low;
            int on = corner >> axis & 1;
            voxel[axis] =
                (int64_t)fmin(fmax(low + on, 0), (double)(r->dims[axis] - 1));
            weight *= on ? part : 1 - part;
        }
        if (weight > 0)
            sum += weight * snow_volume_native(from, index_of(r, voxel));
    }
    return from->info.slope * sum + from->info.intercept;
}

/* Outside a nearest volume is 0, which not every one can hold that has an
 * intercept. */
static bool is_moved(const snow_volume_info *info) {
    return info->intercept != 0;
}

static void put_nearest(const regrid *r, const double at[3], bool within,
                        char *out) {
    const snow_volume *from = r->from;
    const size_t size = snow_type_size(r->to->info.type);
    int64_t voxel = within ? nearest_to(r, at) : 0;
    if (!within) {
        memset(out, 0, size);
    } else if (is_moved(&from->info)) {
        double value = from->info.slope * snow_volume_native(from, voxel) +
                       from->info.intercept;
        memcpy(out, &value, size);
    } else {
        uint64_t one = 1;
        const size_t stored = (size_t)snow_volume_run(from, voxel, &one);
        const char *voxels = from->voxels;
        if (size == 1) /* most masks */
            *out = voxels[stored];
        else
            memcpy(out, voxels + stored * size, size);
    }
}

static void fill_row(const regrid *r, int64_t y, int64_t z) {
    const int64_t *dims = r->to->info.dims, *first = r->first;
    const size_t size = snow_type_size(r->to->info.type);
    char *out =
        (char *)r->to->owned + (size_t)((z * dims[1] + y) * dims[0]) * size;
    for (int64_t x = 0; x < dims[0]; x++, out += size) {
        double at[3];
        for (int axis = 0; axis < 3; axis++)
            at[axis] = r->origin[axis] +
                       r->step[axis][0] * (double)(first[0] + x) +
                       r->step[axis][1] * (double)(first[1] + y) +
                       r->step[axis][2] * (double)(first[2] + z);
        bool within = is_within(r->dims, at);
        float value = within && !r->nearest ? (float)linear_at(r, at) : NAN;
        if (r->nearest)
            put_nearest(r, at, within, out);
        else
            memcpy(out, &value, sizeof value);
    }
}

static snow_status fill(const regrid *r) {
    const int64_t *dims = r->to->info.dims;
    snow_context *context = r->to->context;
    snow_monitor monitor;
    snow_monitor_begin_reading(context, &monitor);
    for (int64_t z = 0; z < dims[2]; z++) {
        if (monitor.entered)
            snow_monitor_report(&monitor, SNOW_STAGE_READ, (double)z,
                                (double)dims[2]);
        for (int64_t y = 0;
             y < dims[1] && !snow_monitor_look(context->monitor, 0); y++)
            fill_row(r, y, z);
    }
    return snow_monitor_end(&monitor, snow_monitor_status(context->monitor));
}

/* All voxels, on dims and matrix of `box`; `what` it is for. */
static snow_status resample(regrid *r, const snow_volume_info *box,
                            const char *what) {
    const snow_volume *volume = r->from;
    const int64_t *dims = box->dims;
    snow_volume_info info = volume->info;
    memcpy(info.dims, dims, sizeof info.dims);
    memcpy(info.matrix, box->matrix, sizeof info.matrix);
    if (!r->nearest || is_moved(&info)) {
        info.whole |= r->nearest && info.type < SNOW_TYPE_FLOAT32;
        info.type = r->nearest ? SNOW_TYPE_FLOAT64 : SNOW_TYPE_FLOAT32;
        info.slope = 1;
        info.intercept = 0;
    }
    SNOW_TRY(snow_volume_new(volume->context, &info, &r->to));
    /* Is each voxel of the new grid one of the volume's? */
    double off = 0;
    for (int axis = 0; axis < 3; axis++) {
        off = fmax(off, fabs(r->origin[axis] - rint(r->origin[axis])));
        for (int n = 0; n < 3; n++)
            off = fmax(off, fabs(r->step[axis][n] - rint(r->step[axis][n])) *
                                (double)r->grid[n]);
    }
    if (!(off < 0.1))
        snow_notify(volume->context,
                    "the %s has another grid than the volume, and is resampled "
                    "to the volume's (%s)",
                    what, r->nearest ? "nearest voxels" : "linear");
    r->to->masked = volume->masked;
    r->to->had_negative = volume->had_negative;
    SNOW_TRY(fill(r));
    return volume->labelled ? snow_volume_set_labels(r->to, volume->labels,
                                                     volume->label_count)
                            : SNOW_STATUS_OK;
}

/* The result, or nothing. */
static snow_status end_resampling(regrid *r, snow_status status,
                                  snow_volume **out) {
    if (status == SNOW_STATUS_OK)
        *out = r->to;
    else
        snow_volume_close(r->to);
    return status;
}

snow_status snow_volume_resample(const snow_volume *volume,
                                 const snow_volume *grid, bool nearest,
                                 const char *what, snow_volume **out) {
    regrid r = {.from = volume, .nearest = nearest};
    bool same;
    *out = NULL;
    SNOW_TRY(snow_volume_need_voxels(volume));
    SNOW_TRY(snow_grids_compare(volume->context, &grid->info, &volume->info,
                                what, &same));
    if (same)
        return SNOW_STATUS_OK;
    memcpy(r.dims, volume->info.dims, sizeof r.dims);
    memcpy(r.grid, grid->info.dims, sizeof r.grid);
    find_steps(&volume->info, &grid->info, r.step, r.origin);
    return end_resampling(&r, resample(&r, &grid->info, what), out);
}

snow_status snow_volume_regrid(snow_volume **volume, const snow_volume *grid,
                               bool nearest) {
    snow_volume *made;
    snow_volume_info *info = &(*volume)->info;
    SNOW_TRY(snow_volume_resample(*volume, grid, nearest, "overlay", &made));
    if (made) {
        snow_volume_close(*volume);
        *volume = made;
        return SNOW_STATUS_OK;
    }
    memcpy(info->matrix, grid->info.matrix, sizeof info->matrix);
    snow_volume_info_measure(info);
    return SNOW_STATUS_OK;
}

/* --- of a box ------------------------------------------------------------- */

/* Reads a box of a volume in its file; planes are for what is made of it. */
static snow_status read_box(const snow_volume *volume, int64_t box[3][2],
                            snow_volume **out) {
    snow_volume_options options = volume->stream->options;
    memset(options.clip, 0, sizeof options.clip);
    for (int axis = 0; axis < 3; axis++) {
        options.crop[axis][1] = options.crop[axis][0] + box[axis][1];
        options.crop[axis][0] += box[axis][0];
    }
    return snow_stream_open_slab(volume->context, volume->stream, &options,
                                 true, out);
}

static snow_status resample_box(const snow_volume *volume,
                                const snow_volume_info *whole, bool nearest,
                                const snow_extent *part,
                                const snow_volume_info *box,
                                snow_volume **out) {
    regrid r = {.nearest = nearest};
    int64_t crop[3][2], from[3][2];
    snow_volume *read;
    for (int axis = 0; axis < 3; axis++) {
        r.first[axis] = crop[axis][0] = part->stored[axis];
        crop[axis][1] = crop[axis][0] + box->dims[axis];
    }
    snow_volume_box_of(&volume->info, whole, (const int64_t(*)[2])crop, from);
    SNOW_TRY(read_box(volume, from, &read));
    for (int axis = 0; axis < 3; axis++)
        r.skip[axis] = from[axis][0];
    memcpy(r.dims, volume->info.dims, sizeof r.dims);
    memcpy(r.grid, whole->dims, sizeof r.grid);
    r.from = read;
    find_steps(&volume->info, whole, r.step, r.origin);
    snow_stream_begin_warnings(volume->context, volume->stream);
    snow_status status = resample(&r, box, "overlay");
    snow_stream_end_warnings(volume->context, volume->stream);
    snow_volume_close(read);
    return end_resampling(&r, status, out);
}

/* Cut by the planes that its file is opened with. */
static snow_status cut_box(const snow_volume *volume, snow_volume **box) {
    const double *planes = volume->stream->options.clip[0];
    snow_volume *cut;
    bool any = false;
    for (int n = 0; n < SNOW_CLIPS_MAX; n++)
        any |= snow_is_plane(planes + 4 * n);
    if (!any)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_volume_clip(*box, planes, SNOW_CLIPS_MAX, &cut));
    snow_volume_close(*box);
    *box = cut;
    return SNOW_STATUS_OK;
}

snow_status snow_volume_take_box(const snow_volume *volume,
                                 const snow_volume_info *whole,
                                 const snow_extent *part,
                                 const int64_t count[3], bool nearest,
                                 snow_volume **out) {
    const snow_volume_info box =
        snow_volume_info_of_box(whole, part->stored, count);
    snow_volume *made = NULL;
    bool same;
    SNOW_TRY(snow_grids_compare(volume->context, whole, &volume->info,
                                "overlay", &same));
    if (same) {
        int64_t from[3][2];
        for (int axis = 0; axis < 3; axis++) {
            from[axis][0] = part->stored[axis];
            from[axis][1] = part->stored[axis] + count[axis];
        }
        SNOW_TRY(read_box(volume, from, &made));
        memcpy(made->info.matrix, box.matrix, sizeof box.matrix);
        snow_volume_info_measure(&made->info);
    } else {
        SNOW_TRY(resample_box(volume, whole, nearest, part, &box, &made));
    }
    snow_status status = cut_box(volume, &made);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_set_extent(made, part);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_set_whole(made, whole);
    if (status == SNOW_STATUS_OK)
        *out = made;
    else
        snow_volume_close(made);
    return status;
}
