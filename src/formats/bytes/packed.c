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
#define SLACK 64

typedef struct bzip2_filter {
    snow_filter_stage filter;
    bz_stream stream;
    bool begun, ended;
} bzip2_filter;

static void *allocate_bzip2(void *context, int count, int size) {
    return snow_allocate_array(context, (uint64_t)count, (size_t)size);
}

static void release_bzip2(void *context, void *block) {
    snow_release(context, block);
}

static void end_bzip2(snow_filter_stage *filter) {
    bzip2_filter *bzip2 = (bzip2_filter *)filter;
    if (bzip2->begun)
        BZ2_bzDecompressEnd(&bzip2->stream);
    bzip2->begun = false;
}

static snow_status begin_bzip2(bzip2_filter *bzip2) {
    bzip2->stream.bzalloc = allocate_bzip2;
    bzip2->stream.bzfree = release_bzip2;
    bzip2->stream.opaque = bzip2->filter.context;
    bzip2->begun = BZ2_bzDecompressInit(&bzip2->stream, 0, 0) == BZ_OK;
    return bzip2->begun ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

/* Behind the end of a stream: another one, or the end of the data. */
static snow_status next_stream(bzip2_filter *bzip2) {
    snow_filter_stage *below = bzip2->filter.below;
    end_bzip2(&bzip2->filter);
    SNOW_TRY(snow_filter_stage_fill(below, 4));
    const size_t left = below->end - below->begin;
    if (left >= 4 && !memcmp(below->buffer + below->begin, "BZh", 3))
        return begin_bzip2(bzip2);
    bzip2->ended = true;
    if (left)
        snow_notify(below->context,
                    "%s: bytes after the end of the compressed data are "
                    "ignored",
                    below->name);
    return SNOW_STATUS_OK;
}

static snow_status unpack_some(bzip2_filter *bzip2) {
    snow_filter_stage *below = bzip2->filter.below;
    SNOW_TRY(snow_filter_stage_fill(below, 1));
    const size_t packed = below->end - below->begin;
    bzip2->stream.next_in = (char *)below->buffer + below->begin;
    bzip2->stream.avail_in = (unsigned)packed;
    const int answer =
        packed ? BZ2_bzDecompress(&bzip2->stream) : BZ_UNEXPECTED_EOF;
    snow_filter_stage_drop(below, packed - bzip2->stream.avail_in);
    if (answer == BZ_STREAM_END)
        return next_stream(bzip2);
    if (answer == BZ_OK)
        return SNOW_STATUS_OK;
    if (answer == BZ_MEM_ERROR)
        return SNOW_STATUS_NO_MEMORY; /* snow_allocate set the message */
    return snow_fail(below->context, SNOW_STATUS_BAD_INPUT,
                     "%s: the compressed data are %s; fetch or compress the "
                     "file again",
                     below->name,
                     answer == BZ_UNEXPECTED_EOF ? "truncated" : "damaged");
}

static snow_status pull_bzip2(snow_filter_stage *filter, void *bytes,
                              size_t size, size_t *got) {
    bzip2_filter *bzip2 = (bzip2_filter *)filter;
    const unsigned wanted = size > 1u << 30 ? 1u << 30 : (unsigned)size;
    bzip2->stream.next_out = bytes;
    bzip2->stream.avail_out = wanted;
    while (!bzip2->ended && bzip2->stream.avail_out == wanted)
        SNOW_TRY(unpack_some(bzip2));
    *got = wanted - bzip2->stream.avail_out;
    return SNOW_STATUS_OK;
}

static uint64_t limit_bzip2(const snow_filter_stage *filter) {
    uint64_t limit = snow_filter_stage_limit(filter->below);
    if (!snow_add_u64(limit, SLACK, &limit) ||
        !snow_mul_u64(limit, MOST_RATIO, &limit) ||
        !snow_add_u64(limit, filter->end - filter->begin, &limit))
        return UINT64_MAX;
    return limit;
}

static snow_status open_bzip2(snow_filter_stage *below,
                              snow_filter_stage **out) {
    bzip2_filter *bzip2 = snow_filter_stage_over(below, sizeof *bzip2);
    if (!bzip2)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = begin_bzip2(bzip2);
    if (status != SNOW_STATUS_OK) {
        snow_release(below->context, bzip2);
        return status;
    }
    bzip2->filter.pull = pull_bzip2;
    bzip2->filter.limit = limit_bzip2;
    bzip2->filter.fini = end_bzip2;
    below->context->inflates = true;
    *out = &bzip2->filter;
    return SNOW_STATUS_OK;
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
