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
 * A share is an equal run of rows as they lie in the file, and lies in memory
 * until its voxels have moved.  Under a limit, large ones of plain files, which
 * are cheap to read, are counted slab by slab and dropped; the box is then read
 * by itself, so that nothing lies beside it.  A box that a limit has no room
 * for stays in the file, and is drawn slab by slab (volume/stream.h).
 * Invariant: the owned boxes of all ranks cover the grid and do not overlap,
 * before and after. */

#include "parallel/part.h"
#include "parallel/same_file.h"
#include "parallel/shares.h"
#include "transfer/look.h"
#include "volume/mask.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

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
    const snow_view *view;
    const snow_settings *settings;
    const snow_ranks_options *how;
    bool again;              /* it can be read in slabs, several times, */
    bool plain;              /* at no more cost than its bytes */
    snow_file_blocks blocks; /* that it is packed in */
} opening;

/* Opens a box of what the options ask for, which is a box itself perhaps.  One
 * without voxels of its own has a voxel, which brings the clip planes along. */
static snow_status read_box(const opening *o, const snow_part_place *p,
                            snow_volume **out) {
    static const double none[SNOW_CLIPS_MAX][4];
    snow_volume_options options = o->options;
    snow_volume_info info;
    snow_volume *volume;
    const bool clips = memcmp(options.clip, none, sizeof none) != 0;
    if (!snow_box_voxels(&p->owned) && !clips)
        return snow_part_new(o->context, &o->whole, p, out);
    for (int i = 0; i < 3; i++) {
        options.crop[i][0] += p->stored.first[i];
        options.crop[i][1] = options.crop[i][0] + p->stored.count[i];
    }
    SNOW_TRY(o->open(o->context, o->path, &options, &info, &volume));
    return snow_part_set(volume, &o->whole, p, out);
}

/* --- what fits into memory ------------------------------------------------ */

/* Bytes of masks of a voxel, and of its number; of a point of the image on the
 * lattice, four to a voxel of a slice, with what is sent of it; of a pixel; of
 * the tables of a look. */
#define MASK_BYTES 1
#define NUMBER_BYTES 4
#define IMAGE_BYTES (4 * 48)
#define PIXEL_BYTES 32
#define TABLE_BYTES ((uint64_t)1 << 20)

/* Slabs that are longer are not read faster. */
#define SLAB_MOST ((uint64_t)8 << 20)

static uint64_t room_of(const snow_context *context) {
    return context->limit > context->bytes ? context->limit - context->bytes
                                           : 0;
}

/* Returns whether a limit has room for a box, and for what is made of it:
 * where values serve as they are, a copy that is turned. */
static bool fits(const opening *o, const snow_part_place *p) {
    const uint64_t size = (uint64_t)snow_type_size(o->whole.type);
    const uint64_t voxel = size + (size > 2 ? NUMBER_BYTES : size) + MASK_BYTES;
    const uint64_t pixels =
        (uint64_t)o->view->width * (uint64_t)o->view->height;
    uint64_t slice = 0; /* the largest along any axis */
    for (int i = 0; i < 3; i++) {
        const uint64_t of =
            (uint64_t)(o->whole.dims[i] * o->whole.dims[(i + 1) % 3]);
        slice = of > slice ? of : slice;
    }
    return !o->context->limit || (uint64_t)snow_box_voxels(&p->stored) * voxel +
                                         slice * IMAGE_BYTES +
                                         pixels * PIXEL_BYTES + TABLE_BYTES <=
                                     room_of(o->context);
}

/* A file of a few kilobytes is only a header. */
#define HEADER_BYTES 65536

/* Under a limit, shares up to this size lie in memory beside their boxes, so
 * that the file is read once. */
#define SHARE_MOST (INT64_C(16) << 20)

/* Returns whether one voxel of the data beside a header is as dear as all, as
 * those of packed data are. It is asked where shares may stay in the file. */
static bool is_packed_beside(const opening *o, double bytes) {
    snow_volume_options voxel = o->options;
    snow_volume_info info;
    snow_volume *volume = NULL;
    const uint64_t before = o->context->bytes_read;
    if (!o->context->limit &&
        bytes <= (double)SHARE_MOST * snow_comm_size(o->comm))
        return false;
    for (int i = 0; i < 3; i++)
        voxel.crop[i][1] = voxel.crop[i][0] + 1;
    (void)o->open(o->context, o->path, &voxel, &info, &volume);
    snow_volume_close(volume);
    return o->context->bytes_read - before > 2 * HEADER_BYTES;
}

