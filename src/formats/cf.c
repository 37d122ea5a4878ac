/* formats/cf.c - coordinates and missing values by the Climate and Forecast
 * conventions (cf.h). */
#include "formats/cf.h"
#include "formats/array.h"

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
    for (int i = 0; i < 3; i++) {
        grid.at[i] = axes[i].uneven ? axes[i].coordinates : NULL;
        grid.moved[i] = axes[i].uneven ? axes[i].moved : NULL;
    }
    if (snow_uneven_any(&grid)) {
        const char *const units[3] = {axes[0].unit, axes[1].unit, axes[2].unit};
        snow_uneven_plan(context, &grid, units, info);
        memcpy(info->dims, grid.even, sizeof grid.even);
    }
    return grid;
}

/* How many units of x one of an axis is.  An axis with another unit, or with
 * none beside one, cannot be compared with x: a month is not longer than a
 * degree.  It is as long as if its voxels in the file had the mean distance of
 * x; but a degree of the earth has a length. */
static double ratio_of(const cf_axis *x, const cf_axis *axis, bool *same) {
    const double usual = x->given ? fabs(x->step) : 1,
                 length = snow_unit_length(axis->unit, NULL),
                 lengths = snow_unit_length(x->unit, NULL);
    *same = axis->given && !strcmp(axis->unit, x->unit);
    if (*same)
        return 1;
    *same = axis->given && length > 0 && lengths > 0;
    if (*same)
        return length / lengths;
    if (axis->given && length > 0 && !strcmp(x->unit, "degrees"))
        return length / (SNOW_DEGREE * snow_unit_length("m", NULL));
    return usual / (axis->given ? fabs(axis->step) : 1);
}

/* Sets what the world's length of a unit of an axis is. */
static void scale_axis(const cf_axis *axis, int i, double ratio, bool same,
                       snow_volume_info *info) {
    const double scale = same || !axis->given ? 1 : ratio;
    info->axis_scale[i] = axis->down ? -scale : scale;
    if (!same)
        snprintf(info->axis_unit[i], sizeof info->axis_unit[i], "%.15s",
                 *axis->unit ? axis->unit : "1");
}

static void place_axis(snow_context *context, const cf_axis axes[3], int i,
                       const snow_uneven *grid, bool given,
                       snow_volume_info *info) {
    const cf_axis *axis = &axes[i];
    bool same;
    const double ratio = ratio_of(&axes[0], axis, &same);
    const double up = axis->down ? -1 : 1,
                 usual = axes[0].given ? fabs(axes[0].step) : 1;
    info->matrix[i][i] = axis->given ? up * ratio * axis->step : ratio;
    info->matrix[i][3] = axis->given ? up * ratio * axis->first : 0;
    if (!same && given) {
        info->matrix[i][i] = copysign(usual, info->matrix[i][i]);
        info->matrix[i][3] = 0;
    } else if (info->dims[i] > 1 || axis->given) {
        scale_axis(axis, i, ratio, same, info);
    }
    if (grid->at[i])
        info->matrix[i][i] *=
            (double)(grid->count[i] - 1) / (double)(grid->even[i] - 1);
    if (axis->given && !axis->even && !grid->at[i] && !given)
        snow_notify(context,
                    "coordinates along %c neither rise nor fall throughout; "
                    "their mean distance, %g, is used",
                    "xyz"[i], axis -> step);
    if (axis->even && axis->departs > EVEN && !given)
        snow_notify(context,
                    "coordinates along %c depart from even ones by %.2g %% of "
                    "a step at most; even ones are used",
                    "xyz"[i], 100 * axis -> departs);
}

/* A grid of the earth is flat: where x and y are in degrees and z is not, it
 * gets a third of their shorter side in height. */
static void make_higher(snow_context *context,
                        const snow_volume_options *options,
                        snow_volume_info *info) {
    double side[3];
    for (int i = 0; i < 3; i++)
        side[i] = fabs(info->matrix[i][i]) * (double)(info->dims[i] - 1);
    const double shorter = fmin(side[0], side[1]);
    if (!*info->axis_unit[2])
        return;
    if (!(options->z_scale > 0) && !*info->axis_unit[1] && side[2] > 0 &&
        shorter > 0 && !strcmp(info->unit, "degrees"))
        snow_volume_stretch(info, shorter / 3 / side[2]);
    if (info->dims[2] > 1)
        snow_notify(context,
                    "z has another unit (\"%s\") than x (\"%s\"): it keeps its "
                    "coordinates; --z-scale sets the height in pictures",
                    !strcmp(info->axis_unit[2], "1") ? "" : info->axis_unit[2],
                    info->unit);
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
    make_higher(context, options, info);
}

void snow_cf_time(const cf_axis *axis, snow_volume_info *info) {
    if (!axis->coordinates)
        return;
    info->time_value = axis->coordinates[info->time];
    memcpy(info->time_unit, axis->unit, sizeof info->time_unit);
    memcpy(info->calendar, axis->calendar, sizeof info->calendar);
}

void snow_cf_name(const char *name, const cf_attributes *says,
                  snow_volume_info *info) {
    snow_copy_name(name, info->quantity, sizeof info->quantity);
    snow_copy_name(says->units, info->value_unit, sizeof info->value_unit);
    snow_copy_name(*says->long_name ? says->long_name : says->standard_name,
                   info->description, sizeof info->description);
}
