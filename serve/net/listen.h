/* listen.h - serves pages over libwebsockets, with limits of its own.
 *
 * A connection has 5 s for each request and, as a WebSocket, 2 s for its hello.
 * At most 64 are silent: when one more comes, the oldest is closed, so that
 * idle connections never keep a page out. */
#ifndef LISTEN_H
#define LISTEN_H

#include "movies/job.h"
#include "net/guard.h"
#include "net/outbox.h"
#include "net/sockets.h"
#include "state.h"

#define LISTEN_CLIENTS_MOST 32
#define LISTEN_SILENT_MOST 64
#define LISTEN_REQUEST_SECONDS 5
#define LISTEN_HELLO_SECONDS 2

typedef struct listener listener;

/* Serves on sockets that stay the caller's but are not used by it any more;
 * NULL: no memory. */
listener *listener_new(const sockets *s, const guard *g, double idle);
void listener_free(listener *l);

/* Lets the serving thread know that messages wait, from any thread. */
void listener_wake(void *listener);

/* Serves until a signal comes, or no page was there for the idle time.
 * Questions go first to `hear`, if there is one, which says whether it has
 * taken them.  What a job writes is sent to pages; or NULL. */
typedef bool listener_hear(void *user, uint64_t client, const json_t *question);
void listener_run(listener *l, viewer_state *state, outbox *box,
                  listener_hear *hear, void *hearer, movie_job *job);

/* Ends listener_run, from any thread and from a signal's handler. */
void listener_stop(listener *l);

#endif
