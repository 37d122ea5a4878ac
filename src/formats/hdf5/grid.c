/* formats/hdf5/grid.c - the geometry of an HDF5 data set, from attributes on
 * which programs have agreed:
 *
 *     element_size_um     size of a voxel in micrometres, z y x
 *     voxel_size, spacing the same, without a unit
 *     resolution, offset  the same and the first voxel, in nanometres
 *     openPMD             gridSpacing and others of the group, by axisLabels
 *                         and dataOrder
 *     HDF5 images         IMAGE_SUBCLASS and INTERLACE_MODE: colours
 *     DIMENSION_LABELS    what the axes are: "component", "time", "x"
 *     NetCDF-4            coordinates by dimension scales, units
 *
 * Without any of them voxels are 1 x 1 x 1. */
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* The most data sets that use one scale. */
#define MOST_USES 65536

static void read_text(const hdf5_file *file, hid_t object, const char *name,
                      char *out, size_t capacity) {
    snow_hdf5_text(file, object, name, 0, out, capacity);
}

static bool all_above_0(const double *values) {
    for (int i = 0; i < 3; i++)
        if (!(values[i] > 0) || !isfinite(values[i]))
            return false;
    return true;
}

/* Uses three numbers z y x of the data set.  Of its size in um there may be one
 * for each axis, or of a picture two. */
static bool place_by_size(snow_context *context, const hdf5_set *set,
                          snow_volume_info *info) {
    static const struct {
        const char *name, *unit;
    } sizes[] = {{"element_size_um", "um"},
                 {"resolution", "nm"},
                 {"voxel_size", ""},
                 {"spacing", ""}};
    double all[HDF5_MOST_AXES], offset[3];
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const int count =
            snow_hdf5_numbers(set->id, sizes[i].name, HDF5_MOST_AXES, all);
        if (i ? count != 3 : count < 2)
            continue;
        const double size[3] = {all[count > 2 ? count - 3 : count - 1],
                                all[count - 2], all[count - 1]};
        if (!all_above_0(size)) {
            snow_notify(context,
                        "%s is ignored: its lengths are not above 0; "
                        "--spacing sets others",
                        sizes[i].name);
            continue;
        }
        for (int a = 0; a < 3; a++)
            info->matrix[a][a] = size[2 - a];
        if (count == 2 && set->axes > 2 && set->sizes[set->axes - 3] > 1)
            snow_notify(context, SNOW_WIDTH_IS_DISTANCE, size[2]);
        memcpy(info->unit, sizes[i].unit, strlen(sizes[i].unit) + 1);
        if (snow_hdf5_numbers(set->id, "offset", 3, offset) == 3)
            for (int a = 0; a < 3; a++)
                if (isfinite(offset[a]))
                    info->matrix[2 - a][3] = offset[a];
        return true;
    }
    return false;
}

/* Reads the letters of the three axes in the order of the array. */
static bool read_labels(const hdf5_file *file, hid_t group, int order[3]) {
    int seen = 0;
    for (size_t i = 0; i < 3; i++) {
        char label[9];
        if (snow_hdf5_text(file, group, "axisLabels", i, label, sizeof label) !=
            3)
            return false;
        /* The axis x y z that a label names, or -1. */
        order[i] = !*label || label[1]              ? -1
                   : *label >= 'x' && *label <= 'z' ? *label - 'x'
                                                    : -1;
        if (order[i] < 0)
            return false;
        seen |= 1 << order[i];
    }
    return seen == 7;
}

/* openPMD (openpmd.org, 1.1.0): the group of a mesh, or the data set itself,
 * has spacing and offset in the order of the labels.  That is the order of the
 * array, with the fastest axis last, or by dataOrder "F" first.  The labels
 * assign x, y and z of the world. */
