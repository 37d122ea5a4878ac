/* pages.c - implements pages.h.  No file is read; a request names a row of a
 * table or nothing. */
#include "net/pages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define HEADER_BYTES 2048

static const struct {
    const char *name, *value;
} headers[] = {
    {"x-content-type-options:", "nosniff"},
    {"referrer-policy:", "no-referrer"},
    {"permissions-policy:", "camera=(), microphone=(), geolocation=()"},
    {"cross-origin-embedder-policy:", "require-corp"},
    {"vary:", "accept-encoding"},
};

#define POLICY                                                          \
    "default-src 'none'; script-src 'self'; style-src 'self'; "         \
    "img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; " \
    "form-action 'none'; frame-ancestors "

static const char *embedding = "";

void pages_embed(const char *origins) {
    embedding = origins;
}

static bool add(struct lws *wsi, const char *name, const char *value,
                unsigned char **at, unsigned char *end) {
    return lws_add_http_header_by_name(wsi, (const unsigned char *)name,
                                       (const unsigned char *)value,
                                       (int)strlen(value), at, end) == 0;
}

/* In a frame of a page that takes only what is meant for others, the page has
 * to say that it is.  x-frame-options cannot name an origin. */
static bool add_policies(struct lws *wsi, unsigned char **at,
                         unsigned char *end) {
    char policy[sizeof POLICY + GUARD_AROUND_BYTES];
    bool alone = !*embedding;
    snprintf(policy, sizeof policy, POLICY "%s", alone ? "'none'" : embedding);
    return add(wsi, "content-security-policy:", policy, at, end) &&
           add(wsi, "cross-origin-resource-policy:",
               alone ? "same-origin" : "cross-origin", at, end) &&
           (!alone ||
            (add(wsi, "x-frame-options:", "DENY", at, end) &&
             add(wsi, "cross-origin-opener-policy:", "same-origin", at, end)));
}

/* A page is asked for each time, its modules only whether they have changed. */
static bool write_head(struct lws *wsi, unsigned status, const page_file *file,
                       const char *type, bool packed, size_t length) {
    static unsigned char scratch[LWS_PRE + HEADER_BYTES];
    unsigned char *start = scratch + LWS_PRE, *at = start,
                  *end = scratch + sizeof scratch - 1;
    if (lws_add_http_common_headers(wsi, status, type, length, &at, end))
        return false;
    bool good = add_policies(wsi, &at, end);
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
        good = good && add(wsi, headers[i].name, headers[i].value, &at, end);
    good = good && add(wsi, "cache-control:",
                       file && *file->name ? "no-cache" : "no-store", &at, end);
    if (file && *file->name)
        good = good && add(wsi, "etag:", file->tag, &at, end);
    if (packed)
        good = good && add(wsi, "content-encoding:", "gzip", &at, end);
    return good && lws_finalize_write_http_header(wsi, start, &at, end) == 0;
}

/* lws writes into the bytes before a body.  What the socket does not take at
 * once, lws keeps. */
static bool write_body(struct lws *wsi, const void *bytes, size_t length) {
    unsigned char *capacity = malloc(LWS_PRE + length);
    if (!capacity)
        return false;
    memcpy(capacity + LWS_PRE, bytes, length);
    int written =
        lws_write(wsi, capacity + LWS_PRE, length, LWS_WRITE_HTTP_FINAL);
    free(capacity);
    return written >= 0;
}

static int finish(struct lws *wsi, bool good) {
    if (!good)
        return -1;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

int pages_refuse(struct lws *wsi, unsigned status, const char *text) {
    if (write_head(wsi, status, NULL, "text/plain; charset=utf-8", false,
                   strlen(text)))
        write_body(wsi, text, strlen(text));
    return -1;
}

bool pages_head(struct lws *wsi, const char *type, size_t length) {
    return write_head(wsi, 200, NULL, type, false, length);
}

static bool header_of(struct lws *wsi, enum lws_token_indexes which, char *out,
                      size_t size) {
    *out = 0;
    return lws_hdr_copy(wsi, out, (int)size, which) > 0;
}

/* For clients that are no browsers. */
static bool write_unpacked(struct lws *wsi, const page_file *file, bool body) {
    z_stream stream = {.next_in = (unsigned char *)(uintptr_t)file->packed,
                       .avail_in = (unsigned)file->packed_length};
    unsigned char *bytes = malloc(file->length + 1);
    bool good = bytes && inflateInit2(&stream, 16 + MAX_WBITS) == Z_OK;
    if (good) {
        stream.next_out = bytes;
        stream.avail_out = (unsigned)file->length;
        good = inflate(&stream, Z_FINISH) == Z_STREAM_END;
        inflateEnd(&stream);
    }
    good = good && write_head(wsi, 200, file, file->type, false, file->length);
    if (good && body)
        good = write_body(wsi, bytes, file->length);
    free(bytes);
    return good;
}

static int send_file(struct lws *wsi, const page_file *file, bool body) {
    char accepted[256], tag[80];
    header_of(wsi, WSI_TOKEN_HTTP_ACCEPT_ENCODING, accepted, sizeof accepted);
    if (*file->name &&
        header_of(wsi, WSI_TOKEN_HTTP_IF_NONE_MATCH, tag, sizeof tag) &&
        strcmp(tag, file->tag) == 0)
        return finish(wsi, write_head(wsi, 304, file, file->type, false, 0));
    if (!strstr(accepted, "gzip"))
        return finish(wsi, write_unpacked(wsi, file, body));
    bool good =
        write_head(wsi, 200, file, file->type, true, file->packed_length);
    if (good && body)
        good = write_body(wsi, file->packed, file->packed_length);
    return finish(wsi, good);
}

int pages_answer(struct lws *wsi, const guard *g, const char *path) {
    char host[GUARD_HOST_BYTES];
    char *uri;
    int length;
    header_of(wsi, WSI_TOKEN_HOST, host, sizeof host);
    if (!guard_host(g, host))
        return pages_refuse(
            wsi, 421,
            "This name is not allowed here. Use the printed URL; for "
            "a tunnel or a proxy start with --allow-host NAME:PORT.\n");
    int method = lws_http_get_uri_and_method(wsi, &uri, &length);
    if (method != LWSHUMETH_GET && method != LWSHUMETH_HEAD)
        return pages_refuse(wsi, 405, "Only GET is understood.\n");
    const char *name = guard_page(path);
    const page_file *file = page_files;
    while (name && file->name && strcmp(file->name, name) != 0)
        file++;
    return name && file->name
               ? send_file(wsi, file, method == LWSHUMETH_GET)
               : pages_refuse(wsi, 404, "There is no such page.\n");
}
