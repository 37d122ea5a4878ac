/* shortage.h - where a picture has no room in the memory that there is. */
#ifndef SHORTAGE_H
#define SHORTAGE_H

#include "options/options.h"

#include <jansson.h>

/* The quality and all of a recipe but where a turn is, which changes nothing of
 * the memory that a picture needs. */
json_t *shortage_need(const json_t *recipe, int level);

/* In words of a page, whose window is the size. */
void shortage_say(const options *opts, int level);

#endif
