/* download.c - implements download.h. */
#include "net/download.h"
#include "net/pages.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PIECE_BYTES 65536

static const struct {
    const char *suffix, *type;
} types[] = {{".mp4", "video/mp4"},
             {".webm", "video/webm"},
             {".gif", "image/gif"},
             {".webp", "image/webp"}};

static const char *type_of(const char *name) {
    const char *suffix = strrchr(name, '.');
    for (size_t i = 0; suffix && i < sizeof types / sizeof *types; i++)
        if (strcmp(suffix, types[i].suffix) == 0)
            return types[i].type;
    return "application/octet-stream";
}

static bool has_secret(struct lws *wsi, const guard *g) {
    char token[GUARD_TOKEN_MOST + 2];
    const int length =
        lws_hdr_copy(wsi, token, sizeof token, WSI_TOKEN_X_AUTH_TOKEN);
    return length > 0 && guard_token(g, token, (size_t)length);
}

bool download_is_meant(const char *path) {
    const char *page = guard_page(path);
    return page && strcmp(page, "movie") == 0;
}

int download_answer(struct lws *wsi, const guard *g, movie_job *job,
                    download *d) {
    char host[GUARD_HOST_BYTES] = "", name[100];
    char *uri;
    int length;
    struct stat what;
    lws_hdr_copy(wsi, host, sizeof host, WSI_TOKEN_HOST);
    if (!guard_host(g, host))
        return pages_refuse(wsi, 421, "This name is not allowed here.\n");
    if (lws_http_get_uri_and_method(wsi, &uri, &length) != LWSHUMETH_GET)
        return pages_refuse(wsi, 405, "Only GET is understood.\n");
    if (!has_secret(wsi, g))
        return pages_refuse(wsi, 403,
                            "The secret of the printed URL is "
                            "needed.\n");
    download_close(d); /* of an earlier request */
    d->file = job ? job_open(job, name) : -1;
    if (d->file < 0)
        return pages_refuse(wsi, 404,
                            "There is no movie: it was taken away, or "
                            "is not written yet.\n");
    d->open = true;
    if (fstat(d->file, &what) != 0 || what.st_size < 1)
        return -1;
    d->left = (uint64_t)what.st_size;
    if (!pages_head(wsi, type_of(name), d->left))
        return -1;
    lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, DOWNLOAD_SECONDS);
    lws_callback_on_writable(wsi);
    return 0;
}

int download_send(struct lws *wsi, download *d) {
    static unsigned char scratch[LWS_PRE + PIECE_BYTES];
    ssize_t got;
    while ((got = read(d->file, scratch + LWS_PRE, PIECE_BYTES)) < 0 &&
           errno == EINTR)
        continue;
    if (got <= 0 || (uint64_t)got > d->left)
        return -1; /* the reader sees that it is not whole */
    d->left -= (uint64_t)got;
    if (lws_write(wsi, scratch + LWS_PRE, (size_t)got,
                  d->left ? LWS_WRITE_HTTP : LWS_WRITE_HTTP_FINAL) < got)
        return -1;
    lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, DOWNLOAD_SECONDS);
    if (d->left) {
        lws_callback_on_writable(wsi);
        return 0;
    }
    download_close(d);
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

bool download_is_open(const download *d) {
    return d && d->open;
}

void download_close(download *d) {
    if (d && d->open)
        close(d->file);
    if (d)
        d->open = false;
}