static bool place_by_mesh(const hdf5_file *file, hid_t object,
                          const hdf5_set *set, snow_volume_info *info) {
    int order[3];
    double spacing[3], offset[3] = {0}, unit = 0, position[3] = {0};
    if (snow_hdf5_numbers(object, "gridSpacing", 3, spacing) != 3 ||
        !all_above_0(spacing) || !read_labels(file, object, order))
        return false;
    snow_hdf5_numbers(object, "gridGlobalOffset", 3, offset);
    snow_hdf5_numbers(set->id, "position", 3, position);
    snow_hdf5_numbers(object, "gridUnitSI", 1, &unit);
    if (unit > 0 && isfinite(unit))
        memcpy(info->unit, "m", 2);
    else
        unit = 1;
    /* Do the labels, and all in their order, begin with the fastest axis? Then
     * the array was written by a program that counts indices as Fortran does.
     */
    char text[4];
    double code = 0;
    read_text(file, object, "dataOrder", text, sizeof text);
    bool fortran =
        *text == 'F' ||
        (snow_hdf5_numbers(object, "dataOrder", 1, &code) == 1 && code == 'F');
    for (int b = 0; b < 3; b++) {
        int label = fortran ? b : 2 - b; /* of x, y and z of the array */
        for (int a = 0; a < 3; a++)
            info->matrix[a][b] = order[label] == a ? unit * spacing[label] : 0;
    }
    for (int b = 0; b < 3; b++) {
        double first = unit * (offset[b] + position[b] * spacing[b]);
        info->matrix[order[b]][3] = isfinite(first) ? first : 0;
    }
    return true;
}

/* The state of a walk over the file's scales. */
typedef struct scales {
    snow_context *context;
    const hdf5_file *file;
    const hdf5_set *set;
    haddr_t address;    /* address of the data set */
    snow_status status; /* the walk ends if memory does */
    snow_axis_hint hints[HDF5_MOST_AXES];
    cf_axis *axes;
    char (*names)[32];
    bool is_netcdf; /* one of them is a dimension of NetCDF-4 */
} scales;

/* Reads the coordinates of a dimension scale, if it has one for each index. */
static snow_status read_scale(const scales *s, hid_t scale, hsize_t count,
                              cf_axis *out) {
    snow_context *context = s->context;
    char name[64];
    cf_attributes says;
    hdf5_set set;
    hsize_t first[HDF5_MOST_AXES] = {0}, points = 1;
    if (!snow_hdf5_describe(scale, &set))
        points = 0;
    for (int i = 0; i < set.axes && points; i++)
        points *= set.sizes[i];
    read_text(s->file, scale, "NAME", name, sizeof name);
    if (!points || points != count || points > CF_MOST_COORDINATES ||
        !strncmp(name, "This is a netCDF dimension but not", 34))
        return SNOW_STATUS_OK;
    double *values = snow_allocate_array(context, count, sizeof *values);
    if (!values)
        return SNOW_STATUS_NO_MEMORY;
    const snow_status status =
        snow_hdf5_read_box(context, s->file, scale, H5T_NATIVE_DOUBLE, set.axes,
                           first, set.sizes, values);
    if (status != SNOW_STATUS_OK) {
        snow_release(context, values);
        return snow_fail_within(context, status, "the coordinates of an axis");
    }
    snow_hdf5_attributes(s->file, scale, &says);
    /* A damaged file may list it twice. */
    snow_cf_release(context, out, 1);
    snow_cf_take_axis(context, &says, set.type, false, (int64_t)points, values,
                      out);
    return SNOW_STATUS_OK;
}

/* An entry of a scale's REFERENCE_LIST: the data set and axis that use it. */
typedef struct scale_use {
    hobj_ref_t set;
    int axis;
} scale_use;

/* What an axis is, by its scale's name in the file and its attributes. */
static snow_axis_hint hint_of(const scales *s, hid_t scale, const char *path) {
    const char *slash = strrchr(path, '/');
    cf_attributes says;
    snow_hdf5_attributes(s->file, scale, &says);
    return snow_cf_hint(slash ? slash + 1 : path, &says);
}

/* The times of a dimension without coordinates (WRF) are those of any variable
 * along it that has the unit of a date. */
static snow_status read_dates(const scales *s, hid_t scale,
                              const scale_use *uses, hssize_t count,
                              hsize_t steps, cf_axis *out) {
    snow_status status = SNOW_STATUS_OK;
    for (hssize_t i = 0;
         i < count && !out->coordinates && status == SNOW_STATUS_OK; i++) {
        char units[64] = "";
        hid_t along =
            H5Rdereference2(scale, H5P_DEFAULT, H5R_OBJECT, &uses[i].set);
        if (along >= 0 && H5Iget_type(along) == H5I_DATASET)
            read_text(s->file, along, "units", units, sizeof units);
        if (strstr(units, " since "))
            status = read_scale(s, along, steps, out);
        snow_hdf5_drop(along);
    }
    return status;
}

