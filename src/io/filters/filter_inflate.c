/* io/filters/filter_inflate.c - the decoder of gzip (RFC 1952) and zlib (RFC
 * 1950), by zlib. */
#include "io/filters/filter.h"
#include "io/source.h"
#include "io/zlib_memory.h"

bool snow_looks_gzip(const unsigned char *bytes, size_t size) {
    /* Two magic bytes, method 8 (deflate), no reserved flag. */
    return size >= 4 && bytes[0] == 0x1f && bytes[1] == 0x8b && bytes[2] == 8 &&
           !(bytes[3] & 0xe0);
}

static bool begin_inflate(void *state, snow_context *context) {
    snow_zlib_use(state, context);
    /* 15: the largest window; + 32: gzip or zlib, according to the header. */
    return inflateInit2((z_stream *)state, 15 + 32) == Z_OK;
}

static snow_decoded inflate_some(void *state, unsigned char *from,
                                 unsigned *packed, void *to, unsigned *room) {
    z_stream *stream = state;
    stream->next_in = from;
    stream->avail_in = *packed;
    stream->next_out = to;
    stream->avail_out = *room;
    const int answer = inflate(stream, Z_NO_FLUSH);
    *packed = stream->avail_in;
    *room = stream->avail_out;
    /* Z_BUF_ERROR is an error: there are input and space for the output. */
    return answer == Z_OK           ? SNOW_DECODED_SOME
           : answer == Z_STREAM_END ? SNOW_DECODED_END
           : answer == Z_MEM_ERROR  ? SNOW_DECODED_NO_MEMORY
                                    : SNOW_DECODED_DAMAGED;
}

static void end_inflate(void *state) {
    inflateEnd(state);
}

snow_status snow_filter_stage_open_inflate(snow_filter_stage *below,
                                           snow_filter_stage **out) {
    static const snow_decoder gzip = {
        .bytes = sizeof(z_stream),
        .begin = begin_inflate,
        .decode = inflate_some,
        .end = end_inflate,
        .begins = snow_looks_gzip,
        .ratio = SNOW_DEFLATE_RATIO,
    };
    return snow_filter_stage_open_decoder(below, &gzip, out);
}
