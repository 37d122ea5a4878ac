/* identity.c - implements identity.h. */
#include "draw/identity.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* Of run.h5:/density it is run.h5. */
void identity_of(const char *path, char out[IDENTITY_BYTES]) {
    char file[PATH_MAX];
    struct stat is;
    const char *within = strstr(path, ":/");
    snprintf(file, sizeof file, "%.*s",
             within ? (int)(within - path) : (int)strlen(path), path);
    *out = 0;
    if (stat(file, &is) == 0)
        snprintf(out, IDENTITY_BYTES, "%lld.%lld.%09ld", (long long)is.st_size,
                 (long long)is.st_mtim.tv_sec, is.st_mtim.tv_nsec);
}

const char *identity_isa(void) {
    return NULL;
}

const char *identity_of_program(void) {
    static char made[IDENTITY_BYTES]; /* one program */
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (!*made)
        snprintf(made, sizeof made, "%lld.%09ld.%ld", (long long)now.tv_sec,
                 now.tv_nsec, (long)getpid());
    return made;
}
