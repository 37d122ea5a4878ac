/* kept.h - what a drawing keeps from one state of the page to the next: keys,
 * by which it knows what has changed, and volumes without their clip planes. */
#ifndef DRAW_KEPT_H
#define DRAW_KEPT_H

#include "draw/drawing.h"

/* Some keys of a recipe as a text that changes with them; to be freed. */
char *kept_key_of(const json_t *recipe, const char *const *names);

/* Replaces a key; whether it is another. */
bool kept_take_key(char **key, char *now);

/* Where clip planes move, the volumes without them are kept, and read only
 * once.  False: what needs more memory than there is, stays in its file or is
 * that of many ranks is to be opened as ever. */
bool kept_clip(drawing *d);

/* What the volumes without clip planes are made of; to be freed. */
char *kept_base_key(const drawing *d, const json_t *recipe);

/* Forgets them where another is meant by `key`, or none; in any case. */
void kept_drop(drawing *d, char *key);
void kept_close(drawing *d);

#endif
