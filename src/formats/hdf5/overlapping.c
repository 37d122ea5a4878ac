/* formats/hdf5/overlapping.c - levels of refinement of VTKHDF (docs.vtk.org,
 * "VTKHDF File Format", OverlappingAMR):
 *
 *     /VTKHDF              Type, Origin
 *       Level0             Spacing
 *         AMRBox           box; first and last cell along x, y and z
 *         CellData/rho     cells of all boxes, one after another, x fastest; a
 *                          second axis has components
 *       Level1 ...
 *       Steps              NSteps
 *         Values           times
 *         Level0           of each step, where its part begins and how many
 *           AMRBoxOffsets, NumberOfAMRBoxes, CellDataOffsets/rho
 *
 * Version 2.2 writes the names of offsets without an s. */
#include "formats/array.h"
#include "formats/hdf5/blocks.h"

#if SNOW_HAVE_HDF5

#include "volume/mask.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define ROOT "/VTKHDF"

/* Ratios may be off whole numbers by so much. */
#define NEAR 0.02

typedef struct overlapping {
    snow_context *context;
    const hdf5_file *file;
    const snow_volume_options *options;
    char name[128]; /* of the array */
    hdf5_set sets[AMR_MOST_LEVELS];
    int opened;
    hsize_t component;
    amr_grid grid;
    int64_t *begins; /* of the cells of each box, in its level's array */
    int64_t low[3];  /* the first cell of level 0 */
} overlapping;

static snow_status fail_levels(const overlapping *o, int level,
                               const char *what) {
    return snow_fail(o->context, SNOW_STATUS_BAD_INPUT,
                     "its level %d %s; it is damaged, or write it again", level,
                     what);
}

/* A number for the step, of a list whose name may lack its last letters. */
static snow_status number_of_step(const overlapping *o, int level,
                                  const char *name, const char *more,
                                  const char *inside, int64_t step,
                                  double *out) {
    char path[HDF5_NAME_BYTES];
    hdf5_set set;
    const hsize_t first = (hsize_t)step, one = 1;
    bool found = false;
    for (int i = 0; i < 2 && !found; i++) {
        snprintf(path, sizeof path, ROOT "/Steps/Level%d/%s%s%s", level, name,
                 i ? "" : more, inside);
        found = snow_hdf5_open_set(o->file, path, 1, &set);
    }
    if (!found || first >= set.sizes[0]) {
        if (found)
            H5Dclose(set.id);
        return fail_levels(o, level, "lacks the offsets of its steps");
    }
    const snow_status status = snow_hdf5_read_box(
        o->context, o->file, set.id, H5T_NATIVE_DOUBLE, 1, &first, &one, out);
    H5Dclose(set.id);
    return status;
}

/* --- the array ------------------------------------------------------------ */

static herr_t look(hid_t group, const char *name, const H5L_info_t *info,
                   void *user) {
    (void)group, (void)info;
    snow_list_add(user, 400, "%s", name);
    return 0;
}

/* The array that is asked for, else the active or first one; false: another
 * data set. */
static snow_status choose_array(overlapping *o, hid_t root, bool *found) {
    const char *asked = o->options->dataset;
    const hid_t group = H5Gopen2(root, "Level0/CellData", H5P_DEFAULT);
    char list[400] = "", path[HDF5_NAME_BYTES];
    H5G_info_t about = {.nlinks = 0};
    if (group >= 0) {
        H5Gget_info(group, &about);
        H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, look, list);
        snow_hdf5_text(o->file, group, "Scalars", 0, o->name, sizeof o->name);
    }
    snow_hdf5_drop(group);
    if (!about.nlinks)
        return snow_fail(o->context, SNOW_STATUS_BAD_INPUT,
                         "has no values of cells on its levels, and those of "
                         "points are not supported; write CellData");
    if (asked)
        snprintf(o->name, sizeof o->name, "%s",
                 strrchr(asked, '/') ? strrchr(asked, '/') + 1 : asked);
    else if (!*o->name)
        snprintf(o->name, sizeof o->name, "%.*s", (int)strcspn(list, ","),
                 list);
    snprintf(path, sizeof path, "Level0/CellData/%s", o->name);
    *found = H5Lexists(root, path, H5P_DEFAULT) > 0;
    if (!*found && (!asked || !strchr(asked, '/')))
        return snow_fail(o->context, SNOW_STATUS_BAD_USAGE,
                         "--dataset %.60s: there is no such array; the cells "
                         "have %s",
                         o->name, list);
    if (!asked && about.nlinks > 1 && !o->options->each_time)
        snow_notify(o->context,
                    "array %s is taken, of %s; --dataset selects another",
                    o->name, list);
    return SNOW_STATUS_OK;
}

