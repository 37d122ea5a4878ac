/* sequence_steps.c - which volumes a movie shows, and in what order. */
#define _XOPEN_SOURCE 700
#include "sequence_steps.h"
#include "commands.h"
#include "launch.h"
#include "memory.h"
#include "report.h"
#include "sequence_names.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static int fail_memory(void) {
    say("no memory for the list of time steps; make a movie of fewer");
    return SNOW_NO_MEMORY;
}

/* Takes a copy of the path. */
static int add_path(step_files *files, const char *path) {
    if (files->count == files->room) {
        int64_t room = files->room ? 2 * files->room : 64;
        char **paths =
            realloc(files->paths, (size_t)room * sizeof *files->paths);
        if (!paths)
            return fail_memory();
        files->paths = paths;
        files->room = room;
    }
    char *copy = strdup(path);
    if (!copy)
        return fail_memory();
    files->paths[files->count++] = copy;
    return GO_ON;
}

void steps_free(step_files *files) {
    for (int64_t i = 0; i < files->count; i++)
        free(files->paths[i]);
    free(files->paths);
}

/* Numbers of a pattern's files, in a growing list. */
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

/* All numbers that there are, rising. */
static int find_numbers(const char *pattern, const frame_names *names,
                        numbers *out) {
    const struct dirent *entry;
    DIR *folder = opendir(names_folder(names));
    if (!folder) {
        say("%s: %s; correct the folder's name", pattern, strerror(errno));
        return SNOW_BAD_INPUT;
    }
    bool good = true;
    while (good && (entry = readdir(folder))) {
        int64_t number = names_index(names, entry->d_name);
        if (number >= 0)
            good = add_number(out, number);
    }
    closedir(folder);
    if (!good)
        return fail_memory();
    if (!out->count) {
        say("%s: there is no such file; correct the pattern", pattern);
        return SNOW_BAD_INPUT;
    }
    qsort(out->items, out->count, sizeof *out->items, by_number);
    return GO_ON;
}

/* Simulations write every tenth step as well as every one: the smallest step
 * between two files is the one between all. */
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
    int done = GO_ON;
    for (size_t i = 0; i < list->count && done == GO_ON; i++) {
        if (i && list->items[i] - list->items[i - 1] != step) {
            names_path(names, list->items[i - 1] + step, path, sizeof path);
            say("%s: this step of %s is missing; make it, or name the files "
                "one by one",
                path, pattern);
            return SNOW_BAD_INPUT;
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
    if (done == GO_ON)
        done = add_numbers(pattern, &names, &list, out);
    free(list.items);
    return done;
}

/* A movie that ends in its ninetieth minute for a file that could have been
 * missed at once would be a shame. */
static int add_file(const char *path, step_files *out) {
    struct stat what;
    if (strcmp(path, "-") == 0)
        return fail_usage("movie: reads its files twice, so that standard "
                          "input will not do; name files");
    if (strncmp(path, "phantom:", 8) != 0 && stat(path, &what) != 0) {
        say("%s: %s; a movie needs all of its steps", path, strerror(errno));
        return SNOW_BAD_INPUT;
    }
    return add_path(out, path);
}

int steps_find(const options *asked, step_files *out) {
    int done = GO_ON;
    for (int i = 0; i < asked->operand_count && done == GO_ON; i++) {
        const char *path = asked->operands[i];
        struct stat what;
        done = names_are_meant(path) && stat(path, &what) != 0
                   ? add_pattern(path, out)
                   : add_file(path, out);
    }
    return done;
}

/* Whether the transfer function follows from the options alone: a preset in
 * units of its own, or one that is spread over given values. */
static bool look_is_fixed(const options *asked) {
    if (!asked->preset)
        return false;
    const char *name =
        snow_preset_name((size_t)snow_preset_named(asked->preset));
    bool values = asked->range.kind == SNOW_RANGE_VALUES ||
                  asked->window == asked->window; /* told: not NaN */
    bool own =
        strncmp(name, "ct-", 3) == 0 && asked->range.kind == SNOW_RANGE_AUTO;
    return values || own;
}

/* What is known of a shot's volume without reading it. */
static int inspect(const shot_renderer *shots, const movie_shot *shot,
                   snow_volume_info *out) {
    options step = scene_step(&shots->scene, shot->time);
    snow_volume_options data = data_options(&step);
    snow_status status =
        snow_volume_inspect(shots->scene.context, shot->path, &data, out);
    return status == SNOW_OK ? GO_ON
                             : fail_status(shots->scene.context, status);
}

/* The last number in a file's name, before its suffix: that of run_0010.nrrd is
 * 10.  `usual` where there is none. */
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
    const options *asked = shots->scene.asked;
    movie_shot first = {files->paths[0], asked->time, asked->azimuth, 0};
    out->count = files->count;
    const bool told = options_told(asked, "time");
    shots->scene.each_time = files->count == 1 && !told;
    shots->whole_files = files->count > 1 && !told;
    if (shots->scene.each_time) {
        snow_volume_info info;
        int done = inspect(shots, &first, &info);
        if (done != GO_ON)
            return done;
        out->count = info.times;
    }
    out->together = out->count > 1 && !look_is_fixed(asked);
    out->shots = calloc((size_t)out->count, sizeof *out->shots);
    if (!out->shots)
        return fail_memory();
    for (int64_t i = 0; i < out->count; i++) {
        movie_shot *shot = &out->shots[i];
        *shot = first;
        if (files->count > 1) {
            shot->path = files->paths[i];
            shot->step = number_in(shot->path, i);
        } else {
            shot->time = told ? first.time : i;
            shot->step = shot->time;
        }
    }
    return GO_ON;
}