/* Assigns the scale to the axes of the data set that use it. */
static void use_scale(scales *s, hid_t scale, const char *path,
                      const scale_use *uses, hssize_t count) {
    for (hssize_t i = 0; i < count && s->status == SNOW_STATUS_OK; i++) {
        int from_end = s->set->axes - 1 - uses[i].axis;
        if (uses[i].set != s->address || uses[i].axis < 0 || from_end < 0)
            continue;
        const char *slash = strrchr(path, '/');
        s->hints[from_end] = hint_of(s, scale, path);
        snprintf(s->names[from_end], sizeof *s->names, "%.31s",
                 slash ? slash + 1 : path);
        s->is_netcdf |= H5Aexists(scale, "_Netcdf4Dimid") > 0;
        const hsize_t steps = s->set->sizes[uses[i].axis];
        cf_axis *axis = &s->axes[from_end];
        s->status = read_scale(s, scale, steps, axis);
        if (s->status == SNOW_STATUS_OK && s->hints[from_end].time &&
            !axis->coordinates)
            s->status = read_dates(s, scale, uses, count, steps, axis);
    }
}

/* Returns whether entries of this type are a reference and a number within
 * their size: libhdf5 converts others without checking their bounds. */
static bool is_use(hid_t type) {
    size_t size = H5Tget_size(type);
    if (H5Tget_class(type) != H5T_COMPOUND || H5Tget_nmembers(type) != 2)
        return false;
    for (unsigned i = 0; i < 2; i++) {
        hid_t member = H5Tget_member_type(type, i);
        size_t at = H5Tget_member_offset(type, i);
        bool right = member >= 0 && at <= size &&
                     H5Tget_size(member) <= size - at &&
                     H5Tget_class(member) == (i ? H5T_INTEGER : H5T_REFERENCE);
        snow_hdf5_drop(member);
        if (!right)
            return false;
    }
    return true;
}

static void read_uses(scales *s, hid_t scale, const char *path) {
    hid_t attribute = H5Aopen(scale, "REFERENCE_LIST", H5P_DEFAULT);
    if (attribute < 0)
        return;
    hid_t kind = H5Aget_type(attribute), space = H5Aget_space(attribute);
    hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(scale_use));
    H5Tinsert(type, "dataset", offsetof(scale_use, set), H5T_STD_REF_OBJ);
    H5Tinsert(type, "dimension", offsetof(scale_use, axis), H5T_NATIVE_INT);
    hssize_t count = H5Sget_simple_extent_npoints(space);
    if (is_use(kind) && count >= 1 && count <= MOST_USES) {
        scale_use *uses =
            snow_allocate_array(s->context, (uint64_t)count, sizeof *uses);
        if (!uses)
            s->status = SNOW_STATUS_NO_MEMORY;
        else if (H5Aread(attribute, type, uses) >= 0)
            use_scale(s, scale, path, uses, count);
        snow_release(s->context, uses);
    }
    H5Tclose(type);
    H5Tclose(kind);
    H5Sclose(space);
    H5Aclose(attribute);
}

static herr_t look_at_scale(hid_t file, const char *name,
                            const H5O_info_t *info, void *user) {
    scales *s = user;
    char kind[32];
    if (info->type != H5O_TYPE_DATASET)
        return 0;
    hid_t id = H5Dopen2(file, name, H5P_DEFAULT);
    if (id < 0)
        return 0;
    read_text(s->file, id, "CLASS", kind, sizeof kind);
    if (!strcmp(kind, "DIMENSION_SCALE") && H5Aexists(id, "REFERENCE_LIST") > 0)
        read_uses(s, id, name);
    H5Dclose(id);
    return s->status != SNOW_STATUS_OK;
}

/* What the labels of axes say, which h5py writes, where no scale does.  A data
 * set of that name beside the array has the coordinates. */
