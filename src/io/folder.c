/* io/folder.c - lists the files of a folder or a pattern, in an order that does
 * not depend on the machine: names are compared by character, numbers in them
 * by value. */
#include "io/folder.h"

#include "io/lookup.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

const char *snow_path_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* More files than any image series has. */
#define MOST_FILES ((size_t)1 << 24)

/* Below a folder: more than any disk of images has, and few enough to be looked
 * at one by one. */
#define MOST_BELOW ((size_t)1 << 16)
#define MOST_LEVELS 5

/* 0: nothing, or the look-up has failed. */
static mode_t mode_of(snow_context *context, const char *path) {
    mode_t mode = 0;
    return snow_look_for(context, path, &mode) == SNOW_STATUS_OK ? mode : 0;
}

bool snow_is_there(snow_context *context, const char *path, size_t length) {
    char whole[4096];
    if (length >= sizeof whole)
        return false;
    memcpy(whole, path, length);
    whole[length] = 0;
    return mode_of(context, whole) != 0;
}

const char *snow_data_set_in(snow_context *context, const char *path) {
    const char *found = NULL;
    for (const char *at = path; (at = strstr(at, ":/")); at++)
        found = at;
    if (!found || snow_is_there(context, path, strlen(path)) ||
        !snow_is_there(context, path, (size_t)(found - path)))
        return NULL;
    return found + 1;
}

bool snow_is_folder(snow_context *context, const char *path) {
    return S_ISDIR(mode_of(context, path));
}

/* The length of "%d", "%5d" or "%05d"; 0 for other text. */
static size_t number_letters(const char *text) {
    if (*text != '%')
        return 0;
    size_t digits = strspn(text + 1, "0123456789");
    return digits <= 2 && text[1 + digits] == 'd' ? digits + 2 : 0;
}

bool snow_is_pattern(snow_context *context, const char *path) {
    const char *part = snow_path_name(path);
    bool signs = strpbrk(part, "*?") != NULL;
    for (const char *at = part; *at && !signs; at++)
        signs = number_letters(at) > 0;
    return signs && mode_of(context, path) == 0;
}

/* The depth of recursion is the number of '*' and numbers in the pattern. */
static bool fits(const char *pattern, const char *name) {
    for (; *pattern; pattern++, name++) {
        size_t letters = number_letters(pattern);
        if (*pattern == '*') {
            for (; *name; name++)
                if (fits(pattern + 1, name))
                    return true;
            return fits(pattern + 1, name);
        }
        if (letters) {
            size_t digits = strspn(name, "0123456789");
            for (size_t some = digits; some; some--)
                if (fits(pattern + letters, name + some))
                    return true;
            return false;
        }
        if (!*name || (*pattern != '?' && *pattern != *name))
            return false;
    }
    return !*name;
}

/* Numbers by their value, other characters by their code; equal numbers of
 * different length by length, so that the order is unique. */
int snow_name_compare(const char *a, const char *b) {
    while (*a && *b) {
        if (isdigit((unsigned char)*a) && isdigit((unsigned char)*b)) {
            size_t zeros_a = strspn(a, "0"), zeros_b = strspn(b, "0");
            const char *x = a + zeros_a, *y = b + zeros_b;
            size_t digits_a = strspn(x, "0123456789");
            size_t digits_b = strspn(y, "0123456789");
            if (digits_a != digits_b)
                return digits_a < digits_b ? -1 : 1;
            int order = strncmp(x, y, digits_a);
            if (order || zeros_a != zeros_b)
                return order ? order : zeros_a < zeros_b ? -1 : 1;
            a = x + digits_a;
            b = y + digits_b;
        } else if (*a != *b) {
            return (unsigned char)*a < (unsigned char)*b ? -1 : 1;
        } else {
            a++;
            b++;
        }
    }
    return *a ? 1 : *b ? -1 : 0;
}

static int compare_paths(const void *a, const void *b) {
    return snow_name_compare(*(char *const *)a, *(char *const *)b);
}

/* Collected names one after another, each with its NUL. */
typedef struct names {
    char *block;
    size_t used, count;
    int levels;     /* of folders below that are listed too */
    size_t folders; /* of them so far */
    bool below;     /* they are listed */
} names;

static bool is_too_many(const names *all) {
    return all->below && all->count + all->folders > MOST_BELOW;
}

static snow_status list_folder(snow_context *context, const char *folder,
                               const char *pattern, names *all);

/* Lists a folder below, whose path is the next in the block. */
static snow_status add_below(snow_context *context, names *all) {
    const char *path = all->block + all->used;
    const size_t length = strlen(path);
    char *folder = snow_allocate(context, length + 1);
    if (!folder)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(folder, path, length + 1);
    all->levels--;
    all->folders++;
    snow_status status = list_folder(context, folder, "", all);
    all->levels++;
    snow_release(context, folder);
    return status;
}

