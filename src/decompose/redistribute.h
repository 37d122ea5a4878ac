/* decompose/redistribute.h - redistributes voxels between ranks.
 *
 * Every rank holds boxes of one grid, which do not overlap, and wants one box:
 * its own with ghost voxels around it, or another partition of the grid. Both
 * sides of a message compute its contents from the boxes alone, so messages
 * hold voxels only.
 *
 *   held                       wanted by rank 0
 *   +-------+-------+          +---------+
 *   |   0   |   1   |          |   0   |1|    its own voxels are copied, one
 *   +-------+---+---+          |-------+-|    message comes from each other
 *   |     2     | 1 |          |    2    |    rank that holds a part
 *   +-----------+---+          +---------+
 *
 * Boxes seldom change from picture to picture: they are planned once, and
 * voxels moved any number of times without allocating memory. */
#ifndef SNOW_DECOMPOSE_REDISTRIBUTE_H
#define SNOW_DECOMPOSE_REDISTRIBUTE_H

#include "comm/comm.h"
#include "decompose/box.h"

/* Voxels that each move sends to other ranks. */
int64_t snow_voxels_sent(const snow_voxels *voxels);

#endif