static snow_status read_axis_labels(scales *s) {
    char label[64], path[HDF5_NAME_BYTES + 64];
    const char *set = s->set->path;
    for (int i = 0; i < s->set->axes; i++) {
        snow_axis_hint *hint = &s->hints[s->set->axes - 1 - i];
        cf_axis *axis = &s->axes[s->set->axes - 1 - i];
        cf_attributes says;
        snow_cf_attributes_begin(&says);
        snow_hdf5_text(s->file, s->set->id, "DIMENSION_LABELS", (size_t)i,
                       label, sizeof label);
        if (!*label || axis->coordinates || hint->time || hint->space ||
            hint->components)
            continue;
        snprintf(says.axis, sizeof says.axis, "%.15s", label);
        *hint = snow_cf_hint(label, &says);
        snprintf(path, sizeof path, "%.*s%s",
                 (int)(strrchr(set, '/') - set) + 1, set, label);
        hid_t beside = strchr(label, '/')
                           ? -1
                           : H5Dopen2(snow_hdf5_id(s->file), path, H5P_DEFAULT);
        if (beside < 0)
            continue;
        *hint = hint_of(s, beside, label);
        const snow_status status =
            read_scale(s, beside, s->set->sizes[i], axis);
        H5Dclose(beside);
        SNOW_TRY(status);
    }
    return SNOW_STATUS_OK;
}

/* NetCDF-4 and h5py: axes and scales refer to each other.  The references of
 * the scales are read, because those of the axes are in the global heap, where
 * libhdf5 crashes if it is damaged. */
static snow_status read_scales(scales *s) {
    H5O_info_t about;
    if (H5Aexists(s->set->id, "DIMENSION_LIST") <= 0 ||
        H5Oget_info2(s->set->id, &about, H5O_INFO_BASIC) < 0)
        return SNOW_STATUS_OK;
    s->address = about.addr;
    SNOW_TRY(
        snow_hdf5_visit(s->context, snow_hdf5_id(s->file), look_at_scale, s));
    return s->status;
}

snow_status snow_hdf5_read_axes(snow_context *context, const hdf5_file *file,
                                const hdf5_set *set, hdf5_axes *out) {
    scales s = {.context = context,
                .file = file,
                .set = set,
                .axes = out->scales,
                .names = out->names};
    int64_t sizes[HDF5_MOST_AXES];
    memset(out, 0, sizeof *out);
    SNOW_TRY(read_scales(&s));
    out->is_netcdf = s.is_netcdf;
    SNOW_TRY(read_axis_labels(&s));
    snow_hdf5_hint_image(file, set, s.hints);
    for (int i = 0; i < HDF5_MOST_AXES; i++)
        sizes[i] = i < set->axes ? (int64_t)set->sizes[set->axes - 1 - i] : 1;
    /* HDF5's own convention for images: colours are the last axis. */
    char kind[32], colours[32], order[32];
    read_text(file, set->id, "CLASS", kind, sizeof kind);
    read_text(file, set->id, "IMAGE_SUBCLASS", colours, sizeof colours);
    read_text(file, set->id, "INTERLACE_MODE", order, sizeof order);
    out->colors = !strcmp(kind, "IMAGE") &&
                  !strcmp(colours, "IMAGE_TRUECOLOR") &&
                  (!*order || !strcmp(order, "INTERLACE_PIXEL"));
    s.hints[0].components |= out->colors;
    s.hints[0].space |= set->spatial;
    if (snow_axes_assign(set->axes, sizes, s.hints, &out->roles))
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "%.200s has more than three axes beside time and "
                     "components; write one with fewer",
                     set->path);
}

static void place_by_scales(snow_context *context, const hdf5_axes *axes,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_uneven *grid) {
    cf_axis space[3] = {{0}};
    for (int i = 0; i < 3; i++)
        if (axes->roles.space[i] >= 0)
            space[i] = axes->scales[axes->roles.space[i]];
    snow_cf_place(context, space, options, info, grid);
}

void snow_hdf5_place(snow_context *context, const hdf5_file *file,
                     const hdf5_set *set, const hdf5_axes *axes,
                     const snow_volume_options *options, snow_volume_info *info,
                     snow_uneven *grid) {
    if (place_by_size(context, set, info) ||
        place_by_mesh(file, set->id, set, info) ||
        snow_hdf5_place_image(file, set, info) ||
        snow_hdf5_place_imaris(file, set, info))
        return;
    hid_t parent = snow_hdf5_above(file, set, 1);
    bool placed = parent >= 0 && place_by_mesh(file, parent, set, info);
    snow_hdf5_drop(parent);
    if (!placed)
        place_by_scales(context, axes, options, info, grid);
}

#endif
