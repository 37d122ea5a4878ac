/* parallel/deterministic.c - the exchange of deterministic pictures: over, or
 * sums, in an order of operations that does not depend on the number of ranks.
 *
 * Each rank has made the nodes of the tree of groups
 * (decompose/deterministic.h) that its slices hold in full, and sends each rank
 * the lines of its piece of them; that rank makes the rest of the tree:
 *
 *   message: for each node of the sender | x0 y0 x1 y1, int32 | pixels there |
 *
 * which is a direct send: for reproducible pictures, not for the fastest. */
#include "parallel/internal.h"

#include <string.h>

/* The head of a node's block: what of it is not transparent. */
#define HEAD sizeof(snow_rectangle)

/* --- who has what --------------------------------------------------------- */

/* The nodes of a rank. */
static int nodes_of(const snow_ranks *r, const snow_placement *p, int rank,
                    snow_group_node nodes[SNOW_NODES_MOST]) {
    const snow_box *box = &r->boxes[rank];
    snow_slab slab = {box->first[p->slice_axis], box->count[p->slice_axis]};
    if (!box->count[0] || !box->count[1] || !box->count[2])
        return 0;
    return snow_group_nodes(p->slices, slab, nodes);
}

/* The lines of a rank's piece. */
static snow_slab lines_of(const snow_ranks *r, const snow_local *local,
                          int rank) {
    return snow_slab_equal(local->image.height, r->ranks, rank);
}

static snow_rectangle cut_lines(snow_rectangle from, snow_slab lines) {
    if (from.y0 < (int)lines.first)
        from.y0 = (int)lines.first;
    if (from.y1 > (int)(lines.first + lines.count))
        from.y1 = (int)(lines.first + lines.count);
    if (from.x0 >= from.x1 || from.y0 >= from.y1)
        return (snow_rectangle){0, 0, 0, 0};
    return from;
}

static size_t pixels_in(snow_rectangle r) {
    return (size_t)(r.x1 - r.x0) * (size_t)(r.y1 - r.y0);
}

static size_t pixel_bytes(const snow_local *local) {
    return (size_t)local->image.channels * sizeof(float);
}

/* --- memory --------------------------------------------------------------- */

/* Bytes of the message to a rank. */
static size_t message_bytes(const snow_ranks *r, const snow_local *local,
                            int rank) {
    size_t bytes = 0;
    for (int n = 0; n < local->image.layers; n++)
        bytes += HEAD + pixels_in(cut_lines(local->drawn[n],
                                            lines_of(r, local, rank))) *
                            pixel_bytes(local);
    return bytes;
}

/* Bytes that a message from a rank has at most. */
static size_t message_room(const snow_ranks *r, const snow_local *local,
                           const snow_placement *p, int rank) {
    snow_group_node nodes[SNOW_NODES_MOST];
    size_t lines = (size_t)lines_of(r, local, r->rank).count;
    return (size_t)nodes_of(r, p, rank, nodes) *
           (HEAD + lines * (size_t)local->image.width * pixel_bytes(local));
}

snow_status snow_layers_prepare(snow_ranks *r, const snow_local *local,
                                const snow_placement *p) {
    size_t sent = 0, came = 0;
    for (int rank = 0; rank < r->ranks; rank++) {
        sent += message_bytes(r, local, rank);
        r->offsets[rank] = came;
        came += message_room(r, local, p, rank);
    }
    size_t region = (size_t)lines_of(r, local, r->rank).count *
                    (size_t)local->image.width * pixel_bytes(local);
    SNOW_TRY(SNOW_RESERVE(r->context, r->sent, 0, sent));
    SNOW_TRY(SNOW_RESERVE(r->context, r->came, 0, came));
    return snow_reserve(r->context, &r->region, 0, SNOW_GROUP_RANKS + 1,
                        region);
}

/* --- messages ------------------------------------------------------------- */

/* Writes what is `rank`'s of this rank's layers; the message's end. */
static char *write_message(const snow_ranks *r, const snow_local *local,
                           int rank, char *at) {
    for (int n = 0; n < local->image.layers; n++) {
        snow_rectangle part =
            cut_lines(local->drawn[n], lines_of(r, local, rank));
        size_t bytes = (size_t)(part.x1 - part.x0) * pixel_bytes(local);
        memcpy(at, &part, HEAD);
        at += HEAD;
        for (int y = part.y0; y < part.y1; y++, at += bytes)
            memcpy(at,
                   local->image.pixels + (size_t)n * local->image.layer_floats +
                       (size_t)y * local->image.stride +
                       (size_t)part.x0 * (size_t)local->image.channels,
                   bytes);
    }
    return at;
}

