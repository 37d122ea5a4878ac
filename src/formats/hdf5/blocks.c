/* formats/hdf5/blocks.c - leaves of a tree of blocks as one grid.
 *
 *     +-------+---+---+
 *     |       |   |   |      each block has as many cells; half as wide a level
 *     |       +---+---+      further down
 *     |       |   |   |
 *     +-------+---+---+
 *
 * Leaves fill the domain, each place once: a file in which one is missing, or
 * there twice, is damaged.  That is so if no two of them share a place, which
 * is seen in Morton's order, and their volumes add up to all. */
#include "formats/hdf5/blocks.h"

#if SNOW_HAVE_HDF5

#include "volume/mask.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Blocks along an axis, so that three numbers of them fit into one. */
#define MOST_BLOCKS ((int64_t)1 << 21)

/* --- leaves --------------------------------------------------------------- */

/* A part of Morton's curve. */
typedef struct stretch {
    uint64_t first, end;
} stretch;

static int by_first(const void *a, const void *b) {
    const stretch *x = a, *y = b;
    return (x->first > y->first) - (x->first < y->first);
}

/* The part that a block covers; false if it lies outside. */
static bool find_stretch(const hdf5_leaves *all, const hdf5_leaf *leaf,
                         stretch *out) {
    const int below = all->grid.levels - 1 - leaf->level;
    out->first = 0;
    for (int i = 0; i < 3; i++) {
        const bool halved = all->grid.ratio[1][i] == 2;
        const int64_t most = all->blocks[i] << (halved ? leaf->level : 0);
        if (leaf->at[i] < 0 || leaf->at[i] >= most)
            return false;
        const uint64_t at = (uint64_t)leaf->at[i] << (halved ? below : 0);
        for (int bit = 0; bit < 21; bit++)
            out->first |= (at >> bit & 1) << (3 * bit + i);
    }
    out->end = out->first + ((uint64_t)1 << 3 * below);
    return true;
}

static snow_status fail_leaves(const hdf5_leaves *all, const char *what) {
    return snow_fail(all->context, SNOW_STATUS_BAD_INPUT,
                     "%s; it is damaged, copy or write it again", what);
}

/* Blocks of the finest level that all leaves, and the domain, have. */
static bool is_filled(const hdf5_leaves *all) {
    const int last = all->grid.levels - 1;
    uint64_t domain = 1, covered = 0;
    int axes = 0;
    for (int i = 0; i < 3; i++) {
        const bool halved = all->grid.ratio[1][i] == 2;
        axes += halved;
        domain *= (uint64_t)all->blocks[i] << (halved ? last : 0);
    }
    for (size_t i = 0; i < all->count; i++)
        covered += (uint64_t)1 << axes * (last - all->leaves[i].level);
    return covered == domain;
}

static snow_status check_leaves(const hdf5_leaves *all) {
    stretch *parts =
        snow_allocate_array(all->context, all->count, sizeof *parts);
    const char *fault = NULL;
    if (!parts)
        return SNOW_STATUS_NO_MEMORY;
    for (size_t i = 0; i < all->count && !fault; i++)
        if (!find_stretch(all, &all->leaves[i], &parts[i]))
            fault = "has a block outside of its domain";
    if (!fault)
        qsort(parts, all->count, sizeof *parts, by_first);
    for (size_t i = 1; i < all->count && !fault; i++)
        if (parts[i].first < parts[i - 1].end)
            fault = "has two blocks in one place";
    snow_release(all->context, parts);
    if (!fault && !is_filled(all))
        fault = "lacks blocks: those that it has do not fill its domain";
    return fault ? fail_leaves(all, fault) : SNOW_STATUS_OK;
}

/* --- values --------------------------------------------------------------- */

static hid_t type_in_memory(snow_type type) {
    return type == SNOW_TYPE_FLOAT32 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
}

static double value_at(const void *values, snow_type type, int64_t at) {
    return type == SNOW_TYPE_FLOAT32 ? (double)((const float *)values)[at]
                                     : ((const double *)values)[at];
}

/* The mean of those of the cells with a value that are in one of `to`. */
static double mean_of(const void *values, snow_type type,
                      const int64_t count[3], const int64_t first[3],
                      const int64_t each[3]) {
    double sum = 0;
    int64_t taken = 0;
    for (int64_t z = first[2]; z < first[2] + each[2]; z++)
        for (int64_t y = first[1]; y < first[1] + each[1]; y++)
            for (int64_t x = first[0]; x < first[0] + each[0]; x++) {
                const double value =
                    value_at(values, type, (z * count[1] + y) * count[0] + x);
                if (isfinite(value)) {
                    sum += value;
                    taken++;
                }
            }
    return taken ? sum / (double)taken : NAN;
}

