/* decompose/voxels.h - voxels that change hands between ranks.
 *
 * Every rank holds boxes of one grid, which do not overlap, and wants one box:
 * its own with ghost voxels around it, or another cut of the grid.  Both sides
 * of a message work out from the boxes alone what is in it, so that voxels
 * travel without a word about them.
 *
 *   held                       wanted by rank 0
 *   +-------+-------+          +---------+
 *   |   0   |   1   |          |   0   |1|    its own voxels are copied, one
 *   +-------+---+---+          |-------+-|    message comes from each other
 *   |     2     | 1 |          |    2    |    rank that holds a part
 *   +-----------+---+          +---------+
 *
 * Boxes seldom change from picture to picture: they are planned once, and
 * voxels moved as often as wished, without taking memory. */
#ifndef SNOW_VOXELS_H
#define SNOW_VOXELS_H

#include "comm/comm.h"
#include "decompose/box.h"

/* A box's voxels as they lie in memory: `voxels` is the first one, strides are
 * counted in values (not bytes) and may be negative. */
typedef struct snow_brick {
    snow_box box;
    const void *voxels;
    int64_t stride[3];
} snow_brick;

/* Copies the part of a brick that lies in `box`, which lies in `whole`, to its
 * place in the dense box `whole` (x fastest).  `value` is the bytes of one, 1,
 * 2, 4 or 8. */
void snow_brick_copy(const snow_brick *brick, size_t value, const snow_box *box,
                     const snow_box *whole, void *dense);

/* A plan, with its buffers. */
typedef struct snow_voxels snow_voxels;

snow_status snow_voxels_new(snow_comm *comm, snow_voxels **out);
void snow_voxels_free(snow_voxels *voxels);

/* Forgets the plan and frees its buffers. */
void snow_voxels_clear(snow_voxels *voxels);

/* Collective.  Plans what goes where when this rank holds `count` boxes and
 * wants one; any of them may be empty.  Statuses are agreed on.  Errors:
 * SNOW_BAD_USAGE (boxes that overlap, wanted voxels that nobody holds),
 * SNOW_NO_MEMORY; the plan is then empty. */
snow_status snow_voxels_plan(snow_voxels *voxels, const snow_box *held,
                             int count, const snow_box *wanted);

/* Collective.  Moves voxels of `value` bytes (the same on all ranks) as
 * planned: bricks[n] is what lies in held[n], `dense` the wanted box.  The
 * first call after a plan takes memory, and any with a larger value, upon which
 * statuses are agreed; later ones take none.  Errors: SNOW_NO_MEMORY, and those
 * of the transport. */
snow_status snow_voxels_move(snow_voxels *voxels, const snow_brick *bricks,
                             size_t value, void *dense);

/* Voxels that each move sends to other ranks. */
int64_t snow_voxels_sent(const snow_voxels *voxels);

#endif
