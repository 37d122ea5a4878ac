/* live.h - the newest picture of a running simulation (snowglass/insitu.h), of
 * which the viewer knows nothing but its recipe and its files.
 *
 * The simulation writes pictures and reads its recipe again when that changes
 * ("reread").  So nothing ties it to a page: it waits for none, and needs no
 * network. */
#ifndef LIVE_H
#define LIVE_H

#include "net/outbox.h"
#include "options/options.h"
#include "state.h"

typedef struct live live;

/* Reads the recipe of the options.  Returns CONTINUE or an exit code. */
int live_new(const options *opts, live **out);
void live_free(live *l);

/* A copy of the recipe, whose state the pages change; NULL: no memory. */
json_t *live_recipe(const live *l);

/* Shows pictures and writes the recipe until the state has ended. */
void live_run(live *l, viewer_state *s, outbox *box);

#endif
