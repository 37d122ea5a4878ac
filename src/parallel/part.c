/* parallel/part.c - a rank's part of a volume, made of what all ranks hold. */
#include "parallel/part.h"

#include "decompose/redistribute.h"
#include "parallel/trim.h"
#include "transfer/transfer.h"
#include "volume/clip_planes.h"
#include "volume/mask.h"

#include <string.h>

snow_part_place snow_part_place_of(const snow_volume_info *whole,
                                   const snow_box *owned,
                                   const int64_t layers[3]) {
    snow_part_place p = {{{0, 0, 0}, {0, 0, 0}}, {{0, 0, 0}, {1, 1, 1}}};
    if (!snow_box_voxels(owned))
        return p;
    p.owned = *owned;
    for (int i = 0; i < 3; i++) {
        int64_t first = owned->first[i], end = first + owned->count[i];
        int64_t most = whole->dims[i] - end;
        p.stored.first[i] = first > layers[i] ? first - layers[i] : 0;
        end += layers[i] < most ? layers[i] : most;
        p.stored.count[i] = end - p.stored.first[i];
    }
    return p;
}

snow_extent snow_part_extent(const snow_volume_info *whole,
                             const snow_part_place *p) {
    snow_extent part = {.size = sizeof part};
    memcpy(part.dims, whole->dims, sizeof part.dims);
    memcpy(part.stored, p->stored.first, sizeof part.stored);
    memcpy(part.first, p->owned.first, sizeof part.first);
    memcpy(part.count, p->owned.count, sizeof part.count);
    return part;
}

snow_status snow_part_set(snow_volume *volume, const snow_volume_info *whole,
                          const snow_part_place *p, snow_volume **out) {
    const snow_extent part = snow_part_extent(whole, p);
    snow_status status = snow_volume_set_extent(volume, &part);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_set_whole(volume, whole);
    if (status == SNOW_STATUS_OK)
        *out = volume;
    else
        snow_volume_close(volume);
    return status;
}

snow_status snow_part_new(snow_context *context, const snow_volume_info *whole,
                          const snow_part_place *p, snow_volume **out) {
    snow_volume *volume;
    snow_volume_info info =
        snow_volume_info_of_box(whole, p->stored.first, p->stored.count);
    SNOW_TRY(snow_volume_new(context, &info, &volume));
    if (!snow_box_voxels(&p->owned))
        memset(volume->owned, 0, snow_type_size(info.type));
    return snow_part_set(volume, whole, p, out);
}

snow_box snow_part_box(const snow_volume *volume) {
    snow_extent part;
    snow_box box;
    if (volume->left_out.any)
        return volume->left_out.box;
    snow_volume_find_extent(volume, &part);
    memcpy(box.first, part.first, sizeof box.first);
    memcpy(box.count, part.count, sizeof box.count);
    return box;
}

/* --- voxels that change hands --------------------------------------------- */

/* What a volume answers for, as it lies in memory. */
static snow_brick brick_of(const snow_volume *volume) {
    snow_extent part;
    size_t size = snow_type_size(volume->info.type);
    snow_volume_find_extent(volume, &part);
    snow_brick brick;
    snow_volume_steps(volume, brick.stride);
    int64_t at = 0;
    for (int i = 0; i < 3; i++) {
        brick.box.first[i] = part.first[i];
        brick.box.count[i] = part.count[i];
        at += (part.first[i] - part.stored[i]) * brick.stride[i];
    }
    brick.voxels = volume->voxels;
    if (snow_box_voxels(&brick.box))
        brick.voxels = (const char *)volume->voxels + (size_t)at * size;
    return brick;
}

/* Collective.  What masks and planes have done to any rank's voxels.  *all: all
 * ranks hold clip planes; where only some do they are lost. */
static snow_status agree_cuts(snow_comm *comm, const snow_volume *held,
                              bool *all, snow_volume *to) {
    double words[4] = {held->clip != NULL, -(held->clip != NULL), held->masked,
                       held->had_negative};
    SNOW_TRY(snow_comm_reduce_doubles(comm, words, 4, SNOW_REDUCE_MAX));
    *all = words[1] < 0;
    to->lost_clip = held->lost_clip || (words[0] > 0 && !*all);
    to->masked = words[2] > 0;
    to->had_negative = words[3] > 0;
    return SNOW_STATUS_OK;
}

/* The planes cut what has come as they have cut what was held. */
static snow_status cut_again(const snow_volume *held, snow_volume *volume) {
    snow_extent from, to;
    int64_t by[3];
    snow_volume_find_extent(held, &from);
    snow_volume_find_extent(volume, &to);
    for (int axis = 0; axis < 3; axis++)
        by[axis] = to.stored[axis] - from.stored[axis];
    SNOW_TRY(snow_clip_planes_move(held->clip, by, &volume->clip));
    return snow_mask_cut_again(volume);
}

/* Collective.  Fills the part `to` from the parts that all ranks hold. */
static snow_status move_voxels(snow_comm *comm, const snow_volume *from,
                               bool spent, const snow_part_place *p,
                               snow_volume *to) {
    static const snow_box nothing;
    snow_voxels *voxels = NULL;
    const snow_brick held = brick_of(from);
    bool any = snow_box_voxels(&p->owned) > 0, all;
    SNOW_TRY(agree_cuts(comm, from, &all, to));
    snow_status status =
        snow_comm_agree_status(comm, snow_voxels_new(comm, &voxels));
    if (status == SNOW_STATUS_OK)
        snow_voxels_expect(voxels, spent && from->owned, from->left_out.any);
    if (status == SNOW_STATUS_OK)
        status =
            snow_voxels_plan(voxels, &held.box, 1, any ? &p->stored : &nothing);
    if (all)
        snow_clip_planes_show(from->clip, from->info.type, true, from->owned);
    if (status == SNOW_STATUS_OK)
        status = snow_voxels_move(voxels, &held,
                                  snow_type_size(from->info.type), to->owned);
    if (all && !spent) /* memory that was given up is not written to */
        snow_clip_planes_show(from->clip, from->info.type, false, from->owned);
    snow_voxels_free(voxels);
    if (status == SNOW_STATUS_OK && all)
        status = cut_again(from, to);
    return all ? snow_comm_agree_status(comm, status) : status;
}

