/* parallel/open.c - each rank gets its part of a volume (SD in figure 7): from
 * a file of which nobody reads or stores all, or from the ranks that hold it.
 *
 *   shares of a file     counts of all      boxes, with ghosts
 *   +---------+ rank 0   ..:::.             +----+----+
 *   |---------|      1   .:####:   reduce   |  0 | 2  |   voxels move
 *   |---------|      2   .:####:  ------->  |----+----|  ------------>
 *   +---------+      3   ..:::.    and cut  |  1 | 3  |   ranks to ranks
 *                                           +----+----+
 *
 * A share is an equal run of rows as they lie in the file.  It is no larger
 * than the largest box will be, since that has at least the mean, and so the
 * most that any rank stores does not rise for it.  Invariant: the owned boxes
 * of all ranks cover the grid and do not overlap, before and after. */

#include "classify/gradient_opacity.h"
#include "decompose/slab.h"
#include "parallel/part.h"
#include "transfer/look.h"
#include "volume/mask.h"
#include "volume/volume.h"

#include <math.h>
#include <string.h>

/* A file that many open. */
typedef struct opening {
    snow_comm *comm;
    snow_context *context;
    snow_open_fn *open;
    snow_format_name_fn *format_name;
    const char *path;
    snow_volume_options options;
    snow_volume_info whole; /* of what the options ask for */
    snow_look look;
    const snow_transfer
        *transfer; /* in the snow_part_place of the look's, or NULL */
} opening;

/* Opens a box of what the options ask for, which is a box itself perhaps. */
static snow_status read_box(const opening *o, const snow_part_place *p,
                            snow_volume **out) {
    snow_volume_options options = o->options;
    snow_volume_info info;
    snow_volume *volume;
    if (!snow_box_voxels(&p->owned))
        return snow_part_new(o->context, &o->whole, p, out);
    for (int i = 0; i < 3; i++) {
        options.crop[i][0] += p->stored.first[i];
        options.crop[i][1] = options.crop[i][0] + p->stored.count[i];
    }
    SNOW_TRY(o->open(o->context, o->path, &options, &info, &volume));
    return snow_part_set(volume, &o->whole, p, out);
}

/* Equal runs of slices, or, with more ranks than slices, of each slice's rows;
 * those of the last ranks may be empty. */
static snow_box share_of(const snow_volume_info *whole, int rank, int ranks) {
    snow_box box = {{0, 0, 0}, {whole->dims[0], 0, 0}};
    int slabs = ranks < whole->dims[2] ? ranks : (int)whole->dims[2];
    int parts = ranks / slabs;
    snow_slab z = {0, 0}, y = {0, 0};
    if (rank < slabs * parts) {
        z = snow_slab_equal(whole->dims[2], slabs, rank / parts);
        y = snow_slab_equal(whole->dims[1], parts, rank % parts);
    }
    box.first[1] = y.first;
    box.count[1] = y.count;
    box.first[2] = z.first;
    box.count[2] = z.count;
    return box;
}

/* Collective.  Ranks that see another file of the name must not make one
 * picture of both. */
static snow_status compare_files(const opening *o) {
    const snow_volume_info *w = &o->whole;
    const int64_t facts[5] = {w->dims[0], w->dims[1], w->dims[2],
                              (int64_t)w->type, w->times};
    int64_t ends[10];
    for (int i = 0; i < 5; i++) {
        ends[i] = facts[i];
        ends[5 + i] = -facts[i];
    }
    SNOW_TRY(snow_comm_reduce_ints(o->comm, ends, 10, SNOW_REDUCE_MIN));
    for (int i = 0; i < 5; i++)
        if (ends[i] != -ends[5 + i])
            return snow_fail(o->context, SNOW_STATUS_BAD_INPUT,
                             "%s: is not the same file on all ranks; put it on "
                             "a file system that all ranks share",
                             o->path);
    return SNOW_STATUS_OK;
}

/* Collective.  Rank 0 has read a stream: the others get to know what it is.
 * The format's name is a constant of each process. */
