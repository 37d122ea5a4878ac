/* formats/dicom/codestream.c - finds the parts of a JPEG 2000 code stream (ITU
 * T.800, annex A), each of which must end where the next one begins. */
#include "formats/dicom/packets.h"

#include "formats/bytes/number.h"
#include "formats/dicom/dicom.h"

#include <stdlib.h>

/* Bytes of a part's first marker and its segment, and of the marker before its
 * packets. */
#define SOT_BYTES 12
#define SOD_BYTES 2

/* Bytes that are still to be read. */
typedef struct rest {
    const unsigned char *at, *end;
} rest;

typedef struct segment {
    int marker;
    const unsigned char *at; /* behind its length */
    size_t size;
} segment;

static uint64_t whole(const unsigned char *at, int bytes) {
    return snow_number_at(at, bytes, true);
}

static int next_marker(const rest *r) {
    return r->end - r->at < 2 ? 0 : (int)whole(r->at, 2);
}

/* Takes a marker with a segment. */
static bool next_segment(rest *r, segment *out) {
    const size_t left = (size_t)(r->end - r->at);
    const size_t size = left < 4 ? 0 : (size_t)whole(r->at + 2, 2);
    if (size < 2 || size > left - 2 || r->at[0] != 0xff)
        return false;
    *out = (segment){next_marker(r), r->at + 4, size - 2};
    r->at += 2 + size;
    return true;
}

/* --- the main header ------------------------------------------------------ */

static bool take_sizes(const segment *siz, j2k_stream *s) {
    if (siz->marker != 0xff51 || siz->size < 36)
        return false;
    uint64_t *const values[] = {&s->x1,      &s->y1,        &s->x0,
                                &s->y0,      &s->tile_wide, &s->tile_high,
                                &s->tile_x0, &s->tile_y0};
    for (int i = 0; i < 8; i++)
        *values[i] = whole(siz->at + 2 + 4 * i, 4);
    s->components = (uint32_t)whole(siz->at + 34, 2);
    if (!s->tile_wide || !s->tile_high || s->tile_x0 > s->x0 ||
        s->tile_y0 > s->y0 || s->x0 >= s->x1 || s->y0 >= s->y1)
        return false;
    const uint64_t tiles =
        ((s->x1 - s->tile_x0 + s->tile_wide - 1) / s->tile_wide) *
        ((s->y1 - s->tile_y0 + s->tile_high - 1) / s->tile_high);
    s->tiles = (uint32_t)tiles;
    return tiles <= UINT16_MAX;
}

static bool take_coding(const segment *cod, j2k_coding *out) {
    const unsigned char *at = cod->at;
    if (cod->size < 10)
        return false;
    j2k_coding c = {.flags = at[0],
                    .order = at[1],
                    .layers = (uint32_t)whole(at + 2, 2),
                    .levels = at[5],
                    .wide = at[6] + 2,
                    .high = at[7] + 2,
                    .style = at[8]};
    const bool given = c.flags & J2K_PRECINCTS;
    if (c.order > 4 || !c.layers || c.levels > 32 || c.wide > 10 ||
        c.high > 10 || (given && cod->size < 11 + (size_t)c.levels))
        return false;
    for (int level = 0; level <= c.levels; level++) {
        c.precinct[level] = given ? at[10 + level] : 0xff;
        /* those of higher levels are halved in bands */
        if (level && (c.precinct[level] < 16 || !(c.precinct[level] & 15)))
            return false;
    }
    *out = c;
    return true;
}

/* Component styles, regions of interest, changes of progression, and packed
 * headers of packets; a region does not change packets. */
static bool is_rare(int marker) {
    return marker == 0xff53 || marker == 0xff5f || marker == 0xff60 ||
           marker == 0xff61;
}

static bool read_main(rest *r, j2k_stream *s) {
    segment next;
    bool coded = false;
    r->at += 2;
    if (!next_segment(r, &next) || !take_sizes(&next, s))
        return false;
    s->plain = true;
    while (next_marker(r) != 0xff90) {
        if (!next_segment(r, &next))
            return false;
        s->plain &= !is_rare(next.marker);
        if (next.marker == 0xff52) {
            coded = take_coding(&next, &s->coding);
            if (!coded)
                return false;
        }
    }
    return coded;
}

