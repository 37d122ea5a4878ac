/* io/tmpfile.h - temporary files without a name until they are given one
 * (Linux's O_TMPFILE), so that an abandoned one leaves nothing. */
#ifndef SNOW_IO_TMPFILE_H
#define SNOW_IO_TMPFILE_H

#include <sys/types.h>

/* Opens one in a folder, for writing; -1 if not supported, or if it could not
 * be named later. */
int snow_tmpfile_open(const char *folder, mode_t mode);

/* Gives it a name in that folder that does not exist yet; -1 and errno. */
int snow_tmpfile_link(int file, const char *path);

#endif
