/* movie_files.c - the files of time steps: named one by one, by a pattern with
 * a number, or by one of a shell that has not taken it (glob(7)). */
#define _XOPEN_SOURCE 700
#include "movie/movie_files.h"
#include "commands/commands.h"
#include "movie/movie_names.h"
#include "run/log.h"
#include "run/paths.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int steps_fail_memory(void) {
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
            return steps_fail_memory();
        files->paths = paths;
        files->room = room;
    }
    char *copy = strdup(path);
    if (!copy)
        return steps_fail_memory();
    files->paths[files->count++] = copy;
    return CONTINUE;
}

void steps_free(step_files *files) {
    for (int64_t i = 0; i < files->count; i++)
        free(files->paths[i]);
    free(files->paths);
    free(files->times);
}

/* A number of a file, and the digits that it has at least. */
typedef struct number {
    int64_t value;
    int digits;
} number;

/* The numbers of a pattern's files, in a growing list. */
typedef struct numbers {
    number *items;
    size_t count, room;
} numbers;

static bool add_number(numbers *list, int64_t value, int digits) {
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : 256;
        number *items = realloc(list->items, room * sizeof *items);
        if (!items)
            return false;
        list->items = items;
        list->room = room;
    }
    list->items[list->count++] = (number){value, digits};
    return true;
}

static int by_number(const void *a, const void *b) {
    const number *x = a, *y = b;
    return (x->value > y->value) - (x->value < y->value);
}

/* Finds the numbers of all existing files, in rising order. */
static int find_numbers(const char *pattern, frame_names *names, numbers *out) {
    const struct dirent *entry;
    DIR *folder = opendir(names_folder(names));
    if (!folder) {
        say("%s: %s; correct the folder's name", pattern, strerror(errno));
        return SNOW_STATUS_BAD_INPUT;
    }
    bool good = true;
    while (good && (errno = 0, entry = readdir(folder))) {
        names_widen(names, entry->d_name);
        int64_t value = names_index(names, entry->d_name);
        if (value >= 0)
            good = add_number(out, value, names->digits);
    }
    const int reason = entry ? 0 : errno;
    closedir(folder);
    if (!good)
        return steps_fail_memory();
    if (reason) {
        say("%s: its folder cannot be listed to the end: %s; check the disk",
            pattern, strerror(reason));
        return SNOW_STATUS_BAD_INPUT;
    }
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
        if (list->items[i].value - list->items[i - 1].value < step)
            step = list->items[i].value - list->items[i - 1].value;
    return step;
}

/* Whether each of the files from `first` on holds a time, and no two in a row
 * the same. */
static bool hold_times(const options *opts, const step_files *files,
                       int64_t first) {
    snow_context *context;
    snow_volume_options data = data_options(opts);
    snow_volume_info info = {.size = sizeof info};
    double last = NAN;
    char unit[sizeof info.time_unit] = "";
    bool held = snow_context_new(NULL, &context) == SNOW_STATUS_OK;
    data.time = 0;
    data.each_time = true;
    for (int64_t i = first; i < files->count && held; i++) {
        held = snow_volume_inspect(context, files->paths[i], &data, &info) ==
                   SNOW_STATUS_OK &&
               isfinite(info.time_value) &&
               (info.time_value != last || strcmp(info.time_unit, unit) != 0);
        last = info.time_value;
        memcpy(unit, info.time_unit, sizeof unit);
    }
    snow_context_free(context);
    return held;
}

/* The first file that does not follow the one before it, in a series without
 * gaps, is refused. */
static int check_next(const char *pattern, frame_names *names,
                      const number *item, int64_t step, bool gaps) {
    char path[PATH_MAX];
    const int64_t last = item[-1].value;
    if (last == item->value) {
        names_path(names, last, path, sizeof path);
        say("%s: another file of %s has this number too; remove one, or name "
            "the files one by one",
            path, pattern);
        return SNOW_STATUS_BAD_INPUT;
    }
    if (gaps || item->value - last == step)
        return CONTINUE;
    names->digits = item[-1].digits;
    names_path(names, last + step, path, sizeof path);
    say("%s: this step of %s is missing; create it, or give the pattern with "
        "* for the number, which takes the files that are there",
        path, pattern);
    return SNOW_STATUS_BAD_INPUT;
}

