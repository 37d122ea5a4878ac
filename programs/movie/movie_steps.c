/* movie_steps.c - lists the volumes that a movie shows, in order, and makes one
 * transfer function for all. */
#define _XOPEN_SOURCE 700
#include "movie/movie_steps.h"
#include "commands/commands.h"
#include "movie/movie_names.h"
#include "run/log.h"
#include "run/memory.h"
#include "run/start.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static int fail_list(void) {
    return fail_memory("out of memory for the list of time steps; make a movie "
                       "of fewer");
}

/* Adds a copy of the path. */
static int add_path(step_files *files, const char *path) {
    if (files->count == files->room) {
        int64_t room = files->room ? 2 * files->room : 64;
        char **paths =
            realloc(files->paths, (size_t)room * sizeof *files->paths);
        if (!paths)
            return fail_list();
        files->paths = paths;
        files->room = room;
    }
    char *copy = strdup(path);
    if (!copy)
        return fail_list();
    files->paths[files->count++] = copy;
    return CONTINUE;
}

void steps_free(step_files *files) {
    for (int64_t i = 0; i < files->count; i++)
        free(files->paths[i]);
    free(files->paths);
}

/* The numbers of a pattern's files, in a growing list. */
typedef struct numbers {
    int64_t *items;
    size_t count, room;
} numbers;

static bool add_number(numbers *list, int64_t number) {
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : 256;
        int64_t *items = realloc(list->items, room * sizeof *items);
        if (!items)
            return false;
        list->items = items;
        list->room = room;
    }
    list->items[list->count++] = number;
    return true;
}

