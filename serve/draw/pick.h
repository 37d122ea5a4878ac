/* pick.h - how far away the object is at a place of the picture. */
#ifndef PICK_H
#define PICK_H

#include "draw/drawing.h"

/* By all ranks.  The distance from the target's plane along the line of sight
 * to where the object is, in the world; x and y are shares of the picture's
 * width and height. NaN where there is nothing, or the mode has no depth, as
 * iso by many ranks. Returns CONTINUE or an exit code. */
int pick_depth(drawing *d, double x, double y, const double size[2],
               double *depth);

#endif