/* Opens the array of a level, of one axis or with components. */
static snow_status open_array(overlapping *o, int level) {
    char path[HDF5_NAME_BYTES];
    hdf5_set *set = &o->sets[level];
    snprintf(path, sizeof path, ROOT "/Level%d/CellData/%s", level, o->name);
    if (!snow_hdf5_open_set(o->file, path, 1, set) &&
        !snow_hdf5_open_set(o->file, path, 2, set))
        return fail_levels(o, level, "lacks the array");
    o->opened = level + 1;
    const hdf5_set *base = &o->sets[0];
    if (set->type != base->type || set->axes != base->axes ||
        (set->axes == 2 && set->sizes[1] != base->sizes[1]))
        return fail_levels(o, level, "has another type than the first");
    return snow_hdf5_check_storage(o->context, set->id);
}

/* --- levels --------------------------------------------------------------- */

/* The ratio to the level below, from the sizes of cells.  An axis without one
 * is of a plane. */
static snow_status take_spacing(overlapping *o, hid_t group, int level,
                                double steps[3]) {
    double now[3];
    amr_grid *grid = &o->grid;
    if (snow_hdf5_numbers(group, "Spacing", 3, now) != 3 || !(now[0] > 0))
        return fail_levels(o, level, "has no Spacing");
    for (int i = 0; i < 3; i++) {
        const bool plane = !(now[i] > 0);
        const double ratio = level && !plane ? steps[i] / now[i] : 1;
        if (!(ratio >= 0.5) || !(ratio < 1024) ||
            fabs(ratio - rint(ratio)) > NEAR)
            return fail_levels(
                o, level,
                "has cells that do not divide those of the one below");
        grid->ratio[level][i] = (int64_t)rint(ratio);
        if (!level)
            grid->size[i] = plane ? now[0] : now[i];
        steps[i] = plane ? 0 : now[i];
    }
    return SNOW_STATUS_OK;
}

/* The world begins at the least cell of level 0. */
static void span_grid(overlapping *o, const double *boxes, int64_t count) {
    for (int i = 0; i < 3; i++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t n = 0; n < count; n++) {
            low = fmin(low, boxes[6 * n + 2 * i]);
            high = fmax(high, boxes[6 * n + 2 * i + 1]);
        }
        const bool right = fabs(low) < 0x1p31 && fabs(high) < 0x1p31;
        o->low[i] = right ? (int64_t)low : 0;
        o->grid.cells[i] = !right       ? 0
                           : high < low ? 1
                                        : (int64_t)(high - low) + 1;
        o->grid.corner[i] += o->grid.size[i] * (double)o->low[i];
    }
}

/* Adds the boxes of a level, whose cells begin at one of its array. */
static snow_status add_boxes(overlapping *o, int level, const double *boxes,
                             int64_t count, double begin) {
    amr_grid *grid = &o->grid;
    const double most = (double)o->sets[level].sizes[0];
    int64_t low[3];
    for (int i = 0; i < 3; i++) {
        low[i] = o->low[i];
        for (int l = 1; l <= level; l++)
            low[i] *= grid->ratio[l][i];
    }
    for (int64_t n = 0; n < count; n++) {
        snow_box box;
        double cells = 1;
        for (int i = 0; i < 3; i++) {
            const double first = boxes[6 * n + 2 * i];
            const double last = boxes[6 * n + 2 * i + 1];
            if (!(fabs(first) < 0x1p31) || !(fabs(last) < 0x1p31))
                return fail_levels(o, level, "has a box without an end");
            box.first[i] = (int64_t)first - low[i];
            box.count[i] = last < first ? 1 : (int64_t)(last - first) + 1;
            cells *= (double)box.count[i];
        }
        SNOW_TRY(
            SNOW_RESERVE(o->context, o->begins, grid->count, grid->count + 1));
        o->begins[grid->count] = (int64_t)begin;
        begin += cells;
        if (!(begin <= most))
            return fail_levels(o, level, "has fewer values than its boxes");
        SNOW_TRY(snow_amr_add(grid, level, &box));
    }
    return SNOW_STATUS_OK;
}

