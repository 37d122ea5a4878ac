/* volume/stream_slabs.c - the walk over the slabs of a volume (stream.h). */
#include "volume/stream_internal.h"

#include "volume/mask.h"

#include <math.h>
#include <string.h>

/* --- sizes ---------------------------------------------------------------- */

void snow_print_limit(const snow_context *context, char text[64]) {
    *text = 0;
    if (context->limit)
        snow_text_print(text, 64, " under the limit of %.1f MiB",
                        (double)context->limit / 0x1p20);
}

/* Bytes of voxels that a slab may have where `made` times as many are made of
 * them: with those half of what a limit leaves, but no more than usual. */
static uint64_t slab_room(const snow_volume *volume, int64_t made) {
    const snow_context *context = volume->context;
    uint64_t usual = volume->stream->slab_bytes;
    if (made <= 0)
        return usual;
    if (!context->limit)
        return usual / (uint64_t)made;
    uint64_t left =
        context->limit > context->bytes ? context->limit - context->bytes : 0;
    uint64_t most = usual > SNOW_SLAB_BYTES ? usual : SNOW_SLAB_BYTES;
    uint64_t capacity = left / 2 / (uint64_t)(1 + made);
    return capacity < most ? capacity : most;
}

/* The slices that are walked over: a volume's own, or one of a part that has
 * none, which makes no sample. */
static int64_t own_slices(const snow_extent *own) {
    return own->count[2] > 0 ? own->count[2] : 1;
}

/* Slices of a slab, without its ghosts. */
static int64_t slab_slices(const snow_volume *volume,
                           const snow_slab_cut *cut) {
    const int64_t *dims = volume->info.dims;
    snow_extent own;
    if (cut->slices)
        return cut->slices;
    snow_volume_find_extent(volume, &own);
    uint64_t slice = (uint64_t)(dims[0] * dims[1]) *
                     (uint64_t)snow_type_size(volume->info.type);
    uint64_t capacity = slab_room(volume, cut->made) / slice;
    uint64_t around = 2 * (uint64_t)cut->ghosts;
    uint64_t slices = capacity > around ? capacity - around : 1;
    return slices < (uint64_t)own_slices(&own) ? (int64_t)slices
                                               : own_slices(&own);
}

uint64_t snow_slab_bytes(const snow_volume *volume, const snow_slab_cut *cut) {
    const int64_t *dims = volume->info.dims;
    int64_t slices = dims[2];
    if (volume->stream)
        slices = slab_slices(volume, cut) + 2 * cut->ghosts;
    if (slices > dims[2])
        slices = dims[2];
    return (uint64_t)(dims[0] * dims[1] * slices) *
           (uint64_t)snow_type_size(volume->info.type);
}

/* What must be alike for one picture to be made of all slabs. */
static snow_status compare(const snow_volume *volume, const snow_volume *slab,
                           const snow_extent *part, int64_t slices) {
    const snow_volume_info *a = &volume->info, *b = &slab->info;
    if (a->type == b->type && a->slope == b->slope &&
        a->intercept == b->intercept && a->dims[0] == b->dims[0] &&
        a->dims[1] == b->dims[1] && b->dims[2] == slices)
        return SNOW_STATUS_OK;
    return snow_fail(volume->context, SNOW_STATUS_BAD_INPUT,
                     "%s: slices from %lld on differ from the volume in type, "
                     "scale or size: was the file replaced while it was read?",
                     volume->stream->path, (long long)part->stored[2]);
}

/* Own slices first .. first + count - 1 of a volume; from its first ghost on.
 */
static snow_extent part_of(const snow_volume *volume, int64_t ghosts,
                           int64_t first, int64_t count) {
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    const int64_t begin = part.first[2] + first;
    if (begin - ghosts > part.stored[2])
        part.stored[2] = begin - ghosts;
    part.first[2] = begin;
    part.count[2] = count;
    return part;
}

/* Its slices, with ghosts on both sides. */
static int64_t stored_slices(const snow_volume *volume, const snow_extent *part,
                             int64_t ghosts) {
    snow_extent all;
    snow_volume_find_extent(volume, &all);
    int64_t end = part->first[2] + part->count[2] + ghosts;
    int64_t last = all.stored[2] + volume->info.dims[2];
    return (end < last ? end : last) - part->stored[2];
}

/* A slab with its ghosts, as a part of the volume. */
static snow_status read_slab(const snow_volume *volume,
                             const snow_slab_cut *cut, const snow_extent *part,
                             snow_volume **out) {
    snow_context *context = volume->context;
    int64_t slices = stored_slices(volume, part, cut->ghosts);
    snow_volume_options options = volume->stream->options;
    snow_volume_info whole;
    snow_extent all;
    snow_volume_whole(volume, &whole);
    snow_volume_find_extent(volume, &all);
    options.crop[2][0] += part->stored[2] - all.stored[2];
    options.crop[2][1] = options.crop[2][0] + slices;
    snow_volume *slab;
    SNOW_TRY(snow_stream_open_slab(context, volume->stream, &options,
                                   cut->clipped, &slab));
    snow_status status = compare(volume, slab, part, slices);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_set_extent(slab, part);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_set_whole(slab, &whole);
    if (status != SNOW_STATUS_OK) {
        snow_volume_close(slab);
        return status;
    }
    *out = slab;
    return SNOW_STATUS_OK;
}

