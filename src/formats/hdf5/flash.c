/* formats/hdf5/flash.c - blocks of FLASH (flash.rochester.edu, "FLASH User's
 * Guide", the chapter on IO):
 *
 *     /bounding box     block, axis, low and high
 *     /refine level     of each block, from 1
 *     /node type        1: a leaf
 *     /dens             block, z, y, x; one for each field
 *     /real scalars     pairs of a name and a number, among them the time
 *     /string scalars, /string runtime parameters
 *                       pairs of texts, among them the geometry
 *
 * Values of parents are those of their leaves once more, and are not read. */
#include "formats/array.h"
#include "formats/hdf5/blocks.h"

#if SNOW_HAVE_HDF5

#include <math.h>
#include <string.h>

/* Bytes of a name or text, and pairs in a list. */
#define TEXT_BYTES 80
#define MOST_PAIRS 4096

/* Blocks may be off their places by this share of one. */
#define NEAR 0.02

/* --- lists of pairs ------------------------------------------------------- */

typedef struct pair {
    char name[TEXT_BYTES + 1], text[TEXT_BYTES + 1];
    double number;
} pair;

static bool is_text(hid_t type) {
    return type >= 0 && H5Tget_class(type) == H5T_STRING &&
           H5Tis_variable_str(type) == 0 && H5Tget_size(type) == TEXT_BYTES;
}

/* Whether the type is a name and a text or a number, within its size, as
 * libhdf5 does not look. */
static bool is_pair(hid_t type, bool texts) {
    if (H5Tget_class(type) != H5T_COMPOUND || H5Tget_nmembers(type) != 2)
        return false;
    bool right = true;
    for (unsigned i = 0; i < 2; i++) {
        hid_t member = H5Tget_member_type(type, i);
        const size_t at = H5Tget_member_offset(type, i);
        right = right && member >= 0 && at <= H5Tget_size(type) &&
                H5Tget_size(member) <= H5Tget_size(type) - at &&
                (i == 0 || texts ? is_text(member)
                                 : H5Tget_class(member) == H5T_FLOAT);
        snow_hdf5_drop(member);
    }
    return right;
}

/* Reads pairs that are stored in one piece. */
static bool read_pairs(hid_t set, bool texts, hssize_t count, pair *out) {
    hid_t kind = H5Dget_type(set), plan = H5Dget_create_plist(set);
    bool read = kind >= 0 && plan >= 0 && is_pair(kind, texts) &&
                H5Pget_layout(plan) == H5D_CONTIGUOUS &&
                H5Dget_storage_size(set) >= (hsize_t)count * H5Tget_size(kind);
    if (read) {
        char *name = H5Tget_member_name(kind, 0);
        char *value = H5Tget_member_name(kind, 1);
        hid_t type = H5Tcreate(H5T_COMPOUND, sizeof *out);
        hid_t text = H5Tcopy(H5T_C_S1);
        H5Tset_size(text, TEXT_BYTES);
        read = name && value &&
               H5Tinsert(type, name, offsetof(pair, name), text) >= 0 &&
               H5Tinsert(type, value,
                         texts ? offsetof(pair, text) : offsetof(pair, number),
                         texts ? text : H5T_NATIVE_DOUBLE) >= 0 &&
               H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0;
        H5Tclose(text);
        H5Tclose(type);
        H5free_memory(name);
        H5free_memory(value);
    }
    snow_hdf5_drop(kind);
    snow_hdf5_drop(plan);
    return read;
}

/* The pair of a name, which blanks fill up, if there is one. */
static snow_status find_pair(const hdf5_leaves *all, const char *list,
                             bool texts, const char *wanted, bool *found,
                             pair *out) {
    const hid_t root = snow_hdf5_id(all->file);
    const hid_t set = H5Lexists(root, list, H5P_DEFAULT) > 0
                          ? H5Dopen2(root, list, H5P_DEFAULT)
                          : -1;
    const hid_t space = set >= 0 ? H5Dget_space(set) : -1;
    const hssize_t count = space >= 0 ? H5Sget_simple_extent_npoints(space) : 0;
    pair *pairs = NULL;
    *found = false;
    snow_hdf5_drop(space);
    const bool any = count >= 1 && count <= MOST_PAIRS;
    if (any)
        pairs =
            snow_allocate_clear(all->context, (size_t)count * sizeof *pairs);
    const bool read = pairs && read_pairs(set, texts, count, pairs);
    for (hssize_t i = 0; read && i < count && !*found; i++) {
        const size_t letters = strcspn(pairs[i].name, " ");
        *found = letters == strlen(wanted) &&
                 !memcmp(pairs[i].name, wanted, letters);
        if (*found)
            *out = pairs[i];
    }
    snow_release(all->context, pairs);
    snow_hdf5_drop(set);
    return any && !pairs ? SNOW_STATUS_NO_MEMORY : SNOW_STATUS_OK;
}

