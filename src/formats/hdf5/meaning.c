/* formats/hdf5/meaning.c - what the values of a data set are, and when: by the
 * Climate and Forecast conventions, by openPMD, or by attributes that many
 * programs write.
 *
 *     units, unit; long_name, description; standard_name
 *     unitSI, unitDimension        openPMD, of a component and its record
 *     time, timeUnitSI             openPMD, of the iteration's group; "time"
 *                                  alone of any group above the data set */
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Reads the first of some attributes that is there. */
static void read_any(const hdf5_file *file, hid_t object,
                     const char *const *names, char *out, size_t capacity) {
    *out = 0;
    for (; *names && !*out; names++)
        snow_hdf5_text(file, object, *names, 0, out, capacity);
}

/* Opens the group `levels` above the data set; below 0: there is none. */
static hid_t open_above(const hdf5_file *file, const hdf5_set *set,
                        int levels) {
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

/* "kg m^-3" of powers of the seven base units (openPMD, unitDimension). */
static void spell_unit(const double powers[7], char *out, size_t capacity) {
    static const char *const units[] = {"m", "kg", "s", "A", "K", "mol", "cd"};
    size_t used = 0;
    *out = 0;
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

/* Values get the factor to SI, so that their unit can be named. */
static void take_si(const hdf5_file *file, const hdf5_set *set,
                    snow_volume_info *info, cf_values *values) {
    double factor, powers[7];
    if (snow_hdf5_numbers(set->id, "unitSI", 1, &factor) != 1 ||
        !isfinite(factor) || factor == 0)
        return;
    bool given = snow_hdf5_numbers(set->id, "unitDimension", 7, powers) == 7;
    hid_t record = given ? -1 : open_above(file, set, 1);
    if (record >= 0) {
        given = snow_hdf5_numbers(record, "unitDimension", 7, powers) == 7;
        H5Oclose(record);
    }
    values->scale *= factor;
    values->offset *= factor;
    if (given && !*info->value_unit)
        spell_unit(powers, info->value_unit, sizeof info->value_unit);
}

/* The time of the nearest group above that has one. */
static void take_time(const hdf5_file *file, const hdf5_set *set,
                      snow_volume_info *info) {
    static const char *const units[] = {"time_units", "time_unit", NULL};
    for (int level = 0; level < 6 && isnan(info->time_value); level++) {
        double time, factor;
        hid_t group = open_above(file, set, level);
        if (group < 0)
            return;
        if (snow_hdf5_numbers(group, "time", 1, &time) == 1 ||
            snow_hdf5_numbers(group, "Time", 1, &time) == 1) {
            info->time_value = time;
            read_any(file, group, units, info->time_unit,
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
                           snow_volume_info *info, cf_values *values) {
    static const char *const units[] = {"units", "unit", NULL};
    static const char *const names[] = {"long_name", "description", NULL};
    const char *slash = strrchr(set->path, '/');
    char unit[64], name[65], standard[64];
    read_any(file, set->id, units, unit, sizeof unit);
    read_any(file, set->id, names, name, sizeof name);
    snow_hdf5_text(file, set->id, "standard_name", 0, standard,
                   sizeof standard);
    snow_cf_name(slash ? slash + 1 : set->path, unit, name, standard, info);
    if (axes->roles.time >= 0)
        snow_cf_time(&axes->scales[axes->roles.time], info);
    take_si(file, set, info, values);
    SNOW_TRY(snow_hdf5_time_image(context, file, set, info));
    take_time(file, set, info);
    return SNOW_STATUS_OK;
}

#endif
