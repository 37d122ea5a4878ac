/* hdf5.c - the object headers of an HDF5 file, and so of NetCDF-4 (HDF5 File
 * Format Specification 3.0, IV.A): messages, shapes, types, filters,
 * attributes.
 *
 * Objects are found by the signatures of their headers, or of the nodes that
 * list them, and not by following links, whose names are not written anyway. */
#include "report/report.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define REACH ((uint64_t)1 << 30) /* bytes that are looked through */
#define STEP ((size_t)4 << 20)
#define OBJECTS 200     /* that are written */
#define BLOCK (1 << 16) /* the longest part of a header */
#define PARTS 64        /* of a header */

typedef struct file5 {
    FILE *out;
    const source *from;
    uint64_t base;
    int offset, length; /* bytes of offsets and lengths */
    uint64_t objects;
} file5;

/* The messages of a part of a header. */
typedef struct part {
    const unsigned char *bytes;
    size_t size;
    int head; /* bytes before a message's data: 8, or 4 or 6 */
} part;

/* Continuations that are still to be read. */
typedef struct parts {
    uint64_t at[PARTS], size[PARTS];
    int count;
} parts;

static void put_shape(const file5 *f, const unsigned char *b, size_t size) {
    size_t at = size && b[0] == 1 ? 8 : 4;
    int rank = size > 1 ? b[1] : 0;
    fprintf(f->out, rank ? " shape" : " scalar");
    for (int i = 0; i < rank && at + (size_t)f->length <= size; i++) {
        fprintf(f->out, " %" PRIu64, whole_at(b + at, f->length, false));
        at += (size_t)f->length;
    }
}

static void put_type(const file5 *f, const unsigned char *b, size_t size) {
    static const char *const classes[] = {
        "integer",  "float",     "time", "string", "bits", "opaque",
        "compound", "reference", "enum", "list",   "array"};
    if (size < 8)
        return;
    unsigned class = b[0] & 15;
    fprintf(f->out, " %s of %" PRIu64 " bytes%s",
            class < sizeof classes / sizeof *classes ? classes[class] : "type",
            whole_at(b + 4, 4, false),
            class < 2 && (b[1] & 1) ? ", big endian" : "");
}

static void put_layout(const file5 *f, const unsigned char *b, size_t size) {
    static const char *const classes[] = {"compact", "contiguous", "chunked",
                                          "virtual"};
    if (size < 2 || b[0] < 3 || b[1] > 3)
        return;
    fprintf(f->out, " layout %s", classes[b[1]]);
    if (b[1] != 2 || size < 5)
        return;
    const bool new = b[0] > 3;
    int rank = new ? b[3] : b[2], width = new ? b[4] : 4;
    size_t at = new ? 5 : 3 + (size_t)f->offset;
    for (int i = 0; i < rank && width <= 8 && at + (size_t)width <= size; i++) {
        fprintf(f->out, " %" PRIu64, whole_at(b + at, width, false));
        at += (size_t)width;
    }
}

static void put_filters(const file5 *f, const unsigned char *b, size_t size) {
    const bool old = size && b[0] == 1;
    size_t at = old ? 8 : 2;
    fprintf(f->out, " filters");
    for (int i = 0; i < (size > 1 ? b[1] : 0) && at + 8 <= size; i++) {
        uint64_t id = whole_at(b + at, 2, false), name = 0, values;
        const bool named = old || id > 255;
        if (named)
            name = whole_at(b + at + 2, 2, false);
        values = whole_at(b + at + (named ? 6 : 4), 2, false);
        if (old)
            name += (8 - name % 8) % 8;
        at += (named ? 8 : 6) + (size_t)name + 4 * (size_t)values;
        at += old && values % 2 ? 4 : 0;
        fprintf(f->out, " %" PRIu64, id);
    }
}

