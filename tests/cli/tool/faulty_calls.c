/* tests/cli/tool/faulty_calls.c - loaded into the tool before all else
 * (LD_PRELOAD), makes calls of the system fail, as SNOW_FAULT says:
 *
 *   interrupt   a signal comes into each second write, sync and close
 *   join        the head of a movie cannot be written, and then no folder
 * listed threads     there are no threads; processes for `spawn`; files for
 * `files`
 */
#define _GNU_SOURCE /* RTLD_NEXT, syscall */
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#define SEEN __attribute__((visibility("default")))

static bool is_fault(const char *name) {
    const char *asked = getenv("SNOW_FAULT");
    return asked && strcmp(asked, name) == 0;
}

static bool is_interrupted(void) {
    static __thread unsigned calls;
    if (!is_fault("interrupt") || calls++ % 2)
        return false;
    errno = EINTR;
    return true;
}

static bool is_broken; /* by the fault `join` */

SEEN DIR *opendir(const char *path) {
    DIR *(*real)(const char *) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "opendir");
    errno = EIO;
    return is_broken ? NULL : real(path);
}

SEEN ssize_t write(int file, const void *bytes, size_t size) {
    if (is_fault("join") && size == 44 && memcmp(bytes, "RIFF", 4) == 0) {
        is_broken = true;
        errno = EIO;
        return -1;
    }
    return is_interrupted() ? -1 : syscall(SYS_write, file, bytes, size);
}

SEEN int fsync(int file) {
    return is_interrupted() ? -1 : (int)syscall(SYS_fsync, file);
}

SEEN int close(int file) {
    const int done = (int)syscall(SYS_close, file);
    return is_interrupted() ? -1 : done;
}

SEEN int pthread_create(pthread_t *thread, const pthread_attr_t *how,
                        void *(*run)(void *), void *user) {
    int (*real)(pthread_t *, const pthread_attr_t *, void *(*)(void *),
                void *) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "pthread_create");
    return is_fault("threads") ? EAGAIN : real(thread, how, run, user);
}

SEEN int posix_spawnp(pid_t *process, const char *file,
                      const posix_spawn_file_actions_t *actions,
                      const posix_spawnattr_t *how, char *const words[],
                      char *const environment[]) {
    (void)process, (void)file, (void)actions, (void)how, (void)words,
        (void)environment;
    return is_fault("spawn") ? EAGAIN : ENOSYS;
}

SEEN FILE *fopen(const char *path, const char *mode) {
    FILE *(*real)(const char *, const char *) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "fopen");
    errno = EMFILE;
    return is_fault("files") ? NULL : real(path, mode);
}