static snow_status add_name(snow_context *context, names *all,
                            const char *folder, size_t folder_length,
                            const char *name) {
    size_t length = strlen(name) + 1;
    SNOW_TRY(SNOW_RESERVE(context, all->block, all->used,
                          all->used + folder_length + length));
    char *path = all->block + all->used;
    memcpy(path, folder, folder_length);
    memcpy(path + folder_length, name, length);
    mode_t mode = 0;
    /* Whoever opens a link that leads nowhere fails: it may be a slice that has
     * not been fetched. */
    const bool dangles = snow_is_dangling(path);
    if (!dangles)
        SNOW_TRY(snow_look_at_given(context, path, &mode));
    if (!dangles && S_ISDIR(mode) && all->levels)
        return add_below(context, all);
    if (!dangles && !S_ISREG(mode))
        return SNOW_STATUS_OK; /* not stored: the next name overwrites it */
    all->used += folder_length + length;
    all->count++;
    return SNOW_STATUS_OK;
}

static snow_status collect_names(snow_context *context, DIR *stream,
                                 const char *folder, size_t folder_length,
                                 const char *pattern, names *all) {
    while (!is_too_many(all)) {
        errno = 0;
        const struct dirent *entry = readdir(stream);
        if (!entry && errno)
            return snow_lookup_fail(context, folder_length ? folder : ".",
                                    "listed to its end");
        if (!entry)
            return SNOW_STATUS_OK;
        if (*entry->d_name == '.' ||
            (*pattern && !fits(pattern, entry->d_name)))
            continue;
        SNOW_TRY(add_name(context, all, folder, folder_length, entry->d_name));
        if (all->count > MOST_FILES)
            return snow_fail(
                context, SNOW_STATUS_BAD_INPUT,
                "has more than %zu files; give a pattern that matches fewer",
                MOST_FILES);
    }
    return SNOW_STATUS_OK;
}

/* Makes the caller's list: pointers, followed by the names. */
static snow_status make_list(snow_context *context, const names *all,
                             snow_folder *out) {
    char **paths =
        snow_allocate(context, all->count * sizeof *paths + all->used);
    if (!paths)
        return SNOW_STATUS_NO_MEMORY;
    char *at = (char *)(paths + all->count);
    if (all->used)
        memcpy(at, all->block, all->used);
    for (size_t i = 0; i < all->count; i++) {
        paths[i] = at;
        at += strlen(at) + 1;
    }
    qsort(paths, all->count, sizeof *paths, compare_paths);
    *out = (snow_folder){context, paths, all->count};
    return SNOW_STATUS_OK;
}

static snow_status list_folder(snow_context *context, const char *folder,
                               const char *pattern, names *all) {
    size_t length = strlen(folder);
    char *begin = snow_allocate(context, length + 2);
    if (!begin)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(begin, folder, length + 1);
    DIR *stream = opendir(*folder ? folder : ".");
    if (length && folder[length - 1] != '/')
        begin[length++] = '/';
    snow_status status =
        stream ? collect_names(context, stream, begin, length, pattern, all)
               : snow_lookup_fail(context, *folder ? folder : ".", "listed");
    if (stream)
        closedir(stream);
    snow_release(context, begin);
    return status;
}

static snow_status list_at(snow_context *context, const char *folder,
                           const char *pattern, names all, snow_folder *out) {
    snow_status status = list_folder(context, folder, pattern, &all);
    if (is_too_many(&all))
        all.used = all.count = 0;
    if (status == SNOW_STATUS_OK)
        status = make_list(context, &all, out);
    snow_release(context, all.block);
    return status;
}

/* The last component of a path may be a pattern; all before it is the folder.
 */
snow_status snow_folder_list(snow_context *context, const char *path,
                             snow_folder *out) {
    bool whole = snow_is_folder(context, path);
    const char *pattern = whole ? "" : snow_path_name(path);
    size_t length = whole ? strlen(path) : (size_t)(pattern - path);
    char *folder = snow_allocate(context, length + 1);
    if (!folder)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(folder, path, length);
    folder[length] = 0;
    snow_status status = list_at(context, folder, pattern, (names){0}, out);
    snow_release(context, folder);
    return status;
}

snow_status snow_folder_list_below(snow_context *context, const char *path,
                                   snow_folder *out) {
    const names all = {.levels = MOST_LEVELS, .below = true};
    return list_at(context, path, "", all, out);
}

bool snow_folder_below(const char *path, char *name, size_t capacity) {
    DIR *stream = opendir(path);
    const struct dirent *entry;
    bool found = false;
    while (stream && (entry = readdir(stream))) {
        struct stat about;
        size_t size = strlen(entry->d_name) + 1;
        if (*entry->d_name == '.' || size > capacity ||
            (found && snow_name_compare(entry->d_name, name) > 0) ||
            fstatat(dirfd(stream), entry->d_name, &about, 0) ||
            !S_ISDIR(about.st_mode))
            continue;
        memcpy(name, entry->d_name, size);
        found = true;
    }
    if (stream)
        closedir(stream);
    return found;
}

void snow_folder_free(snow_folder *folder) {
    snow_release(folder->context, folder->paths);
}
