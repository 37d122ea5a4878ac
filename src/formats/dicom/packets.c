/* formats/dicom/packets.c - walks the packets of a JPEG 2000 code stream (ITU
 * T.800, annexes A and B) before GDCM decodes it.
 *
 *     main header   SIZ: image and tiles   COD: how all tiles are coded
 *     SOT ... SOD   part of a tile: packets
 *     ...
 *     EOC
 *
 * A packet has the bytes of one layer of the code blocks of a precinct, behind
 * a header of bits.  OpenJPEG takes zeros, and what is missing, for empty
 * packets, so that a part of the image is blurred or void, and says nothing of
 * it.  So each tile must be there, and its packets must fill its parts to the
 * last byte.
 *
 * Streams of rare kinds are only looked through part by part: those that change
 * the coding of a component or tile (COC, POC), or gather headers (PPM, PPT).
 */
#include "formats/dicom/packets.h"

#include "base/minmax.h"

#include <stdlib.h>
#include <string.h>

/* A node of a tag tree: the value is known, or at least `low`. */
typedef struct node {
    uint32_t value, low;
} tag_node;

typedef struct block {
    bool included;
    unsigned char length_bits;
    uint16_t passes;
} code_block;

/* The code blocks of a precinct in a band; rows of `wide`.  Their tag trees
 * follow one another. */
typedef struct band {
    size_t blocks, nodes, tree; /* first of each; nodes of a tree */
    int64_t wide, high;
} packet_band;

typedef struct precinct {
    uint64_t key[4]; /* of the order of packets */
    int level, bands;
    packet_band band[3];
} precinct;

typedef struct bits {
    const unsigned char *at, *end;
    unsigned byte;
    int held;
    bool past; /* bits were read beyond the end */
} packet_bits;

typedef struct tile {
    const j2k_stream *s;
    snow_context *context;
    const j2k_part *part, *last; /* the one that is read; behind the last */
    const unsigned char *at;     /* in it */
    uint64_t x0, y0, x1, y1;
    precinct *precincts;
    code_block *blocks;
    tag_node *nodes;
    size_t precinct_count, block_count, node_count;
} tile;

/* Precincts and code blocks of a tile beyond which it is not walked. */
#define MOST_BLOCKS ((size_t)1 << 20)

/* --- the precincts of a tile ---------------------------------------------- */

static uint64_t up(uint64_t value, int bits) {
    return (value >> bits) + ((value & (((uint64_t)1 << bits) - 1)) != 0);
}

/* Half of the whole, from bit `high` of it on: coordinates in a band. */
static uint64_t in_band(uint64_t value, int bits, bool high) {
    const uint64_t offset = high ? (uint64_t)1 << (bits - 1) : 0;
    return value > offset ? up(value - offset, bits) : 0;
}

static size_t count_nodes(int64_t wide, int64_t high) {
    size_t count = (size_t)(wide * high);
    while (wide > 1 || high > 1) {
        wide = (wide + 1) / 2;
        high = (high + 1) / 2;
        count += (size_t)(wide * high);
    }
    return count;
}

/* Counts the code blocks of 1 << bits between two coordinates. */
static int64_t count_blocks(uint64_t from, uint64_t end, int bits) {
    return end > from ? (int64_t)(up(end, bits) - (from >> bits)) : 0;
}

static snow_status add_blocks(tile *t, packet_band *band) {
    const size_t count = (size_t)(band->wide * band->high);
    if (count >= MOST_BLOCKS - t->block_count) {
        t->block_count = MOST_BLOCKS;
        return SNOW_STATUS_OK;
    }
    band->tree = count ? count_nodes(band->wide, band->high) : 0;
    band->blocks = t->block_count;
    band->nodes = t->node_count;
    SNOW_TRY(SNOW_RESERVE(t->context, t->blocks, t->block_count,
                          t->block_count + count));
    SNOW_TRY(SNOW_RESERVE(t->context, t->nodes, t->node_count,
                          t->node_count + 2 * band->tree));
    for (size_t i = 0; i < count; i++)
        t->blocks[t->block_count++] = (code_block){.length_bits = 3};
    for (size_t i = 0; i < 2 * band->tree; i++)
        t->nodes[t->node_count++] = (tag_node){.value = UINT32_MAX};
    return SNOW_STATUS_OK;
}

