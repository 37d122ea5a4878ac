/* formats/bytes/packed.c - unpacks bzip2, of whole files and of NRRD's data, by
 * libbz2, and blocks of LZ4 by liblz4. */
#include "formats/bytes/packed.h"
#include "formats/features.h"

#include <string.h>

bool snow_looks_bzip2(const void *bytes, size_t size) {
    const char *head = bytes;
    return size >= 10 && !memcmp(head, "BZh", 3) && head[3] >= '1' &&
           head[3] <= '9' && !memcmp(head + 4, "1AY&SY", 6);
}

#if SNOW_HAVE_BZIP2

#include <bzlib.h>

/* A block of 900,000 bytes, each five of which stand for 255, has 32 bytes at
 * least. */
#define MOST_RATIO ((uint64_t)1500000)

static void *allocate_bzip2(void *context, int count, int size) {
    return snow_allocate_array(context, (uint64_t)count, (size_t)size);
}

static void release_bzip2(void *context, void *block) {
    snow_release(context, block);
}

static bool begin_bzip2(void *state, snow_context *context) {
    bz_stream *stream = state;
    stream->bzalloc = allocate_bzip2;
    stream->bzfree = release_bzip2;
    stream->opaque = context;
    return BZ2_bzDecompressInit(stream, 0, 0) == BZ_OK;
}

static snow_decoded decode_bzip2(void *state, unsigned char *from,
                                 unsigned *packed, void *to, unsigned *room) {
    bz_stream *stream = state;
    stream->next_in = (char *)from;
    stream->avail_in = *packed;
    stream->next_out = to;
    stream->avail_out = *room;
    const int answer = BZ2_bzDecompress(stream);
    *packed = stream->avail_in;
    *room = stream->avail_out;
    return answer == BZ_OK           ? SNOW_DECODED_SOME
           : answer == BZ_STREAM_END ? SNOW_DECODED_END
           : answer == BZ_MEM_ERROR  ? SNOW_DECODED_NO_MEMORY
                                     : SNOW_DECODED_DAMAGED;
}

static void end_bzip2(void *state) {
    BZ2_bzDecompressEnd(state);
}

static bool begins_bzip2(const unsigned char *bytes, size_t size) {
    return size >= 4 && !memcmp(bytes, "BZh", 3);
}

static snow_status open_bzip2(snow_filter_stage *below,
                              snow_filter_stage **out) {
    static const snow_decoder bzip2 = {
        .bytes = sizeof(bz_stream),
        .begin = begin_bzip2,
        .decode = decode_bzip2,
        .end = end_bzip2,
        .begins = begins_bzip2,
        .ratio = MOST_RATIO,
    };
    return snow_filter_stage_open_decoder(below, &bzip2, out);
}

#else

static snow_status open_bzip2(snow_filter_stage *below,
                              snow_filter_stage **out) {
    (void)out;
    return snow_fail_unbuilt(below->context, "bzip2", "libbz2-dev");
}

#endif

snow_status snow_source_unpack_bzip2(snow_source *source) {
    return snow_source_unpack_by(source, open_bzip2);
}

/* --- LZ4 ------------------------------------------------------------------ */

#if SNOW_HAVE_LZ4

#include <limits.h>
#include <lz4.h>

snow_status snow_lz4_need(snow_context *context) {
    (void)context;
    return SNOW_STATUS_OK;
}

bool snow_lz4_unpack(const void *packed, size_t size, void *out, size_t bytes) {
    return size <= INT_MAX && bytes <= INT_MAX &&
           LZ4_decompress_safe(packed, out, (int)size, (int)bytes) ==
               (int)bytes;
}

#else

snow_status snow_lz4_need(snow_context *context) {
    return snow_fail_unbuilt(context, "LZ4", "liblz4-dev");
}

bool snow_lz4_unpack(const void *packed, size_t size, void *out, size_t bytes) {
    (void)packed, (void)size, (void)out, (void)bytes;
    return false;
}

#endif
