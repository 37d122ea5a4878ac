/* base/layer_blocks.c - the layer that undoes data packed as a row of zlib
 * streams (RFC 1950) of known sizes, as VTK's XML files have them.
 *
 * Since the sizes stand before the data, what is passed by need not be
 * unpacked: a block is skipped by its packed size. */
#include "base/layer.h"
#include "base/source.h"

#include <zlib.h>

/* What a stream needs beside its runs: header, check sum, last bits. */
#define STREAM_SLACK 64

typedef struct blocks_layer {
    snow_layer layer;
    z_stream stream;
    snow_blocks blocks;
    uint64_t next;   /* block to begin */
    uint64_t packed; /* bytes of the current block that were not taken yet */
    uint64_t left;   /* unpacked bytes that it has still to give */
    bool damaged;    /* a jump failed: where we are is not known */
} blocks_layer;

static voidpf allocate_for_zlib(voidpf context, uInt count, uInt size) {
    return snow_allocate_array(context, count, size);
}

static void release_for_zlib(voidpf context, voidpf block) {
    snow_release(context, block);
}

static uint64_t size_of(const blocks_layer *layer, uint64_t block) {
    return block + 1 == layer->blocks.count ? layer->blocks.last
                                            : layer->blocks.whole;
}

static snow_status fail_block(const blocks_layer *layer, const char *why) {
    return snow_fail(layer->layer.context, SNOW_BAD_INPUT,
                     "%s: block %llu of its compressed data is damaged (%s); "
                     "fetch or write the file again",
                     layer->layer.name,
                     (unsigned long long)(layer->next ? layer->next - 1 : 0),
                     why);
}

static void begin_block(blocks_layer *layer) {
    layer->left = size_of(layer, layer->next);
    layer->packed = layer->blocks.packed[layer->next];
    layer->next++;
    inflateReset(&layer->stream);
}

/* Runs inflate once on what is buffered below and belongs to the block. */
static snow_status inflate_some(blocks_layer *layer, int *answer) {
    snow_layer *below = layer->layer.below;
    SNOW_TRY(snow_layer_fill(below, 1));
    size_t some = below->end - below->begin;
    if (some > layer->packed)
        some = (size_t)layer->packed;
    if (!some)
        return fail_block(layer, "it ends too early");
    layer->stream.next_in = below->buffer + below->begin;
    layer->stream.avail_in = (uInt)some;
    *answer = inflate(&layer->stream, Z_NO_FLUSH);
    some -= layer->stream.avail_in;
    snow_layer_drop(below, some);
    layer->packed -= some;
    if (*answer == Z_MEM_ERROR)
        return SNOW_NO_MEMORY;
    if (*answer != Z_OK && *answer != Z_STREAM_END && *answer != Z_BUF_ERROR)
        return fail_block(layer,
                          layer->stream.msg ? layer->stream.msg : "no sense");
    return SNOW_OK;
}

/* The check sum comes behind the last byte: inflate is led on to it, and must
 * make nothing more. */
static snow_status end_block(blocks_layer *layer, int answer) {
    unsigned char none;
    while (answer != Z_STREAM_END) {
        layer->stream.next_out = &none;
        layer->stream.avail_out = 1;
        SNOW_TRY(inflate_some(layer, &answer));
        if (!layer->stream.avail_out)
            return fail_block(layer, "it is longer than it says");
    }
    if (layer->packed)
        return fail_block(layer, "its packed size is wrong");
    return SNOW_OK;
}

/* Brings some bytes of the current block. */
static snow_status pull_block(blocks_layer *layer, void *bytes, size_t size,
                              size_t *got) {
    uInt wanted = size > 1u << 30 ? 1u << 30 : (uInt)size;
    if (wanted > layer->left)
        wanted = (uInt)layer->left;
    layer->stream.next_out = bytes;
    layer->stream.avail_out = wanted;
    int answer = Z_OK;
    while (layer->stream.avail_out && answer != Z_STREAM_END)
        SNOW_TRY(inflate_some(layer, &answer));
    *got = wanted - layer->stream.avail_out;
    layer->left -= *got;
    if (answer == Z_STREAM_END && layer->left)
        return fail_block(layer, "it is shorter than it says");
    return layer->left ? SNOW_OK : end_block(layer, answer);
}