static snow_status exchange_messages(snow_ranks *r, const snow_local *local,
                                     const snow_placement *p) {
    snow_message *messages = r->messages;
    int count = 0;
    char *at = r->sent;
    for (int rank = 0; rank < r->ranks; rank++) {
        size_t capacity = message_room(r, local, p, rank);
        if (capacity && rank != r->rank)
            SNOW_TRY(snow_comm_receive(r->comm, r->came + r->offsets[rank],
                                       capacity, rank, SNOW_TAG_LAYERS,
                                       &messages[count++]));
    }
    for (int rank = 0; rank < r->ranks && local->image.layers; rank++) {
        char *end = write_message(r, local, rank, at);
        if (rank == r->rank)
            memcpy(r->came + r->offsets[rank], at, (size_t)(end - at));
        else
            SNOW_TRY(snow_comm_send(r->comm, at, (size_t)(end - at), rank,
                                    SNOW_TAG_LAYERS, &messages[count++]));
        at = end;
    }
    return snow_comm_wait_all(r->comm, messages, count);
}

/* --- the tree ------------------------------------------------------------- */

/* A piece in the making. */
typedef struct tree_reduction {
    const snow_ranks *ranks;
    const snow_local *local;
    const snow_placement *placement;
    snow_slab lines;
    size_t floats; /* of the piece */
} tree_reduction;

/* The block of a node that a rank has sent; NULL where none has. */
static const char *find_block(const tree_reduction *w, snow_group_node node) {
    const snow_ranks *r = w->ranks;
    for (int rank = 0; rank < r->ranks; rank++) {
        snow_group_node nodes[SNOW_NODES_MOST];
        int count = nodes_of(r, w->placement, rank, nodes);
        const char *block = r->came + r->offsets[rank];
        for (int n = 0; n < count; n++) {
            if (nodes[n].rank == node.rank && nodes[n].index == node.index)
                return block;
            snow_rectangle part;
            if (n + 1 == count)
                break;
            memcpy(&part, block, HEAD);
            block += HEAD + pixels_in(part) * pixel_bytes(w->local);
        }
    }
    return NULL;
}

/* Makes a block a piece; without one, a transparent piece. */
static void unpack(const tree_reduction *w, const char *block, float *region) {
    size_t channels = (size_t)w->local->image.channels;
    snow_rectangle part;
    memset(region, 0, w->floats * sizeof *region);
    if (!block)
        return;
    memcpy(&part, block, HEAD);
    block += HEAD;
    size_t bytes = (size_t)(part.x1 - part.x0) * pixel_bytes(w->local);
    for (int y = part.y0; y < part.y1; y++, block += bytes)
        memcpy(region + ((size_t)(y - (int)w->lines.first) *
                             (size_t)w->local->image.width +
                         (size_t)part.x0) *
                            channels,
               block, bytes);
}

/* A node as a piece; r->piece has one more for each rank of nodes. */
static void reduce_tree(const tree_reduction *w, snow_group_node node,
                        float *region) {
    const char *block = find_block(w, node);
    if (block || node.rank == 0) {
        unpack(w, block, region);
        return;
    }
    bool rises = snow_group_rises(w->placement, node);
    snow_group_node near = {node.rank - 1, 2 * node.index + !rises};
    snow_group_node far = {node.rank - 1, 2 * node.index + rises};
    float *back = w->ranks->region + (size_t)node.rank * w->floats;
    reduce_tree(w, near, region);
    reduce_tree(w, far, back);
    snow_composite_fn *composite = w->local->composite_op == SNOW_COMPOSITE_SUM
                                       ? snow_add_up
                                       : snow_over_of(w->local->image.channels);
    composite(region, back, w->floats / (size_t)w->local->image.channels);
}

snow_status snow_layers_exchange(snow_ranks *r, const snow_local *local,
                                 const snow_placement *placement,
                                 snow_image_region *out) {
    const snow_group_node root = {SNOW_GROUP_RANKS, 0};
    tree_reduction w = {r, local, placement, lines_of(r, local, r->rank), 0};
    SNOW_TRY(exchange_messages(r, local, placement));
    size_t width = (size_t)local->image.width;
    w.floats = (size_t)w.lines.count * width * (size_t)local->image.channels;
    if (w.floats)
        reduce_tree(&w, root, r->region);
    for (int rank = 0; rank < r->ranks; rank++) {
        snow_slab lines = lines_of(r, local, rank);
        r->firsts[rank] = lines.first * local->image.width;
        r->counts[rank] = lines.count * local->image.width;
    }
    *out = (snow_image_region){.first = r->firsts[r->rank],
                               .count = r->counts[r->rank],
                               .pixels = r->region};
    return SNOW_STATUS_OK;
}
