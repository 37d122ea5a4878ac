/* paths.c - implements paths.h. */
#define _XOPEN_SOURCE 700
#include "run/paths.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

bool is_folder(const char *path) {
    struct stat what;
    return stat(path, &what) == 0 && S_ISDIR(what.st_mode);
}

bool is_file(const char *path) {
    struct stat what;
    return stat(path, &what) == 0 && S_ISREG(what.st_mode);
}

bool ends_with(const char *text, const char *end) {
    size_t length = strlen(text), wanted = strlen(end);
    return length >= wanted && strcmp(text + length - wanted, end) == 0;
}

bool means_absence(int number) {
    return number == ENOENT || number == ENOTDIR;
}

bool is_there(const char *path) {
    struct stat what;
    return lstat(path, &what) == 0 || !means_absence(errno);
}

const char *place_remedy(int number) {
    switch (number) {
    case EMFILE:
    case ENFILE:
        return "close other files, or allow more of them (ulimit -n)";
    case ENOSPC:
    case EDQUOT:
        return "make space, or choose another place";
    default:
        return "choose a place that can be written";
    }
}

void file_of_input(const char *path, char *out, size_t size) {
    const char *set = NULL;
    for (const char *at = path; (at = strstr(at, ":/")); at++)
        set = at;
    snprintf(out, size, "%s", path);
    if (!set || is_there(path) || (size_t)(set - path) >= size)
        return;
    out[set - path] = '\0';
    if (!is_there(out))
        snprintf(out, size, "%s", path);
}
