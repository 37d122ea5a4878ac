/* formats/hdf5/text.c - texts of attributes.
 *
 * libhdf5 reads those of fixed length.  Those of variable length, which h5py
 * writes, are in the file's global heap, and libhdf5 1.10 crashes if that is
 * damaged, as fuzzing shows at once; so they are read here, with every step
 * checked.  After "HDF5 File Format Specification Version 3.0":
 *
 *     object header      messages, of which attributes are one kind; more of
 *                        them in continuation blocks
 *     attribute          name, datatype, dataspace, references to the heap
 *     reference          length, address of a collection, index of an object
 *     global heap        collection "GCOL": index, size and bytes of objects
 *
 * Attributes beyond eight may be in dense storage, the blocks of a fractal
 * heap:
 *
 *     attribute info     address of the heap
 *     FRHP               sizes of blocks; the root, which is a block or
 *     FHIB               addresses of blocks, which hold attribute messages */
#include "formats/bytes/number.h"
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include <string.h>

/* Bytes of an attribute of texts, and blocks of messages. */
#define MOST_MESSAGE 4096
#define MOST_BLOCKS 64

/* Objects of a heap's collection that are passed. */
#define MOST_OBJECTS 65536

/* Bytes of dense storage that are searched. */
#define MOST_DENSE ((uint64_t)128 << 10)

enum {
    MESSAGE_ATTRIBUTE = 0x0c,
    MESSAGE_CONTINUATION = 0x10,
    MESSAGE_INFO = 0x15
};

/* A run of messages. */
typedef struct block {
    uint64_t at, end;
} block;

typedef struct search {
    snow_seekable *bytes;
    uint64_t base; /* of all addresses: the user block */
    const char *name;
    size_t index; /* of the text in an array */
    bool version2,
        ordered; /* of the object header; its messages are numbered */
    block blocks[MOST_BLOCKS];
    size_t count;
    uint64_t heap; /* of attributes in dense storage; 0: none */
    unsigned char message[MOST_MESSAGE];
    char *out;
    size_t room;
} search;

static uint64_t number(const unsigned char *bytes, int size) {
    return snow_number_at(bytes, size, false);
}

static bool copy_bytes(const search *s, uint64_t at, void *out, size_t size) {
    return snow_seekable_read(s->bytes, at, out, size) == size;
}

static void add_block(search *s, uint64_t at, uint64_t size) {
    uint64_t end;
    if (s->count < MOST_BLOCKS && snow_add_u64(at, size, &end) &&
        end <= snow_seekable_size(s->bytes))
        s->blocks[s->count++] = (block){at, end};
}

/* The first block of messages, of either version of object headers. */
static bool open_header(search *s, uint64_t at) {
    unsigned char head[32];
    if (!copy_bytes(s, at, head, 16))
        return false;
    if (memcmp(head, "OHDR", 4) != 0) {
        if (head[0] == 1)
            add_block(s, at + 16, number(head + 8, 4));
        return s->count == 1;
    }
    const unsigned flags = head[5];
    const int wide = 1 << (flags & 3);
    uint64_t size_at =
        at + 6 + (flags & 0x20 ? 16 : 0) + (flags & 0x10 ? 4 : 0);
    s->version2 = true;
    s->ordered = flags & 4;
    if (!copy_bytes(s, size_at, head, (size_t)wide))
        return false;
    add_block(s, size_at + (uint64_t)wide, number(head, wide));
    return s->count == 1;
}

