/* paths.h - questions about paths that several verbs ask. */
#ifndef PATHS_H
#define PATHS_H

#include <stdbool.h>

/* Whether a path is a folder, or a regular file, that exists.  To open another
 * file, a pipe, could take for ever. */
bool is_folder(const char *path);
bool is_file(const char *path);

/* Whether a text ends with another, in the same case. */
bool ends_with(const char *text, const char *end);

#endif
