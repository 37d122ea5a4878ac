/* formats/hdf5/athena.c - blocks of Athena++ (github.com/PrincetonUniversity/
 * athena, "Output file formats"), .athdf:
 *
 *     attributes of the root
 *       RootGridSize      cells of level 0 along x, y and z
 *       Coordinates       "cartesian"
 *       DatasetNames      "prim", "B"
 *       NumVariables      of each of these, whose names follow one another in
 *       VariableNames     "rho", "press", "vel1", ...
 *     /Levels             of each block, from 0
 *     /LogicalLocations   block; its place along x, y and z among its level
 *     /x1f, /x2f, /x3f    block; the faces of its cells
 *     /prim               variable, block, z, y, x
 *
 * All blocks are leaves.  Cells around a block (ghost_zones) are in its arrays
 * too, but not in the size of the grid. */
#include "formats/array.h"
#include "formats/hdf5/blocks.h"

#if SNOW_HAVE_HDF5

#include <math.h>
#include <string.h>

#define MOST_SETS 16
#define MOST_VARIABLES 64

/* Faces may be off their places by this share of a cell, beside the rounding
 * of float32. */
#define NEAR 0.02
#define ROUNDING 3e-7

/* --- variables ------------------------------------------------------------ */

/* The variables of the file in their order. */
typedef struct variables {
    int sets, counts[MOST_SETS];
    int count;
    char name[64], set[64]; /* of the one that is taken */
    int number;             /* in its set; -1: none is taken */
    char list[400];
} variables;

static bool is_asked(const char *asked, const char *name) {
    return asked && !strcmp(asked + (*asked == '/'), name);
}

/* Takes the variable that is asked for by its name, or by the data set and a
 * channel of it; without a name by the channel of all. */
static void choose(const hdf5_leaves *all, hid_t root, variables *v) {
    const snow_volume_options *options = all->options;
    int number = 0;
    char set[64], name[64];
    for (int s = 0; s < v->sets; s++) {
        snow_hdf5_text(all->file, root, "DatasetNames", (size_t)s, set,
                       sizeof set);
        for (int i = 0; i < v->counts[s]; i++, number++) {
            snow_hdf5_text(all->file, root, "VariableNames", (size_t)number,
                           name, sizeof name);
            snow_list_add(v->list, sizeof v->list, "%s", name);
            const int64_t wanted = options->dataset ? i : number;
            const bool taken =
                is_asked(options->dataset, name) ||
                ((!options->dataset || is_asked(options->dataset, set)) &&
                 options->channel == wanted);
            if (!taken || v->number >= 0)
                continue;
            v->number = i;
            snow_copy_name(name, v->name, sizeof v->name);
            memcpy(v->set, set, sizeof v->set);
        }
    }
    v->count = number;
}

/* False: the file says nothing of variables. */
static bool find_variables(const hdf5_leaves *all, hid_t root, variables *v) {
    double counts[MOST_SETS];
    *v = (variables){.number = -1};
    v->sets = snow_hdf5_numbers(root, "NumVariables", MOST_SETS, counts);
    double sum = 0;
    for (int i = 0; i < v->sets; i++) {
        if (!(counts[i] >= 1) || !(sum + counts[i] <= MOST_VARIABLES))
            return false;
        sum += counts[i];
        v->counts[i] = (int)counts[i];
    }
    choose(all, root, v);
    return v->sets > 0;
}

/* Opens the data set; false: another one than of blocks is asked for. */
static snow_status open_variable(hdf5_leaves *all, hid_t root, bool *found) {
    const snow_volume_options *options = all->options;
    variables v;
    *found = false;
    if (!find_variables(all, root, &v))
        return SNOW_STATUS_OK;
    if (v.number < 0 && !options->dataset)
        return snow_fail(all->context, SNOW_STATUS_BAD_USAGE,
                         "--channel %lld: there are %d variables, counted from "
                         "0: %s; --dataset takes one by its name",
                         (long long)options->channel, v.count, v.list);
    if (v.number < 0 || !snow_hdf5_open_set(all->file, v.set, 5, &all->set) ||
        all->set.sizes[0] <= (hsize_t)v.number)
        return SNOW_STATUS_OK;
    *found = true;
    all->axis = 1;
    all->variable = (hsize_t)v.number;
    snow_copy_name(v.name, all->info->quantity, sizeof all->info->quantity);
    if (v.count > 1 && !options->dataset && !options->channel &&
        !options->channel_given && !options->each_time)
        snow_notify(all->context,
                    "%s is taken, the first of %s; --dataset selects another",
                    v.name, v.list);
    return SNOW_STATUS_OK;
}

/* --- blocks --------------------------------------------------------------- */

static snow_status fail_athena(const hdf5_leaves *all, const char *what) {
    return snow_fail(all->context, SNOW_STATUS_BAD_INPUT,
                     "%s; it is damaged, copy or write it again", what);
}

static snow_status take_leaves(hdf5_leaves *all) {
    const hsize_t count = all->set.sizes[1];
    hdf5_set sizes;
    double *levels = NULL, *places = NULL;
    SNOW_TRY(snow_hdf5_make_leaves(all, count));
    snow_status status = snow_hdf5_read_table(all->context, all->file, "Levels",
                                              1, count, &sizes, &levels);
    if (status == SNOW_STATUS_OK)
        status =
            snow_hdf5_read_table(all->context, all->file, "LogicalLocations", 2,
                                 count, &sizes, &places);
    bool right = status == SNOW_STATUS_OK && sizes.sizes[1] == 3;
    for (hsize_t n = 0; n < count && right; n++) {
        hdf5_leaf *leaf = &all->leaves[n];
        right = levels[n] >= 0 && levels[n] < AMR_MOST_LEVELS;
        leaf->row = (int64_t)n;
        leaf->level = right ? (int)levels[n] : 0;
        for (int i = 0; i < 3 && right; i++) {
            const double at = places[3 * n + (hsize_t)i];
            right = at >= 0 && at < 0x1p31;
            leaf->at[i] = right ? (int64_t)at : 0;
        }
    }
    all->count = right ? count : 0;
    snow_release(all->context, levels);
    snow_release(all->context, places);
    return status == SNOW_STATUS_OK && !right
               ? fail_athena(all, "has blocks at no places")
               : status;
}

