/* render.h - the thread that draws: the newest state as a draft,
 * then, when it rests, in normal and in high quality; and answers to what pages
 * ask.  It alone uses the context of the volume. */
#ifndef RENDER_H
#define RENDER_H

#include "drawing.h"
#include "outbox.h"
#include "pack.h"
#include "state.h"

typedef struct renderer renderer;

/* Before any page can connect: the first state shows all of the object, and
 * what pages are told of it waits for them. */
void renderer_begin(drawing *d, viewer_state *s, outbox *box);

/* Starts the thread, which takes over the drawing; NULL: no memory, or no
 * thread. */
renderer *renderer_new(drawing *d, viewer_state *s, outbox *box, packer *pack);

/* Waits for its end, after state_end. */
void renderer_free(renderer *r);

#endif