static snow_status set_info(opening *o, const snow_volume *volume) {
    int64_t format = -1;
    if (volume) {
        o->whole = volume->info;
        while (o->format_name((size_t)++format))
            if (!strcmp(o->format_name((size_t)format), o->whole.format))
                break;
    }
    SNOW_TRY(snow_comm_broadcast(o->comm, &format, sizeof format, 0));
    SNOW_TRY(snow_comm_broadcast(o->comm, &o->whole, sizeof o->whole, 0));
    const char *name = o->format_name((size_t)format);
    o->whole.format = name ? name : "memory";
    return SNOW_STATUS_OK;
}

/* Collective.  A stream is read by rank 0, as its share; the others' shares are
 * made later. */
static snow_status read_stream(opening *o, snow_volume **share) {
    snow_volume_info info;
    snow_status status = SNOW_STATUS_OK;
    if (snow_comm_rank(o->comm) == 0)
        status = o->open(o->context, o->path, &o->options, &info, share);
    SNOW_TRY(snow_comm_agree_status(o->comm, status));
    return set_info(o, *share);
}

/* Collective.  Looks at the file, and reads it where that is the only way.
 * Remarks are left to the reading, which makes them too. */
static snow_status inspect_file(opening *o, int64_t *stream,
                                snow_volume **share) {
    *stream = snow_source_is_stream(o->path);
    SNOW_TRY(snow_comm_broadcast(o->comm, stream, sizeof *stream, 0));
    if (*stream)
        return read_stream(o, share);
    snow_warning_fn *warning = o->context->warning;
    o->context->warning = NULL;
    snow_status status =
        o->open(o->context, o->path, &o->options, &o->whole, NULL);
    o->context->warning = warning;
    SNOW_TRY(snow_comm_agree_status(o->comm, status));
    return compare_files(o);
}

/* Collective.  The share of this rank, unless it has one. */
static snow_status read_share(const opening *o, bool stream,
                              snow_volume **share) {
    static const int64_t no_layers[3];
    int ranks = snow_comm_size(o->comm), rank = snow_comm_rank(o->comm);
    snow_box box = stream ? (snow_box){{0, 0, 0}, {0, 0, 0}}
                          : share_of(&o->whole, rank, ranks);
    snow_part_place p = snow_part_place_of(&o->whole, &box, no_layers);
    snow_status status = SNOW_STATUS_OK;
    if (!*share)
        status = read_box(o, &p, share);
    return snow_comm_agree_status(o->comm, status);
}

/* Collective.  Rank 0 warns when a mask or clip planes leave no voxel, so that
 * the user knows why the picture is empty.  As for a volume in memory, there is
 * no warning for a crop. */
static snow_status warn_empty(const opening *o, const snow_volume *read) {
    static const int64_t none[3][2];
    enum { LEFT, MINUS_LEAST, MOST, COUNT };
    double ends[COUNT] = {0, -INFINITY, -INFINITY};
    snow_extent part;
    if (!snow_mask_asked(&o->options) ||
        memcmp(o->options.crop, none, sizeof none) != 0)
        return SNOW_STATUS_OK;
    snow_volume_find_extent(read, &part);
    if (read->emptied) {
        ends[MINUS_LEAST] = fmax(ends[MINUS_LEAST], -read->mask_range[0]);
        ends[MOST] = fmax(ends[MOST], read->mask_range[1]);
    } else
        ends[LEFT] = part.count[0] && part.count[1] && part.count[2];
    SNOW_TRY(snow_comm_reduce_doubles(o->comm, ends, COUNT, SNOW_REDUCE_MAX));
    const bool known = ends[MOST] >= -ends[MINUS_LEAST];
    const double range[2] = {known ? -ends[MINUS_LEAST] : NAN,
                             known ? ends[MOST] : NAN};
    if (ends[LEFT] == 0 && snow_comm_rank(o->comm) == 0)
        snow_mask_remark(o->context, &o->options, range);
    return SNOW_STATUS_OK;
}

/* Collective.  By what all ranks have read. */
static snow_status make_transfer(const opening *o, const snow_volume *read,
                                 snow_transfer **out) {
    if (o->transfer)
        return SNOW_STATUS_OK;
    return snow_ranks_new_transfer(o->comm, read, &o->look, out);
}

