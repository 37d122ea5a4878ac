/* formats/hdf5/theta.c - modes around an axis (openpmd.org, geometry
 * "thetaMode"; FBPIC, Warp, WarpX) on x, y and z.
 *
 *     /data/100/fields/E    geometry, axisLabels, gridSpacing, gridGlobalOffset
 *       r, t, z             record, r, z; or record, z, r, by the labels
 *
 *     F(r, z, a) = F0 + F1 cos a + F2 sin a + F3 cos 2a + F4 sin 2a + ...
 *     x = r cos a - t sin a,   y = r sin a + t cos a      of vectors
 *
 * The records are as many as the array has; geometryParameters count them in
 * different ways.  Nodes lie on x and y as far apart as on r, so that those on
 * the axes are the file's, and are linear in r and z between.  Beyond the last
 * r values are 0. */
#include "formats/array.h"
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include "base/minmax.h"
#include "base/thread_pool.h"

#include <snowglass/snowglass.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Nodes along x and y, and along z; finer grids are shown by every second or
 * third one. */
#define MOST_ACROSS 512
#define MOST_ALONG 4096
#define MOST_RECORDS 65

/* Fewer are made before other threads are awake. */
#define THREADED_NODES 65536

enum { R, Z };

/* An array of records, and the place of its first node in cells. */
typedef struct theta_part {
    hdf5_set set;
    double factor, first[2];
    double *values; /* of all records and r, and z from `low` */
} theta_part;

/* What is made of the arrays. */
typedef enum theta_kind { THETA_SCALAR, THETA_X, THETA_Y } theta_kind;

typedef struct theta {
    snow_context *context;
    const hdf5_file *file;
    const snow_volume_options *options;
    snow_volume_info *info;
    char mesh[HDF5_NAME_BYTES]; /* the group, or data set, with the geometry */
    theta_kind kind;
    theta_part parts[2];
    int count;   /* of parts */
    int axis[2]; /* of the arrays: r and z */
    int64_t records, sizes[2];
    double step[2], offset[2]; /* offset: in cells */
    double unit;
    int64_t each[2];   /* every such node is shown */
    int64_t low, high; /* of z, which are read */
    snow_region region;
    snow_volume *out;
    double *rows; /* one for each worker */
} theta;

static snow_status fail_theta(const theta *t, const char *what) {
    return snow_fail(t->context, SNOW_STATUS_BAD_INPUT,
                     "%.200s %s; write it again", t->mesh, what);
}

/* --- what is asked for ---------------------------------------------------- */

static hid_t open_object(const hdf5_file *file, const char *path) {
    const hid_t root = snow_hdf5_id(file);
    return H5Oexists_by_name(root, path, H5P_DEFAULT) > 0
               ? H5Oopen(root, path, H5P_DEFAULT)
               : -1;
}

static bool is_theta(const hdf5_file *file, const char *path) {
    char text[16] = "";
    const hid_t id = *path ? open_object(file, path) : -1;
    if (id >= 0)
        snow_hdf5_text(file, id, "geometry", 0, text, sizeof text);
    snow_hdf5_drop(id);
    return !strcmp(text, "thetaMode");
}

static snow_status add_part(theta *t, const char *name) {
    char path[2 * HDF5_NAME_BYTES];
    theta_part *part = &t->parts[t->count];
    snprintf(path, sizeof path, "%s%s%s", t->mesh, *name ? "/" : "", name);
    if (strlen(path) >= HDF5_NAME_BYTES ||
        !snow_hdf5_open_values(snow_hdf5_id(t->file), path, &part->set))
        return snow_fail(t->context, SNOW_STATUS_BAD_INPUT,
                         "%.200s lacks the component %s; choose another with "
                         "--dataset",
                         t->mesh, name);
    snprintf(part->set.path, sizeof part->set.path, "%s", path);
    t->count++;
    return SNOW_STATUS_OK;
}

