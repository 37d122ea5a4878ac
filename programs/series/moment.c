/* moment.c - implements moment.h, by the library alone. */
#include "series/moment.h"

#include <math.h>
#include <snowglass/extend.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Up to so many steps all are looked at; of more, which rise, few. */
#define STEPS_ALL 256

/* Steps that have a time each. */
typedef struct step_times {
    snow_context *context;
    const moment *wanted;
    moment_step_fn *read;
    void *user;
    int64_t count;
    snow_volume_info at; /* of the step looked at last */
} step_times;

bool moment_read(const char *text, moment *out) {
    char *end;
    int year, month, day;
    *out = (moment){.value = NAN};
    if (sscanf(text, "%8d-%2d-%2d", &year, &month, &day) == 3) {
        *out = (moment){.date = text};
        return true;
    }
    double value = strtod(text, &end);
    bool point = memchr(text, '.', (size_t)(end - text)) != NULL;
    end += strspn(end, " ");
    size_t letters = strspn(end, "abcdefghijklmnopqrstuvwxyz");
    if (end == text || !isfinite(value) || end[letters] ||
        letters >= sizeof out->unit || (!letters && !point))
        return false;
    out->value = value;
    memcpy(out->unit, end, letters + 1);
    return true;
}

/* Seconds of a unit, whose first word counts: "hours since 2000-01-01"; 0: it
 * is not known. */
static double seconds_of(const char *unit) {
    static const struct {
        const char *words;
        double seconds;
    } units[] = {{" fs ", 1e-15},
                 {" ps ", 1e-12},
                 {" ns ", 1e-9},
                 {" us ", 1e-6},
                 {" ms msec ", 1e-3},
                 {" s sec secs second seconds ", 1},
                 {" min mins minute minutes ", 60},
                 {" h hr hrs hour hours ", 3600},
                 {" d day days ", 86400},
                 {" yr year years ", 365.25 * 86400}};
    char word[24];
    int length = (int)strcspn(unit, " ");
    if (!length || length > 20)
        return 0;
    snprintf(word, sizeof word, " %.*s ", length, unit);
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strstr(units[i].words, word))
            return units[i].seconds;
    return 0;
}

/* The wanted time in the unit of a step; false: it has none there. */
static bool value_at(const moment *wanted, const snow_volume_info *at,
                     double *out) {
    const char *unit = at->time_unit;
    if (wanted->date)
        return snow_time_value(at, wanted->date, out);
    double given = seconds_of(wanted->unit), own = seconds_of(unit);
    *out = wanted->value;
    if (!*wanted->unit || !*unit)
        return true;
    *out *= given / own;
    return given > 0 && own > 0;
}

static snow_status refuse(const step_times *times) {
    const moment *wanted = times->wanted;
    const char *unit = times->at.time_unit, *calendar = times->at.calendar;
    if (!wanted->date)
        return snow_context_fail(
            times->context, SNOW_STATUS_BAD_USAGE,
            "--time: the unit \"%s\" cannot be compared with the input's "
            "\"%s\"; give the number of a step",
            wanted->unit, unit);
    return snow_context_fail(
        times->context, SNOW_STATUS_BAD_USAGE,
        "--time: %.64s is not a date of the input, whose times are in "
        "\"%s\"%s%s%s; give a date such as 2005-08-28 06:00, or the number of "
        "a step",
        wanted->date, unit, *calendar ? " (calendar " : "", calendar,
        *calendar ? ")" : "");
}

static snow_status read_step(step_times *times, int64_t step) {
    const snow_status status = times->read(times->user, step, &times->at);
    if (status != SNOW_STATUS_OK || !isnan(times->at.time_value))
        return status;
    return snow_context_fail(times->context, SNOW_STATUS_BAD_USAGE,
                             "--time: the input has no physical times; give "
                             "the number of a step, from 0");
}

/* How far the time of a step is behind the wanted one, in seconds, or in the
 * unit of the input where that is not known.  Each file may count from a date
 * of its own. */
static snow_status distance_of(step_times *times, int64_t step, double *out) {
    double wanted;
    const snow_status status = read_step(times, step);
    if (status != SNOW_STATUS_OK)
        return status;
    if (!value_at(times->wanted, &times->at, &wanted))
        return refuse(times);
    const double unit = seconds_of(times->at.time_unit);
    *out = (times->at.time_value - wanted) * (unit > 0 ? unit : 1);
    return SNOW_STATUS_OK;
}

static snow_status nearest_of_all(step_times *times, int64_t *out) {
    double best = INFINITY, distance;
    for (int64_t i = 0; i < times->count; i++) {
        const snow_status status = distance_of(times, i, &distance);
        if (status != SNOW_STATUS_OK)
            return status;
        if (fabs(distance) < best) {
            best = fabs(distance);
            *out = i;
        }
    }
    return SNOW_STATUS_OK;
}

/* Halves the steps, whose times rise. */
static snow_status nearest_of_rising(step_times *times, int64_t *out) {
    int64_t low = 0, high = times->count - 1;
    double ends[2], distance;
    snow_status status = distance_of(times, low, &ends[0]);
    if (status == SNOW_STATUS_OK)
        status = distance_of(times, high, &ends[1]);
    while (status == SNOW_STATUS_OK && high - low > 1) {
        int64_t middle = low + (high - low) / 2;
        status = distance_of(times, middle, &distance);
        if (distance > 0) {
            high = middle;
            ends[1] = distance;
        } else {
            low = middle;
            ends[0] = distance;
        }
    }
    if (status == SNOW_STATUS_OK)
        *out = fabs(ends[0]) <= fabs(ends[1]) ? low : high;
    return status;
}

snow_status moment_find(snow_context *context, const moment *wanted,
                        int64_t count, moment_step_fn *read, void *user,
                        int64_t *step, snow_volume_info *at) {
    step_times times = {.context = context,
                        .wanted = wanted,
                        .read = read,
                        .user = user,
                        .count = count};
    snow_status status = count <= STEPS_ALL ? nearest_of_all(&times, step)
                                            : nearest_of_rising(&times, step);
    if (status == SNOW_STATUS_OK)
        status = read_step(&times, *step);
    if (status == SNOW_STATUS_OK)
        *at = times.at;
    return status;
}

bool moment_is_at(const moment *wanted, const snow_volume_info *at) {
    snow_volume_info asked = *at;
    char texts[2][128];
    return value_at(wanted, at, &asked.time_value) &&
           snow_time_text(at, NULL, texts[0], sizeof texts[0]) &&
           snow_time_text(&asked, NULL, texts[1], sizeof texts[1]) &&
           strcmp(texts[0], texts[1]) == 0;
}