/* Boxes of a step: from where on and how many, and where their cells begin. */
static snow_status take_part(const overlapping *o, int level, int64_t step,
                             hsize_t rows, double part[3]) {
    char inside[140];
    part[0] = part[2] = 0;
    part[1] = (double)rows;
    if (step >= 0) {
        snprintf(inside, sizeof inside, "/%s", o->name);
        SNOW_TRY(
            number_of_step(o, level, "AMRBoxOffset", "s", "", step, &part[0]));
        SNOW_TRY(number_of_step(o, level, "NumberOfAMRBox", "es", "", step,
                                &part[1]));
        SNOW_TRY(number_of_step(o, level, "CellDataOffset", "s", inside, step,
                                &part[2]));
    }
    const bool right = part[0] >= 0 && part[1] >= 0 && part[2] >= 0 &&
                       part[2] < 0x1p53 && part[0] + part[1] <= (double)rows;
    return right ? SNOW_STATUS_OK
                 : fail_levels(o, level, "has offsets beyond its boxes");
}

static snow_status take_level(overlapping *o, hid_t group, int level,
                              int64_t step, double steps[3]) {
    char path[64];
    hdf5_set sizes;
    double *boxes = NULL, part[3];
    snprintf(path, sizeof path, ROOT "/Level%d/AMRBox", level);
    SNOW_TRY(take_spacing(o, group, level, steps));
    SNOW_TRY(open_array(o, level));
    SNOW_TRY(
        snow_hdf5_read_table(o->context, o->file, path, 2, 0, &sizes, &boxes));
    snow_status status =
        sizes.sizes[1] == 6 ? take_part(o, level, step, sizes.sizes[0], part)
                            : fail_levels(o, level, "has boxes of other sizes");
    if (status == SNOW_STATUS_OK && level == 0)
        span_grid(o, boxes + 6 * (int64_t)part[0], (int64_t)part[1]);
    if (status == SNOW_STATUS_OK)
        status = snow_amr_check(&o->grid);
    if (status == SNOW_STATUS_OK)
        status = add_boxes(o, level, boxes + 6 * (int64_t)part[0],
                           (int64_t)part[1], part[2]);
    snow_release(o->context, boxes);
    return status;
}

static snow_status take_levels(overlapping *o, hid_t root, int64_t step) {
    double steps[3] = {0};
    char name[16] = "Level0";
    snow_hdf5_numbers(root, "Origin", 3, o->grid.corner);
    for (int l = 0; H5Lexists(root, name, H5P_DEFAULT) > 0;) {
        if (l == AMR_MOST_LEVELS)
            return fail_levels(o, l, "is one too many");
        const hid_t group = H5Gopen2(root, name, H5P_DEFAULT);
        o->grid.levels = l + 1;
        const snow_status status = group < 0
                                       ? fail_levels(o, l, "cannot be opened")
                                       : take_level(o, group, l, step, steps);
        snow_hdf5_drop(group);
        SNOW_TRY(status);
        snprintf(name, sizeof name, "Level%d", ++l);
    }
    return SNOW_STATUS_OK;
}

/* --- values --------------------------------------------------------------- */

/* Reads a part of a box (amr_read_fn): the slices of it, then of these the
 * rows. */
