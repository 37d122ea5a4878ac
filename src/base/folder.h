/* base/folder.h - the files that a folder or a pattern names. */
#ifndef SNOW_FOLDER_H
#define SNOW_FOLDER_H

#include "base/base.h"

/* Paths in the order of people: "s2" before "s10". */
typedef struct snow_folder {
    snow_context *context;
    char **paths; /* one block, and the names behind them */
    size_t count;
} snow_folder;

/* True when the first `length` letters of a path lead to anything. */
bool snow_is_there(const char *path, size_t length);

/* True when the path is a folder; when it is no file of that name, but its last
 * part has a '*', a '?' or a number such as %04d in it. */
bool snow_is_folder(const char *path);
bool snow_is_pattern(const char *path);

/* The regular files of a folder, or those whose names fit a pattern; names that
 * begin with a dot are left out.  May be none.
 * Errors: SNOW_BAD_INPUT (the folder cannot be read), SNOW_NO_MEMORY. */
snow_status snow_folder_list(snow_context *context, const char *path,
                             snow_folder *out);

/* The name of the first folder in a folder, in the same order; false where it
 * has none, or none whose name has room. */
bool snow_folder_below(const char *path, char *name, size_t room);

void snow_folder_free(snow_folder *folder);

/* The order of people, "s2" before "s10": below, equal or above 0. */
int snow_name_compare(const char *a, const char *b);

/* The last number in a path's last part; -1 where there is none. */
int64_t snow_last_number(const char *path);

#endif