/* Makes a band's part of the precinct in column px and row py of its level. */
static snow_status add_band(tile *t, precinct *p, int number, uint64_t px,
                            uint64_t py) {
    const j2k_coding *c = &t->s->coding;
    const int level = p->level, shift = level ? 1 : 0;
    const int bits = c->levels - level + shift; /* of the whole image */
    const int wide = (c->precinct[level] & 15) - shift;
    const int high = (c->precinct[level] >> 4) - shift;
    const bool right = number & 1, low = number & 2;
    const uint64_t sides[4] = {
        in_band(t->x0, bits, right), in_band(t->x1, bits, right),
        in_band(t->y0, bits, low), in_band(t->y1, bits, low)};
    const uint64_t x0 = SNOW_MAX(px << wide, sides[0]);
    const uint64_t x1 = SNOW_MIN((px + 1) << wide, sides[1]);
    const uint64_t y0 = SNOW_MAX(py << high, sides[2]);
    const uint64_t y1 = SNOW_MIN((py + 1) << high, sides[3]);
    packet_band *band = &p->band[p->bands++];
    band->wide = count_blocks(x0, x1, c->wide < wide ? c->wide : wide);
    band->high = count_blocks(y0, y1, c->high < high ? c->high : high);
    if (!band->wide || !band->high)
        band->wide = band->high = 0;
    return add_blocks(t, band);
}

/* The order of packets, but for layers (B.12). */
static void set_key(const tile *t, precinct *p, uint64_t component, uint64_t px,
                    uint64_t py) {
    const j2k_coding *c = &t->s->coding;
    const int n = c->levels - p->level;
    uint64_t x = px << (c->precinct[p->level] & 15) << n;
    uint64_t y = py << (c->precinct[p->level] >> 4) << n;
    const uint64_t level = (uint64_t)p->level;
    x = x > t->x0 ? x : t->x0;
    y = y > t->y0 ? y : t->y0;
    const uint64_t keys[5][4] = {{level, component, y, x},
                                 {level, component, y, x},
                                 {level, y, x, component},
                                 {y, x, component, level},
                                 {component, y, x, level}};
    memcpy(p->key, keys[c->order], sizeof p->key);
}

static snow_status add_level(tile *t, uint64_t component, int level) {
    const j2k_coding *c = &t->s->coding;
    const int n = c->levels - level;
    const int wide = c->precinct[level] & 15, high = c->precinct[level] >> 4;
    const uint64_t x0 = up(t->x0, n), x1 = up(t->x1, n);
    const uint64_t y0 = up(t->y0, n), y1 = up(t->y1, n);
    for (uint64_t py = y0 >> high; y1 > y0 && py < up(y1, high); py++)
        for (uint64_t px = x0 >> wide; x1 > x0 && px < up(x1, wide); px++) {
            precinct p = {.level = level};
            if (t->precinct_count >= MOST_BLOCKS ||
                t->block_count >= MOST_BLOCKS)
                return SNOW_STATUS_OK;
            set_key(t, &p, component, px, py);
            for (int band = level ? 1 : 0; band < (level ? 4 : 1); band++)
                SNOW_TRY(add_band(t, &p, band, px, py));
            SNOW_TRY(SNOW_RESERVE(t->context, t->precincts, t->precinct_count,
                                  t->precinct_count + 1));
            t->precincts[t->precinct_count++] = p;
        }
    return SNOW_STATUS_OK;
}

static int compare_precincts(const void *a, const void *b) {
    const precinct *x = a, *y = b;
    for (int i = 0; i < 4; i++)
        if (x->key[i] != y->key[i])
            return x->key[i] < y->key[i] ? -1 : 1;
    return 0;
}

