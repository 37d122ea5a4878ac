/* formats/hdf5/tables.c - the numbers that say where blocks are, and room for
 * these. */
#include "formats/hdf5/blocks.h"

#if SNOW_HAVE_HDF5

bool snow_hdf5_open_set(const hdf5_file *file, const char *path, int axes,
                        hdf5_set *out) {
    const hid_t root = snow_hdf5_id(file);
    if (H5Lexists(root, path, H5P_DEFAULT) <= 0)
        return false;
    const hid_t id = H5Dopen2(root, path, H5P_DEFAULT);
    if (id < 0)
        return false;
    if (snow_hdf5_describe(id, out) && out->axes == axes)
        return true;
    H5Dclose(id);
    return false;
}

snow_status snow_hdf5_read_table(snow_context *context, const hdf5_file *file,
                                 const char *path, int axes, hsize_t rows,
                                 hdf5_set *sizes, double **out) {
    const hsize_t first[HDF5_MOST_AXES] = {0};
    uint64_t count = 1, most;
    if (!snow_mul_u64(snow_hdf5_size(file), SNOW_DEFLATE_RATIO, &most))
        most = UINT64_MAX;
    if (!snow_hdf5_open_set(file, path, axes, sizes))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "has no numbers /%s for its blocks; write it again",
                         path);
    bool fits = !rows || sizes->sizes[0] == rows;
    for (int i = 0; i < axes; i++)
        fits = fits && snow_mul_u64(count, sizes->sizes[i], &count);
    fits = fits && count && count <= most / sizeof(double);
    double *values =
        fits ? snow_allocate_array(context, count, sizeof *values) : NULL;
    snow_status status =
        !fits ? snow_fail(context, SNOW_STATUS_BAD_INPUT,
                          "has other sizes in /%s than its blocks; it is "
                          "damaged, write it again",
                          path)
        : values
            ? snow_hdf5_read_box(context, file, sizes->id, H5T_NATIVE_DOUBLE,
                                 axes, first, sizes->sizes, values)
            : SNOW_STATUS_NO_MEMORY;
    H5Dclose(sizes->id);
    if (status == SNOW_STATUS_OK)
        *out = values;
    else
        snow_release(context, values);
    return status;
}

snow_status snow_hdf5_make_leaves(hdf5_leaves *all, hsize_t count) {
    if (count < 1 || count > AMR_MOST_BOXES)
        return snow_fail(all->context, SNOW_STATUS_BAD_INPUT,
                         "has %llu blocks: must be 1 to %d; write it again",
                         (unsigned long long)count, AMR_MOST_BOXES);
    all->leaves = snow_allocate_array(all->context, count, sizeof *all->leaves);
    return all->leaves ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

int snow_hdf5_number_levels(hdf5_leaves *all) {
    int low = AMR_MOST_LEVELS, high = 0;
    for (size_t i = 0; i < all->count; i++) {
        low = all->leaves[i].level < low ? all->leaves[i].level : low;
        high = all->leaves[i].level > high ? all->leaves[i].level : high;
    }
    for (size_t i = 0; i < all->count; i++)
        all->leaves[i].level -= low;
    all->grid.levels = high - low + 1;
    return low;
}

#endif
