/* io/folder.h - the files in a folder, or those that match a pattern. */
#ifndef SNOW_IO_FOLDER_H
#define SNOW_IO_FOLDER_H

#include "base/base.h"

/* Paths in natural order: "s2" before "s10". */
typedef struct snow_folder {
    snow_context *context;
    char **paths; /* one block, including the names */
    size_t count;
} snow_folder;

/* The last component of a path. */
const char *snow_path_name(const char *path);

/* Where a look-up fails, those that follow return false or NULL, and the
 * failure is kept (lookup.h). */

/* True if the first `length` characters of a path name an existing file or
 * folder. */
bool snow_is_there(snow_context *context, const char *path, size_t length);

/* The path of a data set in "file.h5:/path", if this is not a file but its
 * first part is; otherwise NULL. */
const char *snow_data_set_in(snow_context *context, const char *path);

/* True if the path is a folder; or if there is no file of that name, but its
 * last component contains a '*', a '?' or a number such as %04d. */
bool snow_is_folder(snow_context *context, const char *path);
bool snow_is_pattern(snow_context *context, const char *path);

/* The regular files of a folder, or those whose names match a pattern, with
 * links that lead nowhere, which are to be opened in vain; names that begin
 * with a dot are omitted. May be empty. Errors:
 * SNOW_STATUS_BAD_INPUT (the folder cannot be read, or something in it cannot
 * be looked at), SNOW_STATUS_NO_MEMORY. */
snow_status snow_folder_list(snow_context *context, const char *path,
                             snow_folder *out);

/* The files of a folder and of those below it, as on disks that have
 * STUDY/SERIES/IM1: at most five levels, in the order of their paths; none
 * where they are more than any disk has. Errors: as above. */
snow_status snow_folder_list_below(snow_context *context, const char *path,
                                   snow_folder *out);

/* The name of the first folder in a folder, in the same order, for a message;
 * false if there is none, or none whose name fits. */
bool snow_folder_below(const char *path, char *name, size_t capacity);

void snow_folder_free(snow_folder *folder);

/* Natural order, "s2" before "s10": below, equal or above 0. */
int snow_name_compare(const char *a, const char *b);

#endif
