/* world.c - units of the world's axes (world.h). */
#include "commands/world.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *world_unit(const snow_volume_info *info, int axis) {
    const char *own = info->axis_unit[axis];
    return !*own ? info->unit : strcmp(own, "1") == 0 ? "" : own;
}

void world_units(const snow_volume_info *info, char *out, size_t size) {
    bool same = true;
    for (int i = 0; i < 3; i++)
        same = same && !*info->axis_unit[i];
    if (same) {
        snprintf(out, size, "%s%s", *info->unit ? " " : "", info->unit);
        return;
    }
    *out = 0;
    for (int i = 0; i < 3; i++) {
        const char *unit = world_unit(info, i);
        const size_t used = strlen(out);
        snprintf(out + used, size - used, "%s%s", i ? ", " : " ",
                 *unit ? unit : "none");
    }
}

double world_length(const snow_volume_info *info, int axis) {
    const double scale = info->axis_scale[axis];
    return fabs(scale) > 0 ? scale : 1;
}

/* Pascals in a unit of pressure; 0: it is none. */
static double pascals(const char *unit) {
    static const struct {
        const char *name;
        double pascals;
    } units[] = {{"Pa", 1},       {"hPa", 100},       {"kPa", 1000},
                 {"mb", 100},     {"mbar", 100},      {"millibar", 100},
                 {"bar", 1e5},    {"millibars", 100}, {"dbar", 1e4},
                 {"decibar", 1e4}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcmp(unit, units[i].name) == 0)
            return units[i].pascals;
    return 0;
}

double world_ratio(const snow_volume_info *info, int axis, const char *unit) {
    const char *own = world_unit(info, axis);
    const double length = snow_unit_length(own, NULL), pressure = pascals(own);
    if (strcmp(unit, own) == 0 || (!*own && strcmp(unit, "mm") == 0))
        return *unit ? 1 : 0;
    return length > 0     ? snow_unit_length(unit, NULL) / length
           : pressure > 0 ? pascals(unit) / pressure
                          : 0;
}

/* Without what was rounded to the world and back. */
static double plain(double value) {
    char text[32];
    snprintf(text, sizeof text, "%.14g", value);
    return strtod(text, NULL);
}

snow_volume_info world_in_units(const snow_volume_info *info) {
    snow_volume_info own = *info;
    const double *scale = info->axis_scale;
    if (!(fabs(scale[0]) + fabs(scale[1]) + fabs(scale[2]) > 0))
        return own;
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 3; i++)
            own.matrix[i][j] =
                plain(own.matrix[i][j] / fabs(world_length(info, i)));
    for (int j = 0; j < 3; j++)
        own.spacing[j] =
            hypot(hypot(own.matrix[0][j], own.matrix[1][j]), own.matrix[2][j]);
    return own;
}
