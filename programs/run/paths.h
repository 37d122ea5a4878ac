/* paths.h - questions about paths that several verbs ask. */
#ifndef PATHS_H
#define PATHS_H

#include <stdbool.h>

/* Whether a path is a folder that exists. */
bool is_folder(const char *path);

/* Whether a text ends with another, in the same case. */
bool ends_with(const char *text, const char *end);

#endif
