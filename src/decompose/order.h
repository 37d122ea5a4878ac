/* decompose/order.h - which of the parts of a volume lie before others, for the
 * local images of boxes to be laid over one another (the visibility order of
 * Ma et al. 1994, for any boxes in the place of a tree's). */
#ifndef SNOW_ORDER_H
#define SNOW_ORDER_H

#include "base/base.h"
#include "decompose/box.h"

/* How the grid is looked at, in index space. */
typedef struct snow_sight {
    bool perspective;
    double eye[3];   /* voxels; in perspective */
    double along[3]; /* away from the viewer; in a parallel projection */
} snow_sight;

/* Whether every ray that meets both boxes meets `a` first: 1; `b` first: -1; no
 * ray meets both: 0.  The boxes are disjoint; they are taken half a voxel to
 * all sides. */
int snow_box_before(const snow_box *a, const snow_box *b,
                    const snow_sight *sight);

/* The numbers of `count` disjoint boxes from front to back, empty ones last.
 * The order depends on boxes and sight only.  Errors: SNOW_BAD_USAGE (boxes
 * that overlap, or lie before one another in a ring), SNOW_NO_MEMORY. */
snow_status snow_order_boxes(snow_context *context, const snow_box *boxes,
                             int count, const snow_sight *sight, int *order);

#endif
