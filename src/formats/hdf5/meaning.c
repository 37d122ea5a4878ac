/* formats/hdf5/meaning.c - what the values of a data set are, and when: by the
 * Climate and Forecast conventions, by openPMD, or by attributes that many
 * programs write.
 *
 *     units, unit; long_name, description; standard_name
 *     unitSI, unitDimension        openPMD, of a component and its record
 *     time, timeUnitSI             openPMD, of the iteration's group; "time"
 *                                  alone of any group above the data set */
#include "formats/array.h"
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Reads an open attribute; of integers all bits. */
static void read_numbers(hid_t attribute, cf_attribute *out) {
    hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    const H5T_class_t kind = H5Tget_class(type);
    const bool plus = kind == H5T_INTEGER && H5Tget_sign(type) == H5T_SGN_NONE;
    double values[CF_MOST_NUMBERS];
    uint64_t bits[CF_MOST_NUMBERS];
    H5Tclose(type);
    H5Sclose(space);
    if (count < 1 || (kind != H5T_INTEGER && kind != H5T_FLOAT))
        return;
    if (count <= CF_MOST_NUMBERS &&
        (H5Aread(attribute, H5T_NATIVE_DOUBLE, values) < 0 ||
         (kind == H5T_INTEGER &&
          H5Aread(attribute, plus ? H5T_NATIVE_UINT64 : H5T_NATIVE_INT64,
                  bits) < 0)))
        return;
    out->count = count;
    for (hssize_t i = 0; i < count && count <= CF_MOST_NUMBERS; i++)
        out->numbers[i] = kind == H5T_INTEGER ? (cf_number){values[i], bits[i]}
                                              : snow_cf_number(values[i]);
}

bool snow_hdf5_attribute(const hdf5_file *file, hid_t object, const char *name,
                         cf_attribute *out) {
    memset(out, 0, sizeof *out);
    if (H5Aexists(object, name) <= 0)
        return false;
    if (file &&
        snow_hdf5_text(file, object, name, 0, out->text, sizeof out->text))
        return true;
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    if (attribute < 0)
        return false;
    read_numbers(attribute, out);
    H5Aclose(attribute);
    return true;
}

int snow_hdf5_numbers(hid_t object, const char *name, int most, double *out) {
    cf_attribute given;
    if (!snow_hdf5_attribute(NULL, object, name, &given) ||
        given.count > most || given.count > CF_MOST_NUMBERS)
        return 0;
    for (int64_t i = 0; i < given.count; i++)
        out[i] = given.numbers[i].value;
    return (int)given.count;
}

void snow_hdf5_attributes(const hdf5_file *file, hid_t object,
                          cf_attributes *out) {
    cf_attribute given;
    snow_cf_attributes_begin(out);
    for (const char *const *name = snow_cf_names; *name; name++)
        if (snow_hdf5_attribute(file, object, *name, &given))
            snow_cf_take(*name, &given, out);
}

/* The library of NetCDF-4 leaves marks in a file. */
static bool is_netcdf(const hdf5_file *file, const hdf5_set *set,
                      const hdf5_axes *axes) {
    bool found = axes->is_netcdf || H5Aexists(set->id, "_Netcdf4Dimid") > 0;
    hid_t root = H5Oopen(snow_hdf5_id(file), "/", H5P_DEFAULT);
    if (root >= 0) {
        found |= H5Aexists(root, "_NCProperties") > 0;
        H5Oclose(root);
    }
    return found;
}

/* Without a fill value of its own a variable is NC_NOFILL. */
static bool is_filled(hid_t set) {
    H5D_fill_value_t status = H5D_FILL_VALUE_UNDEFINED;
    hid_t plan = H5Dget_create_plist(set);
    if (plan >= 0) {
        H5Pfill_value_defined(plan, &status);
        H5Pclose(plan);
    }
    return status == H5D_FILL_VALUE_USER_DEFINED;
}

cf_values snow_hdf5_values(snow_context *context, const hdf5_file *file,
                           const hdf5_set *set, const hdf5_axes *axes,
                           const cf_attributes *says) {
    const bool netcdf = is_netcdf(file, set, axes);
    bool applies = netcdf || says->any;
    for (int i = 0; i < HDF5_MOST_AXES; i++)
        applies |= axes->scales[i].coordinates != NULL;
    return applies ? snow_cf_settle(context, says, set->type,
                                    netcdf && is_filled(set->id))
                   : snow_cf_values_default(set->type);
}

hid_t snow_hdf5_above(const hdf5_file *file, const hdf5_set *set, int levels) {
    char path[HDF5_NAME_BYTES];
    memcpy(path, set->path, sizeof path);
    for (int i = 0; i < levels; i++) {
        char *slash = strrchr(path, '/');
        if (!slash || !path[1])
            return -1;
        slash[slash == path] = 0;
    }
    return H5Oopen(snow_hdf5_id(file), path, H5P_DEFAULT);
}

