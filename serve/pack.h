/* pack.h - packs pictures for the pages, in two threads of its own.
 *
 * Drafts and normal pictures become JPEG, on thin links WebP.  The picture at
 * rest becomes the PNG that `snowglass render` writes, byte for byte, since the
 * same function writes it. */
#ifndef PACK_H
#define PACK_H

#include "net/outbox.h"
#include "state.h"

#include <snowglass/snowglass.h>

/* What the renderer made.  Image and overlay belong to the renderer's context,
 * and go back to it: another thread may only read them. */
typedef struct picture {
    snow_image *image;
    snow_overlay *overlay; /* or NULL */
    snow_image_options form;
    uint32_t revision;
    int level; /* 0 draft, 1 normal, 2 high */
    uint32_t render_us;
    struct picture *next; /* of those that are done */
} picture;

typedef struct packer packer;

/* Starts the threads; NULL: no memory, or no thread, as errno says.  The
 * packing of a picture at rest ends where the state is a newer one by then. */
packer *packer_new(outbox *box, const viewer_state *state);

/* Ends it, and returns all pictures for the renderer to free. */
picture *packer_end(packer *p);
void packer_free(packer *p);

/* Takes over a picture, in place of one that still waits.  Returns those that
 * are done, linked by `next`, for the renderer to free. */
picture *packer_put(packer *p, picture *made);

/* Until no draft is being packed: the next one, which is drawn by all
 * processors, would delay it. */
void packer_wait_for_draft(packer *p);

/* Seconds that the last draft was packed, for each of its pixels; 0: none yet.
 */
double packer_pixel_seconds(packer *p);

/* Until all are packed, which are for the renderer to free: no picture before
 * is then in its memory. */
picture *packer_wait(packer *p);

/* Packs a small picture at once, in the calling thread, which owns its context,
 * as JPEG or, if it is to be `exact`, as the PNG that the tool writes: a
 * message for pane and n of the page, or NULL. */
outgoing *pack_small(const snow_image *image, const snow_image_options *form,
                     bool exact, int pane, uint32_t n);

#endif
