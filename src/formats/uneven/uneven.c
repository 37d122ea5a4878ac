/* formats/uneven/uneven.c - resamples uneven grids (uneven.h). */
#include "formats/uneven/uneven.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* An even grid has at most so many times the file's voxels, along each axis and
 * in all, and so many bytes more: a single narrow step must not make a small
 * file a huge one. */
#define MOST_GROWTH 8
#define SMALL_BYTES 0x1p26

/* A shorter axis has no steps that can be told apart. */
#define LEAST 0x1p-900

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
    const double all = fabs(coordinates[count - 1] - coordinates[0]);
    return isfinite(all) && all > LEAST;
}

bool snow_uneven_any(const snow_uneven *grid) {
    return grid->at[0] || grid->at[1] || grid->at[2];
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

/* Lines of the file that have the node of the one before; and how far the lines
 * are from their nodes at most. */
static int64_t count_shared(const double *at, int64_t count, double step,
                            double *shift) {
    int64_t shared = 0, before = -1;
    *shift = 0;
    for (int64_t i = 0; i < count; i++) {
        const int64_t node = (int64_t)floor((at[i] - at[0]) / step + 0.5);
        shared += node == before;
        before = node;
        *shift = fmax(*shift, fabs(at[i] - at[0] - step * (double)node));
    }
    return shared;
}

/* Voxels for the smallest step, or a half of it where two lines would share a
 * node; never fewer than the file has. */
static double wanted(const snow_uneven *grid, int axis) {
    const double *at = grid->at[axis];
    const int64_t count = grid->count[axis];
    const double most = MOST_GROWTH * (double)count;
    double least, longest, shift;
    if (!at)
        return (double)count;
    find_steps(at, count, &least, &longest);
    double steps = ceil(fabs(at[count - 1] - at[0]) / least - EQUAL);
    while (steps + 1 < most &&
           count_shared(at, count, (at[count - 1] - at[0]) / steps, &shift))
        steps *= 2;
    return fmin(fmax(steps + 1, (double)count), most);
}

/* Makes the axes that grow the most shorter until all voxels are few enough. */
static void limit(const snow_uneven *grid, double bytes, double even[3]) {
    double most = MOST_GROWTH;
    for (int i = 0; i < 3; i++)
        most *= (double)grid->count[i];
    most += SMALL_BYTES / bytes;
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
                      const char *unit, snow_volume_info *info) {
    double least, most, shift;
    char shared[96] = "", behind[80] = "";
    size_t used = strlen(info->storage);
    const double *at = grid->at[axis], step = grid->step[axis];
    find_steps(at, grid->count[axis], &least, &most);
    const int64_t lost = count_shared(at, grid->count[axis], step, &shift);
    if (lost)
        snprintf(shared, sizeof shared,
                 "; %lld fall together with others, as finer steps would be "
                 "too many",
                 (long long)lost);
    if (*unit)
        snprintf(behind, sizeof behind, " %.64s", unit);
    snow_notify(context,
                "coordinates along %c are not evenly spaced (steps of %g to "
                "%g%s); their %lld voxels are resampled to %lld, %g%s apart, "
                "each at the nearest, at most %.4g%s away%s",
                "xyz"[axis], least, most, behind,
                (long long)grid -> count[axis], (long long)grid -> even[axis],
                fabs(step), behind, shift, behind, shared);
    snprintf(info->storage + used, sizeof info->storage - used,
             "%s%c: %lld uneven to %lld even", used ? ", " : "", "xyz"[axis],
             (long long)grid -> count[axis], (long long)grid -> even[axis]);
}

void snow_uneven_plan(snow_context *context, snow_uneven *grid,
                      const char *const units[3], snow_volume_info *info) {
    double even[3];
    for (int i = 0; i < 3; i++)
        even[i] = wanted(grid, i);
    limit(grid, fmax((double)snow_type_size(info->type), 1), even);
    grid->codes = info->type < SNOW_TYPE_FLOAT32;
    for (int i = 0; i < 3; i++) {
        const double *at = grid->at[i];
        grid->even[i] = (int64_t)even[i];
        if (!at)
            continue;
        grid->step[i] = (at[grid->count[i] - 1] - at[0]) / (even[i] - 1);
        note_axis(context, grid, i, units[i], info);
    }
}

/* --- values --------------------------------------------------------------- */

/* Where a voxel of the box lies between two of the file's box: at `low` and, by
 * a share `up`, at the next.  Or it has the values of `low` and of `more`
 * behind it. */
typedef struct place {
    int64_t low, more;
    double up;
} place;

/* An axis of the box. */
typedef struct axis_places {
    place *at;
    int64_t count;
    int64_t first, end; /* the file's voxels around it */
    int64_t most;       /* of these, for one voxel */
} axis_places;

static const double *lines_of(const snow_uneven *grid, int axis) {
    return grid->moved[axis] ? grid->moved[axis] : grid->at[axis];
}

/* The node of a line, which has moved no farther than to the ends. */
static int64_t node_on(const snow_uneven *grid, int axis, int64_t line) {
    const double last = (double)grid->even[axis] - 1,
                 steps = (lines_of(grid, axis)[line] - grid->at[axis][0]) /
                         grid->step[axis];
    return (int64_t)fmin(fmax(floor(steps + 0.5), 0), last);
}

/* The place of a node, where `low` is the last line whose node is not beyond
 * it.  Of codes it is a line of the file. */
static place place_of(const snow_uneven *grid, int axis, int64_t node,
                      int64_t low) {
    const double *at = lines_of(grid, axis);
    const double position = grid->at[axis][0] + grid->step[axis] * (double)node;
    place p = {low, 0, 0};
    if (node_on(grid, axis, low) < node && low < grid->count[axis] - 1) {
        p.up = (position - at[low]) / (at[low + 1] - at[low]);
        return grid->codes ? (place){low + (p.up >= 0.5), 0, 0} : p;
    }
    while (p.low > 0 && node_on(grid, axis, p.low - 1) == node)
        p.low--;
    p.more = low - p.low;
    for (; grid->codes && p.more; p.more--)
        if (fabs(at[low - p.more + 1] - position) < fabs(at[p.low] - position))
            p.low = low - p.more + 1;
    return p;
}

/* The lines of `count` that a place needs.  Those that fall together are held
 * against the ones beside them. */
static void span_of(place p, int64_t count, int64_t *begin, int64_t *end) {
    *begin = p.low - (p.more && p.low);
    *end = p.low + p.more + 1 + (p.more || p.up > 0);
    *end = *end < count ? *end : count;
}

/* Positions are counted from the first voxel of the whole, so that all boxes
 * have the same values. */
static void find_places(const snow_uneven *grid, int axis, int64_t first,
                        axis_places *out) {
    const double *at = grid->at[axis];
    const int64_t count = grid->count[axis];
    int64_t low = 0, begin, end;
    out->first = count;
    out->end = out->most = 0;
    for (int64_t i = 0; i < out->count; i++) {
        out->at[i] = (place){first + i, 0, 0};
        while (at && low < count - 1 &&
               node_on(grid, axis, low + 1) <= first + i)
            low++;
        if (at)
            out->at[i] = place_of(grid, axis, first + i, low);
        span_of(out->at[i], count, &begin, &end);
        out->first = begin < out->first ? begin : out->first;
        out->end = end > out->end ? end : out->end;
        out->most = end - begin > out->most ? end - begin : out->most;
    }
    for (int64_t i = 0; i < out->count; i++)
        out->at[i].low -= out->first;
}

/* A missing value, and one that is infinite, ends half-way to its neighbour. */
static double blend(double low, double high, double up) {
    if (!isfinite(low) || !isfinite(high))
        return up < 0.5 ? low : high;
    return low + (high - low) * up;
}

/* Of values that fall together that one is kept which is farthest from those
 * beside them, of which one may be NaN: a peak stays. */
static double farther(double kept, double value, double before, double behind) {
    const double usual = isfinite(before) && isfinite(behind)
                             ? before + (behind - before) / 2
                         : isfinite(before) ? before
                                            : behind;
    if (!isfinite(kept) || !isfinite(value))
        return isfinite(value) ? value : kept;
    return fabs(value - usual) > fabs(kept - usual) ? value : kept;
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
    /* lines of the file along x, for a place along y and one along z; a line of
     * the result before it is resampled along x, and after */
    double *lines[2], *line, *row;
} resampling;

/* Makes a line of `width` values from those of the file, of which there are
 * `count` in all and `from` is the first that span_of names. */
static void mix(place p, int64_t count, int64_t width, const double *from,
                double *out) {
    int64_t begin, end;
    span_of(p, count, &begin, &end);
    const bool behind = end > p.low + p.more + 1;
    for (int64_t i = 0; i < width; i++) {
        const double *v = from + i + (p.low - begin) * width;
        out[i] = p.up > 0 ? blend(v[0], v[width], p.up) : v[0];
        for (int64_t k = 1; k <= p.more; k++)
            out[i] =
                farther(out[i], v[k * width], begin < p.low ? v[-width] : NAN,
                        behind ? v[(p.more + 1) * width] : NAN);
    }
}

/* A row at a place along y, and z as in the file. */
static void row_along_y(const resampling *r, place y, int64_t z, double *out) {
    const int64_t *dims = r->from->info.dims;
    int64_t begin, end;
    span_of(y, dims[1], &begin, &end);
    snow_volume_stored(r->from, (z * dims[1] + begin) * dims[0],
                       (size_t)((end - begin) * dims[0]), r->lines[0]);
    mix(y, dims[1], dims[0], r->lines[0], out);
}

static void make_row(const resampling *r, place y, place z, double *out) {
    const int64_t *dims = r->from->info.dims;
    int64_t begin, end;
    span_of(z, dims[2], &begin, &end);
    for (int64_t i = begin; i < end; i++)
        row_along_y(r, y, i, r->lines[1] + (i - begin) * dims[0]);
    mix(z, dims[2], dims[0], r->lines[1], r->line);
    for (int64_t x = 0; x < r->axes[0].count; x++) {
        span_of(r->axes[0].at[x], dims[0], &begin, &end);
        mix(r->axes[0].at[x], dims[0], 1, r->line + begin, &out[x]);
    }
}

static snow_status resample(resampling *r, snow_volume *to) {
    snow_context *context = to->context;
    const int64_t *dims = to->info.dims;
    const uint64_t width = (uint64_t)r->from->info.dims[0];
    const size_t row_bytes = (size_t)dims[0] * snow_type_size(to->info.type);
    unsigned char *at = to->owned;
    const uint64_t lines =
        (uint64_t)r->axes[1].most + (uint64_t)r->axes[2].most + 1;
    double *block = snow_allocate_array(
        context, lines * width + (uint64_t)dims[0], sizeof *block);
    if (!block)
        return SNOW_STATUS_NO_MEMORY;
    r->lines[0] = block;
    r->lines[1] = r->lines[0] + (uint64_t)r->axes[1].most * width;
    r->line = r->lines[1] + (uint64_t)r->axes[2].most * width;
    r->row = r->line + width;
    for (int64_t z = 0; z < dims[2]; z++)
        for (int64_t y = 0; y < dims[1]; y++, at += row_bytes) {
            make_row(r, r->axes[1].at[y], r->axes[2].at[z], r->row);
            store_row(to->info.type, at, dims[0], r->row);
        }
    snow_release(context, block);
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
    const bool wide =
        native.type == SNOW_TYPE_INT64 || native.type == SNOW_TYPE_UINT64;
    info->type = wide ? SNOW_TYPE_FLOAT64 : native.type;
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
