/* guard.c - implements guard.h. */
#include "net/guard.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static const char *const own_names[] = {"127.0.0.1", "localhost", "[::1]"};

static bool add_host(guard *g, const char *host, size_t length) {
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyz"
                                  "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                  "0123456789.-_:[]";
    if (length == 0 || length >= GUARD_HOST_BYTES ||
        g->count == GUARD_HOSTS_MOST || strspn(host, allowed) < length)
        return false;
    snprintf(g->hosts[g->count++], GUARD_HOST_BYTES, "%.*s", (int)length, host);
    return true;
}

void guard_allow_own(guard *g, int port) {
    char host[64];
    g->any_port = port == 0;
    for (size_t i = 0; i < sizeof own_names / sizeof *own_names; i++) {
        snprintf(host, sizeof host, port ? "%s:%d" : "%s", own_names[i], port);
        add_host(g, host, strlen(host));
        if (port == 80) /* which browsers leave out */
            add_host(g, own_names[i], strlen(own_names[i]));
    }
    g->own = g->count;
}

bool guard_allow(guard *g, const char *list) {
    for (;;) {
        size_t length = strcspn(list, ",");
        if (!add_host(g, list, length))
            return false;
        if (!list[length])
            return true;
        list += length + 1;
    }
}

#define LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
#define DIGITS "0123456789"

/* What a content security policy takes as an origin, and never more than one
 * word of it. */
static bool is_origin(const char *text) {
    size_t scheme = strspn(text, LETTERS DIGITS "+-.");
    const char *host = text + scheme + 3;
    if (!scheme || !strspn(text, LETTERS) ||
        strncmp(text + scheme, "://", 3) != 0)
        return false;
    size_t length = strspn(host, LETTERS DIGITS "-.");
    const char *port = host + length;
    if (!length || !*port)
        return length > 0;
    size_t digits = strspn(port + 1, DIGITS);
    return *port == ':' && digits > 0 && digits < 6 && !port[1 + digits];
}

bool guard_embed(guard *g, const char *list) {
    char *at = g->around, *end = at + sizeof g->around;
    for (;;) {
        size_t length = strcspn(list, ",");
        if (length + 2 > (size_t)(end - at))
            return false;
        snprintf(at, length + 1, "%s", list);
        if (!is_origin(at))
            return false;
        at += length;
        if (!list[length])
            return true;
        *at++ = ' ';
        list += length + 1;
    }
}

static bool is_named(const guard *g, int index, const char *host) {
    const char *name = g->hosts[index];
    if (strcasecmp(name, host) == 0)
        return true;
    /* The length of a name without ":8000". */
    const char *colon = strrchr(host, ':');
    size_t digits = colon ? strspn(colon + 1, "0123456789") : 0;
    size_t length = colon && digits && !colon[1 + digits]
                        ? (size_t)(colon - host)
                        : strlen(host);
    return g->any_port && index < g->own && strlen(name) == length &&
           strncasecmp(name, host, length) == 0;
}

bool guard_host(const guard *g, const char *host) {
    for (int i = 0; host && i < g->count; i++)
        if (is_named(g, i, host))
            return true;
    return false;
}

/* Names of this machine are never reached by https: no proxy is between. */
bool guard_origin(const guard *g, const char *origin, const char *host) {
    bool plain = origin && strncmp(origin, "http://", 7) == 0;
    bool secure = origin && strncmp(origin, "https://", 8) == 0;
    if (!plain && !secure)
        return false;
    const char *name = origin + (plain ? 7 : 8);
    for (int i = 0; i < g->count; i++) {
        bool mine = i < g->own;
        if (!is_named(g, i, name) || (mine && secure))
            continue;
        return !mine || !g->any_port || (host && strcasecmp(name, host) == 0);
    }
    return false;
}

bool guard_token(const guard *g, const char *token, size_t length) {
    size_t wanted = strlen(g->token);
    unsigned different = wanted != length || wanted == 0;
    for (size_t i = 0; i < GUARD_TOKEN_MOST; i++) {
        unsigned char a = (unsigned char)g->token[i < wanted ? i : 0];
        unsigned char b = length ? (unsigned char)token[i % length] : 0;
        different |= i < wanted ? (unsigned)(a ^ b) : 0;
    }
    return different == 0;
}

bool guard_is_token(const char *text) {
    size_t length = strlen(text);
    return length >= GUARD_TOKEN_LEAST && length <= GUARD_TOKEN_MOST &&
           strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                        "0123456789-_") == length;
}

const char *guard_page(const char *path) {
    const char *slash = path ? strrchr(path, '/') : NULL;
    return slash ? slash + 1 : NULL;
}