/* --- fields --------------------------------------------------------------- */

/* The fields of the file. */
typedef struct fields {
    hdf5_leaves *all;
    hsize_t blocks;
    char first[64], list[400];
    int count;
} fields;

static herr_t look(hid_t root, const char *name, const H5L_info_t *info,
                   void *user) {
    fields *f = user;
    hdf5_set set;
    (void)root, (void)info;
    if (!snow_hdf5_open_set(f->all->file, name, 4, &set))
        return 0;
    H5Dclose(set.id);
    if (set.sizes[0] != f->blocks)
        return 0;
    if (!f->count++)
        snow_copy_name(name, f->first, sizeof f->first);
    snow_list_add(f->list, sizeof f->list, "/%s", name);
    return 0;
}

/* Opens the field that is asked for, else the first; false: another data set is
 * asked for, or there are none. */
static bool open_field(hdf5_leaves *all, hsize_t blocks) {
    fields f = {.all = all, .blocks = blocks};
    const char *asked = all->options->dataset;
    if (asked && *asked == '/')
        asked++;
    if (!asked &&
        H5Literate(snow_hdf5_id(all->file), H5_INDEX_NAME, H5_ITER_INC, NULL,
                   look, &f) >= 0 &&
        f.count)
        asked = f.first;
    if (!asked || !snow_hdf5_open_set(all->file, asked, 4, &all->set))
        return false;
    if (all->set.sizes[0] != blocks) {
        snow_hdf5_drop(all->set.id);
        all->set.id = -1;
        return false;
    }
    snow_copy_name(asked, all->info->quantity, sizeof all->info->quantity);
    if (f.count > 1 && !all->options->each_time)
        snow_notify(all->context,
                    "/%s is taken, the first of %s; --dataset selects another",
                    asked, f.list);
    return true;
}

/* --- blocks --------------------------------------------------------------- */

/* Where each block is: low and high along an axis. */
typedef struct places {
    const double *bounds;
    int64_t rows;
    int axes; /* of the file */
} places;

static double bound(const places *p, int64_t row, int axis, int end) {
    return p->bounds[(row * p->axes + axis) * 2 + end];
}

static snow_status take_leaves(hdf5_leaves *all, const double *levels,
                               const double *kinds, hsize_t blocks) {
    SNOW_TRY(snow_hdf5_make_leaves(all, blocks));
    for (hsize_t i = 0; i < blocks; i++) {
        if (kinds[i] != 1)
            continue;
        if (!(levels[i] >= 1) || !(levels[i] <= AMR_MOST_LEVELS))
            return snow_fail(all->context, SNOW_STATUS_BAD_INPUT,
                             "has a block of level %g: must be 1 to %d",
                             levels[i], AMR_MOST_LEVELS);
        all->leaves[all->count++] =
            (hdf5_leaf){.level = (int)levels[i] - 1, .row = (int64_t)i};
    }
    if (!all->count)
        return snow_fail(all->context, SNOW_STATUS_BAD_INPUT,
                         "has no leaves among its blocks; write it again");
    snow_hdf5_number_levels(all);
    return SNOW_STATUS_OK;
}

/* The domain along an axis: all blocks, and what the run has asked for. */
static snow_status span_axis(const hdf5_leaves *all, const places *p, int axis,
                             double ends[2]) {
    static const char *const names[3][2] = {
        {"xmin", "xmax"}, {"ymin", "ymax"}, {"zmin", "zmax"}};
    bool found;
    pair one;
    ends[0] = INFINITY;
    ends[1] = -INFINITY;
    for (int64_t row = 0; row < p->rows; row++) {
        ends[0] = fmin(ends[0], bound(p, row, axis, 0));
        ends[1] = fmax(ends[1], bound(p, row, axis, 1));
    }
    for (int i = 0; i < 2; i++) {
        SNOW_TRY(find_pair(all, "real runtime parameters", false,
                           names[axis][i], &found, &one));
        const double slack = 1e-6 * (fabs(ends[0]) + fabs(ends[1]));
        if (found &&
            (i ? one.number > ends[1] + slack : one.number < ends[0] - slack))
            ends[i] = one.number;
    }
    return SNOW_STATUS_OK;
}

