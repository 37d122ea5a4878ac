/* remarks.h - notes on a picture that is right, and perhaps not what was meant.
 * They are told by the rank that talks, and not when quiet. */
#ifndef REMARKS_H
#define REMARKS_H

#include "scene.h"

/* Options of the command line that the mode makes no use of. */
void remark_unused(const options *asked);

/* Of the picture that was made last, before anything is drawn on it: a method
 * other than the one that was asked for, a slice that is seen from its edge,
 * and that nothing is to be seen, unless `image` is NULL. */
void remark_picture(const scene *s, snow_image *image);

#endif
