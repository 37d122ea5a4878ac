/* paths.c - implements paths.h. */
#define _XOPEN_SOURCE 700
#include "run/paths.h"

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