/* The numbers of a technical attribute: whole or floats. */
static void put_number(const file5 *f, const unsigned char *type,
                       const unsigned char *b, size_t left) {
    unsigned class = type[0] & 15;
    uint64_t size = whole_at(type + 4, 4, false);
    bool big = type[1] & 1;
    if (class > 1 || size > 8 || size > left || size == 0 ||
        (class == 1 && size < 4))
        return;
    if (class == 1)
        fprintf(f->out, " = %.9g", real_at(b, (int)size, big));
    else
        fprintf(f->out, " = %" PRIu64, whole_at(b, (int)size, big));
}

static size_t padded(uint64_t size, bool pads) {
    return (size_t)(size + (pads ? (8 - size % 8) % 8 : 0));
}

static void put_attribute(const file5 *f, const unsigned char *b, size_t size) {
    if (size < 9)
        return;
    const bool pads = b[0] == 1;
    uint64_t name = whole_at(b + 2, 2, false), type = whole_at(b + 4, 2, false),
             space = whole_at(b + 6, 2, false);
    size_t at = b[0] == 3 ? 9 : 8, end;
    end = at + padded(name, pads) + padded(type, pads) + padded(space, pads);
    if (end > size || name == 0)
        return;
    putc(' ', f->out);
    put_name(f->out, (const char *)b + at,
             strnlen((const char *)b + at, (size_t)name));
    const bool known = has_technical_number(
        (const char *)b + at, strnlen((const char *)b + at, (size_t)name));
    const unsigned char *kind = b + at + padded(name, pads);
    put_type(f, kind, (size_t)type);
    put_shape(f, kind + padded(type, pads), (size_t)space);
    if (known && type >= 8 && !(b[0] > 1 && b[1]))
        put_number(f, kind, b + end, size - end);
}

static void put_header_message(const file5 *f, unsigned type,
                               const unsigned char *b, size_t size,
                               bool shared) {
    static const char *const names[] = {
        "",       "shape",      "link info", "type",    "fill",
        "fill",   "link",       "files",     "layout",  "",
        "group",  "filters",    "attribute", "comment", "time",
        "shared", "more",       "symbols",   "time",    "tree",
        "driver", "attributes", "references"};
    fprintf(f->out, "  %u %s, %zu bytes:", type,
            type < sizeof names / sizeof *names ? names[type] : "", size);
    if (shared)
        fprintf(f->out, " shared");
    else if (type == 1)
        put_shape(f, b, size);
    else if (type == 3)
        put_type(f, b, size);
    else if (type == 8)
        put_layout(f, b, size);
    else if (type == 11)
        put_filters(f, b, size);
    else if (type == 12)
        put_attribute(f, b, size);
    putc('\n', f->out);
}

/* Empty messages, which fill gaps, are left out. */
static void put_part(const file5 *f, part p, parts *more) {
    for (size_t at = 0; at + (size_t)p.head <= p.size;) {
        const unsigned char *b = p.bytes + at;
        const bool old = p.head == 8;
        unsigned type = old ? (unsigned)whole_at(b, 2, false) : b[0];
        size_t size = (size_t)whole_at(b + (old ? 2 : 1), 2, false);
        unsigned flags = b[old ? 4 : 3];
        at += (size_t)p.head;
        if (size > p.size - at)
            return;
        if (type)
            put_header_message(f, type, p.bytes + at, size, flags & 2);
        if (type == 16 && size >= (size_t)(f->offset + f->length) &&
            more->count < PARTS) {
            more->at[more->count] = whole_at(p.bytes + at, f->offset, false);
            more->size[more->count++] =
                whole_at(p.bytes + at + f->offset, f->length, false);
        }
        at += size;
    }
}

