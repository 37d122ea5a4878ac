/* base/nameless.c - see nameless.h; open(2) and linkat(2) tell of the way. */
#define _GNU_SOURCE /* O_TMPFILE */
#include "base/nameless.h"

#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

/* 0: none are wanted, or the system has none. */
#ifndef SNOW_NAMELESS
#ifdef O_TMPFILE
#define SNOW_NAMELESS O_TMPFILE
#else
#define SNOW_NAMELESS 0
#endif
#endif

#define NAME_BYTES 32

/* The name by which the kernel knows what is open here. */
static void name_descriptor(int file, char out[NAME_BYTES]) {
    snprintf(out, NAME_BYTES, "/proc/self/fd/%d", file);
}

int snow_nameless_open(const char *folder, mode_t mode) {
    char descriptor[NAME_BYTES];
    if (!SNOW_NAMELESS)
        return -1;
    int file = open(folder, O_WRONLY | SNOW_NAMELESS | O_CLOEXEC, mode);
    if (file < 0)
        return -1;
    name_descriptor(file, descriptor);
    if (access(descriptor, F_OK) == 0)
        return file;
    close(file);
    return -1;
}

int snow_nameless_link(int file, const char *path) {
    char descriptor[NAME_BYTES];
    name_descriptor(file, descriptor);
    return linkat(AT_FDCWD, descriptor, AT_FDCWD, path, AT_SYMLINK_FOLLOW);
}
