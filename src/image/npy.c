/* image/npy.c - pictures as NumPy arrays.
 *
 * Follows the description in numpy/lib/format.py, versions 1 to 3:
 *
 *   \x93NUMPY  major minor  header length (2 bytes; 4 from version 2 on)
 *   {'descr': '<f4', 'fortran_order': False, 'shape': (480, 640, 4), }  \n
 *   samples, the last index fastest
 *
 * The header is a Python literal of that one kind, with keys in any order.
 * Written are float32 arrays of (height, width, 4), premultiplied; read are
 * floats of both sizes and byte orders with 1 to 4 channels. */
#include "image/image.h"

#include <stdio.h>
#include <string.h>

static const unsigned char magic[6] = {0x93, 'N', 'U', 'M', 'P', 'Y'};

/* A picture's header has some 118 bytes; room for blanks is left. */
#define HEADER_BYTES 4096

/* The samples begin at a multiple of this, so that they can be mapped. */
#define DATA_ALIGNMENT 64

#define MAX_DIMS 3

/* The text is shorter than the room for any sides: the file is the same, byte
 * for byte, as numpy.save makes. */
static snow_status write_npy(const snow_image *image,
                             const snow_image_options *options,
                             snow_writer *writer) {
    (void)options;
    char header[2 * DATA_ALIGNMENT];
    memset(header, ' ', sizeof header);
    memcpy(header, magic, sizeof magic);
    memcpy(header + 6, "\1\0", 2);
    int length = 10 + snprintf(header + 10, sizeof header - 10,
                               "{'descr': '<f4', 'fortran_order': False, "
                               "'shape': (%d, %d, 4), }",
                               image->height, image->width);
    /* The longest text, for sides of 32768, still leaves the newline room. */
    header[length] = ' ';
    header[sizeof header - 1] = '\n';
    header[8] = (char)(sizeof header - 10);
    header[9] = 0;
    SNOW_TRY(snow_writer_write(writer, header, sizeof header));
    return snow_image_write_floats(image, 4, false, writer);
}

static bool probe_npy(const unsigned char *bytes, size_t size) {
    return size >= sizeof magic && memcmp(bytes, magic, sizeof magic) == 0;
}

/* What a header says; `keys` has a bit for each key that was there. */
typedef struct npy_header {
    char type[8];
    bool column_major;
    int64_t shape[MAX_DIMS];
    int dims; /* may be more than MAX_DIMS: the rest is not kept */
    unsigned keys;
} npy_header;

enum { KEY_TYPE = 1, KEY_ORDER = 2, KEY_SHAPE = 4, KEY_ALL = 7 };

static void skip_blanks(const char **at) {
    *at += strspn(*at, " \t\r\n");
}

/* Moves past blanks, and past `c` if that comes next. */
static bool take(const char **at, char c) {
    skip_blanks(at);
    if (**at != c)
        return false;
    ++*at;
    return true;
}

/* Takes a quoted string without escapes that fits. */
static bool take_string(const char **at, char *out, size_t size) {
    char quote = '\'';
    if (!take(at, quote)) {
        quote = '"';
        if (!take(at, quote))
            return false;
    }
    const char *end = strchr(*at, quote);
    if (!end || (size_t)(end - *at) >= size)
        return false;
    memcpy(out, *at, (size_t)(end - *at));
    out[end - *at] = '\0';
    *at = end + 1;
    return true;
}

/* Takes a Python truth value; 0 and 1 are not written by NumPy. */
static bool take_bool(const char **at, bool *out) {
    skip_blanks(at);
    *out = strncmp(*at, "True", 4) == 0;
    if (!*out && strncmp(*at, "False", 5) != 0)
        return false;
    *at += *out ? 4 : 5;
    return true;
}

/* Takes an integer without sign; Python 2 put an L behind large ones. */
static bool take_integer(const char **at, int64_t *out) {
    char digits[20];
    skip_blanks(at);
    size_t length = strspn(*at, "0123456789");
    if (length >= sizeof digits)
        return false;
    memcpy(digits, *at, length);
    digits[length] = '\0';
    *at += length;
    take(at, 'L');
    return snow_parse_int64(digits, out);
}

/* Takes a tuple of integers: (), (n,), (n, m) and so on. */
static bool take_shape(const char **at, npy_header *header) {
    header->dims = 0;
    if (!take(at, '('))
        return false;
    while (!take(at, ')')) {
        int64_t side;
        if (!take_integer(at, &side))
            return false;
        if (header->dims < MAX_DIMS)
            header->shape[header->dims] = side;
        header->dims++;
        if (!take(at, ','))
            return take(at, ')');
    }
    return true;
}

