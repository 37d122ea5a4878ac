/* warnings.h - notes about a picture that is correct but perhaps not what was
 * meant.  The rank that prints prints them, unless quiet. */
#ifndef WARNINGS_H
#define WARNINGS_H

#include "picture/render_state.h"

/* Reports options of the command line that have no effect in the mode. */
void warn_unused(const options *opts);

/* Reports about the last picture, before anything is drawn on it: another
 * method than requested, and an empty picture, unless `image` is NULL. */
void warn_picture(const render_state *s, snow_image *image);

/* Whether nothing is visible in a picture, which has an exit code of its own; a
 * picture of values has no opacity, and none is empty. */
bool picture_is_empty(snow_image *image);

#endif
