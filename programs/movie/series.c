/* series.c - implements series.h. */
#include "movie/series.h"
#include "commands/commands.h"
#include "movie/movie_files.h"
#include "run/log.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Up to so many steps all are looked at; of more, which rise, few. */
#define STEPS_ALL 256

/* Steps that have a time each: of files, or of one file. */
typedef struct step_times {
    snow_context *context;
    const options *opts;
    const step_files *files; /* NULL: the steps of `path` */
    const char *path;
    int64_t count;
    snow_volume_info at; /* of the step looked at last */
} step_times;

/* Reads the time of a step from its header. */
static int time_of(step_times *times, int64_t step, double *out) {
    snow_volume_options data = data_options(times->opts);
    snow_volume_info info = {.size = sizeof info};
    data.time = !times->files         ? step
                : times->files->times ? times->files->times[step]
                                      : 0;
    data.each_time = true;
    snow_status status = snow_volume_inspect(
        times->context, times->files ? times->files->paths[step] : times->path,
        &data, &info);
    if (status != SNOW_STATUS_OK)
        return fail_status(times->context, status);
    *out = info.time_value;
    times->at = info;
    return isnan(*out) ? fail_usage("--time: the input has no physical times; "
                                    "give the number of a step, from 0")
                       : CONTINUE;
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

/* The wanted time in the unit of the input. */
static int wanted_time(const step_times *times, double *out) {
    const options *opts = times->opts;
    const char *unit = times->at.time_unit;
    if (opts->date)
        return snow_time_value(&times->at, opts->date, out)
                   ? CONTINUE
                   : fail_usage(
                         "--time: %s is not a date of the input, whose "
                         "times are in \"%s\"%s%s%s; give a date such as "
                         "2005-08-28 06:00, or the number of a step",
                         opts->date, unit,
                         *times->at.calendar ? " (calendar " : "",
                         times->at.calendar, *times->at.calendar ? ")" : "");
    double given = seconds_of(opts->moment_unit), own = seconds_of(unit);
    *out = opts->moment;
    if (!*opts->moment_unit || !*unit)
        return CONTINUE;
    if (given == 0 || own == 0)
        return fail_usage("--time: the unit \"%s\" cannot be compared with "
                          "the input's \"%s\"; give the number of a step",
                          opts->moment_unit, unit);
    *out *= given / own;
    return CONTINUE;
}

/* How far the time of a step is behind the wanted one, in seconds, or in the
 * unit of the input where that is not known.  Each file may count from a date
 * of its own. */
static int distance_of(step_times *times, int64_t step, double *out) {
    double time, wanted;
    int done = time_of(times, step, &time);
    if (done == CONTINUE)
        done = wanted_time(times, &wanted);
    if (done != CONTINUE)
        return done;
    const double unit = seconds_of(times->at.time_unit);
    *out = (time - wanted) * (unit > 0 ? unit : 1);
    return CONTINUE;
}

static int nearest_of_all(step_times *times, int64_t *out) {
    double best = INFINITY, distance;
    for (int64_t i = 0; i < times->count; i++) {
        int done = distance_of(times, i, &distance);
        if (done != CONTINUE)
            return done;
        if (fabs(distance) < best) {
            best = fabs(distance);
            *out = i;
        }
    }
    return CONTINUE;
}

/* Halves the steps, whose times rise. */
static int nearest_of_rising(step_times *times, int64_t *out) {
    int64_t low = 0, high = times->count - 1;
    double ends[2], distance;
    int done = distance_of(times, low, &ends[0]);
    if (done == CONTINUE)
        done = distance_of(times, high, &ends[1]);
    while (done == CONTINUE && high - low > 1) {
        int64_t middle = low + (high - low) / 2;
        done = distance_of(times, middle, &distance);
        if (distance > 0) {
            high = middle;
            ends[1] = distance;
        } else {
            low = middle;
            ends[0] = distance;
        }
    }
    if (done == CONTINUE)
        *out = fabs(ends[0]) <= fabs(ends[1]) ? low : high;
    return done;
}

static int nearest(step_times *times, int64_t *out) {
    char text[128] = "";
    double time;
    int done = times->count <= STEPS_ALL ? nearest_of_all(times, out)
                                         : nearest_of_rising(times, out);
    if (done == CONTINUE)
        done = time_of(times, *out, &time);
    if (done == CONTINUE && times->opts->verbosity >= 0 &&
        snow_time_text(&times->at, NULL, text, sizeof text))
        say("step %" PRId64 " of %" PRId64 " is the nearest, at %s", *out,
            times->count, text);
    return done;
}

/* The step of a file with several. */
static int take_moment(options *opts, snow_context *context) {
    step_times times = {
        .context = context, .opts = opts, .path = opts->operands[0]};
    snow_volume_options data = data_options(opts);
    snow_volume_info info = {.size = sizeof info};
    data.each_time = true;
    snow_status status = snow_volume_inspect(context, times.path, &data, &info);
    if (status != SNOW_STATUS_OK)
        return fail_status(context, status);
    times.count = info.times;
    return nearest(&times, &opts->time);
}

/* Whether files of a pattern are the slices of one volume. */
static bool are_slices(snow_context *context, const options *opts,
                       const char *path) {
    static const char *const formats[] = {"tiff", "png", "jpeg", "dicom"};
    snow_volume_options data = data_options(opts);
    snow_volume_info info = {.size = sizeof info};
    data.time = 0;
    data.mask = data.labels = NULL; /* as the box: of all slices together */
    memset(data.crop, 0, sizeof data.crop);
    if (snow_volume_inspect(context, path, &data, &info) != SNOW_STATUS_OK ||
        info.dims[2] > 1 || info.times > 1)
        return false;
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (strcmp(info.format, formats[i]) == 0)
            return true;
    return false;
}

/* The operand from now on, as printf makes it. */
SNOW_PRINTF(2, 3)
static int take_input(options *opts, const char *format, ...) {
    static char name[2 * PATH_MAX];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(name, sizeof name, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length >= sizeof name)
        return fail_usage("%s: is too long a name; use a shorter one",
                          opts->operands[0]);
    opts->input[0] = name;
    opts->operands = opts->input;
    return CONTINUE;
}

static int choose_file(options *opts, step_files *files,
                       snow_context *context) {
    int done = steps_expand(opts, files);
    step_times times = {.context = context,
                        .opts = opts,
                        .files = files,
                        .count = files->count};
    int64_t step = opts->time < 0 ? files->count + opts->time : opts->time;
    if (done == CONTINUE && !isnan(opts->moment))
        done = nearest(&times, &step);
    if (done != CONTINUE)
        return done;
    if (step < 0 || step >= files->count)
        return fail_usage("--time: there is no step %" PRId64
                          "; %s stands for %" PRId64
                          " %s, counted from 0, or from -1 at the end",
                          opts->time, opts->operands[0], files->count,
                          files->times ? "steps" : "files");
    done = take_input(opts, "%s", files->paths[step]);
    if (done != CONTINUE)
        return done;
    if (opts->verbosity >= 0 && files->count > 1)
        say("note: %s: step %" PRId64 " of %" PRId64
            " (counted from 0) is taken%s",
            opts->input[0], step, files->count,
            options_given(opts, "time") ? "" : "; --time N takes another");
    opts->time = files->times ? files->times[step] : 0;
    return CONTINUE;
}

static int take_pattern(options *opts, snow_context *context) {
    step_files files = {.gaps = true};
    int done = steps_find(opts, &files);
    if (done == CONTINUE && !are_slices(context, opts, files.paths[0]))
        done = choose_file(opts, &files, context);
    steps_free(&files);
    return done;
}

/* "data_%T.h5 --dataset /data/%T/rho" is one name. */
static int join_set(options *opts) {
    const char *input = opts->operands[0], *set = opts->dataset;
    if (!set || !strchr(set, '%') || opts->operand_count != 1 ||
        !files_are_meant(input))
        return CONTINUE;
    int done = take_input(opts, *set == '/' ? "%s:%s" : "%s:/%s", input, set);
    if (done == CONTINUE)
        opts->dataset = NULL;
    return done;
}

int series_take(options *opts, const verb_row *verb) {
    const unsigned reads = VERB_RENDER | VERB_TURNTABLE | VERB_MOVIE |
                           VERB_SLICE | VERB_CONVERT | VERB_INFO | VERB_SERVE |
                           VERB_EXPORT;
    snow_context *context = NULL;
    if (!(verb->bit & reads) || opts->operand_count == 0)
        return CONTINUE;
    const bool is_movie = verb->bit == VERB_MOVIE, timed = !isnan(opts->moment);
    if (opts->time_range && !is_movie)
        return fail_usage("--time: %s shows one step, and a range of them is "
                          "for movie; give one number",
                          verb->name);
    if (opts->operand_count > 1)
        return timed ? fail_usage("--time: a physical time is of one input; "
                                  "give the number of a step")
                     : CONTINUE;
    int done = join_set(opts);
    if (done == CONTINUE && is_movie && timed &&
        files_are_meant(opts->operands[0]))
        return fail_usage("--time: of several files movie takes steps by their "
                          "numbers, such as 2:8; snowglass info '%s' with "
                          "this --time says which step that is",
                          opts->operands[0]);
    const bool files = !is_movie && files_are_meant(opts->operands[0]);
    if (done != CONTINUE || (!files && !timed))
        return done;
    snow_status status = snow_context_new(NULL, &context);
    if (status != SNOW_STATUS_OK)
        return fail_memory("out of memory at the start; close other programs");
    done = files ? take_pattern(opts, context) : take_moment(opts, context);
    snow_context_free(context);
    return done;
}