/* Takes `key: value`; a key that is not one of the three is an error. */
static bool take_entry(const char **at, npy_header *header) {
    char key[16];
    if (!take_string(at, key, sizeof key) || !take(at, ':'))
        return false;
    if (strcmp(key, "descr") == 0) {
        header->keys |= KEY_TYPE;
        return take_string(at, header->type, sizeof header->type);
    }
    if (strcmp(key, "fortran_order") == 0) {
        header->keys |= KEY_ORDER;
        return take_bool(at, &header->column_major);
    }
    header->keys |= KEY_SHAPE;
    return strcmp(key, "shape") == 0 && take_shape(at, header);
}

/* Reads the literal; false unless it is whole, nothing follows it and all three
 * keys are there.  A key told twice counts as Python has it: the last one. */
static bool parse_header(const char *text, npy_header *header) {
    if (!take(&text, '{'))
        return false;
    while (!take(&text, '}')) {
        if (!take_entry(&text, header))
            return false;
        if (!take(&text, ',')) {
            if (!take(&text, '}'))
                return false;
            break;
        }
    }
    skip_blanks(&text);
    return !*text && header->keys == KEY_ALL;
}

static snow_status refuse(snow_source *source, const char *reason) {
    return snow_fail(snow_source_context(source), SNOW_BAD_INPUT, "%s: %s",
                     snow_source_name(source), reason);
}

/* Takes the file up to the first sample. */
static snow_status read_header(snow_source *source, npy_header *header) {
    unsigned char start[12];
    char text[HEADER_BYTES + 1];
    SNOW_TRY(snow_source_read_all(source, start, 10, "the NPY header"));
    size_t length = start[8] | (size_t)start[9] << 8;
    if (start[6] < 1 || start[6] > 3)
        return refuse(source, "this version of NPY is not read; 1 to 3 are");
    if (start[6] > 1) {
        SNOW_TRY(snow_source_read_all(source, start + 10, 2, "the NPY header"));
        length |= (size_t)start[10] << 16 | (size_t)start[11] << 24;
    }
    if (length > HEADER_BYTES)
        return refuse(source, "the NPY header is longer than any picture's; "
                              "save a plain array of float32");
    SNOW_TRY(snow_source_read_all(source, text, length, "the NPY header"));
    text[length] = '\0';
    *header = (npy_header){0};
    if (strlen(text) != length || !parse_header(text, header))
        return refuse(source, "the NPY header is damaged, or of an array with "
                              "named fields; save a plain array of float32");
    return SNOW_OK;
}

/* Takes apart a type such as <f4.  NumPy writes the byte order of the machine
 * as < or >, never as =. */
static bool parse_type(const char *type, snow_float_layout *layout) {
    bool known = (type[0] == '<' || type[0] == '>') && type[1] == 'f' &&
                 (type[2] == '4' || type[2] == '8') && type[3] == '\0';
    layout->big_endian = type[0] == '>';
    layout->sample_bytes = known ? type[2] - '0' : 0;
    return known;
}

/* Each refusal tells the NumPy call that makes a readable file. */
static snow_status read_npy(snow_source *source, snow_image **out) {
    npy_header header;
    snow_float_layout layout = {.channels = 1};
    SNOW_TRY(read_header(source, &header));
    if (!parse_type(header.type, &layout))
        return refuse(source, "the array is not of float32 or float64; save "
                              "it with .astype('float32')");
    if (header.column_major)
        return refuse(source, "the array is in Fortran order; save it with "
                              "numpy.ascontiguousarray");
    bool has_channels = header.dims == 3;
    if ((header.dims != 2 && !has_channels) ||
        (has_channels && (header.shape[2] < 1 || header.shape[2] > 4)))
        return refuse(source, "the array has not the shape of a picture; it "
                              "is (h, w) or (h, w, 1 to 4)");
    if (has_channels)
        layout.channels = (int)header.shape[2];
    return snow_image_read_floats(source, header.shape[1], header.shape[0],
                                  &layout, out);
}

const snow_image_format snow_image_npy = {
    .name = "NPY",
    .suffix = ".npy",
    .write = write_npy,
    .probe = probe_npy,
    .read = read_npy,
};
