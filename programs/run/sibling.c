/* sibling.c - programs that are installed beside this one. */
#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700 /* readlink */
#endif
#include "run/sibling.h"
#include "run/log.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

bool sibling_find(const char *name, char path[PATH_MAX]) {
    char self[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    if (length <= 0)
        return false;
    self[length] = 0;
    char *slash = strrchr(self, '/');
    int used =
        snprintf(path, PATH_MAX, "%.*s/%s", (int)(slash - self), self, name);
    return used < PATH_MAX &&
           (access(path, X_OK) == 0 ||
            (errno != ENOENT && errno != ENOTDIR && errno != EACCES));
}

/* What stops an exec may be the file itself, or that there is none. */
static int refuse(const char *name) {
    int reason = errno;
    if (reason == EAGAIN || reason == ENOMEM)
        return fail_usage("%s: cannot be started (%s); end other programs, or "
                          "allow more (ulimit -u)",
                          name, strerror(reason));
    return fail_usage("%s: cannot be started (%s); install it beside snowglass "
                      "or in a folder of PATH",
                      name, strerror(reason));
}

int sibling_become(const char *name, char **argv) {
    char path[PATH_MAX];
    argv[0] = (char *)name;
    if (sibling_find(name, path))
        execv(path, argv);
    else
        execvp(name, argv);
    return refuse(name);
}

int sibling_run(const char *name, char **argv) {
    int state = 0;
    fflush(stdout);
    pid_t child = fork();
    if (child < 0)
        return refuse(name);
    if (child == 0)
        _exit(sibling_become(name, argv));
    while (waitpid(child, &state, 0) < 0)
        if (errno != EINTR)
            return refuse(name);
    return WIFEXITED(state) ? WEXITSTATUS(state) : SNOW_STATUS_FAILED;
}