/* The text of a reference to the global heap. */
static bool read_object(const search *s, const unsigned char *reference) {
    const uint64_t length = number(reference, 4);
    const uint64_t index = number(reference + 12, 4);
    unsigned char head[16];
    uint64_t at, end;
    if (!snow_add_u64(s->base, number(reference + 4, 8), &at) ||
        !copy_bytes(s, at, head, 16) || memcmp(head, "GCOL", 4) != 0 ||
        !snow_add_u64(at, number(head + 8, 8), &end))
        return false;
    at += 16;
    for (int i = 0; i < MOST_OBJECTS && at < end && copy_bytes(s, at, head, 16);
         i++) {
        const uint64_t size = number(head + 8, 8);
        at += 16;
        if (number(head, 2) == index && index) {
            size_t bytes = length < s->room ? (size_t)length : s->room - 1;
            if (length > size || !copy_bytes(s, at, s->out, bytes))
                return false;
            s->out[bytes] = 0;
            return true;
        }
        if (size > end - at || !number(head, 2)) /* 0: the free space */
            return false;
        at += (size + 7) / 8 * 8;
    }
    return false;
}

/* Bytes of a part of an attribute, which version 1 fills up to eight. */
static size_t padded(const unsigned char *message, size_t bytes) {
    return message[0] == 1 ? (bytes + 7) / 8 * 8 : bytes;
}

/* The text of an attribute message, if that has the name. */
static bool read_attribute(const search *s, size_t size) {
    const unsigned char *m = s->message;
    const size_t head = m[0] == 3 ? 9 : 8, wanted = strlen(s->name) + 1;
    if (size < head || m[0] < 1 || m[0] > 3 || (m[0] > 1 && m[1]))
        return false;
    size_t name = (size_t)number(m + 2, 2), type = (size_t)number(m + 4, 2);
    size_t space = (size_t)number(m + 6, 2);
    size_t type_at = head + padded(m, name);
    size_t at = type_at + padded(m, type) + padded(m, space) + 16 * s->index;
    if (name != wanted || head + name > size ||
        memcmp(m + head, s->name, wanted) != 0 || at + 16 > size)
        return false;
    /* text of variable length, class 9 of type 1 */
    const unsigned char *t = m + type_at;
    return type >= 8 && (t[0] & 15) == 9 && (t[1] & 15) == 1 &&
           number(t + 4, 4) == 16 && read_object(s, m + at);
}

/* Reads the message whose head is at `*at`, and passes it. */
static bool read_message(search *s, uint64_t *at) {
    unsigned char head[8];
    const size_t bytes = s->version2 ? (s->ordered ? 6 : 4) : 8;
    if (!copy_bytes(s, *at, head, bytes)) {
        *at = UINT64_MAX / 2; /* the block ends here */
        return false;
    }
    const uint64_t kind = number(head, s->version2 ? 1 : 2);
    const size_t size = (size_t)number(head + (s->version2 ? 1 : 2), 2);
    const uint64_t data = *at + bytes;
    *at = data + size;
    if ((kind != MESSAGE_ATTRIBUTE && kind != MESSAGE_CONTINUATION &&
         kind != MESSAGE_INFO) ||
        size > MOST_MESSAGE || !copy_bytes(s, data, s->message, size))
        return false;
    if (kind == MESSAGE_ATTRIBUTE)
        return read_attribute(s, size);
    if (kind == MESSAGE_INFO) {
        const size_t skip = s->message[1] & 1 ? 4 : 2;
        if (size < skip + 8 ||
            !snow_add_u64(s->base, number(s->message + skip, 8), &s->heap))
            s->heap = 0;
        return false;
    }
    uint64_t next;
    if (size >= 16 && snow_add_u64(s->base, number(s->message, 8), &next)) {
        /* Version 2 has "OCHK" before the messages and a sum behind them. */
        const uint64_t all = number(s->message + 8, 8), extra = s->version2;
        add_block(s, next + 4 * extra, all > 8 * extra ? all - 8 * extra : 0);
    }
    return false;
}

/* Looks for the name in a block of the heap, and for the head of an attribute,
 * of 8 or 9 bytes, before it. */