static snow_status read_box(void *user, size_t number, const snow_box *part,
                            snow_volume **out) {
    const overlapping *o = user;
    const amr_box *box = &o->grid.boxes[number];
    const hdf5_set *set = &o->sets[box->level];
    const int64_t *all = box->box.count, plane = all[0] * all[1];
    const size_t bytes = snow_type_size(o->grid.type);
    const hsize_t first[2] = {
        (hsize_t)(o->begins[number] +
                  (part->first[2] - box->box.first[2]) * plane),
        o->component};
    const hsize_t count[2] = {(hsize_t)(part->count[2] * plane), 1};
    snow_volume_info info = snow_volume_info_default("hdf5");
    snow_volume *volume = NULL;
    info.type = o->grid.type;
    memcpy(info.dims, part->count, sizeof info.dims);
    char *slices = snow_allocate_array(o->context, count[0], bytes);
    if (!slices)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = snow_hdf5_read_box(
        o->context, o->file, set->id,
        info.type == SNOW_TYPE_FLOAT32 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE,
        set->axes, first, count, slices);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_new(o->context, &info, &volume);
    for (int64_t n = 0;
         n < part->count[1] * part->count[2] && status == SNOW_STATUS_OK; n++) {
        const int64_t y =
            part->first[1] - box->box.first[1] + n % part->count[1];
        const int64_t from = n / part->count[1] * plane + y * all[0] +
                             part->first[0] - box->box.first[0];
        const size_t row = (size_t)part->count[0] * bytes;
        memcpy((char *)volume->owned + (size_t)n * row,
               slices + (size_t)from * bytes, row);
    }
    snow_release(o->context, slices);
    return snow_volume_give(status, volume, out);
}

/* The steps, and the time of the one that is taken; -1: there are none. */
static snow_status take_steps(overlapping *o, snow_volume_info *info,
                              int64_t *step) {
    hdf5_set set;
    const hsize_t one = 1;
    const bool given =
        snow_hdf5_open_set(o->file, ROOT "/Steps/Values", 1, &set);
    info->times = given && set.sizes[0] > 0 ? (int64_t)set.sizes[0] : 1;
    snow_status status =
        snow_volume_pick_time(o->context, "time step", o->options, info);
    const hsize_t at = (hsize_t)info->time;
    *step = given ? info->time : -1;
    if (!given)
        return status;
    if (status == SNOW_STATUS_OK)
        status =
            snow_hdf5_read_box(o->context, o->file, set.id, H5T_NATIVE_DOUBLE,
                               1, &at, &one, &info->time_value);
    H5Dclose(set.id);
    return status;
}

static snow_status read_all(overlapping *o, hid_t root, snow_volume_info *info,
                            snow_volume **out) {
    int64_t step, component;
    SNOW_TRY(take_steps(o, info, &step));
    SNOW_TRY(take_levels(o, root, step));
    const hdf5_set *set = &o->sets[0];
    o->grid.type = info->type = snow_masked_type(set->type);
    SNOW_TRY(snow_volume_pick_component(
        o->context, o->options, set->axes == 2 ? (int64_t)set->sizes[1] : 1,
        info, &component));
    o->component = (hsize_t)component;
    snow_copy_name(o->name, info->quantity, sizeof info->quantity);
    SNOW_TRY(snow_amr_describe(&o->grid, o->options, info));
    return snow_amr_read(&o->grid, o->options, info, out);
}

snow_status snow_hdf5_read_overlapping(snow_context *context,
                                       const hdf5_file *file,
                                       const snow_volume_options *options,
                                       snow_volume_info *info,
                                       snow_volume **out, bool *found) {
    char type[24] = "";
    *found = false;
    const hid_t id = snow_hdf5_id(file);
    const hid_t root = H5Lexists(id, "VTKHDF", H5P_DEFAULT) > 0
                           ? H5Gopen2(id, "VTKHDF", H5P_DEFAULT)
                           : -1;
    if (root >= 0)
        snow_hdf5_text(file, root, "Type", 0, type, sizeof type);
    if (strcmp(type, "OverlappingAMR") != 0) {
        snow_hdf5_drop(root);
        return SNOW_STATUS_OK;
    }
    overlapping *o = snow_allocate_clear(context, sizeof *o);
    snow_status status = SNOW_STATUS_NO_MEMORY;
    if (o) {
        o->context = o->grid.context = context;
        o->file = file;
        o->options = options;
        o->grid.read = read_box;
        o->grid.user = o;
        status = choose_array(o, root, found);
        if (status == SNOW_STATUS_OK && *found)
            status = read_all(o, root, info, out);
        for (int i = 0; i < o->opened; i++)
            H5Dclose(o->sets[i].id);
        snow_amr_free(&o->grid);
        snow_release(context, o->begins);
    }
    snow_release(context, o);
    snow_hdf5_drop(root);
    return status;
}

#endif
