/* io/filters/relay.c - inflating in turn: see base/relay.h. */
#include "base/fingerprint.h"
#include "io/filters/inflate.h"

#include <string.h>

/* Of unpacked bytes, at least: more than readers read ahead, so that one of two
 * points lies before what they have used. */
#define POINTS_APART ((uint64_t)2 * SNOW_FILTER_BYTES)

static snow_relay *relay_of(const inflate_filter *inflater) {
    return inflater->filter.relay;
}

/* --- where others may enter ----------------------------------------------- */

static void note_point(inflate_filter *inflater, bool between_members) {
    snow_relay *relay = relay_of(inflater);
    snow_relay_point *seen = relay->seen;
    uInt bytes = 0;
    if (inflater->unpacked < seen[0].unpacked + POINTS_APART)
        return;
    seen[1] = seen[0];
    if (!between_members)
        (void)inflateGetDictionary(&inflater->stream, seen[0].window, &bytes);
    seen[0].window_bytes = (uint16_t)bytes;
    seen[0].unpacked = inflater->unpacked;
    seen[0].packed = inflater->filter.below->taken;
    seen[0].member = inflater->member;
    seen[0].check =
        inflater->entered ? inflater->check : (uint32_t)inflater->stream.adler;
    seen[0].bits =
        between_members ? 0 : (uint16_t)(inflater->stream.data_type & 7);
}

void snow_relay_note(inflate_filter *inflater, const unsigned char *bytes,
                     size_t count) {
    const int where = inflater->stream.data_type;
    if (inflater->entered)
        inflater->check = snow_inflate_sum(inflater, bytes, count);
    inflater->unpacked += count;
    if ((where & SNOW_BETWEEN_BLOCKS) && !(where & SNOW_LAST_BLOCK) &&
        inflater->unpacked > inflater->member)
        note_point(inflater, false);
}

void snow_relay_begin_member(inflate_filter *inflater) {
    inflater->entered = false;
    inflater->member = inflater->unpacked;
    note_point(inflater, true);
}

/* --- reading on ----------------------------------------------------------- */

/* Continues at a point that lies ahead; where it does not, nothing is done. */
static snow_status enter(inflate_filter *inflater, const snow_relay_point *p) {
    snow_filter_stage *below = inflater->filter.below;
    z_stream *stream = &inflater->stream;
    const int bits = p->bits;
    const uint64_t begin = p->packed - (bits > 0);
    if (begin < below->taken)
        return SNOW_STATUS_OK;
    if (!snow_filter_stage_pass(below, begin - below->taken))
        return snow_inflate_fail(inflater, "truncated");
    inflater->entered = p->unpacked > p->member;
    inflater->unpacked = p->unpacked;
    inflater->member = p->member;
    inflater->check = p->check;
    inflateReset2(stream, inflater->entered ? -MAX_WBITS : SNOW_ANY_HEADER);
    if (bits) {
        SNOW_TRY(snow_filter_stage_fill(below, 1));
        if (below->begin == below->end)
            return snow_inflate_fail(inflater, "truncated");
        inflatePrime(stream, bits, below->buffer[below->begin] >> (8 - bits));
        snow_filter_stage_drop(below, 1);
    }
    if (inflater->entered)
        inflateSetDictionary(stream, p->window, p->window_bytes);
    return SNOW_STATUS_OK;
}

snow_status snow_relay_catch_up(inflate_filter *inflater) {
    snow_filter_stage *filter = &inflater->filter;
    const snow_relay_point *from = &relay_of(inflater)->from;
    const uint64_t reach = snow_filter_stage_reach(filter);
    if (from->unpacked > inflater->unpacked && from->unpacked <= reach)
        SNOW_TRY(enter(inflater, from));
    while (inflater->unpacked < reach) {
        const uint64_t left = reach - inflater->unpacked;
        size_t got;
        SNOW_TRY(snow_inflate_bytes(
            inflater, filter->buffer,
            left < SNOW_FILTER_BYTES ? (size_t)left : SNOW_FILTER_BYTES, &got));
        if (!got)
            return snow_fail(filter->context, SNOW_STATUS_BAD_INPUT,
                             "%s: ends %llu bytes too early in the voxels; the "
                             "file is truncated, or its sizes or type are "
                             "wrong",
                             filter->name, (unsigned long long)left);
    }
    return SNOW_STATUS_OK;
}

/* Bytes of a number, the least first or last. */
static uint32_t number_at(const unsigned char *bytes, bool least_first) {
    uint32_t number = 0;
    for (int n = 0; n < 4; n++)
        number |= (uint32_t)bytes[n] << 8 * (least_first ? n : 3 - n);
    return number;
}

/* gzip has the sum and the length behind a member, zlib the sum. */
snow_status snow_relay_verify(inflate_filter *inflater) {
    snow_filter_stage *below = inflater->filter.below;
    const size_t size = inflater->gzip ? 8 : 4;
    SNOW_TRY(snow_filter_stage_fill(below, size));
    const unsigned char *end = below->buffer + below->begin;
    if (below->end - below->begin < size)
        return snow_inflate_fail(inflater, "truncated");
    if (number_at(end, inflater->gzip) != inflater->check)
        return snow_inflate_fail(inflater, "damaged (incorrect data check)");
    if (inflater->gzip && number_at(end + 4, true) !=
                              (uint32_t)(inflater->unpacked - inflater->member))
        return snow_inflate_fail(inflater, "damaged (incorrect length check)");
    snow_filter_stage_drop(below, size);
    return SNOW_STATUS_OK;
}

/* --- taking part ---------------------------------------------------------- */

/* Nothing is unpacked until something is read: perhaps others read on. */
static bool skip_later(snow_filter_stage *filter, uint64_t count) {
    inflate_filter *inflater = (inflate_filter *)filter;
    (void)count;
    if (filter->taken == inflater->unpacked)
        inflater->wanted = filter->taken;
    filter->relay->skips = 1;
    return true;
}

void snow_relay_join(inflate_filter *inflater, snow_relay *relay) {
    snow_filter_stage *filter = &inflater->filter;
    const uint64_t begin = filter->below->taken;
    uint64_t source =
        snow_hash_mix(SNOW_HASH_START, filter->name, strlen(filter->name));
    source = snow_hash_mix(source, &begin, sizeof begin) | 1;
    if (!relay->source)
        relay->source = source;
    if (relay->source != source)
        return;
    memset(relay->seen, 0, sizeof relay->seen);
    filter->relay = relay;
    filter->jump = skip_later;
}

void snow_relay_leave(inflate_filter *inflater) {
    const snow_filter_stage *filter = &inflater->filter;
    snow_relay *relay = relay_of(inflater);
    const uint64_t end =
        filter->taken > inflater->unpacked ? inflater->wanted : filter->taken;
    for (int n = 0; n < 2; n++)
        if (relay->seen[n].unpacked > relay->from.unpacked &&
            relay->seen[n].unpacked <= end) {
            relay->from = relay->seen[n];
            return;
        }
}
