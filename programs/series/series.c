/* series.c - implements series.h. */
#include "series/series.h"
#include "commands/commands.h"
#include "movie/movie_files.h"
#include "run/log.h"
#include "series/moment.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Steps of files, or of one file. */
typedef struct steps {
    snow_context *context;
    const options *opts;
    const step_files *files; /* NULL: the steps of `path` */
    const char *path;
} steps;

/* A moment_step_fn. */
static snow_status read_step(void *user, int64_t step, snow_volume_info *out) {
    const steps *s = user;
    snow_volume_options data = data_options(s->opts);
    *out = (snow_volume_info){.size = sizeof *out};
    data.time = !s->files ? step : s->files->times ? s->files->times[step] : 0;
    data.each_time = true;
    return snow_volume_inspect(
        s->context, s->files ? s->files->paths[step] : s->path, &data, out);
}

static int nearest(steps *s, int64_t count, int64_t *out) {
    snow_volume_info at;
    char text[128] = "";
    snow_status status = moment_find(s->context, &s->opts->moment, count,
                                     read_step, s, out, &at);
    if (status != SNOW_STATUS_OK)
        return fail_status(s->context, status);
    if (s->opts->verbosity >= 0 && snow_time_text(&at, NULL, text, sizeof text))
        say("step %" PRId64 " of %" PRId64 " is the nearest, at %s", *out,
            count, text);
    return CONTINUE;
}

/* The step of a file with several. */
static int take_moment(options *opts, snow_context *context) {
    steps s = {.context = context, .opts = opts, .path = opts->operands[0]};
    snow_volume_info info;
    snow_status status = read_step(&s, 0, &info);
    if (status != SNOW_STATUS_OK)
        return fail_status(context, status);
    return nearest(&s, info.times, &opts->time);
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
    steps s = {.context = context, .opts = opts, .files = files};
    int64_t step = opts->time < 0 ? files->count + opts->time : opts->time;
    if (done == CONTINUE && !isnan(opts->moment.value))
        done = nearest(&s, files->count, &step);
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
    const bool is_movie = verb->bit == VERB_MOVIE,
               timed = !isnan(opts->moment.value);
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
