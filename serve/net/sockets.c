/* sockets.c - implements sockets.h. */
#define _GNU_SOURCE /* SOCK_CLOEXEC, SOCK_NONBLOCK */
#include "net/sockets.h"
#include "run/log.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#define BACKLOG 128

/* The port that a browser most likely is given for a tunnel. */
#define TUNNEL_PORT 8000

static int open_socket(int family) {
    return socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

static int listen_on(int fd, const struct sockaddr *address, socklen_t size) {
    if (bind(fd, address, size) == 0 && listen(fd, BACKLOG) == 0)
        return fd;
    int reason = errno;
    close(fd);
    errno = reason;
    return -1;
}

/* --- TCP -------------------------------------------------------------------
 */

static int listen_tcp(const struct addrinfo *at) {
    const int on = 1;
    int fd = open_socket(at->ai_family);
    if (fd < 0)
        return -1;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (at->ai_family == AF_INET6)
        setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
    return listen_on(fd, at->ai_addr, at->ai_addrlen);
}

/* An address as numbers; nothing is looked up. */
static int listen_at(const char *address, int port) {
    const struct addrinfo wanted = {.ai_family = AF_UNSPEC,
                                    .ai_socktype = SOCK_STREAM,
                                    .ai_flags =
                                        AI_NUMERICHOST | AI_NUMERICSERV};
    struct addrinfo *found = NULL;
    char text[16];
    snprintf(text, sizeof text, "%d", port);
    if (getaddrinfo(address, text, &wanted, &found) != 0) {
        errno = EADDRNOTAVAIL;
        return -1;
    }
    int fd = listen_tcp(found);
    freeaddrinfo(found);
    return fd;
}

static int port_of(int fd) {
    struct sockaddr_storage at;
    socklen_t size = sizeof at;
    if (getsockname(fd, (struct sockaddr *)&at, &size) != 0)
        return 0;
    return ntohs(at.ss_family == AF_INET6
                     ? ((struct sockaddr_in6 *)&at)->sin6_port
                     : ((struct sockaddr_in *)&at)->sin_port);
}

static int refuse_address(const char *address, int port) {
    if (port)
        return fail_usage("--listen: %s:%d cannot be used (%s); take another "
                          "port, or 0 for a free one",
                          address, port, strerror(errno));
    return fail_usage("--listen: %s cannot be used (%s); give an address of "
                      "this machine as numbers",
                      address, strerror(errno));
}

/* A machine without IPv6, or whose same port is taken there, has one socket. */
static int open_loopback(const options *opts, guard *g, sockets *out) {
    int fd = listen_at("127.0.0.1", opts->listen.port);
    if (fd < 0)
        return refuse_address("127.0.0.1", opts->listen.port);
    out->fds[out->count++] = fd;
    out->port = port_of(fd);
    int other = listen_at("::1", out->port);
    if (other >= 0)
        out->fds[out->count++] = other;
    guard_allow_own(g, out->port);
    snprintf(out->host, sizeof out->host, "127.0.0.1:%d", out->port);
    return CONTINUE;
}

/* All addresses of the machine have its name. */
static int open_address(const options *opts, guard *g, sockets *out) {
    char name[200] = "", allowed[600];
    const char *address = opts->listen.address;
    bool six = strchr(address, ':') != NULL;
    bool all = strcmp(address, "0.0.0.0") == 0 || strcmp(address, "::") == 0;
    int fd = listen_at(address, opts->listen.port);
    if (fd < 0)
        return refuse_address(address, opts->listen.port);
    out->fds[out->count++] = fd;
    out->port = port_of(fd);
    gethostname(name, sizeof name - 1);
    snprintf(out->host, sizeof out->host,
             all   ? "%.200s:%d"
             : six ? "[%.200s]:%d"
                   : "%.200s:%d",
             all ? name : address, out->port);
    guard_allow_own(g, out->port);
    snprintf(allowed, sizeof allowed, "%s,%s:%d", out->host, name, out->port);
    guard_allow(g, allowed);
    say("note: --listen %s: what pages and this program say to each other can "
        "be read on the way; safer is ssh -L %d:127.0.0.1:%d HOST",
        address, TUNNEL_PORT, out->port);
    return CONTINUE;
}

/* --- a Unix socket ----------------------------------------------------------
 */

/* Whether nobody listens there any more: then it may be replaced. */
static bool is_stale(const struct sockaddr_un *at) {
    struct stat what;
    if (lstat(at->sun_path, &what) != 0 || !S_ISSOCK(what.st_mode))
        return false;
    int fd = open_socket(AF_UNIX);
    bool stale = fd >= 0 &&
                 connect(fd, (const struct sockaddr *)at, sizeof *at) != 0 &&
                 errno == ECONNREFUSED;
    if (fd >= 0)
        close(fd);
    return stale;
}

/* Who may rename in the folder could put a socket of their own in the place of
 * ours, and would get the secret.  Where there is no folder, bind says so.
 */
static int check_folder(const char *path) {
    char folder[sizeof(struct sockaddr_un)] = ".";
    struct stat what;
    const char *slash = strrchr(path, '/');
    if (slash) /* the path is short enough for a socket */
        snprintf(folder, sizeof folder, "%.*s",
                 slash > path ? (int)(slash - path) : 1, path);
    if (stat(folder, &what) != 0)
        return errno == ENOENT || errno == ENOTDIR
                   ? CONTINUE
                   : fail_usage(
                         "--listen: %s: %s; name a file in a folder that "
                         "you can read",
                         folder, strerror(errno));
    bool foreign = what.st_uid != geteuid() && what.st_uid != 0;
    bool shared = what.st_mode & (S_IWGRP | S_IWOTH);
    if (!foreign && (!shared || what.st_mode & S_ISVTX))
        return CONTINUE;
    return fail_usage("--listen: others could replace %s, since its folder %s; "
                      "name a file in a folder that only you can write to, "
                      "such as $XDG_RUNTIME_DIR",
                      path,
                      foreign ? "belongs to another user"
                              : "can be written to by others");
}

static int open_path(const options *opts, guard *g, sockets *out) {
    struct sockaddr_un at = {.sun_family = AF_UNIX};
    if (strlen(opts->listen.path) >= sizeof at.sun_path)
        return fail_usage("--listen: %s is too long: %zu bytes; take a shorter "
                          "path",
                          opts->listen.path, sizeof at.sun_path - 1);
    memcpy(at.sun_path, opts->listen.path, strlen(opts->listen.path) + 1);
    int done = check_folder(opts->listen.path);
    if (done != CONTINUE)
        return done;
    if (is_stale(&at))
        unlink(at.sun_path);
    mode_t before = umask(0177); /* before it has a name */
    int fd = open_socket(AF_UNIX);
    if (fd >= 0)
        fd = listen_on(fd, (struct sockaddr *)&at, sizeof at);
    umask(before);
    if (fd < 0)
        return fail_output("--listen: %s cannot be made (%s); name a new file "
                           "in a folder of yours",
                           opts->listen.path, strerror(errno));
    out->fds[out->count++] = fd;
    out->path = opts->listen.path;
    guard_allow_own(g, 0);
    snprintf(out->host, sizeof out->host, "127.0.0.1:%d", TUNNEL_PORT);
    say("note: reach it by ssh -L %d:%s HOST, then open the URL", TUNNEL_PORT,
        opts->listen.path);
    return CONTINUE;
}

int sockets_open(const options *opts, guard *g, sockets *out) {
    *out = (sockets){.fds = {-1, -1}};
    int done = opts->listen.path       ? open_path(opts, g, out)
               : *opts->listen.address ? open_address(opts, g, out)
                                       : open_loopback(opts, g, out);
    if (done != CONTINUE)
        return done;
    if (opts->allow_host && !guard_allow(g, opts->allow_host)) {
        sockets_close(out);
        return fail_usage("--allow-host: '%s' is no list of up to %d names; "
                          "give NAME or NAME:PORT, with commas between",
                          opts->allow_host, GUARD_HOSTS_MOST - 5);
    }
    if (opts->embed && !guard_embed(g, opts->embed)) {
        sockets_close(out);
        return fail_usage("--embed: '%s' is no list of origins; give "
                          "SCHEME://HOST or SCHEME://HOST:PORT, with commas "
                          "between",
                          opts->embed);
    }
    return CONTINUE;
}

void sockets_close(sockets *s) {
    for (int i = 0; i < s->count; i++)
        if (s->fds[i] >= 0)
            close(s->fds[i]);
    if (s->path)
        unlink(s->path);
    s->count = 0;
    s->path = NULL;
}
