/* paths.h - questions about paths that several verbs ask. */
#ifndef PATHS_H
#define PATHS_H

#include <stdbool.h>
#include <stddef.h>

/* Whether a path is a folder, or a regular file, that exists.  To open another
 * file, a pipe, could take for ever. */
bool is_folder(const char *path);
bool is_file(const char *path);

/* Whether a path names anything that exists, also a link that leads nowhere and
 * what cannot be looked at: to open it says why. */
bool is_there(const char *path);

/* Whether the error number of a look-up says that nothing is there. */
bool means_absence(int number);

/* What to do about an error number of a place for outputs. */
const char *place_remedy(int number);

/* The file of an input that may name a data set in it: run.h5 for run.h5:/rho,
 * if that is there; otherwise the path itself. */
void file_of_input(const char *path, char *out, size_t size);

/* Whether a text ends with another, in the same case. */
bool ends_with(const char *text, const char *end);

#endif