/* A file that is not packed. */
static bool is_plain(const opening *o) {
    struct stat about;
    snow_volume_options all = o->options;
    snow_volume_info info = o->whole;
    if (o->context->inflates)
        return false;
    memset(all.crop, 0, sizeof all.crop);
    if (stat(o->path, &about) != 0 || !S_ISREG(about.st_mode))
        return false;
    if (memcmp(all.crop, o->options.crop, sizeof all.crop) != 0 &&
        o->open(o->context, o->path, &all, &info, NULL) != SNOW_STATUS_OK)
        return false;
    const double bytes = (double)info.dims[0] * (double)info.dims[1] *
                         (double)info.dims[2] * (double)info.times *
                         (double)snow_type_size(info.type);
    return about.st_size <= HEADER_BYTES ? !is_packed_beside(o, bytes)
                                         : (double)about.st_size >= 0.9 * bytes;
}

/* A box that stays in the file. */
static snow_status open_in_file(const opening *o, const snow_part_place *p,
                                snow_volume **out) {
    snow_volume *all;
    const snow_extent part = snow_part_extent(&o->whole, p);
    /* Packed ones are unpacked up to each slab. */
    const uint64_t share = room_of(o->context) / (o->plain ? 8 : 3) + 1;
    SNOW_TRY(snow_stream_open(
        o->context, o->path, &o->options,
        o->context->limit && (share < SLAB_MOST || !o->plain) ? share
                                                              : SLAB_MOST,
        o->open, &all));
    const snow_status status =
        snow_stream_open_part(all, &part, p->stored.count, out);
    snow_volume_close(all);
    return status;
}

/* --- shares --------------------------------------------------------------- */

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
 * Warnings are left to the reading, which makes them too. */
static snow_status inspect_file(opening *o, int64_t *stream,
                                snow_volume **share) {
    *stream = snow_source_is_stream(o->path);
    SNOW_TRY(snow_comm_broadcast(o->comm, stream, sizeof *stream, 0));
    if (*stream)
        return read_stream(o, share);
    struct stat about; /* a file or folder, not what a program makes */
    const bool again = stat(o->path, &about) == 0 &&
                       (S_ISREG(about.st_mode) || S_ISDIR(about.st_mode));
    snow_warning_fn *warning = o->context->warning;
    o->context->warning = NULL;
    o->context->blocks = (snow_file_blocks){{0, 0, 0}, {0, 0, 0}};
    o->context->inflates = false;
    snow_status status =
        o->open(o->context, o->path, &o->options, &o->whole, NULL);
    o->blocks = o->context->blocks;
    const bool unpacked = status == SNOW_STATUS_OK && is_plain(o);
    o->context->warning = warning;
    SNOW_TRY(snow_comm_agree_status(o->comm, status));
    SNOW_TRY(snow_share_agree(o->comm, again, &o->again));
    SNOW_TRY(snow_share_agree(o->comm, unpacked, &o->plain));
    SNOW_TRY(snow_ranks_compare_file(o->comm, o->plain ? o->open : NULL,
                                     o->path, &o->options, &o->whole));
    /* What a mask leaves out is counted over all voxels together. */
    o->plain = o->plain && !snow_mask_asked(&o->options);
    return SNOW_STATUS_OK;
}

/* Collective.  The share of this rank, unless it has one.  A large one stays in
 * the file where that costs little, and any where some rank has no room for it
 * and its box. */
static snow_status read_share(const opening *o, bool stream,
                              snow_volume **share) {
    static const int64_t no_layers[3];
    int ranks = snow_comm_size(o->comm), rank = snow_comm_rank(o->comm);
    snow_box box = stream
                       ? (snow_box){{0, 0, 0}, {0, 0, 0}}
                       : snow_share_of(o->whole.dims, &o->blocks, rank, ranks);
    snow_part_place p = snow_part_place_of(&o->whole, &box, no_layers);
    snow_status status = SNOW_STATUS_OK;
    bool fit;
    const int64_t bytes =
        snow_box_voxels(&p.stored) * (int64_t)snow_type_size(o->whole.type);
    const bool small = bytes <= SHARE_MOST || !o->context->limit;
    SNOW_TRY(
        snow_share_agree(o->comm, fits(o, &p) && (!o->plain || small), &fit));
    if (!*share)
        status = o->again && !fit ? open_in_file(o, &p, share)
                                  : read_box(o, &p, share);
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
        snow_mask_warn(o->context, &o->options, range);
    return SNOW_STATUS_OK;
}

/* Collective.  By what all ranks have read. */
static snow_status make_transfer(const opening *o, const snow_volume *read,
                                 snow_transfer **out) {
    if (o->transfer)
        return SNOW_STATUS_OK;
    return snow_ranks_new_transfer(o->comm, read, &o->look, out);
}

/* Collective.  How the volume is cut for a picture by a transfer function, or,
 * where it is NULL, by a look that is of no labels. */