/* A record of r, t and z has three components. */
static snow_status choose(theta *t, const char *name) {
    const char *slash = strrchr(t->mesh, '/');
    int64_t number = 0;
    char text[8] = "";
    snprintf(text, sizeof text, "%.7s", name);
    t->info->type = SNOW_TYPE_FLOAT64;
    hdf5_set own;
    const bool scalar =
        !*name && snow_hdf5_open_values(snow_hdf5_id(t->file), t->mesh, &own);
    if (scalar)
        snow_hdf5_drop(own.id);
    SNOW_TRY(snow_volume_pick_component(
        t->context, t->options, *name || scalar ? 1 : 3, t->info, &number));
    snow_copy_name(slash ? slash + 1 : t->mesh, t->info->quantity,
                   sizeof t->info->quantity);
    if (!*name && !scalar)
        snprintf(text, sizeof text, "%c", "xyz"[number]);
    if (*text && !t->info->magnitude)
        snow_append(t->info->quantity, sizeof t->info->quantity, " %s", text);
    t->kind = !strcmp(text, "x")   ? THETA_X
              : !strcmp(text, "y") ? THETA_Y
                                   : THETA_SCALAR;
    if (t->kind == THETA_SCALAR)
        return add_part(t, text);
    SNOW_TRY(add_part(t, "r"));
    return add_part(t, "t");
}

/* --- geometry ------------------------------------------------------------- */

/* Labels name the axes of the array behind that of records, the fastest last;
 * by dataOrder "F" first. */
static snow_status take_axes(theta *t, hid_t mesh) {
    char label[2][4], order[4];
    const hdf5_set *set = &t->parts[0].set;
    const int before = set->axes - 2;
    for (size_t i = 0; i < 2; i++)
        if (snow_hdf5_text(t->file, mesh, "axisLabels", i, label[i],
                           sizeof label[i]) != 2)
            return fail_theta(t, "has no axisLabels of two axes");
    snow_hdf5_text(t->file, mesh, "dataOrder", 0, order, sizeof order);
    const int first = !strcmp(label[1], "r");
    if (strcmp(label[first], "r") != 0 || strcmp(label[!first], "z") != 0)
        return fail_theta(t, "has other axisLabels than r and z");
    if (before < 0 || before > 1)
        return fail_theta(t, "has other axes than records, r and z");
    t->axis[R] = before + (*order == 'F' ? !first : first);
    t->axis[Z] = before + (*order == 'F' ? first : !first);
    t->records = before ? (int64_t)set->sizes[0] : 1;
    if (t->records < 1 || t->records > MOST_RECORDS)
        return fail_theta(t, "has more records than any");
    double step[2], offset[2] = {0, 0};
    if (snow_hdf5_numbers(mesh, "gridSpacing", 2, step) != 2)
        return fail_theta(t, "has no gridSpacing");
    snow_hdf5_numbers(mesh, "gridGlobalOffset", 2, offset);
    for (int a = 0; a < 2; a++) {
        const int at = a == R ? first : !first;
        t->sizes[a] = (int64_t)set->sizes[t->axis[a]];
        t->step[a] = step[at];
        t->offset[a] = offset[at] / step[at];
        if (!(t->step[a] > 0) || !isfinite(t->step[a]) ||
            !(fabs(t->offset[a]) < 0x1p40) || t->sizes[a] < 1)
            return fail_theta(t, "has no steps above 0");
    }
    for (int n = 0; n < t->count; n++) {
        double position[3] = {0, 0, 0};
        snow_hdf5_numbers(t->parts[n].set.id, "position", 3, position);
        t->parts[n].first[R] = t->offset[R] + position[first];
        t->parts[n].first[Z] = t->offset[Z] + position[!first];
    }
    return SNOW_STATUS_OK;
}

static snow_status check_parts(const theta *t) {
    for (int n = 0; n < t->count; n++) {
        const theta_part *part = &t->parts[n];
        bool same = part->set.axes == t->parts[0].set.axes &&
                    fabs(part->first[R]) < 0x1p31 &&
                    fabs(part->first[Z]) < 0x1p40;
        for (int i = 0; i < t->parts[0].set.axes && same; i++)
            same = part->set.sizes[i] == t->parts[0].set.sizes[i];
        if (!same)
            return fail_theta(t, "has components of different sizes");
        if (!part->set.constant)
            SNOW_TRY(snow_hdf5_check_storage(t->context, part->set.id));
    }
    return SNOW_STATUS_OK;
}

