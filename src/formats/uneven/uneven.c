/* formats/uneven/uneven.c - resamples uneven grids (uneven.h). */
#include "formats/uneven/uneven.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Voxels of an even grid, unless the file has more: a single narrow step must
 * not make a small file a huge one.  At most so many, and so many for each of
 * the file's, of which a small file may have more. */
#define MOST_VOXELS 0x1p29
#define MOST_GROWTH 64
#define SMALL_VOXELS 0x1p22

/* Steps that differ by this share are equal. */
#define EQUAL 1e-3

bool snow_uneven_fits(const double *coordinates, int64_t count) {
    if (count < 2)
        return false;
    bool rises = coordinates[1] > coordinates[0];
    for (int64_t i = 0; i < count; i++) {
        if (!isfinite(coordinates[i]))
            return false;
        if (i && (rises ? !(coordinates[i] > coordinates[i - 1])
                        : !(coordinates[i] < coordinates[i - 1])))
            return false;
    }
    return isfinite(coordinates[count - 1] - coordinates[0]);
}

bool snow_uneven_any(const snow_uneven *grid) {
    return grid->at[0] || grid->at[1] || grid->at[2];
}

snow_type snow_uneven_type(snow_type type) {
    return type == SNOW_TYPE_INT64 || type == SNOW_TYPE_UINT64
               ? SNOW_TYPE_FLOAT64
               : type;
}

/* --- the even grid -------------------------------------------------------- */

static void find_steps(const double *at, int64_t count, double *least,
                       double *most) {
    *least = INFINITY;
    *most = 0;
    for (int64_t i = 1; i < count; i++) {
        double step = fabs(at[i] - at[i - 1]);
        *least = fmin(*least, step);
        *most = fmax(*most, step);
    }
}

/* Voxels for the smallest step; never fewer than the file has. */
static double wanted(const snow_uneven *grid, int axis) {
    const double *at = grid->at[axis];
    const int64_t count = grid->count[axis];
    double least, most;
    if (!at)
        return (double)count;
    find_steps(at, count, &least, &most);
    double steps = ceil(fabs(at[count - 1] - at[0]) / least - EQUAL);
    return fmin(fmax(steps + 1, (double)count), 0x1p31);
}

/* Makes the axes that grow the most shorter until all voxels are few enough. */
static void limit(const snow_uneven *grid, double even[3]) {
    double most = MOST_GROWTH;
    for (int i = 0; i < 3; i++)
        most *= (double)grid->count[i];
    most = fmin(fmax(most, SMALL_VOXELS), MOST_VOXELS);
    for (;;) {
        double all = even[0] * even[1] * even[2], growth = 1;
        int axis = -1;
        for (int i = 0; i < 3; i++)
            if (even[i] / (double)grid->count[i] > growth) {
                growth = even[i] / (double)grid->count[i];
                axis = i;
            }
        if (all <= most || axis < 0)
            return;
        even[axis] = fmax(floor(even[axis] * fmax(most / all, 0.5)),
                          (double)grid->count[axis]);
    }
}

static void note_axis(snow_context *context, const snow_uneven *grid, int axis,
                      snow_volume_info *info) {
    double least, most, step = fabs(grid->step[axis]);
    size_t used = strlen(info->storage);
    find_steps(grid->at[axis], grid->count[axis], &least, &most);
    snow_notify(context,
                "coordinates along %c are not evenly spaced (steps of %g to "
                "%g); their %lld voxels are resampled to %lld, %g apart%s",
                "xyz"[axis], least, most, (long long)grid -> count[axis],
                (long long)grid -> even[axis], step,
                step > least * (1 + EQUAL) ? ", which is coarser than the "
                                             "smallest step; --crop takes a "
                                             "part"
                                           : "");
    snprintf(info->storage + used, sizeof info->storage - used,
             "%s%c: %lld uneven to %lld even", used ? ", " : "", "xyz"[axis],
             (long long)grid -> count[axis], (long long)grid -> even[axis]);
}

