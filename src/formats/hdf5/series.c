/* formats/hdf5/series.c - patterns of the names of data sets: one step of a
 * simulation in each.
 *
 *     /step_%04d/rho         /step_0000/rho, /step_0010/rho, ...
 *     /data/%T/fields/rho    openPMD: /data/0/fields/rho, /data/100/fields/rho
 *
 * Steps are in the order of their numbers, of which there may be any. */
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The most digits of a number that cannot overflow. */
#define MOST_DIGITS 18

/* The length of "%d", "%T", "%04d" or "%06T"; 0 for other text. */
static size_t number_letters(const char *text, size_t *least) {
    size_t digits = *text == '%' ? strspn(text + 1, "0123456789") : 0;
    if (*text != '%' || digits > 2 ||
        (text[1 + digits] != 'd' && text[1 + digits] != 'T'))
        return 0;
    *least = digits ? (size_t)strtoul(text + 1, NULL, 10) : 1;
    return digits + 2;
}

static bool is_pattern(const char *text) {
    size_t least;
    for (; text && *text; text++)
        if (number_letters(text, &least))
            return true;
    return false;
}

/* Returns whether a name fits; all numbers in it are the same. */
static bool fits(const char *pattern, const char *name, int64_t *out) {
    *out = -1;
    while (*pattern) {
        size_t least, letters = number_letters(pattern, &least);
        if (!letters) {
            if (*pattern++ != *name++)
                return false;
            continue;
        }
        size_t digits = strspn(name, "0123456789");
        if (digits < least || !digits || digits > MOST_DIGITS)
            return false;
        int64_t number = strtoll(name, NULL, 10);
        if (*out >= 0 && *out != number)
            return false;
        *out = number;
        pattern += letters;
        name += digits;
    }
    return !*name;
}

/* The numbers that fit; with `path`, the name of one of them. */
typedef struct numbers {
    snow_context *context;
    const char *pattern;
    int64_t *all;
    size_t count;
    char *path; /* NULL: all are listed */
    int64_t wanted;
    snow_status status;
} numbers;

static herr_t look(hid_t file, const char *name, const H5O_info_t *info,
                   void *user) {
    numbers *n = user;
    int64_t number;
    /* A group with this attribute is shown as one: a record of openPMD, whose
     * components make a vector. */
    if (!fits(n->pattern, name, &number) ||
        (info->type != H5O_TYPE_DATASET &&
         H5Aexists_by_name(file, name, "geometry", H5P_DEFAULT) <= 0))
        return 0;
    if (n->path && number == n->wanted) {
        snprintf(n->path, HDF5_NAME_BYTES, "/%.500s", name);
        return 1;
    }
    if (n->path)
        return 0;
    n->status = SNOW_RESERVE(n->context, n->all, n->count, n->count + 1);
    if (n->status == SNOW_STATUS_OK)
        n->all[n->count++] = number;
    return n->status != SNOW_STATUS_OK;
}

static int by_size(const void *a, const void *b) {
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static snow_status take_step(numbers *n, hid_t file,
                             const snow_volume_options *options,
                             hdf5_series *out) {
    snow_volume_info info = snow_volume_info_default("hdf5");
    SNOW_TRY(snow_hdf5_visit(n->context, file, look, n));
    SNOW_TRY(n->status);
    if (!n->count)
        return snow_fail(n->context, SNOW_STATUS_BAD_USAGE,
                         "--dataset %.200s: no data set has such a name; "
                         "correct the pattern",
                         options->dataset);
    qsort(n->all, n->count, sizeof *n->all, by_size);
    info.times = (int64_t)n->count;
    SNOW_TRY(snow_volume_pick_time(n->context, "time step", options, &info));
    out->count = info.times;
    out->step = info.time;
    out->number = n->wanted = n->all[info.time];
    n->path = out->path;
    return snow_hdf5_visit(n->context, file, look, n);
}

snow_status snow_hdf5_find_step(snow_context *context, hid_t file,
                                const snow_volume_options *options,
                                hdf5_series *out) {
    const char *pattern = options->dataset;
    numbers n = {.context = context};
    *out = (hdf5_series){.given = false};
    if (!is_pattern(pattern) || H5Lexists(file, pattern, H5P_DEFAULT) > 0)
        return SNOW_STATUS_OK;
    n.pattern = pattern + (*pattern == '/');
    out->given = true;
    snow_status status = take_step(&n, file, options, out);
    snow_release(context, n.all);
    return status;
}

#endif
