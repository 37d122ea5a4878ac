/* formats/cf.c - coordinates and missing values by the Climate and Forecast
 * conventions (cf.h). */
#include "formats/cf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Coordinates are often written as floats: they may lie this share of a step
 * away from where even ones do.  With a note they may do so by more, as
 * Gaussian latitudes do. */
#define EVEN 1e-3
#define NEARLY_EVEN 0.05

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

static bool is_any_of(const char *text, const char *const *list) {
    for (; *list; list++)
        if (snow_same_name(text, *list))
            return true;
    return false;
}

snow_axis_hint snow_cf_hint(const char *name, const cf_attributes *says) {
    static const char *const spaces[] = {"x", "y", "z", NULL};
    static const char *const lines[] = {"x", "lon", "longitude", "rlon", NULL};
    static const char *const times[] = {
        "s",    "sec",   "secs",   "second", "seconds", "ms",    "us",
        "ns",   "ps",    "fs",     "min",    "minute",  "mins",  "minutes",
        "h",    "hr",    "hrs",    "hour",   "hours",   "d",     "day",
        "days", "month", "months", "yr",     "year",    "years", NULL};
    static const char *const parts[] = {"component", "components", "vector",
                                        NULL};
    const char *units = says ? says->units : "";
    const char *axis = says ? says->axis : "";
    const char *standard = says ? says->standard_name : "";
    snow_axis_hint hint = {0};
    bool in_space = is_any_of(axis, spaces);
    hint.time = snow_same_name(axis, "t") ||
                (!in_space &&
                 (snow_same_name(standard, "time") ||
                  strstr(units, " since ") || snow_same_name(name, "time")));
    hint.components = !in_space && is_any_of(name, parts);
    hint.duration = !in_space && is_any_of(units, times);
    hint.space = in_space || is_any_of(name, lines) ||
                 (*units && !snow_same_name(units, "1"));
    return hint;
}

/* Longitudes may go on from 355 with 0, or from 180 with -175: once. */
static void unwrap(double *coordinates, int64_t count,
                   const cf_attributes *says) {
    int64_t at = 0, jumps = 0;
    const bool angles = !strncmp(says->units, "degree", 6) ||
                        !strcmp(says->standard_name, "longitude");
    for (int64_t i = 1; i < count && angles; i++)
        if (fabs(coordinates[i] - coordinates[i - 1]) > 180) {
            at = i;
            jumps++;
        }
    if (jumps != 1 || count < 3)
        return;
    const double turn = coordinates[at] < coordinates[at - 1] ? 360 : -360;
    for (int64_t i = at; i < count; i++)
        coordinates[i] += turn;
}

/* Coordinates grow downward (section 4.3) by their attribute positive, or where
 * that is "", by a unit of pressure. */
static bool is_down(const cf_attributes *says) {
    static const char *const pressures[] = {
        "Pa",       "hPa",       "kPa",     "bar",  "mbar", "mb",
        "millibar", "millibars", "decibar", "dbar", "atm",  NULL};
    return *says->positive ? snow_same_name(says->positive, "down")
                           : is_any_of(says->units, pressures);
}

/* How far coordinates are at most from even ones: a share of the shorter step
 * beside them. */
static double departure(const double *at, int64_t count, double first,
                        double step) {
    double most = 0;
    for (int64_t i = 0; i < count; i++) {
        const double before = i ? fabs(at[i] - at[i - 1]) : INFINITY,
                     behind =
                         i < count - 1 ? fabs(at[i + 1] - at[i]) : INFINITY,
                     away = fabs(at[i] - first - step * (double)i);
        most = fmax(most, away > 0 ? away / fmin(before, behind) : 0);
        if (!isfinite(away))
            return INFINITY;
    }
    return most;
}

/* Fits a line to the coordinates, by least squares. */
static void fit(const double *at, int64_t count, double *first, double *step) {
    const double middle = (double)(count - 1) / 2;
    double sum = 0, moment = 0, square = 0;
    for (int64_t i = 0; i < count; i++) {
        const double from = (double)i - middle;
        sum += at[i] - at[0];
        moment += from * (at[i] - at[0]);
        square += from * from;
    }
    *step = moment / square;
    *first = at[0] + sum / (double)count - *step * middle;
}

void snow_cf_measure(double *coordinates, int64_t count,
                     const cf_attributes *says, cf_axis *out) {
    *out = (cf_axis){.even = true, .coordinates = coordinates};
    unwrap(coordinates, count, says);
    double first = coordinates[0], last = coordinates[count - 1];
    double step = count > 1 ? (last - first) / (double)(count - 1) : 0;
    take_unit(says->units, out->unit);
    memcpy(out->calendar, says->calendar, sizeof out->calendar);
    out->down = is_down(says);
    if (!isfinite(first) || !isfinite(step) || step == 0)
        return;
    out->given = true;
    out->departs = departure(coordinates, count, first, step);
    if (out->departs > EVEN) {
        double nearly[2];
        fit(coordinates, count, &nearly[0], &nearly[1]);
        out->departs = departure(coordinates, count, nearly[0], nearly[1]);
        out->even = out->departs <= NEARLY_EVEN;
        first = out->even ? nearly[0] : first;
        step = out->even ? nearly[1] : step;
    }
    out->first = first;
    out->step = step;
    out->uneven = !out->even && snow_uneven_fits(coordinates, count);
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
    if (axis->even && axis->departs > EVEN && !given)
        snow_notify(context,
                    "coordinates along %c depart from even ones by %.2g %% of "
                    "a step at most; even ones are used",
                    "xyz"[i], 100 * axis -> departs);
    if (axis->given && !same && info->dims[i] > 1 && !given)
        snow_notify(context,
                    "%c has another unit than x (\"%s\"); the spacing of x "
                    "is used for it, --spacing sets another",
                    "xyz"[i], axis -> unit);
}

void snow_cf_place(snow_context *context, const cf_axis axes[3],
                   const snow_volume_options *options, snow_volume_info *info,
                   snow_uneven *grid) {
    if (!axes[0].given && !axes[1].given && !axes[2].given)
        return;
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

/* Copies a text to a room, of which a longer one fills all. */
static void keep(const char *text, char *to, size_t capacity) {
    snprintf(to, capacity, "%.*s", (int)capacity - 1, text);
}

void snow_cf_name(const char *name, const cf_attributes *says,
                  snow_volume_info *info) {
    keep(name, info->quantity, sizeof info->quantity);
    keep(says->units, info->value_unit, sizeof info->value_unit);
    keep(*says->long_name ? says->long_name : says->standard_name,
         info->description, sizeof info->description);
}
