/* io/npy_header.c - reads the header of a NumPy array file. */
#include "io/npy_header.h"

#include <string.h>

static const unsigned char magic[6] = {0x93, 'N', 'U', 'M', 'P', 'Y'};

/* Headers have some 118 bytes; this leaves room for blanks. */
#define HEADER_BYTES 4096

bool snow_npy_probe(const unsigned char *bytes, size_t size) {
    return size >= sizeof magic && memcmp(bytes, magic, sizeof magic) == 0;
}

enum { KEY_TYPE = 1, KEY_ORDER = 2, KEY_SHAPE = 4, KEY_ALL = 7 };

static void skip_blanks(const char **at) {
    *at += strspn(*at, " \t\r\n");
}

/* Skips blanks, and `c` if it follows. */
static bool skip_char(const char **at, char c) {
    skip_blanks(at);
    if (**at != c)
        return false;
    ++*at;
    return true;
}

/* Parses a quoted string without escapes that fits. */
static bool take_string(const char **at, char *out, size_t size) {
    char quote = '\'';
    if (!skip_char(at, quote)) {
        quote = '"';
        if (!skip_char(at, quote))
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

/* Parses a Python truth value; NumPy does not write 0 and 1. */
static bool take_bool(const char **at, bool *out) {
    skip_blanks(at);
    *out = strncmp(*at, "True", 4) == 0;
    if (!*out && strncmp(*at, "False", 5) != 0)
        return false;
    *at += *out ? 4 : 5;
    return true;
}

/* Parses an unsigned integer; Python 2 put an L after large ones. */
static bool take_integer(const char **at, int64_t *out) {
    char digits[20];
    skip_blanks(at);
    size_t length = strspn(*at, "0123456789");
    if (length >= sizeof digits)
        return false;
    memcpy(digits, *at, length);
    digits[length] = '\0';
    *at += length;
    skip_char(at, 'L');
    return snow_parse_int64(digits, out);
}

/* Parses a tuple of integers: (), (n,), (n, m) and so on. */
static bool take_shape(const char **at, npy_header *header) {
    header->axes = 0;
    if (!skip_char(at, '('))
        return false;
    while (!skip_char(at, ')')) {
        int64_t side;
        if (!take_integer(at, &side))
            return false;
        if (header->axes < NPY_MOST_AXES)
            header->shape[header->axes] = side;
        header->axes++;
        if (!skip_char(at, ','))
            return skip_char(at, ')');
    }
    return true;
}

/* Parses `key: value`; a key that is not one of the three is an error. */
static bool take_entry(const char **at, npy_header *header) {
    char key[16];
    if (!take_string(at, key, sizeof key) || !skip_char(at, ':'))
        return false;
    if (strcmp(key, "descr") == 0) {
        header->keys |= KEY_TYPE;
        return take_string(at, header->type, sizeof header->type);
    }
    if (strcmp(key, "fortran_order") == 0) {
        header->keys |= KEY_ORDER;
        return take_bool(at, &header->fortran_order);
    }
    header->keys |= KEY_SHAPE;
    return strcmp(key, "shape") == 0 && take_shape(at, header);
}

/* Parses the literal; false unless it is complete, nothing follows it and all
 * three keys are present. Of a repeated key the last value counts, as in
 * Python. */
static bool parse_header(const char *text, npy_header *header) {
    if (!skip_char(&text, '{'))
        return false;
    while (!skip_char(&text, '}')) {
        if (!take_entry(&text, header))
            return false;
        if (!skip_char(&text, ',')) {
            if (!skip_char(&text, '}'))
                return false;
            break;
        }
    }
    skip_blanks(&text);
    return !*text && header->keys == KEY_ALL;
}

snow_status snow_npy_fail(snow_source *source, const char *reason) {
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "%s: %s", snow_source_name(source), reason);
}

snow_status snow_npy_read_header(snow_source *source, npy_header *header) {
    unsigned char start[12];
    char text[HEADER_BYTES + 1];
    SNOW_TRY(snow_source_read_all(source, start, 10, "the NPY header"));
    size_t length = start[8] | (size_t)start[9] << 8;
    if (!snow_npy_probe(start, sizeof start))
        return snow_npy_fail(
            source,
            "is not an NPY file, despite its name; write it with numpy.save");
    if (start[6] < 1 || start[6] > 3)
        return snow_npy_fail(source,
                             "unknown NPY version: 1 to 3 are supported; save "
                             "it again with numpy.save");
    if (start[6] > 1) {
        SNOW_TRY(snow_source_read_all(source, start + 10, 2, "the NPY header"));
        length |= (size_t)start[10] << 16 | (size_t)start[11] << 24;
    }
    if (length > HEADER_BYTES)
        return snow_npy_fail(source,
                             "the NPY header is too long for a plain array; "
                             "save an array of one number type");
    SNOW_TRY(snow_source_read_all(source, text, length, "the NPY header"));
    text[length] = '\0';
    *header = (npy_header){0};
    if (strlen(text) != length || !parse_header(text, header))
        return snow_npy_fail(source,
                             "the NPY header is damaged, or of an array with "
                             "named fields; save a plain array of float32");
    return SNOW_STATUS_OK;
}