/* %T names the iterations that exist, at any distance; so does any pattern if
 * the files hold their times. */
static int check_numbers(const options *opts, const char *pattern,
                         frame_names *names, const numbers *list, int64_t first,
                         const step_files *files) {
    const int64_t step = step_of(list);
    bool gaps = files->gaps || names->iterations;
    int done = CONTINUE;
    for (size_t i = 1; i < list->count && !gaps; i++)
        if (list->items[i].value - list->items[i - 1].value != step) {
            gaps = hold_times(opts, files, first);
            break;
        }
    for (size_t i = 1; i < list->count && done == CONTINUE; i++)
        done = check_next(pattern, names, &list->items[i], step, gaps);
    return done;
}

static int add_numbers(const char *pattern, frame_names *names, const char *set,
                       const numbers *list, step_files *out) {
    char path[2 * PATH_MAX];
    int done = CONTINUE;
    for (size_t i = 0; i < list->count && done == CONTINUE; i++) {
        const number *item = &list->items[i];
        names->digits = item->digits;
        if (!names_path(names, item->value, path, PATH_MAX))
            continue;
        if (set && !names_in_set(set, item->value, path + strlen(path),
                                 sizeof path - strlen(path)))
            return fail_usage("%s: has a %% that is no number; write %%d, "
                              "%%04d or %%T",
                              pattern);
        done = add_path(out, path);
    }
    return done;
}

/* What follows the file of "run_%04d.h5:/rho"; NULL: nothing. */
static const char *set_in(const char *pattern) {
    const char *found = NULL;
    for (const char *at = pattern; (at = strstr(at, ":/")); at++)
        found = at;
    return found;
}

static int add_pattern(const options *opts, const char *pattern,
                       step_files *out) {
    const int64_t first = out->count;
    frame_names names;
    numbers list = {NULL, 0, 0};
    char file[PATH_MAX];
    const char *set = set_in(pattern);
    size_t length = set ? (size_t)(set - pattern) : strlen(pattern);
    if (length >= sizeof file)
        return fail_usage("%s: is too long a name; use a shorter one", pattern);
    memcpy(file, pattern, length);
    file[length] = '\0';
    const char *fault = names_read(file, &names);
    if (fault)
        return fail_usage("%s: %s", pattern, fault);
    int done = find_numbers(file, &names, &list);
    if (done == CONTINUE)
        done = add_numbers(pattern, &names, set, &list, out);
    if (done == CONTINUE)
        done = check_numbers(opts, pattern, &names, &list, first, out);
    free(list.items);
    return done;
}

#define STARS "*?["

/* Where a digit of each stands, the numbers that begin there; else letters. */
static int compare_parts(const char **a, const char **b) {
    if (!isdigit((unsigned char)**a) || !isdigit((unsigned char)**b)) {
        const unsigned char x = (unsigned char)*(*a)++;
        const unsigned char y = (unsigned char)*(*b)++;
        return (x > y) - (x < y);
    }
    *a += strspn(*a, "0");
    *b += strspn(*b, "0");
    const size_t m = strspn(*a, "0123456789"), n = strspn(*b, "0123456789");
    const int order = m == n ? strncmp(*a, *b, m) : m > n ? 1 : -1;
    *a += m;
    *b += n;
    return order;
}

static int by_numbers_within(const void *x, const void *y) {
    const char *a = *(char *const *)x, *b = *(char *const *)y;
    int order = 0;
    while (!order && (*a || *b))
        order = compare_parts(&a, &b);
    return order ? order : strcmp(*(char *const *)x, *(char *const *)y);
}

/* The files of a pattern such as run_*.h5:/rho, by the numbers in their
 * names. */
