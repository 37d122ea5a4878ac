/* formats/dicom/entropy.c - walks the Huffman codes of a JPEG stream (ITU
 * T.81, annexes B, F and H) before GDCM decodes it.
 *
 * GDCM's libjpeg invents what is missing or has no code, and GDCM says nothing
 * of it.  So every code is looked up here, without its value: a stream is whole
 * if each scan has all its units, and a marker follows the last of them.
 * Sequential frames have units of 8 x 8 values, lossless ones of a single
 * value; DICOM has no others. */
#include "formats/dicom/dicom.h"

#include <string.h>

#define MOST_COMPONENTS 4
#define LONGEST_CODE 16
#define QUICK_BITS 8

/* Codes of one length are numbers in a row, after those of shorter ones. */
typedef struct huffman {
    uint32_t end[LONGEST_CODE + 1]; /* the first number that is no code */
    int offset[LONGEST_CODE + 1];   /* of a code's value from its number */
    unsigned char values[256];
    /* By the next bits: length << 8 and value of a short code, else 0. */
    uint16_t quick[1 << QUICK_BITS];
} huffman;

typedef struct component {
    int id, across, down; /* units of one that is interleaved */
    const huffman *dc, *ac;
} component;

typedef struct stream {
    const unsigned char *at, *end;
    uint64_t bits; /* `held` of them, the last ones */
    int held;
    huffman tables[2][4]; /* of DC and AC */
    bool lossless;
    uint32_t columns, rows, restart; /* units between two restarts, or 0 */
    component components[MOST_COMPONENTS];
    int count, across, down; /* components; the most units of one */
    unsigned seen;           /* components that scans had */
} stream;

static uint32_t pair(const unsigned char *at) {
    return (uint32_t)at[0] << 8 | at[1];
}

/* --- bits ----------------------------------------------------------------- */

/* Takes in bytes up to a marker; a 0 after 0xff is none of the data. */
static void fill(stream *s) {
    while (s->held <= 48 && s->at < s->end) {
        const bool stuffed = *s->at == 0xff;
        if (stuffed && (s->end - s->at < 2 || s->at[1] != 0))
            return;
        s->bits = s->bits << 8 | *s->at;
        s->at += stuffed ? 2 : 1;
        s->held += 8;
    }
}

static bool skip_bits(stream *s, int count) {
    if (s->held < count)
        fill(s);
    s->held -= count;
    return s->held >= 0;
}

/* Returns the value of the next code, -1 if there is none. */
static int next_code(stream *s, const huffman *table) {
    if (s->held < LONGEST_CODE)
        fill(s);
    uint32_t next = (uint32_t)(s->held < LONGEST_CODE
                                   ? s->bits << (LONGEST_CODE - s->held)
                                   : s->bits >> (s->held - LONGEST_CODE)) &
                    0xffff;
    const uint16_t quick = table->quick[next >> (LONGEST_CODE - QUICK_BITS)];
    if (quick)
        return skip_bits(s, quick >> 8) ? quick & 0xff : -1;
    for (int length = 1; length <= LONGEST_CODE; length++) {
        uint32_t number = next >> (LONGEST_CODE - length);
        if (number < table->end[length])
            return skip_bits(s, length)
                       ? table->values[(int)number + table->offset[length]]
                       : -1;
    }
    return -1;
}

/* --- units ---------------------------------------------------------------- */

/* A difference has as many bits as its code says, but 32768 has none. */
static bool walk_difference(stream *s, const huffman *table) {
    int bits = next_code(s, table);
    return bits >= 0 && bits <= 16 && skip_bits(s, bits == 16 ? 0 : bits);
}

/* Zeros and a value, sixteen zeros, or the end of the unit, up to 63 values. */
static bool walk_block(stream *s, const component *c) {
    if (!walk_difference(s, c->dc))
        return false;
    for (int k = 1; k < 64; k++) {
        int code = next_code(s, c->ac);
        if (code == 0)
            return true;
        if (code < 0 || (code % 16 == 0 && code != 0xf0))
            return false;
        k += code / 16;
        if (k > 63 || !skip_bits(s, code % 16))
            return false;
    }
    return true;
}

/* Returns the marker behind the last unit, whose byte may end with padding; 0
 * if there are other bytes. */
static int end_units(stream *s) {
    fill(s);
    if (s->held >= 8)
        return 0;
    s->held = 0;
    while (s->end - s->at >= 2 && s->at[0] == 0xff && s->at[1] == 0xff)
        s->at++;
    return s->end - s->at >= 2 && s->at[0] == 0xff ? s->at[1] : 0;
}

static uint64_t divide(uint64_t a, uint64_t b) {
    return (a + b - 1) / b;
}

/* A scan of one component has the units that its values fill; in one of several
 * they alternate. */
static uint64_t count_units(const stream *s, const component *only) {
    const uint64_t side = s->lossless ? 1 : 8;
    const uint64_t across = (uint64_t)s->across, down = (uint64_t)s->down;
    if (!only)
        return divide(s->columns, side * across) * divide(s->rows, side * down);
    return divide(divide(s->columns * (uint64_t)only->across, across), side) *
           divide(divide(s->rows * (uint64_t)only->down, down), side);
}

static bool walk_units(stream *s, component *const *scan, int count) {
    const bool single = count == 1;
    const uint64_t units = count_units(s, single ? scan[0] : NULL);
    s->held = 0;
    for (uint64_t n = 0; n < units; n++) {
        if (s->restart && n && n % s->restart == 0) {
            if (end_units(s) != 0xd0 + (int)((n / s->restart - 1) % 8))
                return false;
            s->at += 2;
        }
        for (int i = 0; i < count; i++) {
            const component *c = scan[i];
            for (int left = single ? 1 : c->across * c->down; left > 0; left--)
                if (!(s->lossless ? walk_difference(s, c->dc)
                                  : walk_block(s, c)))
                    return false;
        }
    }
    return end_units(s) != 0;
}

