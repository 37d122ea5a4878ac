/* secret.c - the secret of the URL (sockets.h): 128 bits of the system's random
 * numbers, or the first line of a file. */
#define _GNU_SOURCE /* getrandom */
#include "net/sockets.h"
#include "run/log.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

static int draw_secret(guard *g) {
    unsigned char bits[GUARD_TOKEN_BITS / 8];
    if (getrandom(bits, sizeof bits, 0) != (ssize_t)sizeof bits)
        return fail_output("the system gives no random numbers; name a secret "
                           "with --token-file");
    for (size_t i = 0; i < sizeof bits; i++)
        snprintf(g->token + 2 * i, 3, "%02x", bits[i]);
    return CONTINUE;
}

static int refuse_file(const char *path, const char *why) {
    return fail_usage("--token-file: %s %s; use a file that only its owner "
                      "can read (mode 0600), with a line of %d to %d letters "
                      "and digits",
                      path, why, GUARD_TOKEN_LEAST, GUARD_TOKEN_MOST);
}

static int read_secret(const char *path, int fd, guard *g) {
    char line[GUARD_TOKEN_MOST + 2] = "";
    struct stat what;
    if (fstat(fd, &what) != 0 || !S_ISREG(what.st_mode))
        return refuse_file(path, "is no file");
    if (what.st_mode & 077)
        return refuse_file(path, "can be read by others");
    if (read(fd, line, sizeof line - 1) < 0)
        return refuse_file(path, "cannot be read");
    line[strcspn(line, "\r\n")] = 0;
    if (!guard_is_token(line))
        return refuse_file(path, "holds no secret");
    memcpy(g->token, line, strlen(line) + 1);
    return CONTINUE;
}

static int write_secret(const char *path, guard *g) {
    int done = draw_secret(g);
    int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (done != CONTINUE || fd < 0)
        return done != CONTINUE ? done : refuse_file(path, "cannot be written");
    bool good = dprintf(fd, "%s\n", g->token) > 0;
    if (close(fd) == 0 && good)
        return CONTINUE;
    unlink(path);
    return refuse_file(path, "cannot be written");
}

int secret_make(const options *opts, guard *g) {
    if (!opts->token_file)
        return draw_secret(g);
    int fd = open(opts->token_file, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        return errno == ENOENT
                   ? write_secret(opts->token_file, g)
                   : refuse_file(opts->token_file, "cannot be read");
    int done = read_secret(opts->token_file, fd, g);
    close(fd);
    return done;
}
