/* inside.h - whether what is opened stays in the folder that was given.
 *
 * Links are followed to what they mean; folders are looked at whole, as readers
 * open each of their files. */
#ifndef FOLDER_INSIDE_H
#define FOLDER_INSIDE_H

#include <limits.h>
#include <stdbool.h>

/* Whether a file or folder, and all that is in it, is in `root`, a path without
 * links.  False where it cannot be said: `where` is then the name that leads
 * out, or what cannot be looked at. */
bool inside_root(const char *root, const char *path, char where[NAME_MAX + 1]);

#endif
