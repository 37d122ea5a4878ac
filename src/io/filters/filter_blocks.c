/* io/filters/filter_blocks.c - the filter stage that unpacks a sequence of zlib
 * streams (RFC 1950) of known sizes, as in VTK's XML files, or of blocks that a
 * function unpacks at once.
 *
 * Since the sizes precede the data, skipped blocks need not be unpacked: a
 * block is skipped by its packed size. */
#include "io/filters/filter.h"
#include "io/source.h"
#include "io/zlib_memory.h"

#include <string.h>

/* Bytes of a stream besides its data: header, check sum, last bits. */
#define STREAM_SLACK 64

/* Of LZ4, whose runs grow by 255 bytes for each byte of their length. */
#define MOST_RATIO ((uint64_t)255)

typedef struct blocks_filter {
    snow_filter_stage filter;
    z_stream stream;
    snow_blocks blocks;
    uint64_t next;   /* next block to begin */
    uint64_t packed; /* bytes of the current block not yet consumed */
    uint64_t left;   /* unpacked bytes that it has still to return */
    unsigned char *packed_bytes, *bytes; /* of blocks that a function unpacks */
    bool damaged; /* a jump failed: the position is unknown */
} blocks_filter;

static uint64_t size_of(const blocks_filter *filter, uint64_t block) {
    return block + 1 == filter->blocks.count ? filter->blocks.last
                                             : filter->blocks.whole;
}

static snow_status fail_block(const blocks_filter *filter, const char *why) {
    return snow_fail(filter->filter.context, SNOW_STATUS_BAD_INPUT,
                     "%s: block %llu of its compressed data is damaged (%s); "
                     "fetch or write the file again",
                     filter->filter.name,
                     (unsigned long long)(filter->next ? filter->next - 1 : 0),
                     why);
}

/* Runs inflate once on the buffered bytes below that belong to the block. */
static snow_status inflate_some(blocks_filter *filter, int *answer) {
    snow_filter_stage *below = filter->filter.below;
    SNOW_TRY(snow_filter_stage_fill(below, 1));
    size_t some = below->end - below->begin;
    if (some > filter->packed)
        some = (size_t)filter->packed;
    if (!some)
        return fail_block(filter, "it ends too early");
    filter->stream.next_in = below->buffer + below->begin;
    filter->stream.avail_in = (uInt)some;
    *answer = inflate(&filter->stream, Z_NO_FLUSH);
    some -= filter->stream.avail_in;
    snow_filter_stage_drop(below, some);
    filter->packed -= some;
    if (*answer == Z_MEM_ERROR)
        return SNOW_STATUS_NO_MEMORY;
    if (*answer != Z_OK && *answer != Z_STREAM_END && *answer != Z_BUF_ERROR)
        return fail_block(filter, filter->stream.msg ? filter->stream.msg
                                                     : "the data are invalid");
    return SNOW_STATUS_OK;
}

/* The check sum follows the last byte: inflate must consume it, and return no
 * more bytes. */
static snow_status end_block(blocks_filter *filter, int answer) {
    unsigned char none;
    while (answer != Z_STREAM_END) {
        filter->stream.next_out = &none;
        filter->stream.avail_out = 1;
        SNOW_TRY(inflate_some(filter, &answer));
        if (!filter->stream.avail_out)
            return fail_block(filter, "it is longer than its declared size");
    }
    if (filter->packed)
        return fail_block(filter, "its packed size is wrong");
    return SNOW_STATUS_OK;
}

/* Reads some bytes of the current block. */
static snow_status pull_block(blocks_filter *filter, void *bytes, size_t size,
                              size_t *got) {
    uInt wanted = size > 1u << 30 ? 1u << 30 : (uInt)size;
    if (wanted > filter->left)
        wanted = (uInt)filter->left;
    filter->stream.next_out = bytes;
    filter->stream.avail_out = wanted;
    int answer = Z_OK;
    while (filter->stream.avail_out && answer != Z_STREAM_END)
        SNOW_TRY(inflate_some(filter, &answer));
    *got = wanted - filter->stream.avail_out;
    filter->left -= *got;
    if (answer == Z_STREAM_END && filter->left)
        return fail_block(filter, "it is shorter than its declared size");
    return filter->left ? SNOW_STATUS_OK : end_block(filter, answer);
}

/* Unpacks the current block as a whole. */
static snow_status unpack_block(blocks_filter *filter) {
    snow_context *context = filter->filter.context;
    const size_t size = (size_t)filter->packed;
    size_t got;
    SNOW_TRY(SNOW_RESERVE(context, filter->packed_bytes, 0, size));
    SNOW_TRY(snow_filter_stage_read(filter->filter.below, filter->packed_bytes,
                                    size, &got));
    if (got < size)
        return fail_block(filter, "it ends too early");
    SNOW_TRY(SNOW_RESERVE(context, filter->bytes, 0, filter->left));
    filter->packed = 0;
    return filter->blocks.unpack(filter->packed_bytes, size, filter->bytes,
                                 (size_t)filter->left)
               ? SNOW_STATUS_OK
               : fail_block(filter, "the data are invalid");
}

/* Copies some bytes of the current block. */
static snow_status copy_block(blocks_filter *filter, void *bytes, size_t size,
                              size_t *got) {
    const uint64_t all = size_of(filter, filter->next - 1);
    if (filter->packed)
        SNOW_TRY(unpack_block(filter));
    *got = size < filter->left ? size : (size_t)filter->left;
    memcpy(bytes, filter->bytes + (all - filter->left), *got);
    filter->left -= *got;
    return SNOW_STATUS_OK;
}

