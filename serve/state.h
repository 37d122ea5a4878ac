/* state.h - what is to be shown: a recipe, which pages change and the renderer
 * reads, and what pages ask.  The newest state wins.
 *
 * Keys that a page may set (message.h) are the state; the others came from the
 * command line and stay. */
#ifndef VIEWER_STATE_H
#define VIEWER_STATE_H

#include "net/outbox.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct viewer_state viewer_state;

/* A question of a page, with the message that holds it. */
typedef struct viewer_question {
    uint64_t client;
    json_t *tree; /* the caller's after state_next */
    bool waits;   /* a thumbnail, which takes long: until the picture rests */
    bool slow;    /* histogram and times, which pictures come between */
} viewer_question;

/* What the renderer is to do next. */
typedef enum viewer_work {
    WORK_END,
    WORK_NONE,   /* nothing yet */
    WORK_ANSWER, /* a question */
    WORK_DRAFT,  /* a new state */
    WORK_NORMAL, /* it has rested for STATE_NORMAL_SECONDS */
    WORK_HIGH    /* or for STATE_HIGH_SECONDS */
} viewer_work;

#define STATE_NORMAL_SECONDS 0.12
#define STATE_HIGH_SECONDS 0.3

/* Questions of all pages, and of one, so that another one has room too. */
#define STATE_QUESTIONS_MOST 192
#define STATE_QUESTIONS_OF_PAGE 128

/* Takes over a recipe's tree; NULL: no memory. */
viewer_state *state_new(json_t *recipe);
void state_free(viewer_state *s);

/* Merges keys into the state; null takes one out.  Returns NULL, or what is
 * wrong, to be freed by the caller: such keys are left out, and the others
 * taken.  And the revision of the state. */
char *state_set(viewer_state *s, const json_t *changes, uint32_t *revision);

/* A page has changed more than the size of its window. */
void state_touch(viewer_state *s);

/* Whether the last state_set wrote, or took out, keys of the look that no page
 * had named (kept_look.h). */
bool state_wrote(viewer_state *s);

/* The state as a message {"t": "state", "step": 0, "touched": false, "keys":
 * {"opacity": ...}, "computed": {"range": ...}} (message.h) for a page, or for
 * all (0) but one; NULL: no memory.  Pages never send back what is computed. */
outgoing *state_message(viewer_state *s, uint64_t client, uint64_t except);

/* Sizes of pages, each once: of a state at rest each gets a picture. */
#define STATE_SIZES_MOST 4
typedef struct page_size {
    int64_t width, height; /* 0: not said */
} page_size;

void state_set_sizes(viewer_state *s, const page_size *sizes, int count);

/* Some page moves something: drafts suffice. */
void state_set_moving(viewer_state *s, bool moving);

/* How many pages look; without any nothing is drawn. */
void state_set_watchers(viewer_state *s, int count);

/* Takes over the tree.  False, and the tree is freed, where too many wait, of
 * all pages or of this one.  A thumbnail takes the place of an older one of its
 * pane. */
bool state_ask(viewer_state *s, uint64_t client, json_t *tree);

void state_end(viewer_state *s);

/* --- for the renderer ------------------------------------------------------
 */

/* The size of a recipe has its picture at rest of a revision, or cannot have
 * one; 0: it is to be drawn again. */
void state_note_rest(viewer_state *s, const json_t *recipe, uint32_t revision);

/* What the look of a revision is, as keys, which are taken over; NULL: it can
 * be given by none. */
void state_note_look(viewer_state *s, uint32_t revision, json_t *computed);

/* The next work.  `drawn` is the revision of the last picture, and `level` its
 * quality; -1: none.  For a state *recipe gets a copy of the whole recipe.
 * Waits where due is NULL; else gives WORK_NONE while nothing is to be done,
 * and at *due, in seconds of the monotonic clock, it is to be asked again; 0:
 * when something has changed. */
viewer_work state_next(viewer_state *s, uint32_t drawn, int level, double *due,
                       viewer_question *question, json_t **recipe,
                       uint32_t *revision);

/* Whether a picture of a revision is no longer wanted: a state is newer, or the
 * end has come. */
bool state_is_stale(const viewer_state *s, uint32_t revision);
/* Whether a page waits for an answer that is to come before a picture at rest.
 */
bool state_is_asked(const viewer_state *s);
bool state_has_ended(const viewer_state *s);
uint32_t state_revision(const viewer_state *s);

/* Whether the set that last changed the crop left the camera as it was: so its
 * zoom is still by the size of the volume before. */
bool state_crop_is_alone(viewer_state *s);

/* In place of a state that cannot be drawn comes the last one that could, but
 * for the size of the window; false where a newer one is there. */
bool state_take_back(viewer_state *s, uint32_t revision, const json_t *drawn);

/* Another volume's recipe, which is taken over, in the place of the state but
 * for the size of the window. */
void state_replace(viewer_state *s, json_t *recipe);

/* A copy of the whole recipe. */
json_t *state_recipe(viewer_state *s);

#endif
