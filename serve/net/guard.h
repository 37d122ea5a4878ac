/* guard.h - who may talk to the viewer: names of the server, origins of pages,
 * the secret of the URL.
 *
 * Other users of the machine can reach 127.0.0.1, and so can any page in the
 * user's own browser.  The secret keeps out the former; exact names keep out
 * the latter, also when a page's own name is made to mean 127.0.0.1 (DNS
 * rebinding).  Nothing here touches a socket. */
#ifndef GUARD_H
#define GUARD_H

#include <stdbool.h>
#include <stddef.h>

#define GUARD_HOSTS_MOST 16
#define GUARD_HOST_BYTES 256
#define GUARD_AROUND_BYTES 512

/* A secret has 128 random bits, as hexadecimal digits; one from a file may be
 * longer. */
#define GUARD_TOKEN_BITS 128
#define GUARD_TOKEN_LEAST 16
#define GUARD_TOKEN_MOST 128

typedef struct guard {
    char hosts[GUARD_HOSTS_MOST][GUARD_HOST_BYTES]; /* "localhost:8000" */
    int count;
    int own;       /* the first of them, which are this machine's */
    bool any_port; /* of a Unix socket: the tunnel chooses the port */
    char token[GUARD_TOKEN_MOST + 1];
    char around[GUARD_AROUND_BYTES]; /* origins of frames, with blanks between;
                                        "": none */
} guard;

/* Allows the names of this machine at a port; 0: at any port. */
void guard_allow_own(guard *g, int port);

/* Allows the names of a list that commas separate; false for no list of names,
 * or too many. */
bool guard_allow(guard *g, const char *list);

/* Allows frames in pages of a list of origins, scheme://host[:port], that
 * commas separate; false for no such list, or too long a one. */
bool guard_embed(guard *g, const char *list);

/* Whether a Host header is one of the names. */
bool guard_host(const guard *g, const char *host);

/* Whether an Origin header is that of a page under one of the names: over http,
 * or over https behind a proxy.  With any port it is that of `host`. */
bool guard_origin(const guard *g, const char *origin, const char *host);

/* Whether it is the secret, in a time that does not depend on how much of it is
 * right. */
bool guard_token(const guard *g, const char *token, size_t length);

/* Whether a text can be a secret: letters, digits, "-" and "_". */
bool guard_is_token(const char *text);

/* The last part of a path, since a proxy may put others before it; "" for a
 * folder, NULL for what is no path. */
const char *guard_page(const char *path);

#endif
