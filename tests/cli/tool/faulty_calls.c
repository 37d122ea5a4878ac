/* tests/cli/tool/faulty_calls.c - loaded into the tool before all else
 * (LD_PRELOAD), makes calls of the system fail, as SNOW_FAULT says:
 *
 *   interrupt   a signal comes into each second open, write, sync and close
 *   join        a movie's head cannot be written, and then no folder listed
 *   threads     there are no threads
 *   spawn       there are no processes
 *   files       there are no more files
 *   look        look-up number SNOW_LOOK fails, and leaves a file `met` */
#define _GNU_SOURCE /* RTLD_NEXT, syscall, stat64 */
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
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

/* Of paths of the system none is lost. */
static bool is_lost(const char *path) {
    static int looked;
    const char *number = getenv("SNOW_LOOK");
    if (!is_fault("look") || !number || !strncmp(path, "/proc", 5) ||
        !strncmp(path, "/sys", 4) || !strncmp(path, "/dev", 4) ||
        ++looked != atoi(number))
        return false;
    syscall(SYS_close, syscall(SYS_openat, AT_FDCWD, "met", O_CREAT, 0600));
    errno = EIO;
    return true;
}

#define LOOK(type, name, lost, parameters, ...)          \
    SEEN type name parameters {                          \
        type(*real) parameters = NULL;                   \
        *(void **)&real = dlsym(RTLD_NEXT, #name);       \
        return is_lost(path) ? lost : real(__VA_ARGS__); \
    }
LOOK(int, stat64, -1, (const char *path, struct stat64 *out), path, out)
LOOK(int, lstat64, -1, (const char *path, struct stat64 *out), path, out)
LOOK(int, fstatat64, -1,
     (int at, const char *path, struct stat64 *out, int how), at, path, out,
     how)
LOOK(int, access, -1, (const char *path, int mode), path, mode)
LOOK(int, __open64_2, -1, (const char *path, int how), path, how)
LOOK(int, openat64, -1, (int at, const char *path, int how, ...), at, path, how,
     0666)
LOOK(char *, realpath, NULL, (const char *path, char *out), path, out)
LOOK(char *, __realpath_chk, NULL, (const char *path, char *out, size_t room),
     path, out, room)

SEEN int open64(const char *path, int how, ...) {
    int (*real)(const char *, int, ...) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "open64");
    return is_lost(path) || is_interrupted() ? -1 : real(path, how, 0666);
}

static bool is_broken; /* by the fault `join` */

SEEN DIR *opendir(const char *path) {
    DIR *(*real)(const char *) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "opendir");
    errno = EIO;
    return is_broken || is_lost(path) ? NULL : real(path);
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
    return is_fault("files") || is_lost(path) ? NULL : real(path, mode);
}