/* Cells of a block: those of the grid by the blocks, of which the last one of a
 * level counts them.  What an array has more are ghosts. */
static snow_status size_blocks(hdf5_leaves *all, hid_t root) {
    double grid[3];
    if (snow_hdf5_numbers(root, "RootGridSize", 3, grid) != 3)
        return fail_athena(all, "has no RootGridSize");
    for (int i = 0; i < 3; i++) {
        double blocks = 0;
        const bool halved = grid[i] > 1;
        for (size_t n = 0; n < all->count; n++) {
            const hdf5_leaf *leaf = &all->leaves[n];
            blocks = fmax(blocks, (double)(leaf->at[i] + 1) /
                                      (halved ? 1 << leaf->level : 1));
        }
        const double cells = grid[i] / blocks;
        const int64_t stored = (int64_t)all->set.sizes[4 - i];
        if (!(cells >= 1) || cells != rint(cells) || blocks != rint(blocks) ||
            !(cells <= (double)stored) || (stored - (int64_t)cells) % 2)
            return fail_athena(all,
                               "has blocks whose sizes and places do not make "
                               "its RootGridSize: blocks are missing");
        all->cells[i] = (int64_t)cells;
        all->ghosts[i] = (stored - (int64_t)cells) / 2;
        all->blocks[i] = (int64_t)blocks;
    }
    const int low = snow_hdf5_number_levels(all);
    for (int i = 0; i < 3; i++)
        all->blocks[i] <<= grid[i] > 1 ? low : 0;
    return SNOW_STATUS_OK;
}

/* Whether all faces lie where an even grid has them. */
static bool is_even(const hdf5_leaves *all, int axis, const double *faces,
                    int64_t each) {
    const double low = all->grid.corner[axis];
    const int64_t cells = all->cells[axis], ghosts = all->ghosts[axis];
    for (size_t n = 0; n < all->count; n++) {
        const hdf5_leaf *leaf = &all->leaves[n];
        const double step = all->grid.size[axis] /
                            (all->grid.cells[axis] > 1 ? 1 << leaf->level : 1);
        for (int64_t i = 0; i <= cells; i++) {
            const double face = faces[leaf->row * each + ghosts + i];
            const double right =
                low + step * (double)(leaf->at[axis] * cells + i);
            if (!(fabs(face - right) <=
                  NEAR * step + ROUNDING * (fabs(face) + fabs(low))))
                return false;
        }
    }
    return true;
}

static snow_status place_axis(hdf5_leaves *all, int axis) {
    static const char *const names[] = {"x1f", "x2f", "x3f"};
    const int64_t cells = all->cells[axis], ghosts = all->ghosts[axis];
    hdf5_set sizes;
    double *faces, low = INFINITY, high = -INFINITY;
    SNOW_TRY(snow_hdf5_read_table(all->context, all->file, names[axis], 2,
                                  all->count, &sizes, &faces));
    const int64_t each = (int64_t)sizes.sizes[1];
    bool right = each == cells + 2 * ghosts + 1;
    for (size_t n = 0; n < all->count && right; n++) {
        const double *first = faces + (int64_t)n * each + ghosts;
        low = fmin(low, first[0]);
        high = fmax(high, first[cells]);
    }
    all->grid.cells[axis] = all->blocks[axis] * cells;
    all->grid.corner[axis] = low;
    all->grid.size[axis] = (high - low) / (double)all->grid.cells[axis];
    const bool placed = right && all->grid.size[axis] > 0;
    right = placed && is_even(all, axis, faces, each);
    snow_release(all->context, faces);
    return right ? SNOW_STATUS_OK
                 : snow_fail(all->context, SNOW_STATUS_BAD_INPUT,
                             "has cells of uneven sizes along x%d (x%drat), "
                             "which are not supported with levels; resample "
                             "it, such as with yt",
                             axis + 1, axis + 1);
}

snow_status snow_hdf5_find_athena(hdf5_leaves *all, bool *found) {
    const hid_t root = H5Oopen(snow_hdf5_id(all->file), "/", H5P_DEFAULT);
    char kind[64];
    if (root < 0)
        return SNOW_STATUS_OK;
    snow_status status = SNOW_STATUS_OK;
    if (H5Aexists(root, "MeshBlockSize") > 0)
        status = open_variable(all, root, found);
    snow_hdf5_text(all->file, root, "Coordinates", 0, kind, sizeof kind);
    if (status == SNOW_STATUS_OK && *found && *kind &&
        strncmp(kind, "cartesian", 9) != 0 && strncmp(kind, "minkowski", 9))
        status = snow_fail(all->context, SNOW_STATUS_BAD_INPUT,
                           "is of Athena++ in %.60s coordinates, which are not "
                           "supported; resample it to even x, y and z, such as "
                           "with yt",
                           kind);
    if (status == SNOW_STATUS_OK && *found)
        status = take_leaves(all);
    if (status == SNOW_STATUS_OK && *found)
        status = size_blocks(all, root);
    for (int i = 0; i < 3 && status == SNOW_STATUS_OK && *found; i++)
        status = place_axis(all, i);
    if (*found)
        snow_hdf5_numbers(root, "Time", 1, &all->info->time_value);
    H5Oclose(root);
    return status;
}

#endif
