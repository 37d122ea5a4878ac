/* kept_look.h - keeps a look that was computed where a page changes a part of
 * it.
 *
 * An automatic look is chosen from the histogram as a whole: given the very
 * opacity that it had, the library would choose other colours, another range
 * and shading.  So the first change of one part writes the others, as they were
 * computed, into the recipe.  They are taken out again when no page sets a part
 * any more, as after an undo, or when another look is chosen. */
#ifndef KEPT_LOOK_H
#define KEPT_LOOK_H

#include <jansson.h>
#include <stdbool.h>

typedef struct kept_look {
    json_t *computed; /* {"colormap": "viridis", "range": ...} of the look that
                         was drawn last; NULL: not known */
    json_t *base;     /* the same of the one without any change */
    json_t *written;  /* keys of the recipe that no page has set: {key: true} */
    bool changed;     /* the last change wrote some, or took some out */
} kept_look;

kept_look kept_look_copy(const kept_look *k);
void kept_look_free(kept_look *k);

/* Takes over what the look of a recipe is computed to be. */
void kept_look_note(kept_look *k, const json_t *recipe, json_t *computed);

/* Completes a recipe that has the changes already. */
void kept_look_follow(kept_look *k, const json_t *changes, json_t *recipe);

#endif