static int add_stars(const char *pattern, step_files *out) {
    const char *set = set_in(pattern);
    char path[2 * PATH_MAX];
    glob_t found;
    snprintf(path, sizeof path, "%.*s",
             set ? (int)(set - pattern) : PATH_MAX - 1, pattern);
    const int fault = glob(path, GLOB_ERR | GLOB_NOSORT, NULL, &found);
    const char *why = fault == GLOB_NOMATCH ? "no file matches this pattern"
                                            : "a folder cannot be listed";
    if (fault == GLOB_NOSPACE)
        return steps_fail_memory();
    if (fault) {
        say("%s: %s; correct it", pattern, why);
        globfree(&found);
        return SNOW_STATUS_BAD_INPUT;
    }
    qsort(found.gl_pathv, found.gl_pathc, sizeof *found.gl_pathv,
          by_numbers_within);
    int done = CONTINUE;
    for (size_t i = 0; i < found.gl_pathc && done == CONTINUE; i++) {
        snprintf(path, sizeof path, "%s%s", found.gl_pathv[i], set ? set : "");
        done = add_path(out, path);
    }
    globfree(&found);
    return done;
}

/* Where the file's part of a path has one of some characters. */
static const char *sign_in(const char *path, const char *signs) {
    const char *set = set_in(path), *sign = strpbrk(path, signs);
    return set && sign > set ? NULL : sign;
}

bool files_are_meant(const char *path) {
    char file[PATH_MAX];
    file_of_input(path, file, sizeof file);
    /* of a file that is there, the data set may have a pattern */
    return sign_in(path, "%" STARS) && !is_there(file) &&
           strncmp(path, "phantom:", 8) != 0;
}

/* A missing file must be found now, not in the ninetieth minute of the
 * movie. */
static int add_file(const char *path, step_files *out) {
    struct stat what;
    char file[PATH_MAX];
    file_of_input(path, file, sizeof file);
    if (strcmp(path, "-") == 0)
        return fail_usage("movie: cannot read standard input, since each file "
                          "is read twice; name files");
    if (strncmp(path, "phantom:", 8) != 0 && stat(file, &what) != 0) {
        say("%s: %s; a movie needs all of its steps", path, strerror(errno));
        return SNOW_STATUS_BAD_INPUT;
    }
    return add_path(out, path);
}

int steps_find(const options *opts, step_files *out) {
    int done = CONTINUE;
    for (int i = 0; i < opts->operand_count && done == CONTINUE; i++) {
        const char *path = opts->operands[i];
        if (!files_are_meant(path))
            done = add_file(path, out);
        else
            done = sign_in(path, "%") ? add_pattern(opts, path, out)
                                      : add_stars(path, out);
    }
    return done;
}

/* How many steps a file has, without notes: they come when it is read. */
static int count_steps(const options *opts, const char *path, int64_t *out) {
    snow_context *context = NULL;
    snow_volume_options data = data_options(opts);
    snow_volume_info info = {.size = sizeof info};
    data.time = 0;
    data.each_time = true;
    memset(data.crop, 0, sizeof data.crop);
    snow_status status = snow_context_new(NULL, &context);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_inspect(context, path, &data, &info);
    int done = check_status(context, status);
    snow_context_free(context);
    *out = info.times;
    return done;
}

/* Adds the steps of a file. */
static int add_steps(const options *opts, const char *path, step_files *out) {
    int64_t steps = 0;
    int done = count_steps(opts, path, &steps);
    int64_t *times =
        realloc(out->times, (size_t)(out->count + steps) * sizeof *times);
    if (!times && done == CONTINUE)
        return steps_fail_memory();
    out->times = times ? times : out->times;
    for (int64_t i = 0; i < steps && done == CONTINUE; i++) {
        out->times[out->count] = i;
        done = add_path(out, path);
    }
    return done;
}

int steps_expand(const options *opts, step_files *files) {
    step_files all = {.gaps = files->gaps};
    int64_t ends[2] = {1, 1};
    if (files->count < 2)
        return CONTINUE;
    int done = count_steps(opts, files->paths[0], &ends[0]);
    if (done == CONTINUE)
        done = count_steps(opts, files->paths[files->count - 1], &ends[1]);
    if (done != CONTINUE || (ends[0] < 2 && ends[1] < 2))
        return done;
    for (int64_t i = 0; i < files->count && done == CONTINUE; i++)
        done = add_steps(opts, files->paths[i], &all);
    steps_free(files);
    *files = all;
    return done;
}