static snow_status pull_blocks(snow_layer *base, void *bytes, size_t size,
                               size_t *got) {
    blocks_layer *layer = (blocks_layer *)base;
    *got = 0;
    if (layer->damaged)
        return fail_block(layer, "it cannot be passed by");
    while (!layer->left && layer->next < layer->blocks.count)
        begin_block(layer);
    return layer->left ? pull_block(layer, bytes, size, got) : SNOW_OK;
}

/* Drops bytes of the layer below; false when it has not so many. */
static bool drop_below(snow_layer *below, uint64_t size) {
    while (size) {
        if (below->begin == below->end && below->jump) {
            int64_t remaining = snow_layer_remaining(below);
            if (remaining >= 0 && (uint64_t)remaining >= size &&
                below->jump(below, size)) {
                below->taken += size;
                return true;
            }
        }
        if (snow_layer_fill(below, 1) != SNOW_OK || below->begin == below->end)
            return false;
        uint64_t some = below->end - below->begin;
        if (some > size)
            some = size;
        snow_layer_drop(below, (size_t)some);
        size -= some;
    }
    return true;
}

/* What is left of the current block, then whole blocks unseen, then a part of
 * one.  The bytes in between are not buffered here, as for every jump. */
static bool jump_blocks(snow_layer *base, uint64_t count) {
    blocks_layer *layer = (blocks_layer *)base;
    while (count) {
        if (!layer->left && layer->next < layer->blocks.count &&
            size_of(layer, layer->next) <= count) {
            count -= size_of(layer, layer->next);
            if (!drop_below(base->below, layer->blocks.packed[layer->next++]))
                layer->damaged = true;
        } else {
            unsigned char scratch[4096];
            size_t got,
                some = sizeof scratch < count ? sizeof scratch : (size_t)count;
            if (pull_blocks(base, scratch, some, &got) != SNOW_OK || !got)
                layer->damaged = true;
            else
                count -= got;
        }
        if (layer->damaged)
            return false;
    }
    return true;
}

static void end_blocks(snow_layer *base) {
    blocks_layer *layer = (blocks_layer *)base;
    inflateEnd(&layer->stream);
    snow_release(base->context, layer->blocks.packed);
}

/* All packed and all unpacked bytes; false when they cannot be true. */
static bool measure(const snow_layer *below, const snow_blocks *blocks,
                    uint64_t *unpacked) {
    uint64_t packed = 0, most;
    for (uint64_t i = 0; i < blocks->count; i++)
        if (!snow_add_u64(packed, blocks->packed[i], &packed))
            return false;
    return blocks->whole && blocks->last && packed <= snow_layer_limit(below) &&
           snow_mul_u64(blocks->count - 1, blocks->whole, unpacked) &&
           snow_add_u64(*unpacked, blocks->last, unpacked) &&
           *unpacked <= (uint64_t)INT64_MAX &&
           snow_mul_u64(blocks->count, STREAM_SLACK, &most) &&
           snow_add_u64(packed, most, &most) &&
           (!snow_mul_u64(most, SNOW_DEFLATE_RATIO, &most) ||
            *unpacked <= most);
}

snow_status snow_layer_open_blocks(snow_layer *below, const snow_blocks *blocks,
                                   snow_layer **out) {
    uint64_t unpacked;
    if (!measure(below, blocks, &unpacked))
        return snow_fail(below->context, SNOW_BAD_INPUT,
                         "%s: the sizes of its compressed blocks are larger "
                         "than the file; it is cut or damaged",
                         below->name);
    blocks_layer *layer = snow_layer_allocate(below->context, sizeof *layer);
    if (!layer)
        return SNOW_NO_MEMORY;
    layer->stream.zalloc = allocate_for_zlib;
    layer->stream.zfree = release_for_zlib;
    layer->stream.opaque = below->context;
    if (inflateInit2(&layer->stream, 15) != Z_OK) {
        snow_release(below->context, layer);
        return SNOW_NO_MEMORY; /* snow_allocate left the message */
    }
    layer->layer.name = below->name;
    layer->layer.below = below;
    layer->layer.pull = pull_blocks;
    layer->layer.jump = jump_blocks;
    layer->layer.fini = end_blocks;
    layer->layer.size = (int64_t)unpacked;
    layer->blocks = *blocks;
    *out = &layer->layer;
    return SNOW_OK;
}
