/* formats/hdf5/vtkhdf.c - image data of VTKHDF (vtk.org, "VTKHDF File Format"):
 *
 *     /VTKHDF
 *       Type             "ImageData"
 *       WholeExtent, Origin, Spacing
 *       Direction        rows of a matrix; its columns are the axes
 *       PointData        Scalars: the name of the active array
 *       PointData/rho    values at points
 *       CellData/rho     values of cells
 *       Steps/Values     times, where arrays have an axis of time before z
 */
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include <stdio.h>
#include <string.h>

#define ROOT "/VTKHDF"

static bool is_in(const hdf5_set *set, const char *group) {
    return !strncmp(set->path, group, strlen(group));
}

/* -1: the data set is not of image data. */
static hid_t open_root(const hdf5_file *file, const hdf5_set *set) {
    char type[16];
    if (!is_in(set, ROOT "/PointData/") && !is_in(set, ROOT "/CellData/"))
        return -1;
    hid_t root = H5Oopen(snow_hdf5_id(file), ROOT, H5P_DEFAULT);
    if (root < 0)
        return -1;
    snow_hdf5_text(file, root, "Type", 0, type, sizeof type);
    if (!strcmp(type, "ImageData"))
        return root;
    H5Oclose(root);
    return -1;
}

bool snow_hdf5_active_image(const hdf5_file *file, char path[HDF5_NAME_BYTES]) {
    static const char *const groups[] = {ROOT "/PointData", ROOT "/CellData"};
    const hid_t id = snow_hdf5_id(file);
    char name[128];
    bool found = false;
    hsize_t arrays = 0;
    for (int i = 0; i < 2; i++) {
        hid_t group = H5Gopen2(id, groups[i], H5P_DEFAULT);
        H5G_info_t about;
        if (group < 0)
            continue;
        if (H5Gget_info(group, &about) >= 0)
            arrays += about.nlinks;
        snow_hdf5_text(file, group, "Scalars", 0, name, sizeof name);
        if (!found && *name && H5Lexists(group, name, H5P_DEFAULT) > 0) {
            snprintf(path, HDF5_NAME_BYTES, "%s/%s", groups[i], name);
            found = true;
        }
        H5Gclose(group);
    }
    return found && arrays > 1;
}

bool snow_hdf5_place_image(const hdf5_file *file, const hdf5_set *set,
                           snow_volume_info *info) {
    double spacing[3], origin[3] = {0}, extent[6] = {0};
    double turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double shift = is_in(set, ROOT "/CellData/") ? 0.5 : 0;
    hid_t root = open_root(file, set);
    if (root < 0)
        return false;
    const bool given = snow_hdf5_numbers(root, "Spacing", 3, spacing) == 3;
    snow_hdf5_numbers(root, "Origin", 3, origin);
    snow_hdf5_numbers(root, "WholeExtent", 6, extent);
    snow_hdf5_numbers(root, "Direction", 9, turn);
    H5Oclose(root);
    for (int a = 0; a < 3 && given; a++) {
        info->matrix[a][3] = origin[a];
        for (int b = 0; b < 3; b++) {
            info->matrix[a][b] = turn[3 * a + b] * spacing[b];
            info->matrix[a][3] += info->matrix[a][b] * (extent[2 * b] + shift);
        }
    }
    return given;
}

/* Opens the times of the steps of the data set and counts them; -1 without
 * them. */
static hid_t open_times(const hdf5_file *file, const hdf5_set *set,
                        hsize_t *count) {
    const hid_t root = open_root(file, set);
    const hid_t times =
        root >= 0 ? H5Dopen2(root, "Steps/Values", H5P_DEFAULT) : -1;
    const hid_t space = times >= 0 ? H5Dget_space(times) : -1;
    const bool line = space >= 0 && H5Sget_simple_extent_ndims(space) == 1 &&
                      H5Sget_simple_extent_dims(space, count, NULL) == 1;
    snow_hdf5_drop(space);
    snow_hdf5_drop(root);
    if (line)
        return times;
    snow_hdf5_drop(times);
    return -1;
}

snow_status snow_hdf5_time_image(snow_context *context, const hdf5_file *file,
                                 const hdf5_set *set, snow_volume_info *info) {
    hsize_t count = 0, at = (hsize_t)info->time, one = 1;
    const hid_t times = open_times(file, set, &count);
    double value = 0;
    snow_status status = SNOW_STATUS_OK;
    if (times >= 0 && at < count) {
        status = snow_hdf5_read_box(context, file, times, H5T_NATIVE_DOUBLE, 1,
                                    &at, &one, &value);
        if (status == SNOW_STATUS_OK)
            info->time_value = value;
        else
            snow_fail_within(context, status, "the times of its steps");
    }
    snow_hdf5_drop(times);
    return status;
}

/* An array of all steps has the axes time, z, y, x, and may have one of
 * components. */
void snow_hdf5_hint_image(const hdf5_file *file, const hdf5_set *set,
                          snow_axis_hint hints[HDF5_MOST_AXES]) {
    hsize_t count = 0;
    const hid_t times = open_times(file, set, &count);
    snow_hdf5_drop(times);
    if (times < 0 || set->axes < 4 || set->sizes[0] != count)
        return;
    hints[set->axes - 1].time = true;
    if (set->axes == 4)
        hints[0].space = true;
    else
        hints[0].components = true;
}

#endif
