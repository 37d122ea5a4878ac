/* download.h - sends the movie that is done, to who has the secret: in a
 * header, as addresses stand in histories and logs. */
#ifndef DOWNLOAD_H
#define DOWNLOAD_H

#include "movies/job.h"
#include "net/guard.h"

#include <libwebsockets.h>

/* How long its reader may take nothing. */
#define DOWNLOAD_SECONDS 60

/* lws allocates it, zeroed, for each request. */
typedef struct download {
    bool open;
    int file;
    uint64_t left;
} download;

/* Whether a path is its address, before which a proxy may put others. */
bool download_is_meant(const char *path);

/* Answers a request.  Returns what a callback of lws does, as all here do: 0
 * where it is sent. */
int download_answer(struct lws *wsi, const guard *g, movie_job *job,
                    download *d);

/* Sends more; called when the socket can take it. */
int download_send(struct lws *wsi, download *d);
bool download_is_open(const download *d);
void download_close(download *d);

#endif
