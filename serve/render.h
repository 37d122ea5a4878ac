/* render.h - draws the newest state as a draft, then, when it rests, in normal
 * and in high quality; and answers what pages ask.  One thread does this, and
 * it alone uses the context of the volume. */
#ifndef RENDER_H
#define RENDER_H

#include "draw/drawing.h"
#include "net/outbox.h"
#include "pack.h"
#include "state.h"

typedef struct renderer renderer;

/* Before any page can connect: the first state shows all of the object, and
 * what pages are told of it waits for them. */
void renderer_begin(drawing *d, viewer_state *s, outbox *box);

/* How another volume is opened: what a question {"what": "open", ...} of a page
 * means, and then whether it could be; see folder/folder.h. */
typedef struct renderer_opener {
    int (*choose)(void *user, const json_t *question, const options **first,
                  const json_t **recipe);
    void (*opened)(void *user, bool good);
    void *user;
} renderer_opener;

/* Writes the movie that a page orders (movies/order.h); it has an answer. */
typedef void order_fn(void *user, drawing *d, viewer_state *s,
                      const viewer_question *question);

/* Takes over the drawing, and has its orders filled (NULL: by nobody).
 * `opener`: or NULL, where there is nothing else to be opened.  NULL: no
 * memory. */
renderer *renderer_new(drawing *d, viewer_state *s, outbox *box, packer *pack,
                       const renderer_opener *opener, order_fn *order,
                       void *order_user);

/* Does what is to be done next, and says what that was.  Waits for it where due
 * is NULL, until WORK_END (state_next). */
viewer_work renderer_step(renderer *r, double *due);

/* After the thread of renderer_step has ended. */
void renderer_free(renderer *r);

#endif
