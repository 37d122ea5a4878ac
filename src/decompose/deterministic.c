/* decompose/deterministic.c - see deterministic.h. */
#include "decompose/deterministic.h"

snow_slab snow_group_slab(int64_t slices, int group) {
    return snow_slab_equal(slices, SNOW_GROUPS, group);
}

snow_slab snow_slab_grouped(int64_t slices, int parts, int part) {
    int groups = slices < SNOW_GROUPS ? (int)slices : SNOW_GROUPS;
    snow_slab of_groups = snow_slab_equal(groups, parts, part);
    snow_slab slab = {slices, 0};
    if (of_groups.count == 0)
        return slab;
    int last = (int)(of_groups.first + of_groups.count) - 1;
    slab.first = snow_group_slab(slices, (int)of_groups.first).first;
    snow_slab end = snow_group_slab(slices, last);
    slab.count = end.first + end.count - slab.first;
    return slab;
}

/* The group that begins at a slice, among those with slices; SNOW_GROUPS at the
 * end, -1 if none does. */
static int group_at(int64_t slices, int64_t slice) {
    for (int group = 0; group < SNOW_GROUPS; group++)
        if (snow_group_slab(slices, group).first == slice)
            return slice == slices ? SNOW_GROUPS : group;
    return slice == slices ? SNOW_GROUPS : -1;
}

int snow_group_nodes(int64_t slices, snow_slab slab,
                     snow_group_node nodes[SNOW_NODES_MOST]) {
    if (slab.count == 0)
        return 0;
    int group = group_at(slices, slab.first);
    int end = group_at(slices, slab.first + slab.count), count = 0;
    if (group < 0 || end < 0)
        return -1;
    while (group < end) {
        int rank = 0;
        while (rank < SNOW_GROUP_RANKS && group % (2 << rank) == 0 &&
               group + (2 << rank) <= end)
            rank++;
        nodes[count++] = (snow_group_node){rank, group >> rank};
        group += 1 << rank;
    }
    return count;
}