/* Cells of a level finer than that of the voxels. */
static snow_status read_means(const hdf5_leaves *all, const hsize_t *first,
                              const hsize_t *count, const int64_t each[3],
                              snow_volume *to) {
    const int64_t *dims = to->info.dims;
    const int axes = all->set.axes;
    const int64_t fine[3] = {dims[0] * each[0], dims[1] * each[1],
                             dims[2] * each[2]};
    const snow_type type = to->info.type;
    void *values = snow_allocate_array(all->context,
                                       (uint64_t)(fine[0] * fine[1] * fine[2]),
                                       snow_type_size(type));
    if (!values)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status =
        snow_hdf5_read_box(all->context, all->file, all->set.id,
                           type_in_memory(type), axes, first, count, values);
    for (int64_t i = 0; i < dims[0] * dims[1] * dims[2]; i++) {
        const int64_t at[3] = {i % dims[0] * each[0],
                               i / dims[0] % dims[1] * each[1],
                               i / dims[0] / dims[1] * each[2]};
        const double mean = status == SNOW_STATUS_OK
                                ? mean_of(values, type, fine, at, each)
                                : NAN;
        if (type == SNOW_TYPE_FLOAT32)
            ((float *)to->owned)[i] = (float)mean;
        else
            ((double *)to->owned)[i] = mean;
    }
    snow_release(all->context, values);
    return status;
}

/* Reads a part of a block (amr_read_fn). */
static snow_status read_block(void *user, size_t number, const snow_box *part,
                              snow_volume **out) {
    const hdf5_leaves *all = user;
    const hdf5_leaf *leaf = &all->leaves[number];
    const snow_box *box = &all->grid.boxes[number].box;
    hsize_t first[HDF5_MOST_AXES], count[HDF5_MOST_AXES];
    int64_t each[3];
    snow_volume_info info = snow_volume_info_default("hdf5");
    snow_volume *volume;
    for (int i = 0; i < all->axis; i++) {
        first[i] = all->variable;
        count[i] = 1;
    }
    first[all->axis] = (hsize_t)leaf->row;
    count[all->axis] = 1;
    info.type = all->grid.type;
    for (int i = 0; i < 3; i++) {
        const int axis = all->set.axes - 1 - i;
        each[i] = all->cells[i] / box->count[i];
        info.dims[i] = part->count[i];
        first[axis] = (hsize_t)((part->first[i] - box->first[i]) * each[i] +
                                all->ghosts[i]);
        count[axis] = (hsize_t)(part->count[i] * each[i]);
    }
    SNOW_TRY(snow_volume_new(all->context, &info, &volume));
    const snow_status status =
        each[0] * each[1] * each[2] > 1
            ? read_means(all, first, count, each, volume)
            : snow_hdf5_read_box(all->context, all->file, all->set.id,
                                 type_in_memory(info.type), all->set.axes,
                                 first, count, volume->owned);
    return snow_volume_give(status, volume, out);
}

/* --- the grid ------------------------------------------------------------- */

static snow_status add_boxes(hdf5_leaves *all) {
    amr_grid *grid = &all->grid;
    for (int i = 0; i < 3; i++) {
        if (all->blocks[i] < 1 || all->blocks[i] > MOST_BLOCKS ||
            all->blocks[i] << (grid->levels - 1) > MOST_BLOCKS)
            return fail_leaves(all, "has more blocks along an axis than any");
        grid->cells[i] = all->blocks[i] * all->cells[i];
        for (int l = 0; l < AMR_MOST_LEVELS; l++)
            grid->ratio[l][i] = l && grid->cells[i] > 1 ? 2 : 1;
    }
    SNOW_TRY(snow_amr_check(grid));
    SNOW_TRY(check_leaves(all));
    for (size_t n = 0; n < all->count; n++) {
        const hdf5_leaf *leaf = &all->leaves[n];
        snow_box box;
        for (int i = 0; i < 3; i++) {
            box.first[i] = leaf->at[i] * all->cells[i];
            box.count[i] = all->cells[i];
        }
        SNOW_TRY(snow_amr_add(grid, leaf->level, &box));
    }
    return SNOW_STATUS_OK;
}

static snow_status read_all(hdf5_leaves *all, snow_volume **out) {
    snow_volume_info *info = all->info;
    const snow_volume_options *options = all->options;
    all->grid.type = snow_masked_type(all->set.type);
    all->grid.leaves = true;
    if (options->component && strcmp(options->component, "0") != 0)
        return snow_fail(all->context, SNOW_STATUS_BAD_USAGE,
                         "--component %.60s: its cells have one value; choose "
                         "a field with --dataset",
                         options->component);
    SNOW_TRY(snow_hdf5_check_storage(all->context, all->set.id));
    SNOW_TRY(add_boxes(all));
    SNOW_TRY(snow_amr_describe(&all->grid, options, info));
    SNOW_TRY(snow_volume_pick_time(all->context, "time step", options, info));
    return snow_amr_read(&all->grid, options, info, out);
}

snow_status snow_hdf5_read_leaves(snow_context *context, const hdf5_file *file,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out,
                                  bool *found) {
    hdf5_leaves all = {.context = context,
                       .file = file,
                       .options = options,
                       .info = info,
                       .set = {.id = -1},
                       .grid = {.context = context, .read = read_block}};
    all.grid.user = &all;
    *found = false;
    snow_status status = snow_hdf5_find_flash(&all, found);
    if (status == SNOW_STATUS_OK && !*found)
        status = snow_hdf5_find_athena(&all, found);
    if (status == SNOW_STATUS_OK && *found)
        status = read_all(&all, out);
    snow_amr_free(&all.grid);
    snow_release(context, all.leaves);
    snow_hdf5_drop(all.set.id);
    return status;
}

#endif
