/* sizes.h - each page has a window of its own, and all see one state.
 *
 * While a page turns only its size is drawn, and the others show that picture
 * scaled; at rest each of the first STATE_SIZES_MOST sizes has a picture. */
#ifndef SIZES_H
#define SIZES_H

#include "net/client.h"
#include "state.h"

/* Which pages are served with their own size, and tells the state. */
void sizes_collect(client *pages, viewer_state *s);

/* What a page's changes are to the state, to be freed: with its size, as it is
 * now the one that acts, or without where that alone changes and others look
 * too. */
json_t *sizes_take(client *pages, client *c, viewer_state *s,
                   const json_t *changes);

/* The picture at rest for a page whose size alone has changed: it is there, or
 * is drawn. */
void sizes_serve(client *c, viewer_state *s, outbox *box);

/* A page's question with its size. */
json_t *sizes_ask(const client *c, const json_t *question);

#endif