/* Collective.  Equal slabs are known before anything is read. */
static snow_status open_equal(const opening *o,
                              const snow_partition_params *order,
                              snow_volume **volume, snow_transfer **transfer) {
    snow_box *boxes = NULL;
    snow_status status = SNOW_RESERVE(o->context, boxes, 0, order->ranks);
    if (status == SNOW_STATUS_OK) {
        snow_partition_equal(&order->grid, order->ranks, boxes);
        snow_part_place p = snow_part_place_of(
            &o->whole, &boxes[snow_comm_rank(o->comm)], order->layers);
        status = read_box(o, &p, volume);
    }
    snow_release(o->context, boxes);
    SNOW_TRY(snow_comm_agree_status(o->comm, status));
    SNOW_TRY(warn_empty(o, *volume));
    return make_transfer(o, *volume, transfer);
}

/* Collective.  By way of shares. */
static snow_status open_shares(const opening *o,
                               const snow_partition_params *order, bool stream,
                               snow_volume **share, snow_volume **volume,
                               snow_transfer **transfer) {
    SNOW_TRY(read_share(o, stream, share));
    if (!stream) /* rank 0 has read all of it, and has warned */
        SNOW_TRY(warn_empty(o, *share));
    SNOW_TRY(make_transfer(o, *share, transfer));
    if (order->ranks == 1) { /* the share is the whole */
        *volume = *share;
        *share = NULL;
        return SNOW_STATUS_OK;
    }
    return snow_part_cut(o->comm, &o->whole, order, *share,
                         o->transfer ? o->transfer : *transfer, volume);
}

/* What is there when it fails is freed by the caller. */
static snow_status open_file(opening *o, const snow_view *view,
                             const snow_settings *settings,
                             const snow_ranks_options *how, snow_volume **share,
                             snow_volume **volume, snow_transfer **transfer) {
    snow_partition_params order;
    int64_t stream;
    SNOW_TRY(inspect_file(o, &stream, share));
    snow_status status = snow_partition_params_make(
        o->context, &o->whole, view, settings, how,
        o->transfer ? snow_transfer_has_gradient_opacity(o->transfer)
                    : snow_look_has_gradient_opacity(&o->look),
        snow_comm_size(o->comm), &order);
    SNOW_TRY(snow_comm_agree_status(o->comm, status));
    if (order.cut == SNOW_PARTITION_EQUAL && !stream)
        return open_equal(o, &order, volume, transfer);
    return open_shares(o, &order, stream, share, volume, transfer);
}

static snow_status read_records(opening *o, const snow_volume_options *options,
                                const snow_look *look,
                                const snow_ranks_options *asked) {
    snow_context *context = o->context;
    snow_ranks_options how;
    SNOW_TRY(
        SNOW_RECORD_READ(context, snow_volume_options, options, &o->options));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_look, look, &o->look));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_ranks_options, asked, &how));
    o->transfer = how.transfer;
    return SNOW_STATUS_OK;
}

snow_status snow_ranks_open_by(snow_open_fn *open,
                               snow_format_name_fn *format_name,
                               snow_comm *comm, const char *path,
                               const snow_volume_options *options,
                               const snow_look *look, const snow_view *view,
                               const snow_settings *settings,
                               const snow_ranks_options *how,
                               snow_volume **volume, snow_transfer **transfer) {
    opening o = {.comm = comm,
                 .context = snow_comm_context(comm),
                 .open = open,
                 .format_name = format_name,
                 .path = path};
    snow_volume *share = NULL, *part = NULL;
    snow_transfer *function = NULL;
    snow_status status =
        snow_comm_agree_status(comm, read_records(&o, options, look, how));
    if (status == SNOW_STATUS_OK)
        status = open_file(&o, view, settings, how, &share, &part, &function);
    snow_volume_close(share);
    if (status != SNOW_STATUS_OK) {
        snow_volume_close(part);
        snow_transfer_free(function);
        return status;
    }
    *volume = part;
    *transfer = function;
    return SNOW_STATUS_OK;
}