static snow_status pull_blocks(snow_filter_stage *base, void *bytes,
                               size_t size, size_t *got) {
    blocks_filter *filter = (blocks_filter *)base;
    *got = 0;
    if (filter->damaged)
        return fail_block(filter, "it cannot be skipped");
    while (!filter->left && filter->next < filter->blocks.count) {
        filter->left = size_of(filter, filter->next);
        filter->packed = filter->blocks.packed[filter->next];
        filter->next++;
        if (!filter->packed)
            return fail_block(filter, "it is empty");
        if (!filter->blocks.unpack)
            inflateReset(&filter->stream);
    }
    if (filter->blocks.unpack && filter->left)
        return copy_block(filter, bytes, size, got);
    return filter->left ? pull_block(filter, bytes, size, got) : SNOW_STATUS_OK;
}

/* Skips bytes, by a jump where that is possible; false: there are fewer. */
static bool pass_by(snow_filter_stage *filter, uint64_t size) {
    while (size) {
        if (filter->begin == filter->end && filter->jump) {
            int64_t remaining = snow_filter_stage_remaining(filter);
            if (remaining >= 0 && (uint64_t)remaining >= size &&
                filter->jump(filter, size)) {
                filter->taken += size;
                return true;
            }
        }
        if (snow_filter_stage_fill(filter, 1) != SNOW_STATUS_OK ||
            filter->begin == filter->end)
            return false;
        uint64_t some = filter->end - filter->begin;
        if (some > size)
            some = size;
        snow_filter_stage_drop(filter, (size_t)some);
        size -= some;
    }
    return true;
}

/* Skips the rest of the current block, then whole blocks without unpacking,
 * then a part of one. The bytes in between are not buffered here, as for every
 * jump. */
static bool jump_blocks(snow_filter_stage *base, uint64_t count) {
    blocks_filter *filter = (blocks_filter *)base;
    while (count) {
        if (!filter->left && filter->next < filter->blocks.count &&
            size_of(filter, filter->next) <= count) {
            count -= size_of(filter, filter->next);
            if (!pass_by(base->below, filter->blocks.packed[filter->next++]))
                filter->damaged = true;
        } else {
            unsigned char scratch[4096];
            size_t got,
                some = sizeof scratch < count ? sizeof scratch : (size_t)count;
            if (pull_blocks(base, scratch, some, &got) != SNOW_STATUS_OK ||
                !got)
                filter->damaged = true;
            else
                count -= got;
        }
        if (filter->damaged)
            return false;
    }
    return true;
}

static void end_blocks(snow_filter_stage *base) {
    blocks_filter *filter = (blocks_filter *)base;
    if (!filter->blocks.unpack)
        inflateEnd(&filter->stream);
    snow_release(base->context, filter->bytes);
    snow_release(base->context, filter->packed_bytes);
    snow_release(base->context, filter->blocks.packed);
}

/* Whole blocks are held, so that none may claim more than its bytes can
 * hold. */
static bool may_hold(const snow_blocks *blocks, uint64_t packed) {
    const uint64_t most =
        MOST_RATIO * (packed < INT32_MAX ? packed : INT32_MAX);
    return blocks->last <= most &&
           (blocks->count == 1 || blocks->whole <= most);
}

/* Adds up all packed and all unpacked bytes; false if they are impossible. */
static bool sum_block_sizes(const snow_filter_stage *below,
                            const snow_blocks *blocks, uint64_t *unpacked) {
    uint64_t packed = 0, most;
    for (uint64_t i = 0; i < blocks->count; i++)
        if (!snow_add_u64(packed, blocks->packed[i], &packed))
            return false;
    return blocks->whole && blocks->last &&
           packed <= snow_filter_stage_limit(below) &&
           snow_mul_u64(blocks->count - 1, blocks->whole, unpacked) &&
           snow_add_u64(*unpacked, blocks->last, unpacked) &&
           *unpacked <= (uint64_t)INT64_MAX &&
           snow_mul_u64(blocks->count, STREAM_SLACK, &most) &&
           snow_add_u64(packed, most, &most) &&
           (!snow_mul_u64(most, SNOW_DEFLATE_RATIO, &most) ||
            *unpacked <= most) &&
           (!blocks->unpack || may_hold(blocks, packed));
}

snow_status snow_filter_stage_open_blocks(snow_filter_stage *below,
                                          const snow_blocks *blocks,
                                          snow_filter_stage **out) {
    uint64_t unpacked;
    if (!sum_block_sizes(below, blocks, &unpacked))
        return snow_fail(below->context, SNOW_STATUS_BAD_INPUT,
                         "%s: its compressed blocks are larger than the file; "
                         "it is truncated or damaged",
                         below->name);
    blocks_filter *filter = snow_filter_stage_over(below, sizeof *filter);
    if (!filter)
        return SNOW_STATUS_NO_MEMORY;
    snow_zlib_use(&filter->stream, below->context);
    if (!blocks->unpack && inflateInit2(&filter->stream, 15) != Z_OK) {
        snow_release(below->context, filter);
        return SNOW_STATUS_NO_MEMORY; /* snow_allocate set the message */
    }
    filter->filter.pull = pull_blocks;
    filter->filter.jump = jump_blocks;
    filter->filter.fini = end_blocks;
    filter->filter.size = (int64_t)unpacked;
    filter->blocks = *blocks;
    *out = &filter->filter;
    return SNOW_STATUS_OK;
}
