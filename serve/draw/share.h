/* share.h - the share of voxels that the present look does not show. */
#ifndef VIEWER_SHARE_H
#define VIEWER_SHARE_H

#include "draw/drawing.h"

/* After each picture.  From 0 to 1; NaN: not known without a count, for which
 * this is no time, or which would take long. */
double share_hidden(drawing *d, bool may_count);

#endif