/* The blocks along an axis, and the place of each leaf. */
static snow_status place_axis(hdf5_leaves *all, const places *p, int axis) {
    double ends[2], width = 0;
    SNOW_TRY(span_axis(all, p, axis, ends));
    const double low = ends[0], high = ends[1];
    for (size_t n = 0; n < all->count; n++)
        if (all->leaves[n].level == 0)
            width = bound(p, all->leaves[n].row, axis, 1) -
                    bound(p, all->leaves[n].row, axis, 0);
    const double blocks = rint((high - low) / width);
    bool right = width > 0 && blocks >= 1 && blocks < 0x1p31;
    all->blocks[axis] = right ? (int64_t)blocks : 1;
    all->grid.corner[axis] = low;
    all->grid.size[axis] = (high - low) / blocks / (double)all->cells[axis];
    for (size_t n = 0; n < all->count && right; n++) {
        hdf5_leaf *leaf = &all->leaves[n];
        const double each = (high - low) / blocks / (1 << leaf->level);
        const double from = bound(p, leaf->row, axis, 0);
        const double at = (from - low) / each;
        right = fabs(at - rint(at)) < NEAR &&
                fabs(bound(p, leaf->row, axis, 1) - from - each) < NEAR * each;
        leaf->at[axis] = right ? (int64_t)rint(at) : 0;
    }
    return right ? SNOW_STATUS_OK
                 : snow_fail(all->context, SNOW_STATUS_BAD_INPUT,
                             "has blocks that do not halve each other along "
                             "%c in /bounding box; write it again",
                             "xyz"[axis]);
}

/* An axis of one cell, of a plane, has the size of x. */
static snow_status place_leaves(hdf5_leaves *all, const places *p) {
    for (int i = 0; i < 3; i++) {
        all->cells[i] = (int64_t)all->set.sizes[3 - i];
        if (i < p->axes && (i == 0 || all->cells[i] > 1)) {
            SNOW_TRY(place_axis(all, p, i));
        } else {
            all->blocks[i] = 1;
            all->grid.corner[i] = 0;
            all->grid.size[i] = all->grid.size[0];
        }
    }
    return SNOW_STATUS_OK;
}

/* The time, and the geometry, which must be Cartesian. */
static snow_status take_pairs(hdf5_leaves *all) {
    static const char *const lists[] = {"string scalars",
                                        "string runtime parameters"};
    bool found;
    pair one;
    for (int i = 0; i < 2; i++) {
        SNOW_TRY(find_pair(all, lists[i], true, "geometry", &found, &one));
        if (found && strncmp(one.text, "cartesian", 9) != 0)
            return snow_fail(all->context, SNOW_STATUS_BAD_INPUT,
                             "is of FLASH in %.*s coordinates, which are not "
                             "supported; resample it to even x, y and z, such "
                             "as with yt",
                             (int)strcspn(one.text, " "), one.text);
    }
    SNOW_TRY(find_pair(all, "real scalars", false, "time", &found, &one));
    if (found)
        all->info->time_value = one.number;
    return SNOW_STATUS_OK;
}

snow_status snow_hdf5_find_flash(hdf5_leaves *all, bool *found) {
    hdf5_set sizes;
    double *bounds = NULL, *levels = NULL, *kinds = NULL;
    if (!snow_hdf5_open_set(all->file, "bounding box", 3, &sizes))
        return SNOW_STATUS_OK;
    H5Dclose(sizes.id);
    const hsize_t blocks = sizes.sizes[0];
    const bool right =
        sizes.sizes[1] >= 1 && sizes.sizes[1] <= 3 && sizes.sizes[2] == 2;
    if (!right || !open_field(all, blocks))
        return SNOW_STATUS_OK;
    *found = true;
    snow_context *context = all->context;
    snow_status status = take_pairs(all);
    if (status == SNOW_STATUS_OK)
        status = snow_hdf5_read_table(context, all->file, "bounding box", 3,
                                      blocks, &sizes, &bounds);
    if (status == SNOW_STATUS_OK)
        status = snow_hdf5_read_table(context, all->file, "refine level", 1,
                                      blocks, &sizes, &levels);
    if (status == SNOW_STATUS_OK)
        status = snow_hdf5_read_table(context, all->file, "node type", 1,
                                      blocks, &sizes, &kinds);
    if (status == SNOW_STATUS_OK)
        status = take_leaves(all, levels, kinds, blocks);
    const places p = {bounds, (int64_t)blocks, right ? (int)sizes.sizes[1] : 0};
    if (status == SNOW_STATUS_OK)
        status = place_leaves(all, &p);
    snow_release(context, bounds);
    snow_release(context, levels);
    snow_release(context, kinds);
    return status;
}

#endif