/* --- a packet ------------------------------------------------------------- */

static unsigned next_bit(packet_bits *b) {
    if (!b->held) {
        b->past |= b->at == b->end;
        if (b->past)
            return 0;
        b->held = b->byte == 0xff ? 7 : 8;
        b->byte = *b->at++;
    }
    return b->byte >> --b->held & 1;
}

static uint64_t next_bits(packet_bits *b, int count) {
    uint64_t value = 0;
    while (count-- > 0)
        value = value << 1 | next_bit(b);
    return value;
}

/* Returns whether a leaf's value is below a limit (B.10.2). */
static bool is_below(packet_bits *b, tag_node *nodes, const packet_band *band,
                     int64_t x, int64_t y, uint32_t limit) {
    size_t first[32] = {0};
    int64_t wide[32] = {band->wide}, high = band->high;
    int top = 0;
    for (; wide[top] > 1 || high > 1; top++, high = (high + 1) / 2) {
        first[top + 1] = first[top] + (size_t)(wide[top] * high);
        wide[top + 1] = (wide[top] + 1) / 2;
    }
    uint32_t low = 0;
    for (; top >= 0; top--) {
        tag_node *n =
            nodes + first[top] + (size_t)((y >> top) * wide[top] + (x >> top));
        low = low > n->low ? low : n->low;
        while (low < limit && low < n->value)
            if (next_bit(b))
                n->value = low;
            else
                low++;
        n->low = low;
    }
    return nodes[y * band->wide + x].value < limit;
}

static int next_passes(packet_bits *b) {
    if (!next_bit(b))
        return 1;
    if (!next_bit(b))
        return 2;
    int more = (int)next_bits(b, 2);
    if (more < 3)
        return 3 + more;
    more = (int)next_bits(b, 5);
    return more < 31 ? 6 + more : 37 + (int)next_bits(b, 7);
}

/* Passes up to the end of a segment that has bytes of its own (D.4.2, D.6). */
static int passes_left(int style, int done) {
    if (style & J2K_EACH_PASS)
        return 1;
    if (!(style & J2K_BYPASS))
        return INT16_MAX;
    return done < 10 ? 10 - done : (done - 10) % 3 == 0 ? 2 : 1;
}

/* Reads what the header says of a block that is included: returns the bytes of
 * its passes. */
static uint64_t block_bytes(packet_bits *b, code_block *block, int style) {
    uint64_t bytes = 0;
    int passes = next_passes(b);
    while (next_bit(b) && block->length_bits < 32)
        block->length_bits++;
    while (passes > 0) {
        int count = passes_left(style, block->passes), bits = 0;
        count = count < passes ? count : passes;
        while (count >> (bits + 1))
            bits++;
        bytes += next_bits(b, block->length_bits + bits);
        passes -= count;
        block->passes = (uint16_t)(block->passes + count);
    }
    return bytes;
}

/* Reads the blocks of a band; adds their bytes. */
static bool read_band(tile *t, packet_bits *b, const packet_band *band,
                      uint32_t layer, uint64_t *bytes) {
    tag_node *inclusion = t->nodes + band->nodes;
    tag_node *zeros = inclusion + band->tree;
    for (int64_t i = 0; i < band->wide * band->high && !b->past; i++) {
        const int64_t x = i % band->wide, y = i / band->wide;
        code_block *block = &t->blocks[band->blocks + (size_t)i];
        const bool first = !block->included;
        if (!(first ? is_below(b, inclusion, band, x, y, layer + 1)
                    : next_bit(b)))
            continue;
        block->included = true;
        for (uint32_t planes = 1;
             first && !is_below(b, zeros, band, x, y, planes); planes++)
            if (planes > 74 || b->past)
                return false;
        *bytes += block_bytes(b, block, t->s->coding.style);
    }
    return !b->past;
}

static bool skip_marker(packet_bits *b, unsigned second, size_t size) {
    if ((size_t)(b->end - b->at) < size || b->at[0] != 0xff ||
        b->at[1] != second)
        return false;
    b->at += size;
    return true;
}

