/* parallel/shares.c - see shares.h. */
#include "parallel/shares.h"

#include "decompose/slab.h"

/* Slabs of whole blocks along z, and parts of each of them along y. */
typedef struct layout {
    const int64_t *dims;
    snow_file_blocks blocks;
    int slabs, parts;
} layout;

static int64_t count_blocks(const layout *l, int axis) {
    const int64_t size = l->blocks.size[axis];
    return (l->dims[axis] + l->blocks.cut[axis] + size - 1) / size;
}

/* Returns where a block begins; the end, for the one behind the last. */
static int64_t begin_of(const layout *l, int axis, int64_t block) {
    const int64_t at = block * l->blocks.size[axis] - l->blocks.cut[axis];
    return at < 0 ? 0 : at < l->dims[axis] ? at : l->dims[axis];
}

static layout divide(layout l, int ranks, int slabs) {
    const int64_t most = count_blocks(&l, 1);
    l.slabs = slabs;
    l.parts = ranks / slabs < most ? ranks / slabs : (int)most;
    return l;
}

/* Rows of the largest share along an axis that is cut into so many. */
static int64_t longest_of(const layout *l, int axis, int parts) {
    const int64_t rows =
        ((count_blocks(l, axis) - 1) / parts + 1) * l->blocks.size[axis];
    return rows < l->dims[axis] ? rows : l->dims[axis];
}

static int64_t largest_of(const layout *l) {
    return longest_of(l, 2, l->slabs) * longest_of(l, 1, l->parts);
}

/* There are as many slabs as there can be, or fewer, if the largest share of
 * blocks is smaller then. */
static layout lay_out(const int64_t dims[3], const snow_file_blocks *blocks,
                      int ranks) {
    const bool packed = blocks && blocks->size[2] > 0;
    const double equal = (double)dims[1] * (double)dims[2] / ranks;
    layout l = {dims, {{1, 1, 1}, {0, 0, 0}}, 1, 1};
    if (packed)
        l.blocks = *blocks;
    const int64_t most = count_blocks(&l, 2);
    l = divide(l, ranks, ranks < most ? ranks : (int)most);
    for (int slabs = l.slabs - 1; slabs > 0 && packed; slabs--) {
        const layout other = divide(l, ranks, slabs);
        if (largest_of(&other) < largest_of(&l))
            l = other;
    }
    return packed && (double)largest_of(&l) > SNOW_SHARE_MOST * equal
               ? lay_out(dims, NULL, ranks)
               : l;
}

static void take_run(const layout *l, int axis, int parts, int part,
                     snow_box *box) {
    const snow_slab run = snow_slab_equal(count_blocks(l, axis), parts, part);
    box->first[axis] = begin_of(l, axis, run.first);
    box->count[axis] =
        begin_of(l, axis, run.first + run.count) - box->first[axis];
}

snow_box snow_share_of(const int64_t dims[3], const snow_file_blocks *blocks,
                       int rank, int ranks) {
    snow_box box = {{0, 0, 0}, {dims[0], 0, 0}};
    const layout l = lay_out(dims, blocks, ranks);
    if (rank >= l.slabs * l.parts)
        return box;
    take_run(&l, 2, l.slabs, rank / l.parts, &box);
    take_run(&l, 1, l.parts, rank % l.parts, &box);
    return box;
}

snow_status snow_share_agree(snow_comm *comm, bool here, bool *all) {
    int64_t word = here;
    SNOW_TRY(snow_comm_reduce_ints(comm, &word, 1, SNOW_REDUCE_MIN));
    *all = word != 0;
    return SNOW_STATUS_OK;
}