static int64_t nodes(double span, int64_t each) {
    return (int64_t)floor(span / (double)each + 1e-6) + 1;
}

/* As many nodes as on r, on both sides of the axis; fewer of a large grid. */
static snow_status place(theta *t, hid_t mesh) {
    snow_volume_info *info = t->info;
    const double across =
        2 * ((double)(t->sizes[R] - 1) + t->parts[0].first[R]);
    if (!(across >= 0) || !(across < 0x1p31))
        return fail_theta(t, "begins at no r");
    t->unit = 0;
    snow_hdf5_numbers(mesh, "gridUnitSI", 1, &t->unit);
    if (t->unit > 0 && isfinite(t->unit))
        memcpy(info->unit, "m", 2);
    else
        t->unit = 1;
    const int64_t wide = nodes(across, 1);
    t->each[R] = (wide + MOST_ACROSS - 1) / MOST_ACROSS;
    t->each[Z] = (t->sizes[Z] + MOST_ALONG - 1) / MOST_ALONG;
    info->dims[0] = info->dims[1] = nodes(across, t->each[R]);
    info->dims[2] = nodes((double)(t->sizes[Z] - 1), t->each[Z]);
    for (int i = 0; i < 3; i++) {
        const int axis = i < 2 ? R : Z;
        const double step = t->unit * t->step[axis] * (double)t->each[axis];
        info->matrix[i][i] = step;
        info->matrix[i][3] = i < 2
                                 ? -step * (double)(info->dims[i] - 1) / 2
                                 : t->unit * t->step[Z] * t->parts[0].first[Z];
    }
    snprintf(info->storage, sizeof info->storage,
             "%lld record%s of %lld x %lld nodes on r and z",
             (long long)t->records, t->records == 1 ? "" : "s",
             (long long)t->sizes[R], (long long)t->sizes[Z]);
    const char *verb = t->records == 1 ? "is" : "are";
    if (t->options->each_time)
        return SNOW_STATUS_OK;
    if (t->each[R] > 1 || t->each[Z] > 1)
        snow_notify(t->context,
                    "%s %s shown on x, y and z, %lld x %lld x %lld of them: "
                    "one in %lld along r and in %lld along z, as all are more "
                    "than are drawn",
                    info->storage, verb, (long long)info->dims[0],
                    (long long)info->dims[1], (long long)info->dims[2],
                    (long long)t->each[R], (long long)t->each[Z]);
    else
        snow_notify(t->context, "%s %s shown on x, y and z", info->storage,
                    verb);
    return SNOW_STATUS_OK;
}

/* --- values --------------------------------------------------------------- */

/* Strides of values along records, r and z. */
static void strides(const theta *t, int64_t out[3]) {
    const int64_t wide = t->high - t->low;
    const bool z_last = t->axis[Z] > t->axis[R];
    out[0] = t->sizes[R] * wide;
    out[1] = z_last ? wide : 1;
    out[2] = z_last ? 1 : t->sizes[R];
}

/* Reads z from `low` to `high` of a part. */
static snow_status read_part(const theta *t, theta_part *part) {
    const hdf5_set *set = &part->set;
    const int64_t count = t->records * t->sizes[R] * (t->high - t->low);
    hsize_t first[HDF5_MOST_AXES] = {0}, sizes[HDF5_MOST_AXES];
    memcpy(sizes, set->sizes, sizeof sizes);
    first[t->axis[Z]] = (hsize_t)t->low;
    sizes[t->axis[Z]] = (hsize_t)(t->high - t->low);
    part->values =
        snow_allocate_array(t->context, (uint64_t)count, sizeof(double));
    if (!part->values)
        return SNOW_STATUS_NO_MEMORY;
    for (int64_t i = 0; i < count && set->constant; i++)
        part->values[i] = set->value;
    return set->constant ? SNOW_STATUS_OK
                         : snow_hdf5_read_box(t->context, t->file, set->id,
                                              H5T_NATIVE_DOUBLE, set->axes,
                                              first, sizes, part->values);
}