void snow_uneven_plan(snow_context *context, snow_uneven *grid,
                      snow_volume_info *info) {
    double even[3];
    for (int i = 0; i < 3; i++)
        even[i] = wanted(grid, i);
    limit(grid, even);
    for (int i = 0; i < 3; i++) {
        const double *at = grid->at[i];
        grid->even[i] = (int64_t)even[i];
        if (!at)
            continue;
        grid->step[i] = (at[grid->count[i] - 1] - at[0]) / (even[i] - 1);
        note_axis(context, grid, i, info);
    }
}

/* --- values --------------------------------------------------------------- */

/* Where a voxel of the box lies between two of the file's box: at `low` and, by
 * a share `up`, at the next. */
typedef struct place {
    int64_t low;
    double up;
} place;

/* An axis of the box. */
typedef struct axis_places {
    place *at;
    int64_t count;
    int64_t first, end; /* the file's voxels around it */
} axis_places;

/* The last of the file's voxels, but the last one, that is not beyond
 * `position`, from `low` on. */
static int64_t find_low(const snow_uneven *grid, int axis, double position,
                        int64_t low) {
    const double *at = grid->at[axis];
    bool rises = grid->step[axis] > 0;
    while (low < grid->count[axis] - 2 &&
           (rises ? at[low + 1] <= position : at[low + 1] >= position))
        low++;
    return low;
}

/* Positions are counted from the first voxel of the whole, so that all boxes
 * have the same values. */
static void find_places(const snow_uneven *grid, int axis, int64_t first,
                        axis_places *out) {
    const double *at = grid->at[axis];
    int64_t low = 0;
    for (int64_t i = 0; i < out->count; i++) {
        out->at[i] = (place){first + i, 0};
        if (!at)
            continue;
        double position = at[0] + grid->step[axis] * (double)(first + i);
        low = find_low(grid, axis, position, low);
        double up = (position - at[low]) / (at[low + 1] - at[low]);
        out->at[i] = (place){low, fmin(fmax(up, 0), 1)};
    }
    out->first = out->at[0].low;
    out->end = out->at[out->count - 1].low + (at ? 2 : 1);
    for (int64_t i = 0; i < out->count; i++)
        out->at[i].low -= out->first;
}

/* A missing value, and one that is infinite, ends half-way to its neighbour. */
static double blend(double low, double high, double up) {
    if (!isfinite(low) || !isfinite(high))
        return up < 0.5 ? low : high;
    return low + (high - low) * up;
}

/* Stores a row; the values lie between those of the type. */
static void store_row(snow_type type, void *to, int64_t count, double *values) {
    for (int64_t i = 0; i < count && type < SNOW_TYPE_FLOAT32; i++)
        values[i] = rint(values[i]);
    snow_type_store(type, values, (size_t)count, to);
}

typedef struct resampling {
    const snow_volume *from;
    axis_places axes[3];
    double *rows; /* two rows of the file's box, one of the result */
} resampling;

/* Blends a row into another one. */
static void blend_rows(double *low, const double *high, double up,
                       int64_t count) {
    for (int64_t i = 0; i < count; i++)
        low[i] = blend(low[i], high[i], up);
}

/* The row at a place along y, and z as in the file. */
static void row_along_y(const resampling *r, place y, int64_t z, double *out,
                        double *beside) {
    const int64_t *dims = r->from->info.dims;
    const int64_t first = (z * dims[1] + y.low) * dims[0];
    snow_volume_stored(r->from, first, (size_t)dims[0], out);
    if (y.up > 0) {
        snow_volume_stored(r->from, first + dims[0], (size_t)dims[0], beside);
        blend_rows(out, beside, y.up, dims[0]);
    }
}