/* Nothing is said of a volume that is cropped, as of one in memory. */
static void warn_empty(const snow_volume *volume) {
    static const int64_t none[3][2];
    snow_stream *stream = volume->stream;
    const snow_volume_options *options = &stream->options;
    if (stream->left || stream->warned_empty || volume->is_part ||
        !snow_mask_asked(options) ||
        memcmp(options->crop, none, sizeof none) != 0)
        return;
    stream->warned_empty = true;
    snow_mask_warn(volume->context, options, stream->mask_range);
}

void snow_slabs_open(const snow_volume *volume, const snow_slab_cut *cut,
                     snow_slabs *slabs) {
    snow_stream *stream = volume->stream;
    snow_extent own;
    snow_volume_find_extent(volume, &own);
    *slabs =
        (snow_slabs){.volume = volume, .cut = *cut, .slices = own_slices(&own)};
    if (!stream)
        return;
    slabs->count = slab_slices(volume, cut);
    slabs->next = slabs->nearest = cut->from / slabs->count * slabs->count;
    stream->left = false;
    stream->mask_range[0] = stream->mask_range[1] = NAN;
}

/* The room of the slab's voxels is left to the next one. */
static void drop_present(snow_slabs *slabs) {
    snow_context *context = slabs->volume->context;
    snow_volume *slab = slabs->slab;
    if (slabs->number) /* the progress is that of the whole again */
        snow_monitor_whole(context->monitor, slabs->whole);
    slabs->slab = NULL;
    if (!slab)
        return;
    snow_release(context, context->spare);
    context->spare = slab->owned;
    slab->owned = NULL;
    slab->voxels = NULL;
    if (!slabs->keep)
        snow_volume_close(slab);
    slabs->keep = false;
}

snow_volume *snow_slabs_keep(snow_slabs *slabs) {
    slabs->keep = slabs->slab != NULL;
    return slabs->slab;
}

snow_status snow_slabs_next(snow_slabs *slabs, const snow_volume **slab) {
    const snow_volume *volume = slabs->volume;
    drop_present(slabs);
    *slab = NULL;
    if (!volume->stream) {
        *slab = slabs->begun ? NULL : volume;
        slabs->begun = true;
        return SNOW_STATUS_OK;
    }
    /* Is a slab of the file left, from `next` on? */
    if (!slabs->falls && slabs->next >= slabs->slices) {
        slabs->falls = true;
        slabs->next = slabs->nearest - slabs->count;
    }
    if (!(!slabs->falls || slabs->next >= 0)) {
        warn_empty(volume);
        return SNOW_STATUS_OK;
    }
    int64_t all = slabs->slices, left = all - slabs->next;
    slabs->whole =
        snow_monitor_divide(volume->context->monitor, (double)slabs->number++,
                            (double)((all + slabs->count - 1) / slabs->count));
    const snow_extent part = part_of(volume, slabs->cut.ghosts, slabs->next,
                                     left < slabs->count ? left : slabs->count);
    if (slabs->cut.kept)
        *slab =
            slabs->cut.kept(slabs->cut.user, &part,
                            stored_slices(volume, &part, slabs->cut.ghosts));
    if (!*slab) {
        SNOW_TRY(read_slab(volume, &slabs->cut, &part, &slabs->slab));
        *slab = slabs->slab;
    }
    slabs->next += slabs->falls ? -slabs->count : slabs->count;
    snow_stream *stream = volume->stream;
    stream->left = stream->left || !(*slab)->emptied;
    stream->mask_range[0] = fmin(stream->mask_range[0], (*slab)->mask_range[0]);
    stream->mask_range[1] = fmax(stream->mask_range[1], (*slab)->mask_range[1]);
    return SNOW_STATUS_OK;
}

void snow_slabs_close(snow_slabs *slabs) {
    snow_context *context = slabs->volume->context;
    if (!slabs->volume->stream)
        return;
    drop_present(slabs);
    SNOW_DROP(context, context->spare);
}

snow_status snow_slabs_visit(const snow_volume *volume,
                             const snow_slab_cut *cut, snow_slab_fn *visit,
                             void *user) {
    snow_slabs slabs;
    const snow_volume *slab;
    snow_slabs_open(volume, cut, &slabs);
    snow_status status = snow_slabs_next(&slabs, &slab);
    while (status == SNOW_STATUS_OK && slab) {
        status = visit(slab, user);
        if (status == SNOW_STATUS_OK)
            status = snow_slabs_next(&slabs, &slab);
    }
    snow_slabs_close(&slabs);
    return status;
}

/* --- the range ------------------------------------------------------------ */

/* `user` is what is known so far; NaN where nothing is. */
static snow_status measure_slab(const snow_volume *slab, void *user) {
    snow_volume_statistics *range = user, here = {.size = sizeof here};
    SNOW_TRY(snow_volume_get_statistics(slab, &here));
    range->voxels += here.voxels;
    range->finite += here.finite;
    range->min = fmin(range->min, here.min);
    range->max = fmax(range->max, here.max);
    return SNOW_STATUS_OK;
}

snow_status snow_volume_range(const snow_volume *volume,
                              snow_volume_statistics *out) {
    static const snow_slab_cut cut = {0};
    snow_volume_statistics range = {.min = NAN, .max = NAN};
    if (volume->stream && volume->stream->measured) {
        *out = volume->stream->range;
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(snow_slabs_visit(volume, &cut, measure_slab, &range));
    if (volume->stream)
        snow_stream_note_range(volume, &range);
    *out = range;
    return SNOW_STATUS_OK;
}

void snow_stream_note_range(const snow_volume *volume,
                            const snow_volume_statistics *range) {
    volume->stream->range = *range;
    volume->stream->measured = true;
}