/* Adds the records of a part at a place to a row of z, times their angles. */
static void add_records(const theta *t, const theta_part *part, double factor,
                        double r, double cosine, double sine, double *row) {
    const double at = fmax(r - part->first[R], 0);
    const int64_t last = t->sizes[R] - 1, wide = t->high - t->low;
    const int64_t below = SNOW_MIN((int64_t)at, last);
    int64_t stride[3];
    double turn[2] = {1, 0}; /* cosine and sine of m times the angle */
    if (at > (double)last + 1e-9)
        return;
    strides(t, stride);
    const int64_t next = below < last ? stride[1] : 0;
    const double share = fmin(at - (double)below, 1);
    for (int64_t n = 0; n < t->records; n++) {
        if (n % 2 == 1) {
            const double old = turn[0];
            turn[0] = old * cosine - turn[1] * sine;
            turn[1] = turn[1] * cosine + old * sine;
        }
        const double weight = factor * turn[n && n % 2 == 0];
        const double *from = part->values + n * stride[0] + below * stride[1];
        for (int64_t z = 0; z < wide; z++) {
            const double *value = from + z * stride[2];
            row[z] += weight * (value[0] + share * (value[next] - value[0]));
        }
    }
}

static void store(const theta *t, int64_t place, double value) {
    if (t->out->info.type == SNOW_TYPE_FLOAT32)
        ((float *)t->out->owned)[place] = (float)value;
    else
        ((double *)t->out->owned)[place] = value;
}

/* The nodes of a place on x and y.  A part's nodes may lie between those of the
 * grid. */
static void make_nodes(const theta *t, int64_t x, int64_t y, double *row) {
    const snow_region *region = &t->region;
    const double middle = (double)(t->info->dims[0] - 1) / 2;
    const int64_t wide = t->high - t->low;
    const int64_t *count = region->count;
    double at[2];
    at[0] = (double)t->each[R] * ((double)(region->first[0] + x) - middle);
    at[1] = (double)t->each[R] * ((double)(region->first[1] + y) - middle);
    const double r = hypot(at[0], at[1]);
    const double cosine = r > 0 ? at[0] / r : 1, sine = r > 0 ? at[1] / r : 0;
    const double factors[3][2] = {{1, 0}, {cosine, -sine}, {sine, cosine}};
    for (int64_t z = 0; z < count[2]; z++)
        store(t, (z * count[1] + y) * count[0] + x, 0);
    for (int n = 0; n < t->count; n++) {
        const theta_part *part = &t->parts[n];
        const double shift = t->parts[0].first[Z] - part->first[Z];
        memset(row, 0, (size_t)wide * sizeof *row);
        add_records(t, part, part->factor * factors[t->kind][n], r, cosine,
                    sine, row);
        for (int64_t z = 0; z < count[2]; z++) {
            const int64_t place = (z * count[1] + y) * count[0] + x;
            const double from = fmin(
                fmax((double)((region->first[2] + z) * t->each[Z] - t->low) +
                         shift,
                     0),
                (double)(wide - 1));
            const int64_t below = (int64_t)from;
            const int64_t above = SNOW_MIN(below + 1, wide - 1);
            const double value =
                row[below] + (from - (double)below) * (row[above] - row[below]);
            const double old = t->out->info.type == SNOW_TYPE_FLOAT32
                                   ? (double)((float *)t->out->owned)[place]
                                   : ((double *)t->out->owned)[place];
            store(t, place, n ? old + value : value);
        }
    }
}

static void make_row(void *user, int64_t item, int worker) {
    const theta *t = user;
    double *row = t->rows + worker * (t->high - t->low);
    for (int64_t x = 0; x < t->region.count[0]; x++)
        make_nodes(t, x, item, row);
}

