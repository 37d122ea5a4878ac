/* fuzz/fuzz_viewer.c - an input is what comes through the viewer's sockets: a
 * message of a page or, after a first line "guard", the headers Host and
 * Origin, a secret and a path, each on a line. */
#include "message.c"
#include "movies/order.c"
#include "net/guard.c"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static const char secret[] = "0123456789abcdef0123456789abcdef";

/* What is taken keeps to the limits, and is read again as it was. */
static void check_message(const char *text, size_t length) {
    message m, again;
    const char *key;
    json_t *value;
    if (message_read(text, length, &m))
        return;
    if (length > MESSAGE_BYTES || !m.tree)
        abort();
    if (m.kind == MESSAGE_SET)
        json_object_foreach(m.keys, key, value) if (!message_may_set(key))
            abort();
    movie_order order;
    if (m.kind == MESSAGE_ASK && order_read(m.tree, 9, &order) &&
        (order.frames < 1 || order.frames > ORDER_FRAMES_MOST ||
         order.frames * order.width * order.height > ORDER_PIXELS_MOST))
        abort();
    char *written = json_dumps(m.tree, JSON_COMPACT | JSON_REAL_PRECISION(17));
    if (!written)
        abort();
    if (strlen(written) <= MESSAGE_BYTES) {
        if (message_read(written, strlen(written), &again) ||
            again.kind != m.kind || again.n != m.n || again.on != m.on ||
            (m.kind == MESSAGE_SET && *again.left_out))
            abort();
        message_free(&again);
    }
    free(written);
    message_free(&m);
}

/* An origin is allowed only where its name is, and a secret only as a whole. */
static void check_guard(char *text, int port) {
    guard g = {.count = 0};
    char *lines[4];
    for (int i = 0; i < 4; i++) {
        lines[i] = text;
        text += strcspn(text, "\n");
        if (*text)
            *text++ = '\0';
    }
    memcpy(g.token, secret, sizeof secret);
    guard_allow_own(&g, port);
    guard_allow(&g, "viewer.example.org,node:8000");
    const char *name = strstr(lines[1], "://");
    if (guard_origin(&g, lines[1], lines[0]) &&
        (!name || !guard_host(&g, name + 3)))
        abort();
    if (guard_token(&g, lines[2], strlen(lines[2])) !=
        (strcmp(lines[2], secret) == 0))
        abort();
    const char *page = guard_page(lines[3]);
    if (page && strchr(page, '/'))
        abort();
    guard more = {.count = 0};
    if (guard_allow(&more, lines[0]) && !guard_host(&more, more.hosts[0]))
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    if (size)
        memcpy(text, bytes, size);
    text[size] = '\0';
    if (strncmp(text, "guard\n", 6) == 0) {
        char *copy = strdup(text + 6);
        if (copy)
            check_guard(copy, 0);
        free(copy);
        check_guard(text + 6, 8000);
    } else {
        check_message(text, size);
    }
    free(text);
    return 0;
}