/* Units with names of their own, by the powers of m, kg, s and A. */
static const char *named_unit(const double powers[7]) {
    static const struct {
        const char *name;
        signed char powers[4];
    } units[] = {
        {"T", {0, 1, -2, -1}},    {"V/m", {1, 1, -3, -1}},
        {"V", {2, 1, -3, -1}},    {"C/m^3", {-3, 0, 1, 1}},
        {"A/m^2", {-2, 0, 0, 1}}, {"C", {0, 0, 1, 1}},
        {"N", {1, 1, -2, 0}},     {"J", {2, 1, -2, 0}},
        {"Pa", {-1, 1, -2, 0}},   {"W", {2, 1, -3, 0}},
        {"W/m^2", {0, 1, -3, 0}}, {"J/m^3", {-1, 1, -2, 0}},
        {"m/s", {1, 0, -1, 0}},
    };
    if (powers[4] != 0 || powers[5] != 0 || powers[6] != 0)
        return NULL;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        bool same = true;
        for (int p = 0; p < 4; p++)
            same = same && powers[p] == units[i].powers[p];
        if (same)
            return units[i].name;
    }
    return NULL;
}

/* "T", or "kg m^-3" of powers of the seven base units (openPMD,
 * unitDimension). */
static void spell_unit(const double powers[7], char *out, size_t capacity) {
    static const char *const units[] = {"m", "kg", "s", "A", "K", "mol", "cd"};
    const char *name = named_unit(powers);
    size_t used = 0;
    *out = 0;
    if (name) {
        snprintf(out, capacity, "%s", name);
        return;
    }
    for (int i = 0; i < 14; i++) { /* what is divided by comes last */
        const double power = powers[i % 7];
        if (power == 0 || (power < 0) != (i >= 7) || used + 12 > capacity)
            continue;
        used += (size_t)snprintf(out + used, capacity - used, "%s%s",
                                 used ? " " : "", units[i % 7]);
        if (power != 1)
            used += (size_t)snow_text_print(out + used, capacity - used, "^%g",
                                            power);
    }
}

double snow_hdf5_unit(const hdf5_file *file, const hdf5_set *set,
                      snow_volume_info *info) {
    double factor, powers[7];
    if (snow_hdf5_numbers(set->id, "unitSI", 1, &factor) != 1 ||
        !isfinite(factor) || factor == 0)
        return 1;
    bool given = snow_hdf5_numbers(set->id, "unitDimension", 7, powers) == 7;
    hid_t record = given ? -1 : snow_hdf5_above(file, set, 1);
    if (record >= 0) {
        given = snow_hdf5_numbers(record, "unitDimension", 7, powers) == 7;
        H5Oclose(record);
    }
    if (given && !*info->value_unit)
        spell_unit(powers, info->value_unit, sizeof info->value_unit);
    return factor;
}

/* A component of a record of openPMD is called by both: "B x". */
static void name_component(const hdf5_file *file, const hdf5_set *set,
                           snow_volume_info *info) {
    char path[HDF5_NAME_BYTES];
    const hid_t record = snow_hdf5_above(file, set, 1);
    const bool named = record >= 0 && H5Aexists(set->id, "unitSI") > 0 &&
                       H5Aexists(set->id, "axisLabels") <= 0 &&
                       H5Aexists(record, "axisLabels") > 0;
    snow_hdf5_drop(record);
    if (!named)
        return;
    memcpy(path, set->path, sizeof path);
    char *slash = strrchr(path, '/');
    *slash = ' ';
    char *above = strrchr(path, '/');
    snow_copy_name(above ? above + 1 : path, info->quantity,
                   sizeof info->quantity);
}

void snow_hdf5_time(const hdf5_file *file, const hdf5_set *set,
                    snow_volume_info *info) {
    for (int level = 0; level < 6 && isnan(info->time_value); level++) {
        double time, factor;
        hid_t group = snow_hdf5_above(file, set, level);
        if (group < 0)
            return;
        if (snow_hdf5_numbers(group, "time", 1, &time) == 1 ||
            snow_hdf5_numbers(group, "Time", 1, &time) == 1) {
            info->time_value = time;
            if (!snow_hdf5_text(file, group, "time_units", 0, info->time_unit,
                                sizeof info->time_unit))
                snow_hdf5_text(file, group, "time_unit", 0, info->time_unit,
                               sizeof info->time_unit);
            if (snow_hdf5_numbers(group, "timeUnitSI", 1, &factor) == 1) {
                info->time_value = time * factor;
                memcpy(info->time_unit, "s", 2);
            }
        }
        H5Oclose(group);
    }
}

snow_status snow_hdf5_mean(snow_context *context, const hdf5_file *file,
                           const hdf5_set *set, const hdf5_axes *axes,
                           const cf_attributes *says, snow_volume_info *info,
                           cf_values *values) {
    const char *slash = strrchr(set->path, '/');
    snow_cf_name(slash ? slash + 1 : set->path, says, info);
    if (axes->roles.time >= 0)
        snow_cf_time(&axes->scales[axes->roles.time], info);
    name_component(file, set, info);
    /* Values get the factor to SI, so that their unit can be named. */
    const double factor = snow_hdf5_unit(file, set, info);
    values->scale *= factor;
    values->offset *= factor;
    SNOW_TRY(snow_hdf5_time_image(context, file, set, info));
    snow_hdf5_time(file, set, info);
    return SNOW_STATUS_OK;
}

#endif
