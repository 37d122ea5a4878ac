/* io/filters/filter_decode.c - the filter stage that decodes compressed streams
 * by a library.
 *
 * The library verifies a check sum at a stream's end; the stage reports the end
 * only after that.  The bytes of streams that follow one another are joined. */
#include "io/filters/filter.h"

#include <string.h>

/* What a decoder may have consumed but not returned: its bit buffer and a
 * started run. In packed bytes, generously. */
#define DECODE_SLACK 64

typedef struct decode_filter {
    snow_filter_stage filter;
    const snow_decoder *decoder;
    bool begun, ended;
    max_align_t state[];
} decode_filter;

static void end_stream(snow_filter_stage *filter) {
    decode_filter *stage = (decode_filter *)filter;
    if (stage->begun)
        stage->decoder->end(stage->state);
    stage->begun = false;
}

static snow_status begin_stream(decode_filter *stage) {
    memset(stage->state, 0, stage->decoder->bytes);
    stage->begun = stage->decoder->begin(stage->state, stage->filter.context);
    return stage->begun ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

/* Behind the end of a stream: another one, or the end of the data. */
static snow_status next_stream(decode_filter *stage) {
    snow_filter_stage *below = stage->filter.below;
    end_stream(&stage->filter);
    SNOW_TRY(snow_filter_stage_fill(below, 4));
    const size_t left = below->end - below->begin;
    if (stage->decoder->begins(below->buffer + below->begin, left))
        return begin_stream(stage);
    stage->ended = true;
    if (left)
        snow_notify(below->context,
                    "%s: bytes after the end of the compressed data are "
                    "ignored",
                    below->name);
    return SNOW_STATUS_OK;
}

/* Runs the decoder once on the buffered bytes below. */
static snow_status decode_some(decode_filter *stage, void *to, unsigned *room) {
    snow_filter_stage *below = stage->filter.below;
    SNOW_TRY(snow_filter_stage_fill(below, 1));
    const size_t packed = below->end - below->begin;
    unsigned left = (unsigned)packed;
    snow_decoded went = SNOW_DECODED_DAMAGED;
    if (packed)
        went = stage->decoder->decode(
            stage->state, below->buffer + below->begin, &left, to, room);
    snow_filter_stage_drop(below, packed - left);
    if (went == SNOW_DECODED_END)
        return next_stream(stage);
    if (went == SNOW_DECODED_SOME)
        return SNOW_STATUS_OK;
    if (went == SNOW_DECODED_NO_MEMORY)
        return SNOW_STATUS_NO_MEMORY;
    return snow_fail(below->context, SNOW_STATUS_BAD_INPUT,
                     "%s: the compressed data are %s; fetch or compress the "
                     "file again",
                     below->name, packed ? "damaged" : "truncated");
}

/* Libraries count in 32 bits; a larger request is served in parts, for which
 * the caller asks again. */
static snow_status pull_decoded(snow_filter_stage *filter, void *bytes,
                                size_t size, size_t *got) {
    decode_filter *stage = (decode_filter *)filter;
    const unsigned wanted = size > 1u << 30 ? 1u << 30 : (unsigned)size;
    unsigned room = wanted;
    while (!stage->ended && room == wanted)
        SNOW_TRY(decode_some(stage, bytes, &room));
    *got = wanted - room;
    return SNOW_STATUS_OK;
}

/* Recursive over the stages: for a packed file within a packed file the limits
 * multiply, but are still bounded by the bytes on the disk. */
static uint64_t limit_decoded(const snow_filter_stage *filter) {
    uint64_t limit = snow_filter_stage_limit(filter->below);
    if (!snow_add_u64(limit, DECODE_SLACK, &limit) ||
        !snow_mul_u64(limit, ((const decode_filter *)filter)->decoder->ratio,
                      &limit) ||
        !snow_add_u64(limit, filter->end - filter->begin, &limit))
        return UINT64_MAX;
    return limit;
}

snow_status snow_filter_stage_open_decoder(snow_filter_stage *below,
                                           const snow_decoder *decoder,
                                           snow_filter_stage **out) {
    decode_filter *stage =
        snow_filter_stage_over(below, sizeof *stage + decoder->bytes);
    if (!stage)
        return SNOW_STATUS_NO_MEMORY;
    stage->decoder = decoder;
    snow_status status = begin_stream(stage);
    if (status != SNOW_STATUS_OK) {
        snow_release(below->context, stage);
        return status;
    }
    stage->filter.pull = pull_decoded;
    stage->filter.limit = limit_decoded;
    stage->filter.fini = end_stream;
    below->context->inflates = true;
    *out = &stage->filter;
    return SNOW_STATUS_OK;
}
