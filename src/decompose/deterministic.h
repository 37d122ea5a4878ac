/* decompose/deterministic.h - groups of slices, for pictures that are the same
 * bit for bit however many processors make them.
 *
 * Over is associative except for rounding, so the order of additions must not
 * depend on the processors. A volume's slices are divided into SNOW_GROUPS
 * groups. Each is composited by itself, and groups are composited by a fixed
 * binary tree, whichever processors compute them:
 *
 *   groups    0   1   2   3   4   5   6   7         a processor that owns
 *             |   |   |   |   |   |   |   |         groups 2 to 6 makes the
 *             +-0-+   +-1-+   +-2-+   +-3-+  rank 1 nodes (1, 1), (1, 2) and
 *               |       |       |       |           (0, 6), as many as it can
 *               +---0---+       +---1---+    rank 2 */
#ifndef SNOW_DECOMPOSE_DETERMINISTIC_H
#define SNOW_DECOMPOSE_DETERMINISTIC_H

#include "decompose/slab.h"

#define SNOW_GROUP_RANKS 5
#define SNOW_GROUPS (1 << SNOW_GROUP_RANKS)

/* The slices of a group; empty if there are fewer slices than groups. */
snow_slab snow_group_slab(int64_t slices, int group);

/* Part `part` of `parts` of whole groups, as equal as possible; empty ones are
 * last. */
snow_slab snow_slab_grouped(int64_t slices, int parts, int part);

/* A node of the tree: groups index << rank .. (index + 1 << rank) - 1. */
typedef struct snow_group_node {
    int rank, index;
} snow_group_node;

/* The fewest nodes that cover a slab, rising; at most SNOW_NODES_MOST. Returns
 * their number, 0 for an empty slab, and -1 if it does not begin and end at
 * borders of groups. */
#define SNOW_NODES_MOST (2 * SNOW_GROUP_RANKS)
int snow_group_nodes(int64_t slices, snow_slab slab,
                     snow_group_node nodes[SNOW_NODES_MOST]);

#endif