/* Version 1 has no signature; version 2 has one, and a check sum behind. */
static void put_object(file5 *f, uint64_t at, unsigned char *bytes) {
    parts more = {.count = 0};
    size_t there = source_read(f->from, at, bytes, BLOCK), start = 16, size;
    if (there < 24)
        return;
    const bool new = memcmp(bytes, "OHDR", 4) == 0;
    part p = {.head = 8};
    if (!new && (bytes[0] != 1 || bytes[1] != 0))
        return;
    size = (size_t)whole_at(bytes + 8, 4, false);
    if (new) {
        unsigned flags = bytes[5];
        int width = 1 << (flags & 3);
        start = 6 + (size_t)(flags & 32 ? 16 : 0) + (flags & 16 ? 4 : 0);
        size = (size_t)whole_at(bytes + start, width, false);
        start += (size_t)width;
        p.head = flags & 4 ? 6 : 4;
    }
    if (f->objects++ >= OBJECTS || start > there)
        return;
    fprintf(f->out, "object %" PRIu64 "\n", f->objects - 1);
    p.bytes = bytes + start;
    p.size = size < there - start ? size : there - start;
    put_part(f, p, &more);
    for (int i = 0; i < more.count; i++) {
        size_t wanted = more.size[i] < BLOCK ? (size_t)more.size[i] : BLOCK;
        p.size = source_read(f->from, f->base + more.at[i], bytes, wanted);
        p.bytes = bytes;
        if (new && (p.size < 8 || memcmp(bytes, "OCHK", 4) != 0))
            continue;
        p.bytes += new ? 4 : 0;
        p.size -= new ? 8 : 0;
        put_part(f, p, &more);
    }
}

/* The objects of a node of an old group. */
static void put_node(file5 *f, uint64_t at, unsigned char *bytes) {
    unsigned char node[8 + 64 * 40];
    const size_t row = 2 * (size_t)f->offset + 24;
    size_t there = source_read(f->from, at, node, sizeof node);
    uint64_t count = there < 8 ? 0 : whole_at(node + 6, 2, false);
    for (uint64_t i = 0; i < count && 8 + (i + 1) * row <= there; i++)
        put_object(f,
                   f->base + whole_at(node + 8 + i * row + f->offset, f->offset,
                                      false),
                   bytes);
}

static void scan(file5 *f, unsigned char *bytes, unsigned char *step) {
    for (uint64_t at = 0; at < f->from->size && at < REACH;) {
        size_t there = source_read(f->from, at, step, STEP);
        for (size_t i = 0; i + 8 < there; i++) {
            if (memcmp(step + i, "OHDR\2", 5) == 0)
                put_object(f, at + i, bytes);
            else if (memcmp(step + i, "SNOD\1", 6) == 0)
                put_node(f, at + i, bytes);
        }
        if (there < STEP)
            break;
        at += there - 8;
    }
}

bool report_hdf5(FILE *out, const source *from) {
    static const unsigned char mark[] = {0x89, 'H',  'D', 'F',
                                         '\r', '\n', 26,  '\n'};
    unsigned char head[96] = {0};
    file5 f = {.out = out, .from = from};
    for (;; f.base = f.base ? 2 * f.base : 512) {
        if (f.base > REACH || source_read(from, f.base, head, sizeof head) < 48)
            return false;
        if (memcmp(head, mark, sizeof mark) == 0)
            break;
    }
    const bool old = head[8] < 2;
    f.offset = head[old ? 13 : 9];
    f.length = head[old ? 14 : 10];
    fprintf(out, "HDF5, superblock %u at %" PRIu64 ", offsets of %d bytes\n",
            head[8], f.base, f.offset);
    if (f.offset < 1 || f.offset > 8 || f.length < 1 || f.length > 8)
        return true;
    unsigned char *bytes = malloc(BLOCK), *step = malloc(STEP);
    if (bytes && step) {
        if (old)
            put_object(
                &f,
                f.base + whole_at(head + 24 + (head[8] ? 4 : 0) + 5 * f.offset,
                                  f.offset, false),
                bytes);
        scan(&f, bytes, step);
    }
    free(bytes);
    free(step);
    fprintf(out, "%" PRIu64 " objects in the first %" PRIu64 " bytes\n",
            f.objects, from->size < REACH ? from->size : REACH);
    return true;
}
