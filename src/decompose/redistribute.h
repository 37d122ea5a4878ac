/* decompose/redistribute.h - voxels that change hands for good
 * (snowglass/extend.h has the rest). */
#ifndef SNOW_DECOMPOSE_REDISTRIBUTE_H
#define SNOW_DECOMPOSE_REDISTRIBUTE_H

#include "comm/comm.h"

/* Before the plan.  Spent: the one brick, whose rows lie one after another, is
 * needed no more once it is moved: its pages go back to the system meanwhile,
 * and what it holds is lost.  Gaps: some voxels of what is wanted may be in
 * no box; they stay as they are, and that all others are there is for the
 * caller to know (parallel/trim.c). */
void snow_voxels_expect(snow_voxels *voxels, bool spent, bool gaps);

/* The slices of a box that move in one of some rounds; whole pages of a brick
 * that have moved go back to the system. */
snow_box snow_box_slices(const snow_box *box, int round, int rounds);
void snow_brick_forget(const snow_brick *brick, int round, int rounds,
                       size_t value);

#endif