/* Room for a part, with a value in the place of voxels that nobody has. */
static snow_status make_room(snow_context *context,
                             const snow_volume_info *whole,
                             const snow_part_place *p,
                             const snow_left_out *left, bool fills,
                             snow_volume **out) {
    SNOW_TRY(snow_part_new(context, whole, p, out));
    (*out)->left_out = *left;
    if (fills)
        snow_volume_fill(*out, left->fill);
    return SNOW_STATUS_OK;
}

/* Collective.  Voxels that all ranks hold go where the boxes say. */
static snow_status send_share(snow_comm *comm, const snow_volume_info *whole,
                              const snow_partition_params *order,
                              const snow_box *boxes,
                              const snow_transfer *transfer,
                              const snow_volume *held, bool spent,
                              snow_volume **out) {
    snow_volume *volume = NULL;
    snow_left_out left = held->left_out;
    snow_box own = left.box = boxes[snow_comm_rank(comm)];
    if (!held->stream && (order->trims || left.any))
        SNOW_TRY(
            snow_ranks_trim(comm, order, boxes, held, transfer, &own, &left));
    const snow_part_place p = snow_part_place_of(whole, &own, order->layers);
    if (held->stream) {
        const snow_extent part = snow_part_extent(whole, &p);
        return snow_comm_agree_status(
            comm, snow_stream_open_part(held, &part, p.stored.count, out));
    }
    snow_status status = snow_comm_agree_status(
        comm, make_room(snow_comm_context(comm), whole, &p, &left,
                        held->left_out.any, &volume));
    if (status == SNOW_STATUS_OK)
        status = move_voxels(comm, held, spent, &p, volume);
    if (status == SNOW_STATUS_OK)
        *out = volume;
    else
        snow_volume_close(volume);
    return status;
}

snow_status snow_part_cut(snow_comm *comm, const snow_volume_info *whole,
                          const snow_partition_params *order,
                          const snow_volume *held, bool spent,
                          const snow_transfer *transfer, snow_volume **out) {
    snow_context *context = snow_comm_context(comm);
    snow_box *boxes = NULL;
    snow_status status = snow_comm_agree_status(
        comm, SNOW_RESERVE(context, boxes, 0, order->ranks));
    if (status == SNOW_STATUS_OK)
        status = snow_partition_boxes(comm, order, held, transfer, boxes, NULL);
    if (status == SNOW_STATUS_OK)
        status =
            send_share(comm, whole, order, boxes, transfer, held, spent, out);
    snow_release(context, boxes);
    return status;
}

/* --- other views ---------------------------------------------------------- */

static bool is_border(const snow_partition_params *order, int64_t slice) {
    for (int64_t n = 0; n <= order->grid.count && order->grid.borders; n++)
        if (order->borders[n] == slice)
            return true;
    return !order->grid.borders;
}

/* Returns whether this rank's part gives its share of a picture. */
static bool serves(const snow_volume *volume,
                   const snow_partition_params *order) {
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    const snow_box box = snow_part_box(volume);
    int axis = order->grid.axis;
    if (!part.count[0] || !part.count[1] || !part.count[2])
        return true;
    for (int i = 0; i < 3; i++) {
        int64_t below = part.first[i] - part.stored[i];
        int64_t end = part.first[i] + part.count[i];
        int64_t above = part.stored[i] + volume->info.dims[i] - end;
        if ((below < order->layers[i] && part.stored[i] > 0) ||
            (above < order->layers[i] && end + above < part.dims[i]))
            return false;
        if (order->slabs_only && i != axis && box.count[i] != part.dims[i])
            return false;
    }
    return is_border(order, box.first[axis]) &&
           is_border(order, box.first[axis] + box.count[axis]);
}

snow_status
snow_ranks_repartition(snow_comm *comm, const snow_transfer *transfer,
                       const snow_view *view, const snow_settings *settings,
                       const snow_ranks_options *how, snow_volume **volume) {
    snow_volume_info whole;
    snow_partition_params order;
    snow_volume_whole(*volume, &whole);
    snow_status status = snow_partition_params_make(
        snow_comm_context(comm), &whole, view, settings, how,
        snow_transfer_slopes(transfer, &whole), snow_comm_size(comm), &order);
    /* One round: 0, all serve; 1, some do not; 2, some failed. */
    int64_t worst = status != SNOW_STATUS_OK ? 2 : !serves(*volume, &order);
    SNOW_TRY(snow_comm_reduce_ints(comm, &worst, 1, SNOW_REDUCE_MAX));
    if (worst == 0)
        return SNOW_STATUS_OK;
    if (worst == 2)
        return snow_comm_agree_status(comm, status);
    snow_volume *recut;
    SNOW_TRY(
        snow_part_cut(comm, &whole, &order, *volume, false, transfer, &recut));
    snow_volume_close(*volume);
    *volume = recut;
    return SNOW_STATUS_OK;
}
