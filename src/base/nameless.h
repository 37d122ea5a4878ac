/* base/nameless.h - files that have no name until they are given one (Linux's
 * O_TMPFILE), so that of one that nobody ends nothing is left. */
#ifndef SNOW_NAMELESS_H
#define SNOW_NAMELESS_H

#include <sys/types.h>

/* Opens one in a folder, for writing; -1 where there are none, or they could
 * not be named later. */
int snow_nameless_open(const char *folder, mode_t mode);

/* Gives it a name in that folder that nobody has; -1 and errno. */
int snow_nameless_link(int file, const char *path);

#endif