/* --- parts ---------------------------------------------------------------- */

/* The last part may reach up to the end of the stream. */
static uint64_t bytes_left(const rest *r) {
    const unsigned char *end = r->end;
    while (end - r->at >= SOT_BYTES + 2 && whole(end - 2, 2) != 0xffd9)
        end--;
    return (uint64_t)(end - r->at) - 2;
}

/* Takes a part; its header may have segments too. */
static bool read_part(rest *r, j2k_stream *s, j2k_part *out) {
    segment next;
    const unsigned char *from = r->at;
    if (r->end - from < SOT_BYTES + SOD_BYTES || !next_segment(r, &next) ||
        next.size < 8)
        return false;
    uint64_t size = whole(next.at + 2, 4);
    const rest all = {from, r->end};
    size = size ? size : bytes_left(&all);
    *out = (j2k_part){.tile = (uint32_t)whole(next.at, 2),
                      .number = next.at[6],
                      .parts = next.at[7]};
    if (out->tile >= s->tiles || size < SOT_BYTES + SOD_BYTES ||
        size > (uint64_t)(r->end - from))
        return false;
    rest part = {r->at, from + size};
    while (next_marker(&part) != 0xff93) {
        if (!next_segment(&part, &next) ||
            (next.marker == 0xff52 && next.size < 10)) /* GDCM reads on */
            return false;
        s->plain &= !is_rare(next.marker) && next.marker != 0xff52;
    }
    out->bytes = part.at + SOD_BYTES;
    out->size = (size_t)(part.end - out->bytes);
    r->at = part.end;
    return true;
}

static snow_status read_parts(snow_context *context, rest *r, j2k_stream *s,
                              bool *whole_stream) {
    *whole_stream = false;
    while (next_marker(r) == 0xff90) {
        j2k_part part;
        if (!read_part(r, s, &part))
            return SNOW_STATUS_OK;
        SNOW_TRY(SNOW_RESERVE(context, s->parts, s->count, s->count + 1));
        s->parts[s->count++] = part;
    }
    *whole_stream = s->count && next_marker(r) == 0xffd9;
    return SNOW_STATUS_OK;
}

static int compare_parts(const void *a, const void *b) {
    const j2k_part *x = a, *y = b;
    if (x->tile != y->tile)
        return x->tile < y->tile ? -1 : 1;
    return (x->bytes > y->bytes) - (x->bytes < y->bytes);
}

/* Counts the parts of a tile, which must have the numbers 0, 1, ...; 0: they
 * have others. */
static size_t count_parts(const j2k_stream *s, size_t first) {
    const j2k_part *part = s->parts + first;
    size_t count = 0, claimed = 0;
    for (; first + count < s->count && part[count].tile == part->tile;
         count++) {
        if (part[count].number != count)
            return 0;
        claimed = part[count].parts ? part[count].parts : claimed;
    }
    return !claimed || claimed == count ? count : 0;
}

static snow_status walk_tiles(snow_context *context, j2k_stream *s,
                              bool *whole_stream) {
    uint32_t tile = 0;
    qsort(s->parts, s->count, sizeof *s->parts, compare_parts);
    for (size_t i = 0; i < s->count && *whole_stream; tile++) {
        const size_t count = count_parts(s, i);
        *whole_stream = count && s->parts[i].tile == tile;
        if (*whole_stream && s->plain)
            SNOW_TRY(snow_dicom_walk_tile(context, s, i, count, whole_stream));
        i += count;
    }
    *whole_stream &= tile == s->tiles;
    return SNOW_STATUS_OK;
}

snow_status snow_dicom_walk_jpeg2000(snow_context *context,
                                     const unsigned char *bytes, size_t size,
                                     bool *whole_stream) {
    j2k_stream s = {.count = 0};
    rest r = {bytes, bytes + size};
    *whole_stream = false;
    if (size < 2 || !read_main(&r, &s))
        return SNOW_STATUS_OK;
    snow_status status = read_parts(context, &r, &s, whole_stream);
    if (status == SNOW_STATUS_OK && *whole_stream)
        status = walk_tiles(context, &s, whole_stream);
    snow_release(context, s.parts);
    return status;
}
