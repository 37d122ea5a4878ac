/* base/layer_inflate.c - the layer that undoes gzip (RFC 1952) and zlib (RFC
 * 1950) streams.
 *
 * zlib verifies the check sum, and for gzip the length, at a stream's end; the
 * layer passes on its end only after that.  A gzip file may be several members
 * one after the other, whose bytes are joined. */
#include "base/layer.h"
#include "base/source.h"

#include <zlib.h>

/* What inflate may have swallowed without having given it out: its bit buffer
 * and a started run.  In packed bytes, generously. */
#define INFLATE_SLACK 64

typedef struct inflate_layer {
    snow_layer layer;
    z_stream stream;
    bool gzip; /* else zlib, which has one member */
    bool ended;
} inflate_layer;

bool snow_looks_gzip(const unsigned char *bytes, size_t size) {
    /* Two magic bytes, method 8 (deflate), no reserved flag. */
    return size >= 4 && bytes[0] == 0x1f && bytes[1] == 0x8b && bytes[2] == 8 &&
           !(bytes[3] & 0xe0);
}

/* zlib's memory comes from the context as well, so that it is counted, limited
 * and made to fail in tests like all other. */
static voidpf allocate_for_zlib(voidpf context, uInt count, uInt size) {
    return snow_allocate_array(context, count, size);
}

static void release_for_zlib(voidpf context, voidpf block) {
    snow_release(context, block);
}

/* After the end of a member: begins the next one, or ends the data. */
static snow_status next_member(inflate_layer *inflater) {
    snow_layer *below = inflater->layer.below;
    SNOW_TRY(snow_layer_fill(below, 4));
    size_t left = below->end - below->begin;
    if (inflater->gzip && snow_looks_gzip(below->buffer + below->begin, left)) {
        inflateReset(&inflater->stream);
        return SNOW_OK;
    }
    inflater->ended = true;
    if (left)
        snow_notify(below->context,
                    "%s: bytes after the end of the compressed data are "
                    "ignored",
                    below->name);
    return SNOW_OK;
}

/* What inflate answers, as a status with a message. Z_BUF_ERROR is an error
 * too: it is only called with bytes to take and room to fill. */
static snow_status check(const inflate_layer *inflater, int answer) {
    const snow_layer *layer = &inflater->layer;
    if (answer == Z_OK || answer == Z_STREAM_END)
        return SNOW_OK;
    if (answer == Z_MEM_ERROR)
        return SNOW_NO_MEMORY; /* snow_allocate left the message */
    return snow_fail(
        layer->context, SNOW_BAD_INPUT,
        "%s: the compressed data are damaged (%s); fetch or compress the file "
        "again",
        layer->name, inflater->stream.msg ? inflater->stream.msg : "no sense");
}

/* Runs inflate once on what is buffered below. */
static snow_status inflate_some(inflate_layer *inflater) {
    snow_layer *below = inflater->layer.below;
    z_stream *stream = &inflater->stream;
    SNOW_TRY(snow_layer_fill(below, 1));
    size_t packed = below->end - below->begin;
    if (!packed)
        return snow_fail(below->context, SNOW_BAD_INPUT,
                         "%s: the compressed data are cut; fetch the file "
                         "again",
                         below->name);
    stream->next_in = below->buffer + below->begin;
    stream->avail_in = (uInt)packed;
    int answer = inflate(stream, Z_NO_FLUSH);
    snow_layer_drop(below, packed - stream->avail_in);
    SNOW_TRY(check(inflater, answer));
    return answer == Z_STREAM_END ? next_member(inflater) : SNOW_OK;
}

/* zlib counts in 32 bits; a larger wish is served in parts, which the layer's
 * reader asks for. */
static snow_status pull_inflated(snow_layer *layer, void *bytes, size_t size,
                                 size_t *got) {
    inflate_layer *inflater = (inflate_layer *)layer;
    uInt wanted = size > 1u << 30 ? 1u << 30 : (uInt)size;
    inflater->stream.next_out = bytes;
    inflater->stream.avail_out = wanted;
    while (!inflater->ended && inflater->stream.avail_out == wanted)
        SNOW_TRY(inflate_some(inflater));
    *got = wanted - inflater->stream.avail_out;
    return SNOW_OK;
}

static void end_inflate(snow_layer *layer) {
    inflateEnd(&((inflate_layer *)layer)->stream);
}

snow_status snow_layer_open_inflate(snow_layer *below, snow_layer **out) {
    SNOW_TRY(snow_layer_fill(below, 4));
    inflate_layer *inflater =
        snow_layer_allocate(below->context, sizeof *inflater);
    if (!inflater)
        return SNOW_NO_MEMORY;
    z_stream *stream = &inflater->stream;
    stream->zalloc = allocate_for_zlib;
    stream->zfree = release_for_zlib;
    stream->opaque = below->context;
    /* 15: the largest window; + 32: gzip or zlib, as the header says. */
    int answer = inflateInit2(stream, 15 + 32);
    inflater->layer.name = below->name;
    snow_status status = check(inflater, answer);
    if (status != SNOW_OK) {
        snow_release(below->context, inflater);
        return status;
    }
    inflater->layer.below = below;
    inflater->layer.pull = pull_inflated;
    inflater->layer.fini = end_inflate;
    inflater->layer.size = -1;
    inflater->gzip = snow_looks_gzip(below->buffer + below->begin,
                                     below->end - below->begin);
    *out = &inflater->layer;
    return SNOW_OK;
}

/* Recursive over the layers: a packed file within a packed file multiplies the
 * limits, and still is bounded by the bytes on the disk. */
uint64_t snow_layer_limit(const snow_layer *layer) {
    if (layer->size >= 0)
        return (uint64_t)snow_layer_remaining(layer);
    if (layer->limit)
        return layer->limit(layer);
    if (!layer->below)
        return UINT64_MAX;
    uint64_t limit = snow_layer_limit(layer->below);
    if (!snow_add_u64(limit, INFLATE_SLACK, &limit) ||
        !snow_mul_u64(limit, SNOW_DEFLATE_RATIO, &limit) ||
        !snow_add_u64(limit, layer->end - layer->begin, &limit))
        return UINT64_MAX;
    return limit;
}
