/* io/filters/filter_inflate.c - the filter stage that unpacks gzip (RFC 1952)
 * and zlib (RFC 1950) streams.
 *
 * zlib verifies the check sum, and for gzip the length, at a stream's end; the
 * stage reports the end only after that. A gzip file may have several members,
 * whose bytes are joined. */
#include "io/filters/filter.h"
#include "io/source.h"
#include "io/zlib_memory.h"

/* What inflate may have consumed but not returned: its bit buffer and a started
 * run. In packed bytes, generously. */
#define INFLATE_SLACK 64

typedef struct inflate_filter {
    snow_filter_stage filter;
    z_stream stream;
    bool gzip; /* else zlib, which has one member */
    bool ended;
} inflate_filter;

bool snow_looks_gzip(const unsigned char *bytes, size_t size) {
    /* Two magic bytes, method 8 (deflate), no reserved flag. */
    return size >= 4 && bytes[0] == 0x1f && bytes[1] == 0x8b && bytes[2] == 8 &&
           !(bytes[3] & 0xe0);
}

/* After the end of a member: begins the next one, or ends the data. */
static snow_status next_member(inflate_filter *inflater) {
    snow_filter_stage *below = inflater->filter.below;
    SNOW_TRY(snow_filter_stage_fill(below, 4));
    size_t left = below->end - below->begin;
    if (inflater->gzip && snow_looks_gzip(below->buffer + below->begin, left)) {
        inflateReset(&inflater->stream);
        return SNOW_STATUS_OK;
    }
    inflater->ended = true;
    if (left)
        snow_notify(below->context,
                    "%s: bytes after the end of the compressed data are "
                    "ignored",
                    below->name);
    return SNOW_STATUS_OK;
}

/* Converts the result of inflate to a status with a message. Z_BUF_ERROR is an
 * error too: inflate is called only with input and with free space in the
 * output. */
static snow_status check_inflate(const inflate_filter *inflater, int answer) {
    const snow_filter_stage *filter = &inflater->filter;
    if (answer == Z_OK || answer == Z_STREAM_END)
        return SNOW_STATUS_OK;
    if (answer == Z_MEM_ERROR)
        return SNOW_STATUS_NO_MEMORY; /* snow_allocate set the message */
    return snow_fail(
        filter->context, SNOW_STATUS_BAD_INPUT,
        "%s: the compressed data are damaged (%s); fetch or compress the file "
        "again",
        filter->name,
        inflater->stream.msg ? inflater->stream.msg : "invalid data");
}

/* Runs inflate once on the buffered bytes below. */
static snow_status inflate_some(inflate_filter *inflater) {
    snow_filter_stage *below = inflater->filter.below;
    z_stream *stream = &inflater->stream;
    SNOW_TRY(snow_filter_stage_fill(below, 1));
    size_t packed = below->end - below->begin;
    if (!packed)
        return snow_fail(below->context, SNOW_STATUS_BAD_INPUT,
                         "%s: the compressed data are truncated; fetch or "
                         "compress the file again",
                         below->name);
    stream->next_in = below->buffer + below->begin;
    stream->avail_in = (uInt)packed;
    int answer = inflate(stream, Z_NO_FLUSH);
    snow_filter_stage_drop(below, packed - stream->avail_in);
    SNOW_TRY(check_inflate(inflater, answer));
    return answer == Z_STREAM_END ? next_member(inflater) : SNOW_STATUS_OK;
}

/* zlib counts in 32 bits; a larger request is served in parts, for which the
 * caller asks again. */
static snow_status pull_inflated(snow_filter_stage *filter, void *bytes,
                                 size_t size, size_t *got) {
    inflate_filter *inflater = (inflate_filter *)filter;
    uInt wanted = size > 1u << 30 ? 1u << 30 : (uInt)size;
    inflater->stream.next_out = bytes;
    inflater->stream.avail_out = wanted;
    while (!inflater->ended && inflater->stream.avail_out == wanted)
        SNOW_TRY(inflate_some(inflater));
    *got = wanted - inflater->stream.avail_out;
    return SNOW_STATUS_OK;
}

static void end_inflate(snow_filter_stage *filter) {
    inflateEnd(&((inflate_filter *)filter)->stream);
}

snow_status snow_filter_stage_open_inflate(snow_filter_stage *below,
                                           snow_filter_stage **out) {
    SNOW_TRY(snow_filter_stage_fill(below, 4));
    inflate_filter *inflater = snow_filter_stage_over(below, sizeof *inflater);
    if (!inflater)
        return SNOW_STATUS_NO_MEMORY;
    z_stream *stream = &inflater->stream;
    snow_zlib_use(stream, below->context);
    /* 15: the largest window; + 32: gzip or zlib, according to the header. */
    int answer = inflateInit2(stream, 15 + 32);
    snow_status status = check_inflate(inflater, answer);
    if (status != SNOW_STATUS_OK) {
        snow_release(below->context, inflater);
        return status;
    }
    inflater->filter.pull = pull_inflated;
    inflater->filter.fini = end_inflate;
    inflater->gzip = snow_looks_gzip(below->buffer + below->begin,
                                     below->end - below->begin);
    below->context->inflates = true;
    *out = &inflater->filter;
    return SNOW_STATUS_OK;
}

/* Recursive over the stages: for a packed file within a packed file the limits
 * multiply, but are still bounded by the bytes on the disk. */
uint64_t snow_filter_stage_limit(const snow_filter_stage *filter) {
    if (filter->size >= 0)
        return (uint64_t)snow_filter_stage_remaining(filter);
    if (filter->limit)
        return filter->limit(filter);
    if (!filter->below)
        return UINT64_MAX;
    uint64_t limit = snow_filter_stage_limit(filter->below);
    if (!snow_add_u64(limit, INFLATE_SLACK, &limit) ||
        !snow_mul_u64(limit, SNOW_DEFLATE_RATIO, &limit) ||
        !snow_add_u64(limit, filter->end - filter->begin, &limit))
        return UINT64_MAX;
    return limit;
}
