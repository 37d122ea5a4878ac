/* decompose/occluded.h - a set of boxes that is asked for one that another box
 * occludes: which a ray that meets both meets later.
 *
 * Seen along an axis, b cannot come after a where it ends before a begins and
 * the eye is in front of a, or the other way round. So what a can occlude lies
 * beyond up to one bound on each axis, and no box before it can: an order
 * without pairs of boxes. The set is a tree of bounds over boxes along a
 * space-filling curve (G. M. Morton, 1966). */
#ifndef SNOW_DECOMPOSE_OCCLUDED_H
#define SNOW_DECOMPOSE_OCCLUDED_H

#include "decompose/order.h"

#define SNOW_OCCLUDED_BRANCHES 8
#define SNOW_OCCLUDED_LEVELS 12

/* Bounds of eight boxes or nodes: those of nothing are infinite and negative.
 */
typedef struct snow_occluded_node {
    double end[3][SNOW_OCCLUDED_BRANCHES];   /* the largest */
    double first[3][SNOW_OCCLUDED_BRANCHES]; /* the negative of the least */
} snow_occluded_node;

typedef struct snow_occluded {
    snow_context *context;
    const snow_box *boxes;
    const snow_viewer *viewer;
    int count, levels;
    int *positions; /* of boxes along the curve; -1: empty */
    int *boxes_at;  /* of positions, roughly from front to back */
    snow_occluded_node *nodes[SNOW_OCCLUDED_LEVELS]; /* from the boxes' up */
    snow_occluded_node *all;
} snow_occluded;

/* An empty set for boxes, to be freed in any case.  Errors:
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_occluded_new(snow_context *context, const snow_box *boxes,
                              int count, const snow_viewer *viewer,
                              snow_occluded *out);
void snow_occluded_free(snow_occluded *set);

/* No box, or all that are not empty, are in it. */
void snow_occluded_clear(snow_occluded *set);
void snow_occluded_fill(snow_occluded *set);

/* Returns whether it was in the set. */
bool snow_occluded_remove(snow_occluded *set, int box);
void snow_occluded_insert(snow_occluded *set, int box);

/* One of the set that a box, which is not in it, occludes or overlaps; one that
 * it overlaps; -1: none. */
int snow_occluded_find(const snow_occluded *set, int box);
int snow_occluded_overlap(const snow_occluded *set, int box);

#endif
