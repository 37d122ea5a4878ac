/* formats/cf.c - coordinates and missing values by the Climate and Forecast
 * conventions (cf.h). */
#include "formats/cf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Coordinates are often written as floats: steps may differ by this share. */
#define EVEN 1e-3

cf_values snow_cf_values_default(void) {
    return (cf_values){.scale = 1};
}

/* Lengths get their usual names; degrees east and degrees north are one unit
 * here; others stay. */
static void take_unit(const char *text, char unit[64]) {
    char name[16];
    if (snow_unit_length(text, name) > 0)
        text = name;
    else if (!strncmp(text, "degree", 6))
        text = "degrees";
    size_t length = strlen(text) < 64 ? strlen(text) : 63;
    memcpy(unit, text, length);
    unit[length] = 0;
}

static bool is_same(const char *a, const char *b) {
    for (; *a && *b; a++, b++)
        if ((*a | 32) != (*b | 32))
            return false;
    return *a == *b;
}

static bool is_any_of(const char *text, const char *const *list) {
    for (; *list; list++)
        if (is_same(text, *list))
            return true;
    return false;
}

snow_axis_hint snow_cf_hint(const cf_words *words) {
    static const char *const spaces[] = {"x", "y", "z", NULL};
    static const char *const lines[] = {"x", "lon", "longitude", "rlon", NULL};
    static const char *const times[] = {
        "s",    "sec",   "secs",   "second", "seconds", "ms",    "us",
        "ns",   "ps",    "fs",     "min",    "minute",  "mins",  "minutes",
        "h",    "hr",    "hrs",    "hour",   "hours",   "d",     "day",
        "days", "month", "months", "yr",     "year",    "years", NULL};
    static const char *const parts[] = {"component", "components", "vector",
                                        NULL};
    snow_axis_hint hint = {0};
    bool in_space = is_any_of(words->axis, spaces);
    hint.time = is_same(words->axis, "t") ||
                (!in_space && (is_same(words->standard_name, "time") ||
                               strstr(words->units, " since ") ||
                               is_same(words->name, "time")));
    hint.components = !in_space && is_any_of(words->name, parts);
    hint.duration = !in_space && is_any_of(words->units, times);
    hint.space = in_space || is_any_of(words->name, lines) ||
                 (*words->units && !is_same(words->units, "1"));
    return hint;
}

void snow_cf_measure(double *coordinates, int64_t count, const char *units,
                     cf_axis *out) {
    *out = (cf_axis){.even = true, .coordinates = coordinates};
    double first = coordinates[0], last = coordinates[count - 1];
    double step = count > 1 ? (last - first) / (double)(count - 1) : 0;
    take_unit(units, out->unit);
    if (!isfinite(first) || !isfinite(step) || step == 0)
        return;
    out->given = true;
    out->first = first;
    out->step = step;
    for (int64_t i = 1; i < count; i++) {
        double gap = coordinates[i] - coordinates[i - 1];
        if (!(fabs(gap - step) <= EVEN * fabs(step)))
            out->even = false;
    }
    out->uneven = !out->even && snow_uneven_fits(coordinates, count);
}

bool snow_cf_is_down(const char *positive, const char *units) {
    static const char *const pressures[] = {
        "Pa",       "hPa",       "kPa",     "bar",  "mbar", "mb",
        "millibar", "millibars", "decibar", "dbar", "atm",  NULL};
    return *positive ? is_same(positive, "down") : is_any_of(units, pressures);
}

void snow_cf_release(snow_context *context, cf_axis *axes, int count) {
    for (int i = 0; i < count; i++)
        snow_release(context, axes[i].coordinates);
}

static snow_uneven plan_grid(snow_context *context, const cf_axis axes[3],
                             snow_volume_info *info) {
    snow_uneven grid = {.count = {1, 1, 1}};
    memcpy(grid.count, info->dims, sizeof grid.count);
    for (int i = 0; i < 3; i++)
        grid.at[i] = axes[i].uneven ? axes[i].coordinates : NULL;
    if (snow_uneven_any(&grid)) {
        snow_uneven_plan(context, &grid, info);
        memcpy(info->dims, grid.even, sizeof grid.even);
    }
    return grid;
}

/* Other lengths become the unit of x.  An axis with another unit, or with none
 * beside one, cannot be compared with x: a month is not longer than a degree.
 * It is as long as if its voxels in the file had the mean distance of x. */