static snow_status make_order(const opening *o, const snow_transfer *transfer,
                              snow_partition_params *out) {
    int slopes = transfer ? snow_transfer_slopes(transfer, &o->whole)
                          : snow_look_slopes(&o->look, NULL);
    return snow_comm_agree_status(
        o->comm, snow_partition_params_make(o->context, &o->whole, o->view,
                                            o->settings, o->how, slopes,
                                            snow_comm_size(o->comm), out));
}

/* Collective.  This rank's box of all: read, or left in the file where some
 * rank has no room for its own. */
static snow_status open_box(const opening *o, const snow_box *boxes,
                            const snow_partition_params *order,
                            snow_volume **out) {
    const snow_part_place p = snow_part_place_of(
        &o->whole, &boxes[snow_comm_rank(o->comm)], order->layers);
    bool fit;
    SNOW_TRY(snow_share_agree(o->comm, fits(o, &p), &fit));
    const snow_status status =
        fit || !o->again ? read_box(o, &p, out) : open_in_file(o, &p, out);
    return snow_comm_agree_status(o->comm, status);
}

/* Collective.  Boxes by what a share counts; equal slabs are known before
 * anything is read. */
static snow_status cut_and_open(const opening *o,
                                const snow_partition_params *order,
                                snow_volume **share,
                                const snow_transfer *transfer,
                                snow_volume **volume) {
    snow_box *boxes = NULL;
    snow_status status = snow_comm_agree_status(
        o->comm, SNOW_RESERVE(o->context, boxes, 0, order->ranks));
    if (status == SNOW_STATUS_OK && !*share)
        snow_partition_equal(&order->grid, order->ranks, boxes);
    else if (status == SNOW_STATUS_OK)
        status =
            snow_partition_boxes(o->comm, order, *share, transfer, boxes, NULL);
    snow_volume_close(*share);
    *share = NULL;
    if (status == SNOW_STATUS_OK)
        status = open_box(o, boxes, order, volume);
    snow_release(o->context, boxes);
    return status;
}

/* Collective.  Equal slabs are known before anything is read; those of labels,
 * whose gradients look farther, are read again. */
static snow_status open_equal(const opening *o, snow_partition_params *order,
                              snow_volume **volume, snow_transfer **transfer) {
    snow_volume *no_share = NULL;
    SNOW_TRY(cut_and_open(o, order, &no_share, NULL, volume));
    SNOW_TRY(warn_empty(o, *volume));
    SNOW_TRY(make_transfer(o, *volume, transfer));
    if (o->transfer || !snow_transfer_has_labels(*transfer, &o->whole))
        return SNOW_STATUS_OK;
    SNOW_TRY(make_order(o, *transfer, order));
    snow_volume_close(*volume);
    *volume = NULL;
    return cut_and_open(o, order, &no_share, NULL, volume);
}

/* Collective.  Warnings were given when the share was opened. */
static snow_status open_counted(const opening *o,
                                const snow_partition_params *order,
                                snow_volume **share,
                                const snow_transfer *transfer,
                                snow_volume **volume) {
    snow_warning_fn *warning = o->context->warning;
    o->context->warning = NULL;
    const snow_status status = cut_and_open(o, order, share, transfer, volume);
    o->context->warning = warning;
    return status;
}

/* Collective.  By way of shares. */
static snow_status open_shares(const opening *o, snow_partition_params *order,
                               bool stream, snow_volume **share,
                               snow_volume **volume, snow_transfer **transfer) {
    SNOW_TRY(read_share(o, stream, share));
    if (!stream) /* rank 0 has read all of it, and has warned */
        SNOW_TRY(warn_empty(o, *share));
    SNOW_TRY(make_transfer(o, *share, transfer));
    const snow_transfer *known = o->transfer ? o->transfer : *transfer;
    if (order->ranks == 1 && !(*share)->stream) { /* the share is the whole */
        *volume = *share;
        *share = NULL;
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(make_order(o, known, order));
    return (*share)->stream ? open_counted(o, order, share, known, volume)
                            : snow_part_cut(o->comm, &o->whole, order, *share,
                                            true, known, volume);
}

/* What is there when it fails is freed by the caller. */
static snow_status open_file(opening *o, snow_volume **share,
                             snow_volume **volume, snow_transfer **transfer) {
    snow_partition_params order;
    int64_t stream;
    SNOW_TRY(inspect_file(o, &stream, share));
    SNOW_TRY(make_order(o, o->transfer, &order));
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
                 .path = path,
                 .view = view,
                 .settings = settings,
                 .how = how};
    snow_volume *share = NULL, *part = NULL;
    snow_transfer *function = NULL;
    snow_status status =
        snow_comm_agree_status(comm, read_records(&o, options, look, how));
    if (status == SNOW_STATUS_OK)
        status = open_file(&o, &share, &part, &function);
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