/* Returns whether bytes can be those of code blocks, in which 0xff stands
 * before a bit that is 0 (C.2.3, D.6). */
static bool are_codes(const unsigned char *at, uint64_t count) {
    for (uint64_t i = 1; i < count; i++)
        if (at[i - 1] == 0xff && at[i] > 0x8f)
            return false;
    return true;
}

static bool walk_packet(tile *t, const precinct *p, uint32_t layer) {
    while (t->at == t->part->bytes + t->part->size) {
        if (++t->part == t->last)
            return false;
        t->at = t->part->bytes;
    }
    packet_bits b = {.at = t->at, .end = t->part->bytes + t->part->size};
    uint64_t bytes = 0;
    if (t->s->coding.flags & J2K_SOP)
        skip_marker(&b, 0x91, 6);
    if (next_bit(&b))
        for (int i = 0; i < p->bands; i++)
            if (!read_band(t, &b, &p->band[i], layer, &bytes))
                return false;
    if (b.byte == 0xff) { /* a bit of the next byte is none */
        if (b.at == b.end)
            return false;
        b.at++;
    }
    if (t->s->coding.flags & J2K_EPH)
        skip_marker(&b, 0x92, 2);
    if (b.past || bytes > (uint64_t)(b.end - b.at))
        return false;
    t->at = b.at + bytes;
    return are_codes(b.at, bytes);
}

/* --- a tile --------------------------------------------------------------- */

/* Layers are the outermost of the order, those of a level, or innermost. */
static bool walk_packets(tile *t) {
    const int order = t->s->coding.order;
    const precinct *p = t->precincts;
    for (size_t i = 0, end; i < t->precinct_count; i = end) {
        end = order ? i + 1 : t->precinct_count;
        while (order == 1 && end < t->precinct_count &&
               p[end].level == p[i].level)
            end++;
        for (uint32_t layer = 0; layer < t->s->coding.layers; layer++)
            for (size_t k = i; k < end; k++)
                if (!walk_packet(t, &p[k], layer))
                    return false;
    }
    while (t->at == t->part->bytes + t->part->size && ++t->part < t->last)
        t->at = t->part->bytes;
    return t->part == t->last;
}

static snow_status walk_tile(tile *t, bool *whole) {
    const j2k_stream *s = t->s;
    for (uint32_t c = 0; c < s->components; c++)
        for (int level = 0; level <= s->coding.levels; level++)
            SNOW_TRY(add_level(t, c, level));
    if (t->precinct_count >= MOST_BLOCKS || t->block_count >= MOST_BLOCKS)
        return SNOW_STATUS_OK;
    if (t->precinct_count)
        qsort(t->precincts, t->precinct_count, sizeof *t->precincts,
              compare_precincts);
    *whole = walk_packets(t);
    return SNOW_STATUS_OK;
}

snow_status snow_dicom_walk_tile(snow_context *context, const j2k_stream *s,
                                 size_t first, size_t count, bool *whole) {
    const j2k_part *part = s->parts + first;
    const uint64_t across =
        (s->x1 - s->tile_x0 + s->tile_wide - 1) / s->tile_wide;
    const uint64_t x = s->tile_x0 + part->tile % across * s->tile_wide;
    const uint64_t y = s->tile_y0 + part->tile / across * s->tile_high;
    tile t = {.s = s,
              .context = context,
              .part = part,
              .last = part + count,
              .at = part->bytes,
              .x0 = x > s->x0 ? x : s->x0,
              .y0 = y > s->y0 ? y : s->y0};
    t.x1 = x + s->tile_wide < s->x1 ? x + s->tile_wide : s->x1;
    t.y1 = y + s->tile_high < s->y1 ? y + s->tile_high : s->y1;
    *whole = true;
    snow_status status = walk_tile(&t, whole);
    snow_release(context, t.precincts);
    snow_release(context, t.blocks);
    snow_release(context, t.nodes);
    return status;
}
