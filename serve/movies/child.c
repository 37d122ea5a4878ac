/* child.c - implements child.h. */
#define _GNU_SOURCE
#include "movies/child.h"
#include "run/sibling.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#define PROGRAM "snowglass"
#define LOWEST 19
#define FILES_MOST 4096

/* --- words ---------------------------------------------------------------- */

/* Copies the next word without its quotes; where the command goes on. */
static const char *take_word(const char *at, char **out) {
    bool quoted = false;
    at += strspn(at, " ");
    for (; *at && (quoted || *at != ' '); at++) {
        if (*at == '\'')
            quoted = !quoted;
        else if (*at == '\\' && !quoted && at[1])
            *(*out)++ = *++at;
        else
            *(*out)++ = *at;
    }
    *(*out)++ = 0;
    return at + strspn(at, " ");
}

char **child_words(const char *command, const char *output) {
    static char progress[] = "--progress", always[] = "always";
    const size_t most = strlen(command) / 2 + 4;
    char **words = malloc(most * sizeof *words + strlen(command) + 1);
    size_t count = 0;
    if (!words)
        return NULL;
    for (char *text = (char *)(words + most); *command;) {
        words[count++] = text;
        command = take_word(command, &text);
    }
    for (size_t i = 1; i < count; i++)
        if (strcmp(words[i - 1], "--output") == 0) {
            words[i] = (char *)output;
            break; /* a title of the same word comes later */
        }
    words[count] = progress;
    words[count + 1] = always;
    words[count + 2] = NULL;
    return words;
}

/* --- the process ---------------------------------------------------------- */

/* All that follows a fork is safe in a program of many threads. */
static void become(const char *path, char **words, int pipes[2][2],
                   pid_t parent) {
    const struct rlimit most = {CHILD_FILE_BYTES, CHILD_FILE_BYTES};
    struct rlimit now;
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    setpgid(0, 0);
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
    setpriority(PRIO_PROCESS, 0, LOWEST);
    if (getrlimit(RLIMIT_FSIZE, &now) == 0 && now.rlim_cur > most.rlim_cur)
        setrlimit(RLIMIT_FSIZE, &most);
    const int nothing = open("/dev/null", O_RDWR);
    dup2(nothing, STDIN_FILENO);
    dup2(nothing, STDOUT_FILENO);
    dup2(pipes[0][1], STDERR_FILENO);
    for (int fd = STDERR_FILENO + 1; fd < FILES_MOST; fd++)
        if (fd != pipes[1][1])
            close(fd);
    if (getppid() == parent)
        execvp(path, words);
    const int number = errno;
    _exit(write(pipes[1][1], &number, sizeof number) < 0 ? 126 : 127);
}

/* The error number of an exec that failed; 0: it did not. */
static int read_fault(int from) {
    int number = 0;
    ssize_t got;
    while ((got = read(from, &number, sizeof number)) < 0 && errno == EINTR)
        continue;
    return got == (ssize_t)sizeof number ? number : 0;
}

int child_start(char **words, child *out) {
    int pipes[2][2] = {{-1, -1}, {-1, -1}}; /* of messages; of a failed exec */
    char path[PATH_MAX];
    *out = (child){.messages = -1};
    if (!sibling_find(PROGRAM, path))
        memcpy(path, PROGRAM, sizeof PROGRAM);
    if (pipe2(pipes[0], O_CLOEXEC) != 0)
        return errno;
    const pid_t parent = getpid();
    const bool good = pipe2(pipes[1], O_CLOEXEC) == 0;
    const pid_t process = good ? fork() : -1;
    int number = process < 0 ? errno : 0;
    if (process == 0)
        become(path, words, pipes, parent);
    close(pipes[0][1]);
    if (good)
        close(pipes[1][1]);
    if (process > 0) {
        setpgid(process, process);
        number = read_fault(pipes[1][0]);
    }
    if (good)
        close(pipes[1][0]);
    if (number != 0) {
        close(pipes[0][0]);
        if (process > 0)
            waitpid(process, NULL, 0);
        return number;
    }
    fcntl(pipes[0][0], F_SETFL, O_NONBLOCK);
    out->process = process;
    out->messages = pipes[0][0];
    return 0;
}

/* A whole line, or all that there is at the end, or too much for one. */
static bool take_line(child *c, bool all, char line[CHILD_LINE_BYTES]) {
    char *end = memchr(c->text, '\n', c->used);
    if (!end && !(all && c->used) && c->used < sizeof c->text - 1)
        return false;
    const size_t length = end ? (size_t)(end - c->text) : c->used;
    memcpy(line, c->text, length);
    line[length] = 0;
    const size_t taken = length + (end != NULL);
    c->used -= taken;
    memmove(c->text, c->text + taken, c->used);
    return true;
}

void child_close(child *c) {
    if (c->messages >= 0)
        close(c->messages);
    c->messages = -1;
}

bool child_read(child *c, double seconds, char line[CHILD_LINE_BYTES]) {
    struct pollfd of = {.fd = c->messages, .events = POLLIN};
    if (take_line(c, false, line))
        return true;
    if (c->messages < 0 || poll(&of, 1, (int)(1000 * seconds)) <= 0)
        return false;
    const ssize_t got =
        read(c->messages, c->text + c->used, sizeof c->text - 1 - c->used);
    if (got > 0)
        c->used += (size_t)got;
    if (got == 0)
        child_close(c);
    return take_line(c, got == 0, line);
}

void child_stop(const child *c, bool at_once) {
    if (c->process)
        kill(-c->process, at_once ? SIGKILL : SIGTERM);
}

bool child_ended(child *c, int *code) {
    int how = 0;
    const pid_t done = waitpid(c->process, &how, WNOHANG);
    if (done == 0 || (done < 0 && errno == EINTR))
        return false;
    *code = WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
    c->process = 0;
    return true;
}