/* --- segments ------------------------------------------------------------- */

static bool make_table(huffman *table, const unsigned char *counts, int total) {
    uint32_t number = 0;
    int index = 0;
    memset(table->quick, 0, sizeof table->quick);
    for (int length = 1; length <= LONGEST_CODE; length++) {
        table->offset[length] = index - (int)number;
        for (int i = 0; i < counts[length - 1]; i++, index++, number++) {
            const int low = QUICK_BITS - length;
            if (number >> length)
                return false;
            for (uint32_t k = 0; low >= 0 && k < 1u << low; k++)
                table->quick[(number << low) + k] =
                    (uint16_t)(length << 8 | table->values[index]);
        }
        table->end[length] = number;
        number *= 2;
    }
    return index == total;
}

/* Tables follow one another: class and number, counts of the lengths, values.
 */
static bool take_tables(stream *s, const unsigned char *at, size_t size) {
    while (size >= 17) {
        int kind = at[0] >> 4, total = 0;
        for (int i = 1; i <= LONGEST_CODE; i++)
            total += at[i];
        if (kind > 1 || (at[0] & 15) > 3 || total > 256 ||
            (size_t)total > size - 17)
            return false;
        huffman *table = &s->tables[kind][at[0] & 3];
        memcpy(table->values, at + 17, (size_t)total);
        if (!make_table(table, at + 1, total))
            return false;
        at += 17 + total;
        size -= 17 + (size_t)total;
    }
    return size == 0;
}

static bool take_frame(stream *s, int marker, const unsigned char *at,
                       size_t size) {
    if (size < 6 || s->count || at[5] < 1 || at[5] > MOST_COMPONENTS ||
        size < 6 + 3 * (size_t)at[5])
        return false;
    s->lossless = marker == 0xc3;
    s->rows = pair(at + 1);
    s->columns = pair(at + 3);
    s->count = at[5];
    for (int i = 0; i < s->count; i++) {
        const unsigned char *of = at + 6 + 3 * i;
        component c = {.id = of[0], .across = of[1] >> 4, .down = of[1] & 15};
        if (c.across < 1 || c.across > 4 || c.down < 1 || c.down > 4)
            return false;
        s->across = c.across > s->across ? c.across : s->across;
        s->down = c.down > s->down ? c.down : s->down;
        s->components[i] = c;
    }
    return true;
}

/* Walks a scan, whose units follow its header. */
static bool take_scan(stream *s, const unsigned char *at, size_t size) {
    component *scan[MOST_COMPONENTS];
    const int count = size ? at[0] : 0;
    if (count < 1 || count > s->count || size < 4 + 2 * (size_t)count)
        return false;
    for (int i = 0; i < count; i++) {
        const unsigned char *of = at + 1 + 2 * i;
        int n = 0;
        while (n < s->count && s->components[n].id != of[0])
            n++;
        if (n == s->count || s->seen >> n & 1)
            return false;
        s->seen |= 1u << n;
        scan[i] = &s->components[n];
        scan[i]->dc = &s->tables[0][of[1] >> 4 & 3];
        scan[i]->ac = &s->tables[1][of[1] & 3];
    }
    return walk_units(s, scan, count);
}

static bool take_segment(stream *s, int marker, const unsigned char *at,
                         size_t size) {
    switch (marker) {
    case 0xc0: /* baseline */
    case 0xc1: /* extended sequential */
    case 0xc3: /* lossless */
        return take_frame(s, marker, at, size);
    case 0xc4:
        return take_tables(s, at, size);
    case 0xda:
        return take_scan(s, at, size);
    case 0xdd:
        s->restart = size >= 2 ? pair(at) : 0;
        return size >= 2;
    default: /* other frames, and markers that belong elsewhere */
        return marker >= 0xdb && marker != 0xff;
    }
}

static bool walk_segments(stream *s) {
    for (;;) {
        const int marker = end_units(s);
        if (marker == 0xd9)
            return s->count && s->seen + 1 == 1u << s->count;
        if (!marker || s->end - s->at < 4)
            return false;
        const size_t length = pair(s->at + 2);
        const unsigned char *segment = s->at + 4;
        if (length < 2 || length > (size_t)(s->end - s->at) - 2)
            return false;
        s->at += 2 + length;
        if (!take_segment(s, marker, segment, length - 2))
            return false;
    }
}

/* A byte with its high bit set makes 0xff before it a marker, in JPEG-LS (T.87,
 * A.1) as in segments between scans. */
bool snow_dicom_jpeg_ls_has_end(const unsigned char *bytes, size_t size) {
    size_t at = 2;
    while (at + 2 <= size) {
        const int marker = bytes[at + 1];
        if (bytes[at] != 0xff || marker < 0x80 || marker == 0xff)
            at++;
        else if (marker == 0xd9)
            return true;
        else if (marker >= 0xd0 && marker <= 0xd7)
            at += 2;
        else
            at += at + 4 <= size ? 2 + pair(bytes + at + 2) : 2;
    }
    return false;
}

bool snow_dicom_jpeg_is_whole(const unsigned char *bytes, size_t size) {
    stream s = {.at = bytes + 2, .end = bytes + size};
    return size >= 2 && walk_segments(&s);
}