static bool search_block(search *s, uint64_t at, uint64_t size) {
    unsigned char part[MOST_MESSAGE];
    const size_t letters = strlen(s->name) + 1;
    for (uint64_t done = 0; done < size; done += sizeof part / 2) {
        const uint64_t left = size - done;
        const size_t got = snow_seekable_read(
            s->bytes, at + done, part, left < sizeof part ? left : sizeof part);
        for (size_t i = 9; i + letters <= got; i++) {
            if (memcmp(part + i, s->name, letters) != 0)
                continue;
            for (size_t head = 8; head <= 9; head++) {
                const size_t bytes =
                    snow_seekable_read(s->bytes, at + done + i - head,
                                       s->message, sizeof s->message);
                if (read_attribute(s, bytes))
                    return true;
            }
        }
    }
    return false;
}

/* The blocks of dense storage without filters, first ones first. */
static bool search_heap(search *s) {
    unsigned char head[142], entry[8];
    uint64_t root, done = 0;
    if (!s->heap || !copy_bytes(s, s->heap, head, sizeof head) ||
        memcmp(head, "FRHP", 4) != 0 || number(head + 7, 2) ||
        !snow_add_u64(s->base, number(head + 132, 8), &root))
        return false;
    const uint64_t width = number(head + 110, 2), rows = number(head + 140, 2);
    uint64_t size = number(head + 112, 8);
    if (!rows)
        return search_block(s, root, size < MOST_DENSE ? size : MOST_DENSE);
    uint64_t at = root + 13 + (number(head + 128, 2) + 7) / 8;
    for (uint64_t n = 0; n < rows * width && done < MOST_DENSE; n++, at += 8) {
        uint64_t to;
        if (n >= 2 * width && n % width == 0)
            size *= 2;
        if (!copy_bytes(s, at, entry, sizeof entry) || size > MOST_DENSE ||
            size < 64 || !snow_add_u64(s->base, number(entry, 8), &to))
            return false;
        done += size;
        if (number(entry, 8) != UINT64_MAX && search_block(s, to, size))
            return true;
    }
    return false;
}

static bool find(search *s, uint64_t header) {
    if (!open_header(s, header))
        return false;
    for (size_t i = 0; i < s->count; i++)
        for (uint64_t at = s->blocks[i].at; at + 4 <= s->blocks[i].end;)
            if (read_message(s, &at))
                return true;
    return search_heap(s);
}

/* Variable length: by our own parser. */
static void read_variable(const hdf5_file *file, hid_t object, const char *name,
                          size_t index, char *out, size_t room) {
    H5O_info_t about;
    search s = {.name = name, .index = index, .out = out, .room = room};
    uint64_t header;
    if (H5Oget_info2(object, &about, H5O_INFO_BASIC) < 0 ||
        !snow_hdf5_is_usual(file))
        return;
    s.bytes = snow_hdf5_bytes(file, &s.base);
    if (!snow_add_u64(s.base, about.addr, &header) || !find(&s, header))
        *out = 0;
}

/* Fixed length: an array is read whole. */
static void read_fixed(hid_t attribute, hid_t type, size_t index, size_t count,
                       char *out, size_t capacity) {
    char text[4096];
    const size_t size = H5Tget_size(type);
    if (!size || size > sizeof text / count ||
        H5Aread(attribute, type, text) < 0)
        return;
    size_t length = size < capacity ? size : capacity - 1;
    memcpy(out, text + index * size, length);
    out[length] = 0;
}

size_t snow_hdf5_text(const hdf5_file *file, hid_t object, const char *name,
                      size_t index, char *out, size_t capacity) {
    *out = 0;
    if (H5Aexists(object, name) <= 0)
        return 0;
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    if (attribute < 0)
        return 0;
    hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    hssize_t points = H5Sget_simple_extent_npoints(space);
    size_t count = points > 0 && points <= 64 ? (size_t)points : 0;
    if (H5Tget_class(type) != H5T_STRING || index >= count)
        count = 0;
    else if (H5Tis_variable_str(type) > 0)
        read_variable(file, object, name, index, out, capacity);
    else
        read_fixed(attribute, type, index, count, out, capacity);
    H5Sclose(space);
    H5Tclose(type);
    H5Aclose(attribute);
    return count;
}

#endif