static snow_status make_volume(theta *t) {
    snow_context *context = t->context;
    const int64_t *dims = t->region.count;
    const bool worth = dims[0] * dims[1] * dims[2] >= THREADED_NODES;
    const int workers = worth ? snow_processors() : 1;
    /* A node further, for parts that lie between. */
    const int64_t first = t->region.first[2] * t->each[Z] - 1;
    const int64_t end =
        (t->region.first[2] + t->region.count[2] - 1) * t->each[Z] + 2;
    t->low = SNOW_MAX(first, 0);
    t->high = SNOW_MIN(end, t->sizes[Z]);
    for (int n = 0; n < t->count; n++)
        SNOW_TRY(read_part(t, &t->parts[n]));
    t->rows = snow_allocate_array(
        context, (uint64_t)((t->high - t->low) * workers), sizeof *t->rows);
    if (!t->rows)
        return SNOW_STATUS_NO_MEMORY;
    return snow_parallel(context, workers, t->region.count[1], make_row, t);
}

/* Impossible sizes are refused before memory is allocated. */
static snow_status check_size(const theta *t) {
    uint64_t most, all = (uint64_t)t->records;
    if (!snow_mul_u64(snow_hdf5_size(t->file), SNOW_DEFLATE_RATIO, &most))
        most = UINT64_MAX;
    const bool fits = snow_mul_u64(all, (uint64_t)t->sizes[R], &all) &&
                      snow_mul_u64(all, (uint64_t)t->sizes[Z], &all) &&
                      all <= most / sizeof(float);
    return fits ? SNOW_STATUS_OK
                : fail_theta(t, "claims more values than its file can hold");
}

static snow_status read_all(theta *t, const char *name, snow_volume **out) {
    SNOW_TRY(choose(t, name));
    const hid_t mesh = open_object(t->file, t->mesh);
    snow_status status =
        mesh < 0 ? fail_theta(t, "cannot be opened") : take_axes(t, mesh);
    if (status == SNOW_STATUS_OK)
        status = check_parts(t);
    if (status == SNOW_STATUS_OK)
        status = check_size(t);
    if (status == SNOW_STATUS_OK)
        status = place(t, mesh);
    snow_hdf5_drop(mesh);
    SNOW_TRY(status);
    bool narrow = true;
    for (int n = 0; n < t->count; n++) {
        t->parts[n].factor = snow_hdf5_unit(t->file, &t->parts[n].set, t->info);
        narrow = narrow && (t->parts[n].set.constant ||
                            t->parts[n].set.type == SNOW_TYPE_FLOAT32);
    }
    t->info->type = narrow ? SNOW_TYPE_FLOAT32 : SNOW_TYPE_FLOAT64;
    snow_hdf5_time(t->file, &t->parts[0].set, t->info);
    SNOW_TRY(
        snow_volume_pick_time(t->context, "time step", t->options, t->info));
    snow_volume_info box = *t->info;
    SNOW_TRY(snow_region_lay_out(t->context, t->options, &box, &t->region));
    if (out) {
        SNOW_TRY(snow_volume_new(t->context, &box, &t->out));
        status = make_volume(t);
        SNOW_TRY(snow_volume_give(status, t->out, out));
    }
    *t->info = box;
    return SNOW_STATUS_OK;
}

snow_status snow_hdf5_read_theta(snow_context *context, const hdf5_file *file,
                                 const char *path,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out,
                                 bool *found) {
    char parent[HDF5_NAME_BYTES];
    const char *name = "";
    *found = false;
    if (!path || strlen(path) + 2 > sizeof parent)
        return SNOW_STATUS_OK;
    snprintf(parent, sizeof parent, "%s%s", *path == '/' ? "" : "/", path);
    if (!is_theta(file, parent)) {
        char *slash = strrchr(parent, '/');
        *slash = 0;
        name = slash + 1;
        if (!is_theta(file, parent))
            return SNOW_STATUS_OK;
    }
    *found = true;
    theta *t = snow_allocate_clear(context, sizeof *t);
    if (!t)
        return SNOW_STATUS_NO_MEMORY;
    t->context = context;
    t->file = file;
    t->options = options;
    t->info = info;
    memcpy(t->mesh, parent, sizeof t->mesh);
    const snow_status status = read_all(t, name, out);
    for (int n = 0; n < t->count; n++) {
        snow_hdf5_drop(t->parts[n].set.id);
        snow_release(context, t->parts[n].values);
    }
    snow_release(context, t->rows);
    snow_release(context, t);
    return status;
}

#endif
