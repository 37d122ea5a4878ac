/* formats/nrrd/unpack.c - the encodings of NRRD's binary data: gzip, bzip2 (by
 * libbz2), and hex, two digits for each byte with blanks anywhere. */
#include "formats/features.h"
#include "formats/nrrd/nrrd.h"
#include "io/filters/filters.h"

#include <ctype.h>
#include <string.h>

/* --- hex ------------------------------------------------------------------ */

typedef struct hex_filter {
    snow_filter_stage filter;
    int digits;    /* of a byte, so far */
    unsigned byte; /* their value */
} hex_filter;

static snow_status fail_hex(const hex_filter *hex, const char *what) {
    return snow_fail(hex->filter.context, SNOW_STATUS_BAD_INPUT,
                     "%s: its hexadecimal data %s; fetch or write it again",
                     hex->filter.name, what);
}

static snow_status pull_hex(snow_filter_stage *filter, void *bytes, size_t size,
                            size_t *got) {
    static const char digits[] = "0123456789abcdef";
    hex_filter *hex = (hex_filter *)filter;
    snow_filter_stage *below = filter->below;
    for (*got = 0; *got < size;) {
        SNOW_TRY(snow_filter_stage_fill(below, 1));
        if (below->begin == below->end)
            return hex->digits ? fail_hex(hex, "end within a byte")
                               : SNOW_STATUS_OK;
        const int letter = tolower(below->buffer[below->begin]);
        const char *digit = letter ? strchr(digits, letter) : NULL;
        if (!digit && !isspace(letter))
            return fail_hex(hex, "have a letter that is no digit");
        snow_filter_stage_drop(below, 1);
        if (!digit)
            continue;
        hex->byte = hex->byte << 4 | (unsigned)(digit - digits);
        if (++hex->digits == 2) {
            ((unsigned char *)bytes)[(*got)++] = (unsigned char)hex->byte;
            hex->digits = 0;
        }
    }
    return SNOW_STATUS_OK;
}

static uint64_t limit_hex(const snow_filter_stage *filter) {
    return snow_filter_stage_limit(filter->below) / 2 +
           (filter->end - filter->begin) + 1;
}

static snow_status open_hex(snow_filter_stage *below, snow_filter_stage **out) {
    hex_filter *hex = snow_filter_stage_allocate(below->context, sizeof *hex);
    if (!hex)
        return SNOW_STATUS_NO_MEMORY;
    hex->filter.name = below->name;
    hex->filter.below = below;
    hex->filter.pull = pull_hex;
    hex->filter.limit = limit_hex;
    hex->filter.size = -1;
    *out = &hex->filter;
    return SNOW_STATUS_OK;
}

/* --- bzip2 ---------------------------------------------------------------- */

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
    bzip2_filter *bzip2 =
        snow_filter_stage_allocate(below->context, sizeof *bzip2);
    if (!bzip2)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = begin_bzip2(bzip2);
    if (status != SNOW_STATUS_OK) {
        snow_release(below->context, bzip2);
        return status;
    }
    bzip2->filter.name = below->name;
    bzip2->filter.below = below;
    bzip2->filter.pull = pull_bzip2;
    bzip2->filter.limit = limit_bzip2;
    bzip2->filter.fini = end_bzip2;
    bzip2->filter.size = -1;
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

snow_status snow_nrrd_unpack(snow_source *source, nrrd_encoding encoding) {
    switch (encoding) {
    case NRRD_GZIP:
        return snow_source_unpack(source);
    case NRRD_BZIP2:
        return snow_source_unpack_by(source, open_bzip2);
    case NRRD_HEX:
        return snow_source_unpack_by(source, open_hex);
    case NRRD_RAW:
    case NRRD_ASCII:
        break;
    }
    return SNOW_STATUS_OK;
}
