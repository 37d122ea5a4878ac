/* inside.c - implements inside.h. */
#define _XOPEN_SOURCE 700
#include "folder/inside.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Deeper than any volume's own folders. */
#define LEVELS_MOST 32

static bool is_below(const char *root, const char *path) {
    char real[PATH_MAX];
    const size_t length = strcmp(root, "/") ? strlen(root) : 0;
    return realpath(path, real) && strncmp(real, root, length) == 0 &&
           (real[length] == '/' || !real[length]);
}

static void note(const char *path, char where[NAME_MAX + 1]) {
    const char *slash = strrchr(path, '/');
    snprintf(where, NAME_MAX + 1, "%.*s", NAME_MAX, slash ? slash + 1 : path);
}

static bool check(const char *root, const char *path, int levels,
                  char where[NAME_MAX + 1]);

static bool check_each(const char *root, const char *folder, int levels,
                       char where[NAME_MAX + 1]) {
    char path[PATH_MAX];
    const struct dirent *entry;
    DIR *stream = opendir(folder);
    bool good = stream && levels < LEVELS_MOST;
    if (!good)
        note(folder, where);
    while (good && (entry = readdir(stream))) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        good = snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) <
               PATH_MAX;
        if (!good)
            note(folder, where);
        good = good && check(root, path, levels + 1, where);
    }
    if (stream)
        closedir(stream);
    return good;
}

/* Below a folder a link to another folder is refused too, since it may lead to
 * one around it. */
static bool check(const char *root, const char *path, int levels,
                  char where[NAME_MAX + 1]) {
    struct stat itself, what;
    bool good = lstat(path, &itself) == 0 && stat(path, &what) == 0;
    const bool link = good && S_ISLNK(itself.st_mode);
    if (good && (link || !levels))
        good =
            is_below(root, path) && !(link && levels && S_ISDIR(what.st_mode));
    if (!good)
        note(path, where);
    return good &&
           (!S_ISDIR(what.st_mode) || check_each(root, path, levels, where));
}

bool inside_root(const char *root, const char *path, char where[NAME_MAX + 1]) {
    *where = 0;
    return check(root, path, 0, where);
}