static int by_number(const void *a, const void *b) {
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* Finds the numbers of all existing files, in rising order. */
static int find_numbers(const char *pattern, const frame_names *names,
                        numbers *out) {
    const struct dirent *entry;
    DIR *folder = opendir(names_folder(names));
    if (!folder) {
        say("%s: %s; correct the folder's name", pattern, strerror(errno));
        return SNOW_STATUS_BAD_INPUT;
    }
    bool good = true;
    while (good && (entry = readdir(folder))) {
        int64_t number = names_index(names, entry->d_name);
        if (number >= 0)
            good = add_number(out, number);
    }
    closedir(folder);
    if (!good)
        return fail_list();
    if (!out->count) {
        say("%s: no file matches this pattern; correct it", pattern);
        return SNOW_STATUS_BAD_INPUT;
    }
    qsort(out->items, out->count, sizeof *out->items, by_number);
    return CONTINUE;
}

/* Simulations may write every tenth step only, so the smallest distance between
 * two files is taken as the distance between all. */
static int64_t step_of(const numbers *list) {
    int64_t step = INT64_MAX;
    for (size_t i = 1; i < list->count; i++)
        if (list->items[i] - list->items[i - 1] < step)
            step = list->items[i] - list->items[i - 1];
    return step;
}

static int add_numbers(const char *pattern, const frame_names *names,
                       const numbers *list, step_files *out) {
    char path[PATH_MAX];
    int64_t step = step_of(list);
    int done = CONTINUE;
    for (size_t i = 0; i < list->count && done == CONTINUE; i++) {
        if (i && list->items[i] - list->items[i - 1] != step) {
            names_path(names, list->items[i - 1] + step, path, sizeof path);
            say("%s: this step of %s is missing; create it, or name the files "
                "one by one",
                path, pattern);
            return SNOW_STATUS_BAD_INPUT;
        }
        if (names_path(names, list->items[i], path, sizeof path))
            done = add_path(out, path);
    }
    return done;
}

static int add_pattern(const char *pattern, step_files *out) {
    frame_names names;
    numbers list = {NULL, 0, 0};
    const char *fault = names_read(pattern, &names);
    if (fault)
        return fail_usage("%s: %s", pattern, fault);
    int done = find_numbers(pattern, &names, &list);
    if (done == CONTINUE)
        done = add_numbers(pattern, &names, &list, out);
    free(list.items);
    return done;
}

/* A missing file must be found now, not in the ninetieth minute of the
 * movie. */
static int add_file(const char *path, step_files *out) {
    struct stat what;
    if (strcmp(path, "-") == 0)
        return fail_usage("movie: cannot read standard input, since each file "
                          "is read twice; name files");
    if (strncmp(path, "phantom:", 8) != 0 && stat(path, &what) != 0) {
        say("%s: %s; a movie needs all of its steps", path, strerror(errno));
        return SNOW_STATUS_BAD_INPUT;
    }
    return add_path(out, path);
}

int steps_find(const options *opts, step_files *out) {
    int done = CONTINUE;
    for (int i = 0; i < opts->operand_count && done == CONTINUE; i++) {
        const char *path = opts->operands[i];
        struct stat what;
        done = names_are_meant(path) && stat(path, &what) != 0
                   ? add_pattern(path, out)
                   : add_file(path, out);
    }
    return done;
}

/* Whether the transfer function depends on the options alone: a preset with
 * values of its own, or one that is spread over given values. */
static bool look_is_fixed(const options *opts) {
    if (!opts->preset)
        return false;
    const char *name =
        snow_preset_name((size_t)snow_preset_from_name(opts->preset));
    snow_range range = options_range(opts).kind;
    return range == SNOW_RANGE_VALUES ||
           (strncmp(name, "ct-", 3) == 0 && range == SNOW_RANGE_AUTO);
}

/* Reads what the header says about a shot's volume. */
static int inspect(const shot_renderer *shots, const movie_shot *shot,
                   snow_volume_info *out) {
    options step = render_state_step(&shots->state, shot->time);
    snow_volume_options data = data_options(&step);
    snow_status status =
        snow_volume_inspect(shots->state.context, shot->path, &data, out);
    return status == SNOW_STATUS_OK ? CONTINUE
                                    : fail_status(shots->state.context, status);
}

/* The last number in a file's name before its suffix: 10 for run_0010.nrrd;
 * `usual` if there is none. */
static int64_t number_in(const char *path, int64_t usual) {
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    const char *end = strrchr(name, '.');
    int64_t number = usual;
    while (*name && name != end) {
        size_t digits = strspn(name, "0123456789");
        if (digits > 0 && digits <= 15)
            number = strtoll(name, NULL, 10);
        name += digits ? digits : 1;
    }
    return number;
}

int steps_list(const step_files *files, shot_renderer *shots, shot_list *out) {
    const options *opts = shots->state.opts;
    movie_shot first = {files->paths[0], opts->time, opts->azimuth, 0};
    out->count = files->count;
    const bool given = options_given(opts, "time");
    shots->state.steps = true;
    shots->state.each_time = files->count == 1 && !given;
    shots->whole_files = files->count > 1 && !given;
    if (shots->state.each_time) {
        snow_volume_info info = {.size = sizeof info};
        int done = inspect(shots, &first, &info);
        if (done != CONTINUE)
            return done;
        out->count = info.times;
    }
    out->together = out->count > 1 && !look_is_fixed(opts);
    out->shots = calloc((size_t)out->count, sizeof *out->shots);
    if (!out->shots)
        return fail_list();
    for (int64_t i = 0; i < out->count; i++) {
        movie_shot *shot = &out->shots[i];
        *shot = first;
        if (files->count > 1) {
            shot->path = files->paths[i];
            shot->step = number_in(shot->path, i);
        } else {
            shot->time = given ? first.time : i;
            shot->step = shot->time;
        }
    }
    return CONTINUE;
}

/* --- one transfer function for all steps ---------------------------------- */

/* The number of values taken from all steps together, and the minimum from
 * each: enough that the histogram looks the same. */
#define POOL_VALUES (INT64_C(1) << 22)
#define STEP_VALUES 1024

/* What a rank has read: the values of its share of a step, and their smallest
 * and largest. */
typedef struct step_values {
    int64_t count;
    double ends[2];
} step_values;

/* The values of all steps, in order. */
typedef struct value_pool {
    double *values;
    int64_t count;
    double *step;      /* values of the step that this rank has read */
    step_values given; /* describes `step` */
    int64_t quota;     /* values of one step, without its extremes */
    int group;         /* ranks that read a step together, one slab each */
} value_pool;

static int64_t common_factor(int64_t a, int64_t b) {
    while (b) {
        int64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* The distance between sampled values.  It has no common factor with rows and
 * slices, so that the sample does not follow one column of them. */
static int64_t stride_of(const snow_volume_info *info, int64_t quota) {
    int64_t slice = info->dims[0] * info->dims[1];
    int64_t stride = (slice * info->dims[2] + quota - 1) / quota;
    while (stride > 1 && common_factor(stride, slice) != 1)
        stride++;
    return stride < 1 ? 1 : stride;
}

/* Reads a stored value as a double. */
static double native(const void *voxels, snow_type type, int64_t i) {
    switch (type) {
#define NATIVE(name, c_type, text) \
    case SNOW_TYPE_##name:         \
        return (double)((const c_type *)voxels)[i];
        SNOW_TYPE_MAP(NATIVE)
#undef NATIVE
    default:
        return 0;
    }
}

/* Samples a step's data values and finds its extremes, which no sample may
 * miss, from slice `first` on of a step with the geometry `whole`.  The sample
 * does not depend on how many ranks share it. */
static void pool_slab(value_pool *pool, const snow_volume_info *whole,
                      int64_t first, const snow_volume *volume) {
    const snow_volume_info *info = snow_volume_get_info(volume);
    const void *voxels = snow_volume_voxels(volume);
    int64_t slice = info->dims[0] * info->dims[1];
    int64_t begin = first * slice, end = begin + slice * info->dims[2];
    int64_t stride = stride_of(whole, pool->quota);
    int64_t at = (begin + stride - 1) / stride;
    snow_volume_statistics ends = {.size = sizeof ends};
    snow_volume_get_statistics(volume, &ends);
    pool->given = (step_values){0, {ends.min, ends.max}};
    for (; at < pool->quota && at * stride < end; at++)
        pool->step[pool->given.count++] =
            info->slope * native(voxels, info->type, at * stride - begin) +
            info->intercept;
}

/* Makes the transfer function for a volume that consists of the pool and has
 * the shape of `step` (a block, a slice or a row), since the shape counts.
 * Missing values are NaN; memory for them is available where steps were
 * read. */
static int look_at_pool(render_state *s, const snow_volume_info *step,
                        value_pool *pool) {
    snow_volume_info info = {
        .size = sizeof info, .dims = {1, 1, 1}, .type = SNOW_TYPE_FLOAT64};
    int axes = 0;
    for (int i = 0; i < 3; i++)
        axes += step->dims[i] > 1;
    for (int i = 1; i < axes; i++)
        info.dims[i] = 2;
    int64_t across = info.dims[1] * info.dims[2];
    while (pool->count % across)
        pool->values[pool->count++] = NAN;
    info.dims[0] = pool->count / across;
    snow_volume *volume = NULL;
    snow_status status =
        snow_volume_wrap(s->context, &info, pool->values, &volume);
    if (status != SNOW_STATUS_OK)
        return fail_status(s->context, status);
    int done = open_look(s->context, s->opts, volume, &s->transfer);
    snow_volume_close(volume);
    return done;
}

static void report_step(const options *opts, int64_t step, int64_t count) {
    char line[96];
    snprintf(line, sizeof line,
             "reading values of step %" PRId64 " of %" PRId64, step + 1, count);
    if (progress_is_live())
        progress(opts, line);
}

/* The slices of a member: from slab[0] up to, not including, slab[1]. */
static void share_of(int64_t slices, int group, int member, int64_t slab[2]) {
    slab[0] = slices / group * member + slices % group * member / group;
    member++;
    slab[1] = slices / group * member + slices % group * member / group;
}

/* Reads a share of a step, which may be the whole step. */
static int read_share(shot_renderer *shots, const movie_shot *shot, int member,
                      value_pool *pool) {
    render_state *s = &shots->state;
    snow_volume *volume = NULL;
    snow_volume_info whole = {.size = sizeof whole};
    int64_t slab[2];
    options step = render_state_step(s, shot->time);
    snow_volume_options data = data_options(&step);
    int done = inspect(shots, shot, &whole);
    if (done == CONTINUE)
        done = shots_check(shots, shot->path, &whole);
    if (done != CONTINUE)
        return done;
    share_of(whole.dims[2], pool->group, member, slab);
    pool->given = (step_values){0, {NAN, NAN}};
    if (slab[0] == slab[1])
        return CONTINUE;
    data.crop[2][1] = data.crop[2][0] + slab[1];
    data.crop[2][0] += slab[0];
    snow_status status =
        snow_volume_open(s->context, shot->path, &data, &volume);
    if (status != SNOW_STATUS_OK)
        return fail_status(s->context, status);
    pool_slab(pool, &whole, slab[0], volume);
    snow_volume_close(volume);
    return CONTINUE;
}

static int read_step(shot_renderer *shots, const movie_shot *shot,
                     value_pool *pool) {
    render_state *s = &shots->state;
    snow_volume *volume = NULL;
    options step = render_state_step(s, shot->time);
    snow_volume_options data = data_options(&step);
    int done = memory_check(&step, shot->path, &data);
    if (done == CONTINUE)
        done = open_input(s->context, &step, shot->path, &volume);
    if (done == CONTINUE)
        done = shots_check(shots, shot->path, snow_volume_get_info(volume));
    if (done == CONTINUE)
        pool_slab(pool, snow_volume_get_info(volume), 0, volume);
    snow_volume_close(volume);
    return done;
}

/* Appends what a rank has read; the extremes of a step follow its last
 * values. */
static int append_share(value_pool *pool, int rank, double ends[2]) {
    double *to = pool->values + pool->count;
    step_values given = pool->given;
    snow_comm *comm = process_comm();
    snow_status status = SNOW_STATUS_OK;
    if (comm)
        status = snow_comm_broadcast(comm, &given, sizeof given, rank);
    size_t bytes = (size_t)given.count * sizeof *to;
    if (rank == process_rank())
        memcpy(to, pool->step, bytes);
    if (comm && status == SNOW_STATUS_OK)
        status = snow_comm_broadcast(comm, to, bytes, rank);
    pool->count += given.count;
    ends[0] = fmin(ends[0], given.ends[0]); /* NaN if there are none */
    ends[1] = fmax(ends[1], given.ends[1]);
    return status == SNOW_STATUS_OK
               ? CONTINUE
               : fail_status(snow_comm_context(comm), status);
}

static int append_step(value_pool *pool, int group) {
    double ends[2] = {NAN, NAN};
    int done = CONTINUE;
    for (int member = 0; member < pool->group && done == CONTINUE; member++)
        done = append_share(pool, group * pool->group + member, ends);
    pool->values[pool->count++] = ends[0];
    pool->values[pool->count++] = ends[1];
    return done;
}

/* Reads steps from `first` on, one for each group of ranks. */
static int pool_round(const shot_list *list, int64_t first,
                      shot_renderer *shots, value_pool *pool) {
    const int groups = process_ranks() / pool->group;
    int mine = process_rank() / pool->group, done = CONTINUE;
    double begin = seconds_now();
    if (mine < groups && first + mine < list->count) {
        const movie_shot *shot = &list->shots[first + mine];
        done =
            pool->group == 1
                ? read_step(shots, shot, pool)
                : read_share(shots, shot, process_rank() % pool->group, pool);
    }
    shots->state.times.read += seconds_now() - begin;
    done = process_agree(done);
    for (int group = 0; group < groups && first + group < list->count; group++)
        if (done == CONTINUE)
            done = append_step(pool, group);
    return done;
}

/* Chooses so many ranks per step that none is idle if there are few steps, and
 * more if a step is too large for so few. */
static int choose_group(const options *opts, const snow_volume_info *step,
                        int64_t steps) {
    const int ranks = process_ranks();
    int group = steps < ranks ? ranks / (int)steps : 1;
    snow_volume_info share = *step;
    for (; group < ranks; group++) {
        share.dims[2] = (step->dims[2] + group - 1) / group;
        if (!opts->memory || memory_needed(opts, &share).least <= opts->memory)
            break;
    }
    return group;
}

/* All ranks compare their steps with the first. */
static int pool_steps(const shot_list *list, shot_renderer *shots,
                      value_pool *pool) {
    snow_volume_info first = {.size = sizeof first};
    int done = inspect(shots, &list->shots[0], &first);
    if (done == CONTINUE)
        done = shots_check(shots, list->shots[0].path, &first);
    done = process_agree(done);
    if (done == CONTINUE)
        pool->group = choose_group(shots->state.opts, &first, list->count);
    int groups = done == CONTINUE ? process_ranks() / pool->group : 1;
    for (int64_t i = 0; i < list->count && done == CONTINUE; i += groups) {
        report_step(shots->state.opts, i, list->count);
        done = pool_round(list, i, shots, pool);
    }
    hear_warnings(shots->state.opts, shots->state.context, true);
    return done == CONTINUE
               ? process_agree(look_at_pool(&shots->state, &first, pool))
               : done;
}

int steps_look(const shot_list *list, shot_renderer *shots) {
    if (!list->together)
        return CONTINUE;
    value_pool pool = {.quota = POOL_VALUES / list->count};
    if (pool.quota < STEP_VALUES)
        pool.quota = STEP_VALUES;
    /* All steps are opened again later and cause the same notes.  They are
     * printed now, except if ranks read steps that rank 0 does not see now. */
    const bool later = process_ranks() > 1;
    hear_warnings(shots->state.opts, shots->state.context, !later);
    int64_t room = pool.quota + 2;
    pool.values =
        malloc((size_t)(room * (list->count + 1)) * sizeof *pool.values);
    int done = process_agree(pool.values ? CONTINUE : fail_list());
    if (done == CONTINUE) {
        pool.step = pool.values + room * list->count;
        done = pool_steps(list, shots, &pool);
    }
    free(pool.values);
    hear_warnings(shots->state.opts, shots->state.context, later);
    return done;
}
