/* io/tmpfile.c - see tmpfile.h; the method is described in open(2) and
 * linkat(2). */
#define _GNU_SOURCE /* O_TMPFILE */
#include "io/tmpfile.h"

#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

/* 0: disabled, or the system has none. */
#ifndef SNOW_TMPFILE
#ifdef O_TMPFILE
#define SNOW_TMPFILE O_TMPFILE
#else
#define SNOW_TMPFILE 0
#endif
#endif

#define NAME_BYTES 32

/* The name under /proc of an open file. */
static void name_descriptor(int file, char out[NAME_BYTES]) {
    snprintf(out, NAME_BYTES, "/proc/self/fd/%d", file);
}

int snow_tmpfile_open(const char *folder, mode_t mode) {
    char descriptor[NAME_BYTES];
    if (!SNOW_TMPFILE)
        return -1;
    int file = open(folder, O_WRONLY | SNOW_TMPFILE | O_CLOEXEC, mode);
    if (file < 0)
        return -1;
    name_descriptor(file, descriptor);
    if (access(descriptor, F_OK) == 0)
        return file;
    close(file);
    return -1;
}

int snow_tmpfile_link(int file, const char *path) {
    char descriptor[NAME_BYTES];
    name_descriptor(file, descriptor);
    return linkat(AT_FDCWD, descriptor, AT_FDCWD, path, AT_SYMLINK_FOLLOW);
}
