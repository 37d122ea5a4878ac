/* decompose/order.h - the visibility order of the parts of a volume, in which
 * the local images of boxes are composited (that of Ma et al. 1994, for any
 * boxes instead of a tree's). */
#ifndef SNOW_ORDER_H
#define SNOW_ORDER_H

#include "base/base.h"

/* The viewer of the grid, in index space. */
typedef struct snow_viewer {
    bool perspective;
    double eye[3];   /* voxels; for perspective */
    double along[3]; /* away from the viewer; for parallel projection */
} snow_viewer;

/* The indices of `count` disjoint boxes from front to back, empty ones last.
 * The order depends on boxes and viewer only. Errors: SNOW_STATUS_BAD_USAGE
 * (boxes that overlap, or occlude each other in a cycle),
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_order_boxes(snow_context *context, const snow_box *boxes,
                             int count, const snow_viewer *viewer, int *order);

#endif
