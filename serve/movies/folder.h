/* folder.h - a folder for files that nobody but this user may see, and that do
 * not outlive the program. */
#ifndef MOVIES_FOLDER_H
#define MOVIES_FOLDER_H

#include <limits.h>

typedef struct private_folder {
    char path[PATH_MAX / 2]; /* "": none */
    int lock;                /* held while its program lives */
} private_folder;

/* Where it is made: TMPDIR, or /tmp. */
const char *folder_parent(void);

/* Makes it, and removes those of programs that were killed.  Returns 0 or an
 * error number. */
int folder_make(private_folder *out);

/* Removes it with all that is in it. */
void folder_remove(private_folder *f);

#endif