static void place_axis(snow_context *context, const cf_axis axes[3], int i,
                       const snow_uneven *grid, bool given,
                       snow_volume_info *info) {
    const cf_axis *x = &axes[0], *axis = &axes[i];
    double usual = x->given ? fabs(x->step) : 1;
    /* How many units of x one is; 0 if they cannot be compared. */
    const double times = !axis->given                   ? 0
                         : !strcmp(axis->unit, x->unit) ? 1
                         : snow_unit_length(x->unit, NULL) > 0
                             ? snow_unit_length(axis->unit, NULL) /
                                   snow_unit_length(x->unit, NULL)
                             : 0;
    const bool same = times > 0;
    const double up = axis->down ? -1 : 1;
    info->matrix[i][i] =
        up * (same ? times * axis->step : copysign(usual, axis->step));
    info->matrix[i][3] = same ? up * times * axis->first : 0;
    if (grid->at[i])
        info->matrix[i][i] *=
            (double)(grid->count[i] - 1) / (double)(grid->even[i] - 1);
    if (same && !axis->even && !grid->at[i] && !given)
        snow_notify(context,
                    "coordinates along %c neither rise nor fall throughout; "
                    "their mean distance, %g, is used",
                    "xyz"[i], axis -> step);
    if (axis->given && !same && info->dims[i] > 1 && !given)
        snow_notify(context,
                    "%c has another unit than x (\"%s\"); the spacing of x "
                    "is used for it, --spacing sets another",
                    "xyz"[i], axis -> unit);
}

void snow_cf_place(snow_context *context, const cf_axis axes[3],
                   const snow_volume_options *options, snow_volume_info *info,
                   snow_uneven *grid) {
    bool given = snow_spacing_given(options);
    const cf_axis *x = &axes[0];
    *grid = plan_grid(context, axes, info);
    for (int i = 0; i < 3; i++)
        place_axis(context, axes, i, grid, given, info);
    if (x->given && strlen(x->unit) < sizeof info->unit)
        memcpy(info->unit, x->unit, strlen(x->unit) + 1);
}

void snow_cf_time(const cf_axis *axis, snow_volume_info *info) {
    if (!axis->coordinates)
        return;
    info->time_value = axis->coordinates[info->time];
    memcpy(info->time_unit, axis->unit, sizeof info->time_unit);
    memcpy(info->calendar, axis->calendar, sizeof info->calendar);
}

void snow_cf_name(const char *name, const char *units, const char *long_name,
                  const char *standard_name, snow_volume_info *info) {
    snprintf(info->quantity, sizeof info->quantity, "%s", name);
    snprintf(info->value_unit, sizeof info->value_unit, "%s", units);
    snprintf(info->description, sizeof info->description, "%s",
             *long_name ? long_name : standard_name);
}

static snow_type float_type(snow_type type) {
    switch (type) {
    case SNOW_TYPE_INT8:
    case SNOW_TYPE_UINT8:
    case SNOW_TYPE_INT16:
    case SNOW_TYPE_UINT16:
        return SNOW_TYPE_FLOAT32;
    case SNOW_TYPE_INT32:
    case SNOW_TYPE_UINT32:
        return SNOW_TYPE_FLOAT64;
    default:
        return type;
    }
}

void snow_cf_apply(const cf_values *values, snow_volume_info *info) {
    if (values->fills)
        info->type = float_type(info->type);
    info->slope = values->scale;
    info->intercept = values->offset;
}

/* Floats are compared as they were rounded: a fill value of 1e20 differs from
 * its float. */
static void blank(const cf_values *values, const snow_volume *from,
                  snow_volume *to) {
    const int64_t *dims = to->info.dims;
    cf_values narrow = *values;
    for (int i = 0; i < narrow.fills && from->info.type == SNOW_TYPE_FLOAT32;
         i++)
        narrow.fill[i] = (double)(float)narrow.fill[i];
    for (int64_t i = 0; i < dims[0] * dims[1] * dims[2]; i++) {
        double value = snow_volume_native(from, i);
        bool fill = false;
        for (int n = 0; n < narrow.fills && !fill; n++)
            fill = value == narrow.fill[n];
        if (fill)
            value = NAN;
        if (!fill && to == from)
            continue;
        if (to->info.type == SNOW_TYPE_FLOAT32)
            ((float *)to->owned)[i] = (float)value;
        else
            ((double *)to->owned)[i] = value;
    }
}

snow_status snow_cf_blank(const cf_values *values, snow_volume **volume) {
    snow_volume *old = *volume, *made = old;
    snow_volume_info info = old->info;
    if (!values->fills)
        return SNOW_STATUS_OK;
    info.type = float_type(info.type);
    if (info.type != SNOW_TYPE_FLOAT32 && info.type != SNOW_TYPE_FLOAT64) {
        snow_notify(old->context, "missing values are kept as they are: no "
                                  "type holds both NaN and 64-bit integers");
        return SNOW_STATUS_OK;
    }
    if (info.type != old->info.type) {
        snow_status status = snow_volume_new(old->context, &info, &made);
        if (status != SNOW_STATUS_OK) {
            snow_volume_close(old);
            *volume = NULL;
            return status;
        }
    }
    blank(values, old, made);
    if (made != old)
        snow_volume_close(old);
    *volume = made;
    return SNOW_STATUS_OK;
}