static void make_row(const resampling *r, place y, place z, double *out) {
    const int64_t width = r->from->info.dims[0];
    double *low = r->rows, *high = low + width, *beside = high + width;
    row_along_y(r, y, z.low, low, beside);
    if (z.up > 0) {
        row_along_y(r, y, z.low + 1, high, beside);
        blend_rows(low, high, z.up, width);
    }
    for (int64_t x = 0; x < r->axes[0].count; x++) {
        const place at = r->axes[0].at[x];
        out[x] = at.up > 0 ? blend(low[at.low], low[at.low + 1], at.up)
                           : low[at.low];
    }
}

static snow_status resample(resampling *r, snow_volume *to) {
    snow_context *context = to->context;
    const int64_t *dims = to->info.dims;
    const uint64_t width = (uint64_t)r->from->info.dims[0];
    const size_t row_bytes = (size_t)dims[0] * snow_type_size(to->info.type);
    unsigned char *at = to->owned;
    r->rows = snow_allocate_array(context, 3 * width + (uint64_t)dims[0],
                                  sizeof *r->rows);
    if (!r->rows)
        return SNOW_STATUS_NO_MEMORY;
    double *row = r->rows + 3 * width;
    for (int64_t z = 0; z < dims[2]; z++)
        for (int64_t y = 0; y < dims[1]; y++, at += row_bytes) {
            make_row(r, r->axes[1].at[y], r->axes[2].at[z], row);
            store_row(to->info.type, at, dims[0], row);
        }
    snow_release(context, r->rows);
    return SNOW_STATUS_OK;
}

/* Finds the places of all axes, in one block. */
static snow_status find_all_places(snow_context *context,
                                   const snow_uneven *grid,
                                   const snow_region *box,
                                   axis_places axes[3]) {
    int64_t all = box->count[0] + box->count[1] + box->count[2];
    place *places = snow_allocate_array(context, (uint64_t)all, sizeof *places);
    if (!places)
        return SNOW_STATUS_NO_MEMORY;
    axes[0].at = places;
    axes[1].at = places + box->count[0];
    axes[2].at = axes[1].at + box->count[1];
    for (int i = 0; i < 3; i++) {
        axes[i].count = box->count[i];
        find_places(grid, i, box->first[i], &axes[i]);
    }
    return SNOW_STATUS_OK;
}

/* Reads the file's voxels around the box, and makes those of the box. */
static snow_status read_box(snow_context *context, resampling *r,
                            const snow_uneven *grid,
                            const snow_volume_options *options,
                            snow_uneven_fn *read, void *user,
                            snow_volume_info *info, snow_volume **out) {
    snow_volume_options own = *options;
    snow_volume_info native = *info;
    snow_volume *from = NULL, *to = NULL;
    for (int i = 0; i < 3; i++) {
        own.crop[i][0] = r->axes[i].first;
        own.crop[i][1] = r->axes[i].end;
        native.dims[i] = grid->count[i];
    }
    SNOW_TRY(read(user, &own, &native, out ? &from : NULL));
    info->type = snow_uneven_type(native.type);
    info->slope = native.slope;
    info->intercept = native.intercept;
    if (!out)
        return SNOW_STATUS_OK;
    r->from = from;
    snow_status status = snow_volume_new(context, info, &to);
    if (status == SNOW_STATUS_OK)
        status = resample(r, to);
    snow_volume_close(from);
    return snow_volume_give(status, to, out);
}

snow_status snow_uneven_read(snow_context *context, const snow_uneven *grid,
                             const snow_volume_options *options,
                             snow_uneven_fn *read, void *user,
                             snow_volume_info *info, snow_volume **out) {
    resampling r = {.from = NULL};
    snow_region box;
    if (!snow_uneven_any(grid))
        return read(user, options, info, out);
    SNOW_TRY(snow_region_lay_out(context, options, info, &box));
    SNOW_TRY(find_all_places(context, grid, &box, r.axes));
    snow_status status =
        read_box(context, &r, grid, options, read, user, info, out);
    snow_release(context, r.axes[0].at);
    return status;
}