/* --- one look for all steps -------------------------------------------------
 */

/* Values that are taken from all steps together, and from each at least: so
 * many that the histogram is the same to the eye. */
#define POOL_VALUES (INT64_C(1) << 22)
#define STEP_VALUES 1024

/* What a rank has read: values of its share of a step, and the smallest and the
 * largest of that. */
typedef struct step_values {
    int64_t count;
    double ends[2];
} step_values;

/* Values of all steps, in their order. */
typedef struct value_pool {
    double *values;
    int64_t count;
    double *step;     /* those of the step that this rank has read */
    step_values told; /* of these */
    int64_t quota;    /* of one step, less its ends */
    int group;        /* ranks that read a step together, slabs of it */
} value_pool;

static int64_t common_factor(int64_t a, int64_t b) {
    while (b) {
        int64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* From value to value.  No factor in common with rows and slices, so that the
 * sample does not run along one column of them. */
static int64_t stride_of(const snow_volume_info *info, int64_t quota) {
    int64_t slice = info->dims[0] * info->dims[1];
    int64_t stride = (slice * info->dims[2] + quota - 1) / quota;
    while (stride > 1 && common_factor(stride, slice) != 1)
        stride++;
    return stride < 1 ? 1 : stride;
}

/* A native value as a double. */
static double native(const void *voxels, snow_type type, int64_t i) {
    switch (type) {
#define NATIVE(name, c_type, text) \
    case SNOW_##name:              \
        return (double)((const c_type *)voxels)[i];
        SNOW_TYPE_MAP(NATIVE)
#undef NATIVE
    default:
        return 0;
    }
}

/* A sample of a step's data values, and its ends, which no sample may miss: of
 * slices `first` on of a step that is like `whole`.  What is sampled does not
 * depend on how many ranks share it. */
static void pool_slab(value_pool *pool, const snow_volume_info *whole,
                      int64_t first, const snow_volume *volume) {
    const snow_volume_info *info = snow_volume_describe(volume);
    const void *voxels = snow_volume_voxels(volume);
    int64_t slice = info->dims[0] * info->dims[1];
    int64_t begin = first * slice, end = begin + slice * info->dims[2];
    int64_t stride = stride_of(whole, pool->quota);
    int64_t at = (begin + stride - 1) / stride;
    snow_volume_measures ends;
    snow_volume_measure(volume, &ends);
    pool->told = (step_values){0, {ends.min, ends.max}};
    for (; at < pool->quota && at * stride < end; at++)
        pool->step[pool->told.count++] =
            info->slope * native(voxels, info->type, at * stride - begin) +
            info->intercept;
}

/* The look of a volume that consists of the pool, and is a block, a slice or a
 * row as `step` is: that counts for a look.  What lacks is no number; there is
 * room for it where steps were read. */
static int look_at_pool(scene *s, const snow_volume_info *step,
                        value_pool *pool) {
    snow_volume_info info = {.dims = {1, 1, 1}, .type = SNOW_FLOAT64};
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
        snow_volume_share(s->context, &info, pool->values, &volume);
    if (status != SNOW_OK)
        return fail_status(s->context, status);
    int done = open_look(s->context, s->asked, volume, &s->transfer);
    snow_volume_close(volume);
    return done;
}

static void tell_step(const options *asked, int64_t step, int64_t count) {
    char line[96];
    snprintf(line, sizeof line,
             "reading values of step %" PRId64 " of %" PRId64, step + 1, count);
    if (progress_is_live())
        progress(asked, line);
}

/* A member's slices: from slab[0] to slab[1] less one. */
static void share_of(int64_t slices, int group, int member, int64_t slab[2]) {
    slab[0] = slices / group * member + slices % group * member / group;
    member++;
    slab[1] = slices / group * member + slices % group * member / group;
}

/* A share of a step, which may be all. */
static int read_share(shot_renderer *shots, const movie_shot *shot, int member,
                      value_pool *pool) {
    scene *s = &shots->scene;
    snow_volume *volume = NULL;
    snow_volume_info whole;
    int64_t slab[2];
    options step = scene_step(s, shot->time);
    snow_volume_options data = data_options(&step);
    int done = inspect(shots, shot, &whole);
    if (done == GO_ON)
        done = shots_check(shots, shot->path, &whole);
    if (done != GO_ON)
        return done;
    share_of(whole.dims[2], pool->group, member, slab);
    pool->told = (step_values){0, {NAN, NAN}};
    if (slab[0] == slab[1])
        return GO_ON;
    data.crop[2][1] = data.crop[2][0] + slab[1];
    data.crop[2][0] += slab[0];
    snow_status status =
        snow_volume_open(s->context, shot->path, &data, &volume);
    if (status != SNOW_OK)
        return fail_status(s->context, status);
    pool_slab(pool, &whole, slab[0], volume);
    snow_volume_close(volume);
    return GO_ON;
}

static int read_step(shot_renderer *shots, const movie_shot *shot,
                     value_pool *pool) {
    scene *s = &shots->scene;
    snow_volume *volume = NULL;
    options step = scene_step(s, shot->time);
    snow_volume_options data = data_options(&step);
    int done = memory_check(&step, shot->path, &data);
    if (done == GO_ON)
        done = open_input(s->context, &step, shot->path, &volume);
    if (done == GO_ON)
        done = shots_check(shots, shot->path, snow_volume_describe(volume));
    if (done == GO_ON)
        pool_slab(pool, snow_volume_describe(volume), 0, volume);
    snow_volume_close(volume);
    return done;
}

/* Appends what a rank has read; the ends of a step follow its last values. */
static int append_share(value_pool *pool, int rank, double ends[2]) {
    double *to = pool->values + pool->count;
    step_values told = pool->told;
    snow_comm *comm = launch_comm();
    snow_status status = SNOW_OK;
    if (comm)
        status = snow_comm_broadcast(comm, &told, sizeof told, rank);
    size_t bytes = (size_t)told.count * sizeof *to;
    if (rank == launch_rank())
        memcpy(to, pool->step, bytes);
    if (comm && status == SNOW_OK)
        status = snow_comm_broadcast(comm, to, bytes, rank);
    pool->count += told.count;
    ends[0] = fmin(ends[0], told.ends[0]); /* NaN where there is none */
    ends[1] = fmax(ends[1], told.ends[1]);
    return status == SNOW_OK ? GO_ON
                             : fail_status(snow_comm_context(comm), status);
}

static int append_step(value_pool *pool, int group) {
    double ends[2] = {NAN, NAN};
    int done = GO_ON;
    for (int member = 0; member < pool->group && done == GO_ON; member++)
        done = append_share(pool, group * pool->group + member, ends);
    pool->values[pool->count++] = ends[0];
    pool->values[pool->count++] = ends[1];
    return done;
}

/* Steps from `first` on, one for each group of ranks. */
static int pool_round(const shot_list *list, int64_t first,
                      shot_renderer *shots, value_pool *pool) {
    const int groups = launch_ranks() / pool->group;
    int mine = launch_rank() / pool->group, done = GO_ON;
    double begin = seconds_now();
    if (mine < groups && first + mine < list->count) {
        const movie_shot *shot = &list->shots[first + mine];
        done = pool->group == 1
                   ? read_step(shots, shot, pool)
                   : read_share(shots, shot, launch_rank() % pool->group, pool);
    }
    shots->scene.times.read += seconds_now() - begin;
    done = launch_agree(done);
    for (int group = 0; group < groups && first + group < list->count; group++)
        if (done == GO_ON)
            done = append_step(pool, group);
    return done;
}

/* As many that no rank is left over, where there are few steps; more, where a
 * step is too large for so few. */
static int choose_group(const options *asked, const snow_volume_info *step,
                        int64_t steps) {
    const int ranks = launch_ranks();
    int group = steps < ranks ? ranks / (int)steps : 1;
    snow_volume_info share = *step;
    for (; group < ranks; group++) {
        share.dims[2] = (step->dims[2] + group - 1) / group;
        if (!asked->memory ||
            memory_needed(asked, &share).least <= asked->memory)
            break;
    }
    return group;
}

/* All ranks compare their steps with the first. */
static int pool_steps(const shot_list *list, shot_renderer *shots,
                      value_pool *pool) {
    snow_volume_info first;
    int done = inspect(shots, &list->shots[0], &first);
    if (done == GO_ON)
        done = shots_check(shots, list->shots[0].path, &first);
    done = launch_agree(done);
    if (done == GO_ON)
        pool->group = choose_group(shots->scene.asked, &first, list->count);
    int groups = done == GO_ON ? launch_ranks() / pool->group : 1;
    for (int64_t i = 0; i < list->count && done == GO_ON; i += groups) {
        tell_step(shots->scene.asked, i, list->count);
        done = pool_round(list, i, shots, pool);
    }
    hear_notices(shots->scene.asked, shots->scene.context, true);
    return done == GO_ON
               ? launch_agree(look_at_pool(&shots->scene, &first, pool))
               : done;
}

int steps_look(const shot_list *list, shot_renderer *shots) {
    if (!list->together)
        return GO_ON;
    value_pool pool = {.quota = POOL_VALUES / list->count};
    if (pool.quota < STEP_VALUES)
        pool.quota = STEP_VALUES;
    /* All steps will be opened once more, and say the same again: it is told
     * now, but where ranks look at steps of which rank 0 knows nothing. */
    const bool later = launch_ranks() > 1;
    hear_notices(shots->scene.asked, shots->scene.context, !later);
    int64_t room = pool.quota + 2;
    pool.values =
        malloc((size_t)(room * (list->count + 1)) * sizeof *pool.values);
    int done = launch_agree(pool.values ? GO_ON : fail_memory());
    if (done == GO_ON) {
        pool.step = pool.values + room * list->count;
        done = pool_steps(list, shots, &pool);
    }
    free(pool.values);
    hear_notices(shots->scene.asked, shots->scene.context, later);
    return done;
}
